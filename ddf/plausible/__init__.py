"""Whether a valid case makes physical sense and can be run here: what no single key of the file can tell."""

from ddf.plausible.prepare import examine, prepare

__all__ = ["examine", "prepare"]
