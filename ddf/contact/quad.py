"""Four doubles in one register: the little explicit SIMD that contact needs (numba has none).

A node of a master sheet is stored as (x, y, z, cover): one load, and each weight multiplies all components.
With fastmath `scaled` and `add_scaled` become one packed instruction each.
"""

from __future__ import annotations

from llvmlite import ir
from numba import types
from numba.extending import intrinsic, models, register_model

VECTOR = ir.VectorType(ir.DoubleType(), 4)


class _Quad(types.Type):
    def __init__(self) -> None:
        super().__init__(name="Quad")


QUAD = _Quad()


@register_model(_Quad)
class _QuadModel(models.PrimitiveModel):
    def __init__(self, manager, kind) -> None:
        super().__init__(manager, kind, VECTOR)


def _address(context, builder, kind, array, index):
    """Pointer to four doubles of a flat contiguous array."""
    data = context.make_array(kind)(context, builder, array).data
    return builder.bitcast(builder.gep(data, [index]), VECTOR.as_pointer())


def _splat(builder, number):
    """The number in all four places."""
    one = builder.insert_element(ir.Constant(VECTOR, ir.Undefined), number, ir.Constant(ir.IntType(32), 0))
    mask = ir.Constant(ir.VectorType(ir.IntType(32), 4), [0, 0, 0, 0])
    return builder.shuffle_vector(one, ir.Constant(VECTOR, ir.Undefined), mask)


@intrinsic
def load(typing, array, index):
    """array[index : index + 4]; array (n,) contiguous float64, index uint64."""

    def build(context, builder, signature, args):
        return builder.load(_address(context, builder, signature.args[0], *args), align=8)

    return QUAD(array, types.uint64), build


@intrinsic
def store(typing, array, index, value):
    """array[index : index + 4] = value."""

    def build(context, builder, signature, args):
        builder.store(args[2], _address(context, builder, signature.args[0], *args[:2]), align=8)
        return context.get_dummy_value()

    return types.void(array, types.uint64, QUAD), build


@intrinsic
def quad(typing, x, y, z):
    """(x, y, z, 0)."""

    def build(context, builder, signature, args):
        value = ir.Constant(VECTOR, [0.0] * 4)
        for k in range(3):
            value = builder.insert_element(value, args[k], ir.Constant(ir.IntType(32), k))
        return value

    return QUAD(types.float64, types.float64, types.float64), build


@intrinsic
def quad_with(typing, x, y, z, w):
    """(x, y, z, w)."""

    def build(context, builder, signature, args):
        value = ir.Constant(VECTOR, [0.0] * 4)
        for k in range(4):
            value = builder.insert_element(value, args[k], ir.Constant(ir.IntType(32), k))
        return value

    return QUAD(types.float64, types.float64, types.float64, types.float64), build


@intrinsic
def scaled(typing, number, value):
    """Return number * value."""

    def build(context, builder, signature, args):
        return builder.fmul(_splat(builder, args[0]), args[1])

    return QUAD(types.float64, QUAD), build


@intrinsic
def add_scaled(typing, number, value, rest):
    """Return number * value + rest."""

    def build(context, builder, signature, args):
        return builder.fadd(builder.fmul(_splat(builder, args[0]), args[1]), args[2])

    return QUAD(types.float64, QUAD, QUAD), build


@intrinsic
def part(typing, value, index):
    """Component 0, 1 or 2 of a quad."""

    def build(context, builder, signature, args):
        return builder.extract_element(args[0], args[1])

    return types.float64(QUAD, types.int64), build
