"""How numba compiles kernels: with the passes that they need, and optimizing only what Python calls.

Numba by itself optimizes every function in full and makes machine code of it, and does so again within each
function that calls it. A kernel that only kernels call is never run on its own, though: here it stays what
LLVM reads, tidied up. The kernel that Python calls takes in all that it and they call, and is optimized as a
whole, as numba would.

Numba's own compiler is left as it is for whatever else uses it: kernels name these as their pipelines.

Glossary
--------
inner kernel : one that only kernels call.
"""

# Numba declares no types.
# mypy: disable-error-code="no-untyped-call, misc, import-untyped, attr-defined"
from __future__ import annotations

from copy import copy
from functools import cache
from types import BuiltinFunctionType
from typing import Any

import numba.core.typed_passes as typed
import numba.core.untyped_passes as untyped
from llvmlite import binding as llvm
from numba import _dynfunc
from numba.core import types
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase
from numba.core.compiler_machinery import PassManager, register_pass
from numba.core.llvm_bindings import create_pass_builder

# Numba's passes but those for what kernels are without: closures, blocks of ``with``, errors that are raised,
# functions put in place of their calls, literals that are types, and expressions of whole arrays.
PASSES = (
    untyped.TranslateByteCode,
    untyped.FixupArgs,
    untyped.IRProcessing,
    untyped.RewriteSemanticConstants,
    untyped.DeadBranchPrune,
    untyped.GenericRewrites,
    untyped.ReconstructSSA,
    typed.NopythonTypeInference,
    typed.PreLowerStripPhis,
)


class Code(JITCodeLibrary):
    """The code of a kernel, tidied up as it comes."""

    def add_llvm_module(self, module: Any) -> None:
        """Takes in a function, its variables in registers."""
        module.data_layout = self._codegen._data_layout
        passes, builder = llvm.create_new_module_pass_manager(), create_pass_builder(self._codegen._tm, opt=0)
        passes.add_sroa_pass()
        passes.add_simplify_cfg_pass()
        passes.add_instruction_combine_pass()
        passes.run(module, builder)
        self._final_module.link_in(module)


class InnerCode(Code):
    """The code of an inner kernel: for others to take in."""

    def finalize(self) -> None:
        """Makes a function one that its callers may inline or drop."""
        for function in self._final_module.functions:
            if not function.is_declaration:
                function.linkage = "linkonce_odr"
        self._finalized = True


class OuterCode(Code):
    """The code of a kernel that Python calls, with all that it calls."""

    def finalize(self) -> None:
        """Takes in all inner kernels, whoever calls them, optimizes and makes machine code."""
        found, waiting = dict[Any, None](), list(self._linking_libraries)
        while waiting:
            library = waiting.pop()
            if library not in found and isinstance(library, InnerCode):
                waiting += library._linking_libraries
            found[library] = None
        self._linking_libraries = list(found)
        super().finalize()


@register_pass(mutates_CFG=True, analysis_only=False)
class InnerLowering(typed.NativeLowering):
    """Lower an inner kernel to what LLVM reads, without machine code."""

    _name = "inner_kernel_lowering"

    def run_pass(self, state: Any) -> bool:
        """Lowers, and makes the kernel known to those that call it by something that is never called."""
        library = state.library = InnerCode(state.targetctx.codegen(), state.func_id.func_qualname)
        state.flags.no_compile = True
        super().run_pass(state)
        library._ensure_finalized()
        lowered = state["cr"]
        description = lowered.fndesc
        name = _dynfunc.make_function(
            description.lookup_module(), description.qualname, "", 0, lowered.env, (library,)
        )
        state.targetctx.insert_user_function(name, description, [library])
        state.reload_init.extend(library._reload_init)
        state["cr"] = lowered._replace(cfunc=name)
        return True


@register_pass(mutates_CFG=True, analysis_only=False)
class OuterLowering(typed.NativeLowering):
    """Lower a kernel that Python calls, and make machine code of it."""

    _name = "outer_kernel_lowering"

    def run_pass(self, state: Any) -> bool:
        """Lower as numba does, with all that is called optimized as a whole."""
        state.library = OuterCode(state.targetctx.codegen(), state.func_id.func_qualname)
        state.library.enable_object_caching()
        return bool(super().run_pass(state))


@cache
def steady_contexts(typing: Any, target: Any) -> tuple[Any, Any]:
    """Numba's contexts of types and of the machine, which look for new declarations only now and remember
    their answers.

    Without, each kernel would look through all declarations, and ask anew what the sum of two numbers is,
    each time.
    """
    typing.refresh()
    target.refresh()
    steady, machine = copy(typing), copy(target)
    answers: dict[Any, Any] = {}

    def resolve_function_type(function: Any, arguments: Any, keywords: Any) -> Any:
        if keywords or not isinstance(function, (types.Function, BuiltinFunctionType)):
            return typing.resolve_function_type(function, arguments, keywords)
        if (function, arguments) not in answers:
            answers[function, arguments] = typing.resolve_function_type(function, arguments, keywords)
        return answers[function, arguments]

    steady.resolve_function_type = resolve_function_type
    steady.refresh = machine.refresh = lambda: None
    return steady, machine


class OuterCompiler(CompilerBase):
    """Numba's compiler of kernels that Python calls."""

    lowering: type[typed.NativeLowering] = OuterLowering

    def __init__(self, typing: Any, target: Any, *rest: Any) -> None:
        super().__init__(*steady_contexts(typing, target), *rest)

    def define_pipelines(self) -> list[Any]:
        """The passes; deletions count references, so kernels without counts are lowered without."""
        passes = PassManager("kernel")
        counting = (typed.IRLegalization,) if self.state.flags.nrt else ()
        for kind in (*PASSES, *counting, self.lowering, typed.NoPythonBackend):
            passes.add_pass(kind, kind._name)
        passes.finalize()
        return [passes]


class InnerCompiler(OuterCompiler):
    """Numba's compiler of inner kernels."""

    lowering = InnerLowering
