"""workhold finds every way to hold a part in a fixture vise with four pegs.

The public face is small: :func:`load` reads a part, :class:`Vise` describes the vise, :func:`design` finds all fixtures
and returns a :class:`Result`. Names are imported on first use, so that ``import workhold`` costs next to nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from workhold.version import __version__ as __version__

if TYPE_CHECKING:
    from workhold.errors import InputError, WorkholdError
    from workhold.files.part.load import load
    from workhold.model.fixture import Fixture, Peg, Pose
    from workhold.model.query import Query
    from workhold.model.result import Result
    from workhold.model.vise import OpeningVise, Vise
    from workhold.model.workpiece import Workpiece
    from workhold.search.contacts import count_contacts
    from workhold.search.design import answer, design

__all__ = [
    "Fixture",
    "WorkholdError",
    "InputError",
    "OpeningVise",
    "Peg",
    "Pose",
    "Query",
    "Result",
    "Vise",
    "Workpiece",
    "answer",
    "count_contacts",
    "design",
    "load",
]

HOMES = {
    "Fixture": "workhold.model.fixture",
    "WorkholdError": "workhold.errors",
    "InputError": "workhold.errors",
    "Peg": "workhold.model.fixture",
    "Pose": "workhold.model.fixture",
    "Query": "workhold.model.query",
    "Result": "workhold.model.result",
    "OpeningVise": "workhold.model.vise",
    "Vise": "workhold.model.vise",
    "Workpiece": "workhold.model.workpiece",
    "answer": "workhold.search.design",
    "count_contacts": "workhold.search.contacts",
    "design": "workhold.search.design",
    "load": "workhold.files.part.load",
}


def __getattr__(name: str) -> Any:
    if name in HOMES:
        return getattr(import_module(HOMES[name]), name)
    raise AttributeError(f"module 'workhold' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
