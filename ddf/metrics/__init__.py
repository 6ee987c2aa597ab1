"""What a formed ply is judged by: boundary profile, shear, bridging and wrinkles."""

from ddf.metrics.boundary import BoundaryProfile, boundary_profile, draw_in, outline_area, outline_length
from ddf.metrics.bridging import Bridging, find_bridging
from ddf.metrics.shear import fibre_strain, fibre_strain_range, shear_angle, shear_statistics
from ddf.metrics.summary import outline_numbers, ply_metrics, wrinkle_row
from ddf.metrics.surface import PlySurface
from ddf.metrics.wrinkles import Wrinkle, WrinkleResult, find_wrinkles

__all__ = [
    "BoundaryProfile",
    "Bridging",
    "PlySurface",
    "Wrinkle",
    "WrinkleResult",
    "boundary_profile",
    "draw_in",
    "fibre_strain",
    "fibre_strain_range",
    "find_bridging",
    "find_wrinkles",
    "outline_area",
    "outline_length",
    "outline_numbers",
    "ply_metrics",
    "shear_angle",
    "shear_statistics",
    "wrinkle_row",
]
