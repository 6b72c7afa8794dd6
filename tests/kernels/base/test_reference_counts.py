"""Hot kernels count no references to arrays: a count is an atomic addition, and took half of a search's time."""

from __future__ import annotations

import pkgutil
import re
from importlib import import_module
from typing import Any

import pytest
from numba.core.dispatcher import Dispatcher

import workhold.kernels
from workhold.kernels import preparing
from workhold.kernels.curves.three_and_one import three_and_one_cells
from workhold.kernels.curves.two_and_two import two_and_two_cells
from workhold.kernels.proof.newton_kantorovich import certified

# Kernels that may make arrays, where room is made for those that do the work.
MAKERS = {
    "add_parts",
    "add_stretches",
    "branch_intervals",
    "cell_pieces",
    "chord_intervals",
    "grown",
    "pairs_of",
    "interval_newton",
    "jacobians",
    "join_near_spots",
    "kept_edges",
    "least_middle_error",
    "outline_distances",
    "sliding_pairs_between",
    "sliding_fixtures",
    "sorted_limbs",
    "tail_curves",
    "three_and_one_cells",
    "two_and_two_cells",
    "with_room",
    "work_space",
    "block_work",
}
# Counts in the compiled code of one such kernel, about one for each array it makes or hands on; a loop that looks at rows
# has many more.
FEW = 20


def kernels() -> dict[str, Any]:
    """Every kernel of the package by its name."""
    found = {}
    for info in pkgutil.walk_packages(workhold.kernels.__path__, "workhold.kernels."):
        for name, value in vars(import_module(info.name)).items():
            if isinstance(value, Dispatcher) and value.py_func.__module__ == info.name:
                found[name] = value
    return found


def counting_functions(kernel: Any) -> dict[str, int]:
    """Compile a kernel anew; how often its machine code counts a reference, by the function that does; what Python calls
    is left out."""
    for _ in (done for part in preparing.PARTS for done in preparing.prepared(part)):
        pass
    (signature,) = kernel.signatures
    # What is stored cannot be looked at.
    compiler = kernel._compiler.pipeline_class
    anew = type(kernel)(kernel.py_func, targetoptions=kernel.targetoptions, pipeline_class=compiler)
    anew.compile(signature)
    functions = anew.inspect_llvm(signature).split("\ndefine ")[1:]
    assert functions
    found = {}
    for text in functions:
        name = re.search(r"@\"?([^\s(\"]+)", text)
        count = len(re.findall(r"call [^\n]*@NRT_incref", text))
        if name and count and "cpython" not in name[1] and not name[1].startswith("NRT_"):
            found[name[1]] = count
    return found


def test_only_kernels_that_make_room_count_references():
    """All others are compiled without: numba then refuses arrays that are made, but not those handed back."""
    counted = {name for name, kernel in kernels().items() if kernel.targetoptions.get("_nrt", True)}
    assert counted == MAKERS
    for name, kernel in kernels().items():
        if name not in MAKERS:
            told = str(kernel.py_func.__annotations__["return"])
            assert re.search("Array|Verdicts|Space|Work", told) is None, name


@pytest.mark.thorough
@pytest.mark.parametrize(
    "kernel", [two_and_two_cells, three_and_one_cells], ids=["two and two", "three and one"]
)
def test_the_loops_of_a_search_count_no_references(kernel):
    """In the compiled code only kernels that make arrays count, and the outermost only outside of the pairing."""
    found = counting_functions(kernel)
    assert found
    for function, count in found.items():
        assert any(f"{len(name)}{name}" in function for name in MAKERS), function
        assert count <= FEW, function


@pytest.mark.thorough
def test_the_certificate_counts_no_references():
    """The kernel that proves fixtures makes no array at all."""
    assert counting_functions(certified) == {}
