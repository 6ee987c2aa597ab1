"""`fidelity = "auto"`: the cheapest rung of a ladder that is valid for a scene and meets its target."""

from ddf.fidelity.choice import Choice, choose

__all__ = ["Choice", "choose"]
