"""Whether the hand-counted constants of the proof are as sharp as they are said to be.

A bound that is right by a wide margin hides a fault in it: leaving a factor out, nobody would see. So ``make prove`` holds
every constant against the true value on many inputs, among them those for which its own term matters most, with the constant
as it is and with the constant at a tenth: the bound must hold as it is, and must fail at a tenth. How far it is from the
worst seen stands in docs/belief.md, in the table "How sharp", which is compared with what is seen here.
"""

from __future__ import annotations

import ast
import copy
import inspect
import re
import textwrap
from collections.abc import Callable
from functools import cache
from pathlib import Path
from random import Random
from types import FunctionType
from typing import Any

from attrs import frozen

__all__ = ["Constant", "changed", "check_sharpness", "interpreted"]

Kernel = Callable[..., Any]
MANUAL = Path(__file__).parents[1] / "docs" / "belief.md"


def interpreted(kernel: Kernel) -> Any:
    """Return the Python function of a kernel, which it is itself where kernels are not compiled."""
    return getattr(kernel, "py_func", kernel)


def changed(
    kernel: Kernel, literal: float | None = None, at: int = 0, times: float = 0.1, **names: Any
) -> Kernel:
    """The Python form of a kernel in which one number is multiplied.

    Parameters
    ----------
    literal, at : the number as it stands in the kernel, and which one where it stands there more than once.
    names : what other names of its module are to mean to it, such as another kernel changed before.

    Raises
    ------
    LookupError
        When no such number stands in the kernel: it has been changed, and its row in the table must be too. Also
        when the kernel's module has none of the names.
    """
    function: FunctionType = interpreted(kernel)
    if names and not names.keys() & function.__globals__.keys():
        raise LookupError(f"{function.__module__} has no {' or '.join(names)}")
    tree: ast.Module = copy.deepcopy(vars(function).get("tree")) or ast.parse(
        textwrap.dedent(inspect.getsource(function))
    )
    (definition,) = tree.body
    assert isinstance(definition, ast.FunctionDef)
    definition.decorator_list = []
    if literal is not None:
        found = [
            node
            for node in ast.walk(definition)
            if isinstance(node, ast.Constant) and isinstance(node.value, float) and node.value == literal
        ]
        found.sort(key=lambda node: (node.lineno, node.col_offset))
        if at >= len(found):
            raise LookupError(f"{function.__name__} has no number {literal:g} for the {at + 1}th time")
        found[at].value = literal * times
    scope = {**function.__globals__, **names}
    exec(compile(tree, function.__code__.co_filename, "exec"), scope)
    out: Kernel = scope[function.__name__]
    # What is changed may be changed again.
    vars(out)["tree"] = tree
    return out


@frozen
class Constant:
    """A constant of the proof.

    Parameters
    ----------
    name : its name in the manual's table.
    kernel, literal, at : where it stands, see :func:`changed`; or else ``symbol``, the name of a number of the kernel's
        module.
    ratio : the true value over the bound that a form of the kernel tells, on one random input; 0 where it tells none.
    draws, seed : how many inputs are drawn, and from which seed.
    within : where the bound is told by another kernel, that makes it from a form of this one.
    times : what breaks the bound, 10 for a divisor.
    """

    name: str
    kernel: Kernel
    ratio: Callable[[Random, Kernel], float]
    literal: float | None = None
    at: int = 0
    symbol: str = ""
    draws: int = 300
    seed: int = 1
    within: Callable[[Kernel], Kernel] = lambda form: form
    times: float = 0.1

    def form(self, times: float) -> Kernel:
        """The kernel with the constant multiplied."""
        if self.symbol:
            value = interpreted(self.kernel).__globals__[self.symbol]
            return self.within(changed(self.kernel, **{self.symbol: value * times}))
        return self.within(changed(self.kernel, self.literal, self.at, times))

    def worst(self, times: float = 1.0) -> float:
        """The largest true value over its bound that is seen with the constant multiplied."""
        random, form = Random(self.seed), self.form(times)
        return max(self.ratio(random, form) for _ in range(self.draws))


@cache
def told_factors() -> dict[str, float]:
    """Bound over worst seen of every constant, as the manual tells it."""
    rows = re.findall(r"^\| ([^|]+?) \| [^|]+ \| ([0-9.]+) \|$", MANUAL.read_text(), re.MULTILINE)
    return {name: float(factor) for name, factor in rows}


def check_sharpness(constant: Constant) -> None:
    """The bound holds, a tenth of the constant breaks it, and the manual tells the factor between."""
    worst = constant.worst()
    assert worst <= 1.0, f"{constant.name}: the true value is {worst:.3g} times the bound"
    broken = constant.worst(constant.times)
    assert broken > 1.0, (
        f"{constant.name}: a tenth of it still bounds all that is seen, up to a factor {1 / broken:.3g}"
    )
    told = told_factors().get(constant.name)
    assert told is not None and abs(told * worst - 1.0) < 0.15, (
        f"the manual's factor of {constant.name} is {1 / worst:.2g}"
    )
