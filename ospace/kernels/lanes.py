"""How a kernel is compiled, and how it reaches memory.

A *number* is a ``float64``, or several of them in the lanes of a vector register (`ospace.kernels.simd`); kernels never
say which. A *row* of numbers comes out of memory as a tuple and goes back as one: ``S = load6(tree.S, i)``.

Two decorators make every kernel of the package:

``inlined``  functions on values and sweeps over tables: melted into whoever calls them, so that a recursion
             written as its equations costs what its arithmetic costs. From Python they run interpreted.
``entry``    what Python calls: compiled on first use and kept on disk under a key made of all kernel sources.

Tables are NumPy arrays and are indexed as such, so that ``NUMBA_BOUNDSCHECK=1`` checks every access of the
compiled kernels and ``NUMBA_DISABLE_JIT=1`` runs all of them interpreted.
"""

from __future__ import annotations

import pickle
from collections.abc import Callable
from typing import Any, TypeVar, cast

import llvmlite.binding
import numba
from numba.core.caching import NullCache
from numba.core.compiler_lock import global_compiler_lock
from numba.extending import overload

from ospace.kernels import cache

Number = Any
Row = tuple[Any, ...]
Table = Any
Function = TypeVar("Function", bound=Callable[..., Any])

# Sums may be reordered and contracted; NaN and infinity keep their meaning, so that bad numbers stay visible.
_FASTMATH = {"contract", "reassoc", "nsz", "arcp"}
_SOUND_LLVM = (20, 0, 0)
_OF_THE_CACHE = (OSError, EOFError, ValueError, pickle.UnpicklingError)  # a full disk, a file cut short or garbled
_OPTIONS: dict[str, Any] = {"fastmath": _FASTMATH, "error_model": "numpy"}
_MELTED = {**_OPTIONS, "forceinline": True, "no_cfunc_wrapper": True}


def inlined(function: Function) -> Function:
    """Let compiled kernels melt `function` into themselves; from Python it stays the plain function it is."""
    overload(function, strict=False, jit_options=_MELTED)(lambda *kinds: function)
    return function


def entry(function: Function) -> Function:
    """Compile `function` for calls from Python, with the result kept on disk."""
    return _compiled(function, nogil=False)


def entry_for_threads(function: Function) -> Function:
    """Compile as `entry` does, for calls that take long: others may run meanwhile, which costs 60 ns."""
    return _compiled(function, nogil=True)


def _compiled(function: Function, nogil: bool) -> Function:
    with cache.keyed_on_sources() as writable:
        compiled: Any = numba.njit(cache=writable, nogil=nogil, **_OPTIONS)(function)
    if hasattr(compiled, "compile"):  # not there where kernels run interpreted
        compiled.compile = _compiling_as_we_like(compiled, compiled.compile)
    return cast(Function, compiled)


def _compiling_as_we_like(entry: Any, compile_: Callable[..., Any]) -> Callable[..., Any]:
    """Let LLVM gather scalar arithmetic into vectors, which makes one state a quarter faster; survive a broken cache.

    Numba has the former off because of LLVM 14's faults, so it stays off where LLVM is old.
    """

    def compile_so(signature: Any) -> Any:
        with global_compiler_lock:  # numba's own, so that no other code is compiled so
            before = numba.config.SLP_VECTORIZE
            numba.config.SLP_VECTORIZE = int(llvmlite.binding.llvm_version_info >= _SOUND_LLVM)
            try:
                with cache.announced(entry):
                    return compile_(signature)
            except _OF_THE_CACHE as error:
                cache.warn(error)
                entry._cache = NullCache()
                return compile_(signature)
            finally:
                numba.config.SLP_VECTORIZE = before

    return compile_so


@inlined
def _three(rows: Table, i: int, k: int) -> Row:
    return (rows[i, k], rows[i, k + 1], rows[i, k + 2])


@inlined
def _put3(rows: Table, i: int, k: int, x: Row) -> None:
    rows[i, k] = x[0]
    rows[i, k + 1] = x[1]
    rows[i, k + 2] = x[2]


@inlined
def _add3(rows: Table, i: int, k: int, x: Row) -> None:
    rows[i, k] += x[0]
    rows[i, k + 1] += x[1]
    rows[i, k + 2] += x[2]


@inlined
def load3(rows: Table, i: int) -> Row:
    """Row `i` as a tuple of 3."""
    return _three(rows, i, 0)


@inlined
def load6(rows: Table, i: int) -> Row:
    """Row `i` as a tuple of 6."""
    return _three(rows, i, 0) + _three(rows, i, 3)


@inlined
def load9(rows: Table, i: int) -> Row:
    """The first 9 numbers of row `i` as a tuple."""
    return load6(rows, i) + _three(rows, i, 6)


@inlined
def load21(rows: Table, i: int) -> Row:
    """Row `i` as a tuple of 21."""
    return load9(rows, i) + _three(rows, i, 9) + _three(rows, i, 12) + _three(rows, i, 15) + _three(rows, i, 18)


@inlined
def load36(rows: Table, i: int) -> Row:
    """Row `i` as a tuple of 36."""
    return (
        load21(rows, i)
        + _three(rows, i, 21)
        + _three(rows, i, 24)
        + _three(rows, i, 27)
        + _three(rows, i, 30)
        + _three(rows, i, 33)
    )


@inlined
def load_translation(placements: Table, i: int) -> Row:
    """The translation of placement `i`: what follows the nine numbers of its rotation."""
    return _three(placements, i, 9)


@inlined
def store3(rows: Table, i: int, x: Row) -> None:
    """Write the tuple of 3 to row `i`."""
    _put3(rows, i, 0, x)


@inlined
def store6(rows: Table, i: int, x: Row) -> None:
    """Write the tuple of 6 to row `i`."""
    _put3(rows, i, 0, x[0:3])
    _put3(rows, i, 3, x[3:6])


@inlined
def store9(rows: Table, i: int, x: Row) -> None:
    """Write the tuple of 9 to row `i`."""
    store6(rows, i, x[0:6])
    _put3(rows, i, 6, x[6:9])


@inlined
def store21(rows: Table, i: int, x: Row) -> None:
    """Write the tuple of 21 to row `i`."""
    store6(rows, i, x[0:6])
    _put3(rows, i, 6, x[6:9])
    _put3(rows, i, 9, x[9:12])
    _put3(rows, i, 12, x[12:15])
    _put3(rows, i, 15, x[15:18])
    _put3(rows, i, 18, x[18:21])


@inlined
def store36(rows: Table, i: int, x: Row) -> None:
    """Write the tuple of 36 to row `i`."""
    store21(rows, i, x[0:21])
    _put3(rows, i, 21, x[21:24])
    _put3(rows, i, 24, x[24:27])
    _put3(rows, i, 27, x[27:30])
    _put3(rows, i, 30, x[30:33])
    _put3(rows, i, 33, x[33:36])


@inlined
def store_part6(rows: Table, i: int, k: int, x: Row) -> None:
    """Write the tuple of 6 to row `i`, from column `k` on."""
    _put3(rows, i, k, x[0:3])
    _put3(rows, i, k + 3, x[3:6])


@inlined
def add_to6(rows: Table, i: int, x: Row) -> None:
    """Add the tuple of 6 to row `i`."""
    _add3(rows, i, 0, x[0:3])
    _add3(rows, i, 3, x[3:6])


@inlined
def add_to21(rows: Table, i: int, x: Row) -> None:
    """Add the tuple of 21 to row `i`."""
    add_to6(rows, i, x[0:6])
    _add3(rows, i, 6, x[6:9])
    _add3(rows, i, 9, x[9:12])
    _add3(rows, i, 12, x[12:15])
    _add3(rows, i, 15, x[15:18])
    _add3(rows, i, 18, x[18:21])
