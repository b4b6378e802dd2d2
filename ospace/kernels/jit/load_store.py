"""Tables in flat memory, and how rows come out of them as tuples and go back.

A `View` is a numba type of a start, rows and columns: less than a NumPy array, since the memory outlives the call and
no reference is counted, which would take longer than the arithmetic. ``rows[i, k]`` is a number of either kind.
Interpreted, a table is a NumPy array. Rows of NumPy arrays that a kernel is given are loaded by the same functions.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any, Literal, overload

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils, config
from numba.core.typing.templates import AbstractTemplate, AttributeTemplate, infer_getattr, infer_global, signature
from numba.extending import lower_builtin, lower_getattr, models, register_model

from ospace.kernels.jit.compile import Mat3, Mat6, Row, Sym6, Table, Vec3, Vec6
from ospace.kernels.jit.simd import FLAGS


class View(types.Type):
    """A table of numbers of one kind, or with one dimension a list."""

    def __init__(self, dtype: Any, ndim: int) -> None:
        self.dtype, self.ndim = dtype, ndim
        super().__init__(name=f"View({dtype}, {ndim})")


@register_model(View)
class _ViewModel(models.StructModel):
    def __init__(self, manager: Any, kind: View) -> None:
        members = [("data", types.CPointer(kind.dtype)), ("rows", types.intp), ("columns", types.intp)]
        super().__init__(manager, kind, members)


def build_view(context: Any, builder: Any, memory: Any, flat: Any, extent: Any, seen: View) -> Any:
    """Write the instructions that make a view of type `seen` in `flat` memory: start, rows and columns."""
    start, rows, columns = extent
    if isinstance(memory, View):
        source = cgutils.create_struct_proxy(memory)(context, builder, value=flat).data
    else:
        source = context.make_array(memory)(context, builder, flat).data
    result = cgutils.create_struct_proxy(seen)(context, builder)
    pointer = context.get_data_type(seen.dtype).as_pointer()
    result.data = builder.bitcast(builder.gep(source, [start]), pointer)
    result.rows, result.columns = rows, columns
    return result._getvalue()


# -- views of flat memory ------------------------------------------------------------------------------------


class _Values(np.ndarray):
    """Numbers of several lanes that are read as values, as compiled kernels read them, not as views."""

    def __getitem__(self, at: Any) -> Any:
        found = super().__getitem__(at)
        return np.array(found) if isinstance(at, tuple) else found

    def __setitem__(self, at: Any, value: Any) -> None:
        self.view(np.ndarray)[at] = value  # NumPy would go through __getitem__


def table(memory: Any, start: int, rows: int, columns: int, number: Any) -> Any:
    """Return a view of flat memory, from `start` on, as a table of numbers such as `number`."""
    lanes = np.shape(number)
    end = start + rows * columns * (lanes[0] if lanes else 1)
    return memory[start:end].reshape((rows, columns, *lanes)).view(_Values if lanes else np.ndarray)


def view_int(memory: Any, start: int, length: int) -> Any:
    """Return a view of flat memory as integers."""
    return memory[start : start + length].view(np.int64)


def unowned(array: Any) -> Any:
    """Return a list of an array's numbers, in whose passing on no references are counted."""
    return array


@infer_global(unowned)
class _Unowned(AbstractTemplate):
    def generic(self, args: Any, kws: Any) -> Any:
        return signature(View(args[0].dtype, 1), args[0])


@lower_builtin(unowned, types.Array)
def _lower_unowned(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    array = context.make_array(sig.args[0])(context, builder, args[0])
    zero, one = (context.get_constant(types.intp, k) for k in (0, 1))
    return build_view(context, builder, sig.args[0], args[0], [zero, array.nitems, one], sig.return_type)


@infer_global(table)
class _Table(AbstractTemplate):
    def generic(self, args: Any, kws: Any) -> Any:
        memory, *_, number = args
        return signature(View(types.unliteral(number), 2), memory, *[types.intp] * 3, types.unliteral(number))


@lower_builtin(table, View, types.intp, types.intp, types.intp, types.Any)
@lower_builtin(table, types.Array, types.intp, types.intp, types.intp, types.Any)
def _lower_table(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    return build_view(context, builder, sig.args[0], args[0], args[1:4], sig.return_type)


@infer_global(view_int)
class _ViewInt(AbstractTemplate):
    def generic(self, args: Any, kws: Any) -> Any:
        return signature(View(types.int64, 1), args[0], types.intp, types.intp)


@lower_builtin(view_int, View, types.intp, types.intp)
@lower_builtin(view_int, types.Array, types.intp, types.intp)
def _lower_view_int(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    extent = [args[1], args[2], context.get_constant(types.intp, 1)]
    return build_view(context, builder, sig.args[0], args[0], extent, sig.return_type)


# -- single numbers ------------------------------------------------------------------------------------------


def _address(context: Any, builder: Any, kind: Any, rows: Any, at: Any) -> Any:
    """Pointer to the number in row and column `at`, of a view or of an array."""
    if isinstance(kind, types.Array):
        array = context.make_array(kind)(context, builder, rows)
        return cgutils.get_item_pointer(context, builder, kind, array, at, wraparound=False, boundscheck=_checks())
    view = cgutils.create_struct_proxy(kind)(context, builder, value=rows)
    if _checks():
        for index, length in zip(at, (view.rows, view.columns), strict=False):
            cgutils.do_boundscheck(context, builder, index, length)
    if kind.ndim == 1:
        return builder.gep(view.data, at)
    return builder.gep(view.data, [builder.add(builder.mul(at[0], view.columns), at[1])])


def _checks() -> bool:
    return bool(config.BOUNDSCHECK)


def _aligned(instruction: Any) -> Any:
    instruction.align = 8  # of a vector as well: memory is as NumPy gives it
    return instruction


def _index(kind: View) -> Any:
    return types.UniTuple(types.intp, 2) if kind.ndim == 2 else types.intp


def _indices(builder: Any, kind: View, at: Any) -> Any:
    return cgutils.unpack_tuple(builder, at, 2) if kind.ndim == 2 else [at]


@infer_global(operator.getitem)
class _GetItem(AbstractTemplate):
    def generic(self, args: Any, kws: Any) -> Any:
        view, at = args
        if isinstance(view, View) and isinstance(at, types.BaseTuple) == (view.ndim == 2):
            return signature(view.dtype, view, _index(view))
        return None


@lower_builtin(operator.getitem, View, types.Any)
def _lower_getitem(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    kind = sig.args[0]
    return _aligned(builder.load(_address(context, builder, kind, args[0], _indices(builder, kind, args[1]))))


@infer_global(operator.setitem)
class _SetItem(AbstractTemplate):
    def generic(self, args: Any, kws: Any) -> Any:
        view, at, _ = args
        if isinstance(view, View) and isinstance(at, types.BaseTuple) == (view.ndim == 2):
            return signature(types.none, view, _index(view), view.dtype)
        return None


@lower_builtin(operator.setitem, View, types.Any, types.Any)
def _lower_setitem(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    kind = sig.args[0]
    _aligned(builder.store(args[2], _address(context, builder, kind, args[0], _indices(builder, kind, args[1]))))
    return context.get_dummy_value()


@infer_getattr
class _ViewAttributes(AttributeTemplate):
    key = View

    def resolve_shape(self, view: Any) -> Any:
        return types.UniTuple(types.intp, 2)

    def resolve_size(self, view: Any) -> Any:
        return types.intp


@lower_getattr(View, "shape")
def _lower_shape(context: Any, builder: Any, kind: Any, value: Any) -> Any:
    view = cgutils.create_struct_proxy(kind)(context, builder, value=value)
    return context.make_tuple(builder, types.UniTuple(types.intp, 2), [view.rows, view.columns])


@lower_getattr(View, "size")
def _lower_size(context: Any, builder: Any, kind: Any, value: Any) -> Any:
    view = cgutils.create_struct_proxy(kind)(context, builder, value=value)
    return builder.mul(view.rows, view.columns)


# -- rows ----------------------------------------------------------------------------------------------------


def _pointers(context: Any, builder: Any, kind: Any, rows: Any, i: Any, k: Any, count: int) -> list[Any]:
    """Pointers to `count` numbers of row `i` from column `k` on."""
    columns = [builder.add(k, ir.Constant(k.type, step)) for step in range(count)]
    if _checks() or not isinstance(kind, View):
        return [_address(context, builder, kind, rows, [i, column]) for column in columns]
    first = _address(context, builder, kind, rows, [i, k])
    return [builder.gep(first, [ir.Constant(k.type, step)]) for step in range(count)]


def _loads(count: int, function: Callable[..., Any], first: int = 0) -> None:
    @infer_global(function)
    class _Load(AbstractTemplate):
        def generic(self, args: Any, kws: Any) -> Any:
            return signature(types.UniTuple(args[0].dtype, count), args[0], *[types.intp] * (len(args) - 1))

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        k = args[2] if len(args) > 2 else context.get_constant(types.intp, first)
        pointers = _pointers(context, builder, sig.args[0], args[0], args[1], k, count)
        return context.make_tuple(builder, sig.return_type, [_aligned(builder.load(one)) for one in pointers])

    for kind in (View, types.Array):
        lower_builtin(function, kind, types.intp)(lower)
        lower_builtin(function, kind, types.intp, types.intp)(lower)


def _stores(count: int, function: Callable[..., Any], add: bool) -> None:
    @infer_global(function)
    class _Store(AbstractTemplate):
        def generic(self, args: Any, kws: Any) -> Any:
            indices = [types.intp] * (len(args) - 2)
            return signature(types.none, args[0], *indices, types.UniTuple(args[0].dtype, count))

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        k = args[2] if len(args) > 3 else context.get_constant(types.intp, 0)
        values = cgutils.unpack_tuple(builder, args[-1], count)
        pointers = _pointers(context, builder, sig.args[0], args[0], args[1], k, count)
        if add:
            before = [_aligned(builder.load(one)) for one in pointers]
            values = [builder.fadd(x, y, flags=FLAGS) for x, y in zip(before, values, strict=True)]
        for pointer, value in zip(pointers, values, strict=True):
            _aligned(builder.store(value, pointer))
        return context.get_dummy_value()

    for kind in (View, types.Array):
        lower_builtin(function, kind, types.intp, types.Any)(lower)
        lower_builtin(function, kind, types.intp, types.intp, types.Any)(lower)


@overload
def _row(rows: Table, i: int, k: int, count: Literal[3]) -> Vec3: ...
@overload
def _row(rows: Table, i: int, k: int, count: Literal[6]) -> Vec6: ...
@overload
def _row(rows: Table, i: int, k: int, count: Literal[9]) -> Mat3: ...
@overload
def _row(rows: Table, i: int, k: int, count: Literal[21]) -> Sym6: ...
@overload
def _row(rows: Table, i: int, k: int, count: Literal[36]) -> Mat6: ...
@overload
def _row(rows: Table, i: int, k: int, count: int) -> Row: ...
def _row(rows: Table, i: int, k: int, count: int) -> Row:
    return tuple(rows[i, column] for column in range(k, k + count))


def _put(rows: Table, i: int, k: int, x: Row) -> None:
    for step, value in enumerate(x):
        rows[i, k + step] = value


def _add(rows: Table, i: int, x: Row) -> None:
    for k, value in enumerate(x):
        rows[i, k] = rows[i, k] + value


def load3(rows: Table, i: int) -> Vec3:
    """Row `i` as a tuple of 3."""
    return _row(rows, i, 0, 3)


def load6(rows: Table, i: int) -> Vec6:
    """Row `i` as a tuple of 6."""
    return _row(rows, i, 0, 6)


def load7(rows: Table, i: int) -> Row:
    """The first 7 numbers of row `i` as a tuple."""
    return _row(rows, i, 0, 7)


def load9(rows: Table, i: int) -> Mat3:
    """The first 9 numbers of row `i` as a tuple."""
    return _row(rows, i, 0, 9)


def load21(rows: Table, i: int) -> Sym6:
    """Row `i` as a tuple of 21."""
    return _row(rows, i, 0, 21)


def load36(rows: Table, i: int) -> Mat6:
    """Row `i` as a tuple of 36."""
    return _row(rows, i, 0, 36)


def load_translation(placements: Table, i: int) -> Vec3:
    """The translation of placement `i`: what follows the nine numbers of its rotation."""
    return _row(placements, i, 9, 3)


def load3_at(rows: Table, i: int, k: int) -> Vec3:
    """3 numbers of row `i`, from column `k` on."""
    return _row(rows, i, k, 3)


def load6_at(rows: Table, i: int, k: int) -> Vec6:
    """6 numbers of row `i`, from column `k` on."""
    return _row(rows, i, k, 6)


def store3(rows: Table, i: int, x: Vec3) -> None:
    """Write the tuple of 3 to row `i`."""
    _put(rows, i, 0, x)


def store6(rows: Table, i: int, x: Vec6) -> None:
    """Write the tuple of 6 to row `i`."""
    _put(rows, i, 0, x)


def store9(rows: Table, i: int, x: Mat3) -> None:
    """Write the tuple of 9 to row `i`."""
    _put(rows, i, 0, x)


def store21(rows: Table, i: int, x: Sym6) -> None:
    """Write the tuple of 21 to row `i`."""
    _put(rows, i, 0, x)


def store36(rows: Table, i: int, x: Mat6) -> None:
    """Write the tuple of 36 to row `i`."""
    _put(rows, i, 0, x)


def store6_at(rows: Table, i: int, k: int, x: Vec6) -> None:
    """Write the tuple of 6 to row `i`, from column `k` on."""
    _put(rows, i, k, x)


def add_to6(rows: Table, i: int, x: Vec6) -> None:
    """Add the tuple of 6 to row `i`."""
    _add(rows, i, x)


def add_to21(rows: Table, i: int, x: Sym6) -> None:
    """Add the tuple of 21 to row `i`."""
    _add(rows, i, x)


for _count, _load in ((3, load3), (6, load6), (7, load7), (9, load9), (21, load21), (36, load36)):
    _loads(_count, _load)
_loads(3, load3_at)
_loads(6, load6_at)
_loads(3, load_translation, first=9)
for _count, _store in ((3, store3), (6, store6), (9, store9), (21, store21), (36, store36)):
    _stores(_count, _store, add=False)
_stores(6, store6_at, add=False)
for _count, _store in ((6, add_to6), (21, add_to21)):
    _stores(_count, _store, add=True)
