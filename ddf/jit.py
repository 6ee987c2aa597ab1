"""How kernels are compiled."""

from __future__ import annotations

from typing import Any

INLINE: dict[str, Any] = {
    "fastmath": True, "error_model": "numpy", "boundscheck": False, "nogil": True, "forceinline": True,
}  # fmt: skip
"""Options of small functions that are part of whatever kernel calls them. (numba's own `inline="always"` has their
types found out again for every call: compiling took a third longer.)"""

FAST: dict[str, Any] = {
    "fastmath": True, "error_model": "numpy", "boundscheck": False, "nogil": True, "cache": True,
    "no_cfunc_wrapper": True,
}  # fmt: skip
"""Options of kernels. (A wrapper for calls from C, which nothing does, is a tenth of what there is to compile.)"""
