"""How a kernel is compiled.

A *number* is a ``float64``, or several of them in the lanes of a vector register (`ospace.kernels.jit.simd`); kernels
never say which. A *row* of numbers comes out of a table as a tuple and goes back as one: ``S = load6(w.S, i)``.

Two decorators make every kernel of the package:

``inlined``  functions on values and sweeps over tables: inlined into the caller, so that a recursion written as its
             equations costs what its arithmetic costs. From Python they run interpreted.
``entry``    what Python calls: compiled on first use and kept on disk under a key made of all kernel sources.

``NUMBA_BOUNDSCHECK=1`` checks every access to a table, and ``NUMBA_DISABLE_JIT=1`` runs all kernels interpreted.
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

from ospace.kernels.jit import cache

Number = Any
Row = tuple[Any, ...]
Table = Any
Function = TypeVar("Function", bound=Callable[..., Any])

# Sums may be reordered and contracted; NaN and infinity keep their meaning, so that bad numbers stay visible.
_FASTMATH = {"contract", "reassoc", "nsz", "arcp"}
_SOUND_LLVM = (20, 0, 0)
_CACHE_ERRORS = (OSError, EOFError, ValueError, pickle.UnpicklingError)  # a full disk, a file cut short or garbled
_OPTIONS: dict[str, Any] = {"fastmath": _FASTMATH, "error_model": "numpy"}
INLINED = {**_OPTIONS, "forceinline": True, "no_cfunc_wrapper": True}


def inlined(function: Function) -> Function:
    """Inline `function` into compiled kernels that call it; from Python it stays the plain function it is."""
    overload(function, strict=False, jit_options=INLINED)(lambda *kinds: function)
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


_KEPT: list[Any] = []  # numba numbers a type anew when nothing refers to it any more


def take_read_only(entry: Any, arguments: tuple[Any, ...], which: tuple[int, ...]) -> None:
    """Compile `entry` for arrays such as `arguments`, of which those at `which` may be read-only, and for no others.

    A read-only array is another type to numba, and machine code that only reads is the same: it is registered for both.
    Any other type is a TypeError from then on.
    """
    if not hasattr(entry, "disable_compile") or not entry._can_compile:  # interpreted, or done
        return
    kinds = tuple(map(numba.typeof, arguments))
    entry.compile(kinds)
    code = entry.overloads[kinds]
    for some in range(1, 2 ** len(which)):
        frozen = {at for k, at in enumerate(which) if some >> k & 1}
        seen = [kind.copy(readonly=True) if at in frozen else kind for at, kind in enumerate(kinds)]
        entry._insert([kind._code for kind in seen], code.entry_point, False)
        _KEPT.extend(seen)
    entry.disable_compile()


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
            except _CACHE_ERRORS as error:
                cache.warn(error)
                entry._cache = NullCache()
                return compile_(signature)
            finally:
                numba.config.SLP_VECTORIZE = before

    return compile_so
