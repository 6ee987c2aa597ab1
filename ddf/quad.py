"""Four doubles in one register: the little explicit SIMD that kernels need (numba has none).

Contact stores a node of a master sheet as (x, y, z, cover): one load, and each weight multiplies all components; with
fastmath `scaled` and `add_scaled` become one packed instruction each. Fibre lines are gathered four numbers at a time.
"""

from __future__ import annotations

from llvmlite import ir
from numba import njit, types
from numba.core import cgutils
from numba.core.errors import TypingError
from numba.extending import intrinsic, models, register_model

from ddf.jit import INLINE

VECTOR = ir.VectorType(ir.DoubleType(), 4)
SINGLES = ir.VectorType(ir.FloatType(), 4)


class _Quad(types.Type):
    def __init__(self) -> None:
        super().__init__(name="Quad")


QUAD = _Quad()


@register_model(_Quad)
class _QuadModel(models.PrimitiveModel):
    def __init__(self, manager, kind) -> None:
        super().__init__(manager, kind, VECTOR)


def _flat(array):
    """Refuse arrays that do not lie in memory as one row after the other: they would be read at wrong places."""
    if array.layout != "C":
        raise TypingError(f"contiguous array wanted, not {array}")


def _address(context, builder, kind, array, index, vector=VECTOR):
    """Pointer to four numbers of a contiguous array seen as flat."""
    data = context.make_array(kind)(context, builder, array).data
    return builder.bitcast(builder.gep(data, [index]), vector.as_pointer())


def _splat(builder, number):
    """The number in all four places."""
    one = builder.insert_element(ir.Constant(VECTOR, ir.Undefined), number, ir.Constant(ir.IntType(32), 0))
    mask = ir.Constant(ir.VectorType(ir.IntType(32), 4), [0, 0, 0, 0])
    return builder.shuffle_vector(one, ir.Constant(VECTOR, ir.Undefined), mask)


@intrinsic
def load(typing, array, index):
    """Four numbers from place `index` (uint64) on of a contiguous array seen as flat, float64 or float32."""
    _flat(array)
    single = array.dtype == types.float32

    def build(context, builder, signature, args):
        kind = SINGLES if single else VECTOR
        found = builder.load(_address(context, builder, signature.args[0], *args, kind), align=4 if single else 8)
        return builder.fpext(found, VECTOR) if single else found

    return QUAD(array, types.uint64), build


@intrinsic
def expect(typing, array, index):
    """Have the processor fetch what lies at place `index` (uint64) of a contiguous array seen as flat."""
    _flat(array)

    def build(context, builder, signature, args):
        data = context.make_array(signature.args[0])(context, builder, args[0]).data
        pointer, number = ir.IntType(8).as_pointer(), ir.IntType(32)
        kind = ir.FunctionType(ir.VoidType(), [pointer, number, number, number])
        function = cgutils.get_or_insert_function(builder.module, kind, "llvm.prefetch.p0")
        place = builder.bitcast(builder.gep(data, [args[1]]), pointer)
        builder.call(function, [place, number(0), number(3), number(1)])  # to read, soon again, data
        return context.get_dummy_value()

    return types.void(array, types.uint64), build


@intrinsic
def store(typing, array, index, value):
    """Put the value to place `index` (uint64) and the three after it of a contiguous float64 array seen as flat."""
    _flat(array)

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
    """Component 0, 1, 2 or 3 of a quad."""

    def build(context, builder, signature, args):
        return builder.extract_element(args[0], args[1])

    return types.float64(QUAD, types.int64), build


def _shuffled(places):
    """Intrinsic of two quads: one made of the numbers at four places of both, those of the second from 4 on."""

    @intrinsic
    def shuffle(typing, first, second):
        def build(context, builder, signature, args):
            return builder.shuffle_vector(*args, ir.Constant(ir.VectorType(ir.IntType(32), 4), places))

        return QUAD(QUAD, QUAD), build

    return shuffle


_even, _odd = _shuffled([0, 4, 2, 6]), _shuffled([1, 5, 3, 7])
_low, _high = _shuffled([0, 1, 4, 5]), _shuffled([2, 3, 6, 7])


@njit(**INLINE)
def transposed(a, b, c, d):
    """The four quads of the first, second, third and fourth numbers of four quads."""
    p, q, r, s = _even(a, b), _odd(a, b), _even(c, d), _odd(c, d)
    return _low(p, r), _low(q, s), _high(p, r), _high(q, s)
