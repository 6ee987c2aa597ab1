"""From a case to a scene: meshes, masses, contact pairs, step."""

from ddf.build.loads import load_path
from ddf.build.rest import state_at_rest
from ddf.build.scene import build_scene

__all__ = ["build_scene", "load_path", "state_at_rest"]
