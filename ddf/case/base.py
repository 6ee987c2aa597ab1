"""What every section of a case shares: its strictness, and the value types used by several sections."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

MAX_POINTS = 2000


class Section(BaseModel):
    """One table of a case file: immutable, no unknown keys, no NaN or infinity, no silent conversion."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False, strict=True)


def _both_families(value: object) -> object:
    """Turn one number into the pair that holds for both fibre families; leave anything else alone."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        return (value, value)
    return value


Coordinate = Annotated[float, Field(ge=-10_000, le=10_000)]
Point = Annotated[tuple[Coordinate, Coordinate], Field(strict=False)]
Polygon = Annotated[tuple[Point, ...], Field(strict=False, min_length=3, max_length=MAX_POINTS)]
Polyline = Annotated[tuple[Point, ...], Field(strict=False, min_length=2, max_length=MAX_POINTS)]
Positive = Annotated[float, Field(gt=0, le=1e7)]
NonNegative = Annotated[float, Field(ge=0, le=1e7)]
PositivePair = Annotated[
    tuple[Positive, Positive],
    Field(strict=False),
    BeforeValidator(_both_families, json_schema_input_type=Positive | tuple[Positive, Positive]),
]
NonNegativePair = Annotated[
    tuple[NonNegative, NonNegative],
    Field(strict=False),
    BeforeValidator(_both_families, json_schema_input_type=NonNegative | tuple[NonNegative, NonNegative]),
]
# Names become file names in the run folder.
Name = Annotated[str, Field(min_length=1, max_length=64, pattern=r"^[A-Za-z0-9][A-Za-z0-9._-]*$")]
