"""Durations of tasks: estimated in advance, so that the longest come first, and measured afterwards.

The estimate is a power law. A search grows with the number of faces and with the number of steps that the
lattice offers between two pegs on a part of that size. Constants and exponents come from a fit to measured
runs (``benchmarks/batch_estimate.py``); docs/benchmarks.md gives its accuracy. Only the order and the ratios
of estimates matter; the speed of a machine is found while it runs. Where friction holds a part that is loaded, most
of the time goes into the forces: of each hold between flat jaws, and of the first seats under straps.

Durations are kept in a text file beside the records, which does not tell whether a task is done. They are not
in the records, because the bytes of a record must not depend on the machine or its speed. Each line is
appended in one write, so that two runs can share the file; a line cut short by the end of a run is ignored.
"""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from math import exp, hypot, log
from pathlib import Path

from attrs import define, field

from workhold.batch.tasks import LETTERS, Outcome
from workhold.errors import InputError, make_printable
from workhold.files.atomic import explain_system_errors
from workhold.files.budget import LIMITS
from workhold.files.text import read_limited
from workhold.fixels.toolkit import Toolkit
from workhold.model.query import Query
from workhold.model.straps import USUAL_SEATS

__all__ = ["TaskDurations", "predict_answering_seconds", "compute_measures", "predict_reading_seconds"]

# Seconds are exp(constant) * faces ** first * steps ** second.
LAWS: Mapping[str, tuple[float, float, float]] = {
    "vise": (-9.35, 0.83, 1.33),
    "plate": (-10.94, 0.93, 1.32),
    "two clamps": (-19.51, 0.07, 3.86),
    "fence": (-3.9, 0.39, -0.02),
    "straps": (-6.99, -0.19, 1.21),
}
# Where friction holds the part, processor seconds for each hold or seat that is looked at under loads: for the first
# load, each further one, and a program whose tools press on the part.
FIRST_LOAD: Mapping[str, float] = {"jaws": 0.05, "straps": 0.16}
FURTHER_LOAD: Mapping[str, float] = {"jaws": 0.04, "straps": 0.05}
OF_PROGRAM: Mapping[str, float] = {"jaws": 0.2, "straps": 0.45}
# How a line begins.
NAME = re.compile(rf"[0-9a-f]{{1,{LETTERS}}}(,|$)")
# Of a drawing: seconds for the first byte, and for a million of them.
READING: Mapping[str, tuple[float, float]] = {".step": (2.0, 10.0), ".stp": (2.0, 10.0), ".dxf": (0.02, 4.0)}
OTHER_READING = (0.005, 1.0)


def predict_reading_seconds(ending: str, size: int) -> float:
    """Return the predicted seconds to read a file with this ending, such as ".dxf", and size in bytes."""
    first, million = READING.get(ending.lower(), OTHER_READING)
    return first + million * size / 1e6


def compute_measures(faces: int, size: tuple[float, float], toolkit: Toolkit) -> tuple[str, float, float]:
    """Return (law, log of the number of faces, log of the number of lattice steps) to estimate a search.

    ``law`` is a key of :data:`LAWS` for the toolkit, ``size`` the width and height of the part in mm.
    """
    if not toolkit.plates:
        return toolkit.law, log(faces), 0.0
    carrier = toolkit.plates[0]
    diameter = hypot(*size) + 2.0 * carrier.peg_radius
    across, along = (
        diameter / pitch if count is None else min(count - 1.0, diameter / pitch)
        for pitch, count in zip(carrier.pitch, (carrier.columns, carrier.rows), strict=True)
    )
    return toolkit.law, log(faces), log((2.0 * across + 1.0) * (2.0 * along + 1.0))


def predict_answering_seconds(
    faces: int, size: tuple[float, float], toolkit: Toolkit, query: Query | None = None
) -> float:
    """Return the predicted seconds of a search; ``size`` is width and height of the part in mm.

    ``query`` says with which loads; None for a search without loads.
    """
    law, of_faces, of_steps = compute_measures(faces, size, toolkit)
    constant, first, second = LAWS[law]
    seconds = exp(constant + first * of_faces + second * of_steps)
    return seconds if query is None else seconds + predict_friction_seconds(faces, toolkit, query)


def predict_friction_seconds(faces: int, toolkit: Toolkit, query: Query) -> float:
    """Return the predicted seconds in which forces are found for what friction holds; 0 for pegs, and without loads."""
    jaws = toolkit.flat_jaws
    if not query.is_loaded or not toolkit.holds_by_friction:
        return 0.0
    kind = "straps" if jaws is None else "jaws"
    if jaws is None:
        looked_at = USUAL_SEATS if query.strapped is None else query.strapped
    else:
        looked_at = faces * len(jaws.parallels) * len(jaws.stops)
    each = 0.0
    if query.loads:
        each += FIRST_LOAD[kind] + FURTHER_LOAD[kind] * (len(query.loads) - 1)
    if query.program is not None and query.program.forces is not None:
        each += OF_PROGRAM[kind]
    return looked_at * each


@define(eq=False)
class TaskDurations:
    """Seconds and workers of tasks, by name.

    Parameters
    ----------
    path : path of the file; its folder must exist when the first line is added.
    known : by name of the task, the durations read from the file and those added since.

    Raises
    ------
    InputError
        For a file of that name that was not written by workhold: nothing is added to it.
    """

    path: Path
    known: dict[str, tuple[float, str]] = field(factory=dict, init=False)

    def __attrs_post_init__(self) -> None:
        if not self.path.is_file():
            return
        content = read_limited(self.path, LIMITS["measured"])
        lines = content.decode("utf-8", errors="replace").splitlines()
        if lines and not NAME.match(lines[0]):
            raise InputError(f"{self.path} was not written by workhold: give another folder, or rename it.")
        for line in lines:
            name, _, rest = line.partition(",")
            seconds, comma, worker = rest.partition(",")
            if comma and worker:
                try:
                    self.known[name] = (float(seconds), worker)
                except ValueError:
                    continue

    def add(self, outcome: Outcome) -> None:
        """Keep the seconds and the worker of an outcome, and append them to the file."""
        worker = make_printable(outcome.worker) or "-"
        self.known[outcome.name] = (outcome.seconds, worker)
        with explain_system_errors(self.path):
            self.path.parent.mkdir(parents=True, exist_ok=True)
            descriptor = os.open(self.path, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o666)
            try:
                os.write(descriptor, f"{outcome.name},{outcome.seconds:.6f},{worker}\n".encode())
            finally:
                os.close(descriptor)
