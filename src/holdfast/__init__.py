"""holdfast finds every way to hold a part in a fixture vise with four pegs.

The public face is small: :func:`load` reads a part, :class:`Vise` describes the vise, :func:`design` finds all fixtures
and returns a :class:`Result`. Names are imported on first use, so that ``import holdfast`` costs next to nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from holdfast.errors import HoldfastError, InputError
    from holdfast.files.load import load
    from holdfast.model.fixture import Fixture, Peg, Pose
    from holdfast.model.result import Result
    from holdfast.model.vise import Vise
    from holdfast.model.workpiece import Workpiece
    from holdfast.search.contacts import count_contacts
    from holdfast.search.design import design

__all__ = [
    "Fixture",
    "HoldfastError",
    "InputError",
    "Peg",
    "Pose",
    "Result",
    "Vise",
    "Workpiece",
    "count_contacts",
    "design",
    "load",
]

__version__ = "0.1.0"

HOMES = {
    "Fixture": "holdfast.model.fixture",
    "HoldfastError": "holdfast.errors",
    "InputError": "holdfast.errors",
    "Peg": "holdfast.model.fixture",
    "Pose": "holdfast.model.fixture",
    "Result": "holdfast.model.result",
    "Vise": "holdfast.model.vise",
    "Workpiece": "holdfast.model.workpiece",
    "count_contacts": "holdfast.search.contacts",
    "design": "holdfast.search.design",
    "load": "holdfast.files.load",
}


def __getattr__(name: str) -> Any:
    if name in HOMES:
        return getattr(import_module(HOMES[name]), name)
    raise AttributeError(f"module 'holdfast' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
