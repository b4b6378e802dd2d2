"""Inlined functions as what they are: pieces of an entry, of which none runs on its own.

Numba makes every function that it compiles ready to be called from Python: it optimizes it with all that it calls in
turn, emits machine code, and wraps it. For a function that is inlined into its callers this is done for nothing, and
once more in each of them. A fragment holds the instructions of one function alone; the entry links the fragments
that it needs, each once, and optimizes the whole.
"""

from __future__ import annotations

from typing import Any

from numba import _dynfunc
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.compiler_machinery import register_pass
from numba.core.typed_passes import NativeLowering


class _Fragment(JITCodeLibrary):
    """The instructions of one function, without those of the functions that it calls."""

    def finalize(self) -> None:
        """End the writing: there is nothing to link, to optimize or to load yet."""
        self._raise_if_finalized()
        self._finalized = True


@register_pass(mutates_CFG=True, analysis_only=False)
class _LowerFragment(NativeLowering):
    """Lower to a fragment; whoever calls it links it, and the fragments that it calls."""

    _name = "ospace_lower_fragment"

    def run_pass(self, state: Any) -> bool:
        """Lower, and register the function for those that call it."""
        function = state.func_id
        state.library = fragment = _Fragment(state.targetctx.codegen(), function.func_qualname)
        state.flags.no_compile = True
        super().run_pass(state)
        lowered = state["cr"]
        # Numba knows functions by an object that Python could call; nothing calls this one.
        key = _dynfunc.make_function(
            lowered.fndesc.lookup_module(), function.func_name, "", 0, lowered.env, (fragment,)
        )
        state.targetctx.insert_user_function(key, lowered.fndesc, [fragment, *fragment._linking_libraries])
        state["cr"] = lowered._replace(cfunc=key)
        return True


class FragmentCompiler(CompilerBase):
    """Numba's compiler, but for the last step."""

    def define_pipelines(self) -> list[Any]:
        """Return numba's own pipeline, that ends in a fragment."""
        pipeline = DefaultPassBuilder.define_nopython_pipeline(self.state)
        pipeline.passes = [
            (_LowerFragment if step is NativeLowering else step, about) for step, about in pipeline.passes
        ]
        pipeline.finalize()
        return [pipeline]
