"""Compilation of a kernel.

A *number* is a ``float64``, or several of them in the lanes of a vector register (`ospace.kernels.jit.simd`); kernels
never say which. A *row* of numbers comes out of a table as a tuple and goes back as one: ``S = load6(w.S, i)``. The
types of values below are tuples by their length, which mypy checks through slices and sums of them.

Two decorators make every kernel of the package:

``inlined``  functions on values and sweeps over tables: inlined into the caller, so that a recursion written as its
             equations costs what its arithmetic costs. From Python they run interpreted.
``entry``    what Python calls: compiled on first use and kept on disk under a key made of all kernel sources.

``NUMBA_BOUNDSCHECK=1`` checks every access to a table, and ``NUMBA_DISABLE_JIT=1`` runs all kernels interpreted.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, TypeVar, cast

import llvmlite.binding
import numba
from numba import types
from numba.core.caching import NullCache
from numba.core.compiler_lock import global_compiler_lock
from numba.extending import overload

from ospace.kernels.jit import cache

Number = Any
"""A ``float64``, or several of them in the lanes of a vector register."""
Row = tuple[Number, ...]
"""A row of numbers of any length."""
Vec3 = tuple[Number, Number, Number]
Vec6 = tuple[*Vec3, *Vec3]
"""Motion or force, linear part first."""
Quaternion = tuple[Number, Number, Number, Number]
"""x, y, z, w."""
Mat3 = tuple[*Vec3, *Vec3, *Vec3]
"""A 3×3 matrix by columns, as Pinocchio stores a rotation."""
Sym3 = tuple[Number, Number, Number, Number, Number, Number]
"""A symmetric 3×3 matrix as its lower rows."""
Mat6 = tuple[*Vec6, *Vec6, *Vec6, *Vec6, *Vec6, *Vec6]
"""A 6×6 matrix by rows."""
Sym6 = tuple[*Vec6, *Vec6, *Vec6, *Vec3]
"""A symmetric 6×6 matrix, such as an inertia or its inverse, as its lower rows."""
Table = Any
"""Rows of numbers in memory."""
Function = TypeVar("Function", bound=Callable[..., Any])

# Sums may be reordered and contracted; NaN and infinity keep their meaning, so that bad numbers stay visible.
_FASTMATH = {"contract", "reassoc", "nsz", "arcp"}
_SOUND_LLVM = (20, 0, 0)
# Kernels make no arrays, so none is counted: _nrt.
_OPTIONS: dict[str, Any] = {"fastmath": _FASTMATH, "error_model": "numpy", "_nrt": False}
INLINED = {**_OPTIONS, "forceinline": True, "no_cfunc_wrapper": True}
try:
    from ospace.kernels.jit.fragment import FragmentCompiler
except (ImportError, AttributeError):  # another numba inside: kernels are the same, and take longer to compile
    pass
else:
    INLINED |= {"no_cpython_wrapper": True, "pipeline_class": FragmentCompiler}


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
        cache.check_files(compiled)
        compiled.compile = _Compilation(compiled)
    return cast(Function, compiled)


def kinds_of(arguments: Iterable[Any]) -> tuple[Any, ...]:
    """Return numba's types of arguments."""
    return tuple(map(numba.typeof, arguments))


def refuse_other_types(entry: Any, arguments: Iterable[Any]) -> None:
    """Compile `entry` for arguments of the types of these, read-only or not; with any other a call is a TypeError.

    The caller converts what is of another type, which takes less time than to compile for it.
    """
    if hasattr(entry, "compile"):
        kinds = kinds_of(arguments)
        entry.compile(kinds)
        entry.compile.only = kinds


class _Compilation:
    """Compilation of an entry for arguments of types that numba has not seen.

    A read-only array is another type to numba, but machine code that only reads it is the same: it is registered for
    both. LLVM gathers scalar arithmetic into vectors, which makes one state a quarter faster; numba has that off
    because of LLVM 14's faults, so it stays off where LLVM is old. A cache that cannot be written is left alone.
    """

    def __init__(self, entry: Any) -> None:
        self.only: tuple[Any, ...] | None = None
        """Types, all others of which are refused."""
        self._entry, self._compile = entry, entry.compile
        self._seen: list[Any] = []  # numba numbers a type anew when nothing refers to it any more

    def __call__(self, signature: Any) -> Any:
        if not isinstance(signature, tuple):
            return self._compiled(signature)
        writable = tuple(_writable(kind) for kind in signature)
        if self.only not in (None, writable):
            raise TypeError(f"{self._entry.__name__} takes {self.only}, not {signature}")
        if writable == signature or not _SHARES_CODE:
            return self._compiled(signature)
        self._compiled(writable)
        code = self._entry.overloads[writable].entry_point
        self._entry._insert([kind._code for kind in signature], code, False)
        self._seen.extend(signature)
        return code

    def _compiled(self, signature: Any) -> Any:
        entry = self._entry
        with global_compiler_lock:  # numba's own, so that no other code is compiled so
            before = numba.config.SLP_VECTORIZE
            numba.config.SLP_VECTORIZE = int(llvmlite.binding.llvm_version_info >= _SOUND_LLVM)
            try:
                with cache.announced(entry):
                    return self._compile(signature)
            except OSError as error:  # a full disk
                cache.warn(error)
                entry._cache = NullCache()
                return self._compile(signature)
            finally:
                numba.config.SLP_VECTORIZE = before


_SHARES_CODE = all(hasattr(numba.core.dispatcher.Dispatcher, name) for name in ("_insert", "add_overload"))


def _writable(kind: Any) -> Any:
    return kind.copy(readonly=False) if isinstance(kind, types.Array) and not kind.mutable else kind
