"""What compiled functions hand on as one pointer: the fields of a named tuple, by reference.

A named tuple of forty arrays is handed from function to function as some three hundred numbers, and a compiler that
follows them through a dozen functions takes minutes. `held` copies the fields (not the arrays) into one block of memory
of numba's own; compiled code reads `handle.field` as it read `tuple.field`. The handle does not own the arrays: who
holds it holds the tuple too. (Counting owners, two threads would write to the same few counters at every access.)
"""

from __future__ import annotations

from numba import njit, types
from numba.core import cgutils
from numba.experimental import structref
from numba.experimental.jitclass.base import imp_dtor
from numba.extending import intrinsic


@structref.register
class HandleType(types.StructRef):
    """Type of a handle; its fields are those of the tuple, names and types."""

    def preprocess_fields(self, fields):
        """Fields without literal types."""
        return tuple((name, types.unliteral(kind)) for name, kind in fields)


class Handle(structref.StructRefProxy):
    """A handle as Python sees it: something to pass on to compiled functions."""


structref.define_boxing(HandleType, Handle)


def _borrowed(context, builder, kind, value):
    """Code for a value without owners: references to it are not counted."""
    if isinstance(kind, types.Array):
        array = context.make_array(kind)(context, builder, value)
        array.meminfo = cgutils.get_null_value(array.meminfo.type)
        array.parent = cgutils.get_null_value(array.parent.type)
        return array._getvalue()
    if isinstance(kind, types.Tuple | types.UniTuple):
        for position, part in enumerate(kind.types):
            borrowed = _borrowed(context, builder, part, builder.extract_value(value, position))
            value = builder.insert_value(value, borrowed, position)
    return value


@intrinsic
def _hold(typingctx, data):
    """A handle on the fields of a named tuple."""
    kind = HandleType(tuple(zip(data.fields, data.types, strict=True)))

    def codegen(context, builder, signature, args):
        layout = context.data_model_manager[kind.get_data_type()]
        block = layout.get_value_type()
        size = context.get_constant(types.uintp, context.get_abi_sizeof(block))
        free = imp_dtor(context, builder.module, kind)
        memory = context.nrt.meminfo_alloc_dtor(builder, size, free)
        pointer = builder.bitcast(context.nrt.meminfo_data(builder, memory), block.as_pointer())
        builder.store(cgutils.get_null_value(block), pointer)
        values = cgutils.create_struct_proxy(kind.get_data_type())(context, builder, ref=pointer)
        for position, (name, field) in enumerate(zip(data.fields, data.types, strict=True)):
            setattr(values, name, _borrowed(context, builder, field, builder.extract_value(args[0], position)))
        handle = context.make_helper(builder, kind)
        handle.meminfo = memory
        return handle._getvalue()

    return kind(data), codegen


@njit(cache=True)
def held(data):
    """A handle on the fields of a named tuple `data`; arrays are shared, not owned, numbers copied."""
    return _hold(data)
