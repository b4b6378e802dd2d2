"""A number that is W numbers: one state in each lane of a processor's vector register.

`Lanes(W)` is a numba type held in one LLVM vector of W doubles, with arithmetic.
Interpreted, such a number is an array.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from functools import cache
from typing import Any

import llvmlite.binding
import numpy as np
from llvmlite import ir
from numba.core import cgutils, types
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, lower_cast, models, overload, register_model

from ospace.kernels.jit.compile import INLINED

_DOUBLE = ir.DoubleType()
FLAGS = ("contract", "reassoc", "nsz", "arcp")


class Lanes(types.Type):
    """W doubles in one vector."""

    def __init__(self, width: int) -> None:
        self.width = width
        super().__init__(name=f"Lanes({width})")


@register_model(Lanes)
class _LanesModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Lanes) -> None:
        super().__init__(manager, kind, ir.VectorType(_DOUBLE, kind.width))


WIDTHS = {width: Lanes(width) for width in (2, 4, 8)}


def _splat(builder: Any, x: Any, width: int) -> Any:
    """All lanes alike."""
    kind = ir.VectorType(_DOUBLE, width)
    nothing = ir.Constant(kind, ir.Undefined)
    first = builder.insert_element(nothing, x, ir.Constant(ir.IntType(32), 0))
    return builder.shuffle_vector(first, nothing, ir.Constant(ir.VectorType(ir.IntType(32), width), [0] * width))


@lower_cast(types.Float, Lanes)
def _same_in_all_lanes(context: Any, builder: Any, given: Any, kind: Lanes, x: Any) -> Any:
    return _splat(builder, context.cast(builder, x, given, types.float64), kind.width)


def _both_as_lanes(context: Any, builder: Any, sig: Any, args: Any) -> list[Any]:
    width = sig.return_type.width
    return [
        x if isinstance(kind, Lanes) else _splat(builder, context.cast(builder, x, kind, types.float64), width)
        for x, kind in zip(args, sig.args, strict=True)
    ]


def _binary(key: Callable[..., Any], method: str) -> None:
    class Typing(AbstractTemplate):
        def generic(self, args: Any, kws: Any) -> Any:
            lanes = [kind for kind in args if isinstance(kind, Lanes)]
            others = [kind for kind in args if not isinstance(kind, Lanes)]
            if len(args) == 2 and lanes and all(isinstance(kind, types.Number) for kind in others):
                return signature(lanes[0], *args)
            return None

    Typing.key = key
    infer_global(key)(Typing)

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return getattr(builder, method)(*_both_as_lanes(context, builder, sig, args), flags=FLAGS)

    for kinds in ((Lanes, Lanes), (Lanes, types.Number), (types.Number, Lanes)):
        lower_builtin(key, *kinds)(lower)


for _key, _method in (
    (operator.add, "fadd"),
    (operator.sub, "fsub"),
    (operator.mul, "fmul"),
    (operator.truediv, "fdiv"),
    (operator.iadd, "fadd"),
):
    _binary(_key, _method)


@infer_global(operator.neg)
class _Negative(AbstractTemplate):
    def generic(self, args: Any, kws: Any) -> Any:
        return signature(args[0], args[0]) if isinstance(args[0], Lanes) else None


@lower_builtin(operator.neg, Lanes)
def _lower_negative(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    return builder.fneg(args[0])


def _call(name: str, builder: Any, args: Any) -> Any:
    """Call LLVM's function `name` on numbers of either kind."""
    kind = args[0].type
    suffix = f"v{kind.count}f64" if isinstance(kind, ir.VectorType) else "f64"
    function_type = ir.FunctionType(kind, [kind] * len(args))
    called = cgutils.get_or_insert_function(builder.module, function_type, f"llvm.{name}.{suffix}")
    return builder.call(called, args)


@intrinsic
def _sqrt(typing: Any, x: Any) -> Any:
    return x(x), lambda context, builder, sig, args: _call("sqrt", builder, args)


@intrinsic
def _fabs(typing: Any, x: Any) -> Any:
    return x(x), lambda context, builder, sig, args: _call("fabs", builder, args)


@intrinsic
def _floor(typing: Any, x: Any) -> Any:
    return x(x), lambda context, builder, sig, args: _call("floor", builder, args)


@intrinsic
def _minnum(typing: Any, x: Any, y: Any) -> Any:
    return x(x, x), lambda context, builder, sig, args: _call("minnum", builder, args)


@intrinsic
def _copysign(typing: Any, x: Any, y: Any) -> Any:
    return x(x, x), lambda context, builder, sig, args: _call("copysign", builder, args)


@intrinsic
def _fence(typing: Any, x: Any) -> Any:
    return x(x), lambda context, builder, sig, args: _call("arithmetic.fence", builder, args)


def fence(x: Any) -> Any:
    """x, computed before what follows: sums are not reordered across."""
    return x


@overload(fence, strict=False, jit_options=INLINED)
def _fenced(x: Any) -> Any:
    return lambda x: _fence(x)


def sqrt(x: Any) -> Any:
    """√x."""
    return np.sqrt(x)


def absolute(x: Any) -> Any:
    """|x|."""
    return np.abs(x)


def copysign(x: Any, y: Any) -> Any:
    """|x| with the sign of y."""
    return np.copysign(x, y)


def floor(x: Any) -> Any:
    """The largest whole number not above x."""
    return np.floor(x)


def minimum(x: Any, y: Any) -> Any:
    """The smaller of two; the other one of NaN."""
    return np.fmin(x, y)


def maximum(x: Any, y: Any) -> Any:
    """The larger of two; the other one of NaN."""
    return np.fmax(x, y)


@overload(sqrt, strict=False, jit_options=INLINED)
def _overload_sqrt(x: Any) -> Any:
    return lambda x: _sqrt(x)


@overload(absolute, strict=False, jit_options=INLINED)
def _overload_absolute(x: Any) -> Any:
    return lambda x: _fabs(x)


@overload(copysign, strict=False, jit_options=INLINED)
def _overload_copysign(x: Any, y: Any) -> Any:
    return lambda x, y: _copysign(x, y)


@overload(floor, strict=False, jit_options=INLINED)
def _floor_(x: Any) -> Any:
    return lambda x: _floor(x)


@intrinsic
def _maxnum(typing: Any, x: Any, y: Any) -> Any:
    return x(x, x), lambda context, builder, sig, args: _call("maxnum", builder, args)


@overload(maximum, strict=False, jit_options=INLINED)
def _overload_maximum(x: Any, y: Any) -> Any:
    return lambda x, y: _maxnum(x, y)


@overload(minimum, strict=False, jit_options=INLINED)
def _overload_minimum(x: Any, y: Any) -> Any:
    return lambda x, y: _minnum(x, y)


def full_like(value: float, number: Any) -> Any:
    """`value` as the kind of number that `number` is."""
    return value


@overload(full_like, strict=False, jit_options=INLINED)
def _overload_full_like(value: Any, number: Any) -> Any:
    if isinstance(number, Lanes):
        return lambda value, number: _repeat(value, number)
    return lambda value, number: value


@intrinsic
def _repeat(typing: Any, value: Any, number: Any) -> Any:
    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return _splat(builder, args[0], number.width)

    return number(types.float64, number), generate


def zeros(width: int) -> Any:
    """Zero as a number of `width` lanes, a literal; a plain float for 1."""
    return 0.0 if width == 1 else np.zeros(width)


@overload(zeros, strict=False, prefer_literal=True, jit_options=INLINED)
def _zeros(width: Any) -> Any:
    return lambda width: _nothing(width)


@intrinsic(prefer_literal=True)
def _nothing(typing: Any, width: Any) -> Any:
    kind = WIDTHS.get(width.literal_value, types.float64)

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return cgutils.get_null_value(context.get_value_type(kind))

    return kind(width), generate


@cache
def widest() -> int:
    """Return the number of doubles that this machine's processor takes in one vector."""
    try:
        features = llvmlite.binding.get_host_cpu_features()
    except RuntimeError:  # unknown on this platform
        return 2
    return 8 if features.get("avx512f") else 4 if features.get("avx") else 2
