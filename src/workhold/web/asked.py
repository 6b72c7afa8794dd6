"""A search as it is asked for: everything that :func:`workhold.search.design.design` needs."""

from __future__ import annotations

from attrs import evolve, field, frozen

from workhold.model.load import Load
from workhold.model.restrictions import Restrictions
from workhold.model.result import Result
from workhold.model.tolerance import Tolerance
from workhold.model.vise import Vise
from workhold.model.workpiece import Workpiece

__all__ = ["Asked", "plain", "plain_part"]


@frozen(eq=False)
class Asked:
    """A search, its values checked; see :func:`workhold.search.design.design` for what they are.

    Parameters
    ----------
    title : what the vise is called; empty for one that was typed in.
    """

    workpiece: Workpiece
    vise: Vise
    types: tuple[str, ...] = ("I", "II")
    contact_margin: float = 0.0
    restrictions: Restrictions = field(factory=Restrictions)
    ranking: tuple[str, ...] | None = None
    tolerance: Tolerance = field(factory=Tolerance)
    loads: tuple[Load, ...] = ()
    title: str = ""


def plain_part(workpiece: Workpiece) -> Workpiece:
    """A workpiece that carries nothing that can be computed again: it goes from one process to another."""
    return Workpiece(workpiece.name, workpiece.loops)


def plain(result: Result) -> Result:
    """A result whose workpiece carries nothing that can be computed again."""
    return evolve(result, workpiece=plain_part(result.workpiece))
