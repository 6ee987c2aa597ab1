"""A team of threads that runs one compiled function side by side.

Every member runs the same code. Within a phase the members draw task numbers from a shared counter; a
barrier closes the phase. Counter and barrier only ever grow, so nothing needs resetting. Which member runs a
task never matters for the result. A member that waits spins briefly, then yields its processor, then sleeps,
so a busy machine costs little.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
from llvmlite import ir
from numba import njit, types
from numba.core import cgutils
from numba.extending import intrinsic

_yield = types.ExternalFunction("sched_yield", types.int32())
_usleep = types.ExternalFunction("usleep", types.int32(types.uint32))

ARRIVED, DRAWN = 0, 8  # a cache line apart
SPINS, YIELDS = 2000, 200


@intrinsic
def atomic_add(typingctx, array, index, amount):
    """array[index] += amount, atomically; returns the old value. array: int64, one dimension."""

    def codegen(context, builder, signature, args):
        view = context.make_array(signature.args[0])(context, builder, args[0])
        position = context.cast(builder, args[1], signature.args[1], types.intp)
        pointer = cgutils.get_item_pointer(context, builder, signature.args[0], view, [position])
        value = context.cast(builder, args[2], signature.args[2], types.int64)
        return builder.atomic_rmw("add", pointer, value, "seq_cst")

    return types.int64(array, index, amount), codegen


@intrinsic
def atomic_load(typingctx, array, index):
    """Value of array[index], not cached in a register. array: int64, one dimension."""

    def codegen(context, builder, signature, args):
        view = context.make_array(signature.args[0])(context, builder, args[0])
        position = context.cast(builder, args[1], signature.args[1], types.intp)
        pointer = cgutils.get_item_pointer(context, builder, signature.args[0], view, [position])
        zero = ir.Constant(ir.IntType(64), 0)
        return builder.atomic_rmw("add", pointer, zero, "seq_cst")

    return types.int64(array, index), codegen


@njit(cache=True, nogil=True)
def barrier(sync, members):
    """Wait until all members have come here."""
    if members == 1:
        return
    mine = atomic_add(sync, ARRIVED, 1)
    target = (mine // members + 1) * members
    waited = 0
    while atomic_load(sync, ARRIVED) < target:
        waited += 1
        if waited > SPINS + YIELDS:
            _usleep(np.uint32(20))
        elif waited > SPINS:
            _yield()


@njit(cache=True, nogil=True)
def draw(sync, base):
    """Next task number of the phase that began at counter value `base`."""
    return atomic_add(sync, DRAWN, 1) - base


class Team:
    """`members` threads that call the same compiled function, each with its own number first."""

    def __init__(self, members: int) -> None:
        self.members = members
        self.sync = np.zeros(16, dtype=np.int64)
        self._pool = ThreadPoolExecutor(members - 1) if members > 1 else None

    def run(self, function: Callable[..., None], *arguments: object, members: int | None = None) -> None:
        """Call function(member, members, sync, *arguments) on all members, or on so many; return when all have."""
        self.sync[:] = 0
        count = self.members if members is None else members
        if self._pool is None or count == 1:
            function(0, 1, self.sync, *arguments)
            return
        others = [self._pool.submit(function, k, count, self.sync, *arguments) for k in range(1, count)]
        function(0, count, self.sync, *arguments)
        for other in others:
            other.result()

    def each(self, tasks: list[Callable[[], Any]]) -> list[Any]:
        """Call tasks that know nothing of each other, on whichever member is free; returns their results."""
        if self._pool is None:
            return [task() for task in tasks]
        waiting = [self._pool.submit(task) for task in tasks]
        # from the last on, what no other thread has begun is done here
        results = [task() if at.cancel() else at.result() for task, at in zip(tasks[::-1], waiting[::-1], strict=True)]
        return results[::-1]

    def close(self) -> None:
        """End the threads."""
        if self._pool is not None:
            self._pool.shutdown()
