"""Kernels compiled in the lean way give what numba's own way gives, bit for bit; inner kernels become no machine code."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from math import hypot, sqrt
from pathlib import Path
from typing import Any

import numba
import numpy as np
import pytest
from numba.core.runtime import _nrt_python
from numba.core.runtime.nrt import rtsys

from workhold.kernels.base import compiling
from workhold.kernels.base.compiling import (
    MAKING_ARRAYS,
    NO_CALLBACK,
    ONLY_INNER,
    WITHOUT_COUNTS,
    lean_compiler,
)
from workhold.kernels.base.lean import InnerCode, InnerCompiler, OuterCode, OuterCompiler

BENCHMARKS = Path(__file__).resolve().parents[3] / "benchmarks"
Compiler = Callable[[Callable[..., Any]], Any]
OUTER: dict[str, Any] = {**WITHOUT_COUNTS, **NO_CALLBACK, "pipeline_class": OuterCompiler}
INNER: dict[str, Any] = {**WITHOUT_COUNTS, **ONLY_INNER, "pipeline_class": InnerCompiler}
OWN: dict[str, Any] = {"nogil": True, "error_model": "numpy"}


def kernels(inner: Compiler, outer: Compiler) -> tuple[Any, ...]:
    """A kernel that two others call, two that Python calls, and the one between."""

    @inner
    def ratio(x, y):
        return x / y + hypot(x, y) * 3.0

    @inner
    def along(rows, k, both):
        total = 0.0
        for j in range(rows.shape[1]):
            if both and j % 2 == 1:
                total -= ratio(rows[k, j], rows[k, 0] + both[1])
            else:
                total += ratio(rows[k, j], sqrt(abs(rows[k, j])))
        return total

    @outer
    def least(rows, out):
        found = 0
        for k in range(len(rows)):
            out[k] = along(rows, k, (k, 2.5))
            if out[k] < out[found]:
                found = k
        return found, min(out[found], 7), max(1, found)

    @outer
    def first(rows):
        return ratio(rows[0, 0], rows[0, 1])

    return ratio, along, least, first


@pytest.fixture(scope="module")
def lean() -> tuple[Any, ...]:
    return kernels(numba.njit(**INNER), numba.njit(**OUTER))


@pytest.mark.thorough
def test_bits_are_those_of_numba_s_own_way(lean):
    """Infinities and what is no number included."""
    *_, least, first = kernels(numba.njit(**OWN), numba.njit(**OWN))
    rows = np.random.default_rng(5).normal(size=(40, 7)) * 10.0 ** np.arange(-3, 4)
    rows[3, 2], rows[4, 0], rows[5, 5], rows[0, 1] = np.inf, -0.0, np.nan, 0.0
    mine, own = np.zeros(40), np.zeros(40)
    assert lean[2](rows, mine) == least(rows, own)
    assert mine.tobytes() == own.tobytes() and np.isnan(own[5])
    assert np.float64(lean[3](rows)).tobytes() == np.float64(first(rows)).tobytes()


@pytest.mark.thorough
def test_only_what_python_calls_becomes_machine_code(lean):
    """With all that it calls inside of it, also what only those call."""
    rows = np.ones((2, 3))
    for kernel, arguments in ((lean[2], (rows, np.zeros(2))), (lean[3], (rows,))):
        kernel(*arguments)
        library = kernel.overloads[kernel.signatures[0]].library
        assert isinstance(library, OuterCode)
        assert library.codegen._engine.is_symbol_defined(
            kernel.overloads[kernel.signatures[0]].fndesc.llvm_func_name
        )
    for kernel in lean[:2]:
        (compiled,) = kernel.overloads.values()
        assert isinstance(compiled.library, InnerCode)
        name = compiled.fndesc.llvm_func_name
        assert f"linkonce_odr i32 @{name}" in compiled.library.get_llvm_str()
        whole = lean[2].overloads[lean[2].signatures[0]].library
        assert f"@{name}(" not in whole.get_llvm_str(), "put in place of its call"


@pytest.mark.thorough
def test_arrays_that_a_kernel_makes_are_given_back():
    """Kernels that count references are lowered with what ends their variables."""

    @numba.njit(**MAKING_ARRAYS, **ONLY_INNER, pipeline_class=InnerCompiler)
    def room(count):
        made = np.zeros(count)
        return np.empty(len(made) + count)

    @numba.njit(**MAKING_ARRAYS, pipeline_class=OuterCompiler)
    def sizes(count):
        total = 0
        for k in range(count):
            total += len(room(k))
        return total

    sizes(1)
    _nrt_python.memsys_enable_stats()
    try:
        before = rtsys.get_allocation_stats()
        assert sizes(20) == 380
        after = rtsys.get_allocation_stats()
    finally:
        _nrt_python.memsys_disable_stats()
    assert after.alloc - before.alloc == after.free - before.free > 0


def test_another_numba_and_a_wheel_s_compile_in_numba_s_own_way(monkeypatch):
    """What the lean way builds on may be otherwise in another."""
    assert lean_compiler("InnerCompiler") == {"pipeline_class": InnerCompiler}
    monkeypatch.setattr(compiling, "MODE", "building")
    assert lean_compiler("InnerCompiler") == {}, "a wheel's code is worth numba's whole effort"
    monkeypatch.undo()
    monkeypatch.setattr(numba, "__version__", "0.70.0")
    assert lean_compiler("InnerCompiler") == {}


@pytest.mark.thorough
def test_the_loop_that_a_search_is_measured_by_calls_a_kernel_so_compiled():
    """Code that numba compiles in its own way cannot call one: the benchmark of the floor ended by a signal."""
    command = [
        sys.executable,
        BENCHMARKS / "report.py",
        "floor.floor_seconds",
        '["small4Handle", 3.0, 10000]',
    ]
    environment = {**os.environ, "WORKHOLD_KERNELS": "numba"}
    done = subprocess.run(command, check=True, capture_output=True, text=True, env=environment)
    assert 0.05 < json.loads(done.stdout)["closing"] < 0.3, "about every eighth of random contacts closes"
