"""workhold finds every way to hold a flat part: in a vise, on a plate with clamps, or against a fence.

The public face is small. The function :func:`load` reads a part; :class:`Vise`, :class:`Plate`,
:class:`Fence`, :class:`FlatJaw`, :class:`PlainVise` and :class:`StrapPlate` describe what holds it. The
function :func:`design` finds all fixtures and returns a :class:`Result`; :func:`save` writes it, and
:func:`open` reads it. Names are imported on first use, so ``import workhold`` costs next to nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from workhold.version import __version__ as __version__

if TYPE_CHECKING:
    from workhold.completeness import verify
    from workhold.errors import InputError, WorkholdError
    from workhold.family.family import plan_family
    from workhold.files.part.load import load
    from workhold.files.part.loaded import solids_in
    from workhold.files.result.columns import answer_to_file
    from workhold.files.result.reader import read_result
    from workhold.files.result.save import save
    from workhold.fixels.fence import Fence
    from workhold.fixels.flat_jaw import FlatJaw
    from workhold.fixels.plain_vise import PlainVise
    from workhold.fixels.plate import Plate
    from workhold.fixels.strapped import StrapPlate
    from workhold.fixels.vise import OpeningVise, Vise
    from workhold.model.fixture import Fixture, Peg
    from workhold.model.pose import Pose
    from workhold.model.program import Program
    from workhold.model.query import Query
    from workhold.model.requirements import Load, Restrictions, Tolerance, circle_zone, polygon_zone
    from workhold.model.result import Result
    from workhold.model.workpiece import Workpiece
    from workhold.presenting.assembly import from_build123d, from_cadquery
    from workhold.search.design import answer, design
    from workhold.search.evaluating import evaluate
    from workhold.search.toolkit_search import count_contacts
    from workhold.seating.solver import seatings

    open = read_result

# What ``from workhold import *`` brings; not ``open``, which would hide Python's own.
__all__ = [
    "Fence",
    "Fixture",
    "FlatJaw",
    "InputError",
    "Load",
    "OpeningVise",
    "Peg",
    "PlainVise",
    "Plate",
    "Pose",
    "Program",
    "Query",
    "Restrictions",
    "Result",
    "StrapPlate",
    "Tolerance",
    "Vise",
    "WorkholdError",
    "Workpiece",
    "answer",
    "answer_to_file",
    "circle_zone",
    "count_contacts",
    "design",
    "evaluate",
    "from_build123d",
    "from_cadquery",
    "load",
    "plan_family",
    "polygon_zone",
    "save",
    "seatings",
    "solids_in",
    "verify",
]

HOMES = {
    "Fence": "workhold.fixels.fence",
    "FlatJaw": "workhold.fixels.flat_jaw",
    "Fixture": "workhold.model.fixture",
    "WorkholdError": "workhold.errors",
    "InputError": "workhold.errors",
    "Load": "workhold.model.requirements",
    "Peg": "workhold.model.fixture",
    "PlainVise": "workhold.fixels.plain_vise",
    "StrapPlate": "workhold.fixels.strapped",
    "Plate": "workhold.fixels.plate",
    "Pose": "workhold.model.pose",
    "Program": "workhold.model.program",
    "Query": "workhold.model.query",
    "Restrictions": "workhold.model.requirements",
    "Result": "workhold.model.result",
    "Tolerance": "workhold.model.requirements",
    "OpeningVise": "workhold.fixels.vise",
    "Vise": "workhold.fixels.vise",
    "Workpiece": "workhold.model.workpiece",
    "answer": "workhold.search.design",
    "answer_to_file": "workhold.files.result.columns",
    "circle_zone": "workhold.model.requirements",
    "count_contacts": "workhold.search.toolkit_search",
    "design": "workhold.search.design",
    "evaluate": "workhold.search.evaluating",
    "from_build123d": "workhold.presenting.assembly",
    "from_cadquery": "workhold.presenting.assembly",
    "load": "workhold.files.part.load",
    "open": "workhold.files.result.reader:read_result",
    "plan_family": "workhold.family.family",
    "polygon_zone": "workhold.model.requirements",
    "save": "workhold.files.result.save",
    "seatings": "workhold.seating.solver",
    "solids_in": "workhold.files.part.loaded",
    "verify": "workhold.completeness",
}


def import_object(name: str, home: str) -> Any:
    """Import and return an object.

    ``home`` is its module; or "module:other_name", if the object is called other than ``name`` there.
    """
    module, _, known_as = home.partition(":")
    return getattr(import_module(module), known_as or name)


def __getattr__(name: str) -> Any:
    """Import an exported name when it is first asked for (PEP 562)."""
    if name in HOMES:
        return import_object(name, HOMES[name])
    raise AttributeError(f"module 'workhold' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*HOMES, "__version__"})
