"""What loads do to a fixture, as a table for the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from workhold.cli.tables import Table
from workhold.statics.jaw import jaw_words
from workhold.units import MILLIMETRE, Unit

if TYPE_CHECKING:
    from collections.abc import Sequence

    from workhold.fixels.toolkit import Toolkit
    from workhold.model.fixture import Fixture
    from workhold.statics.loads import LoadCase

__all__ = ["load_tables"]


def load_tables(
    cases: Sequence[LoadCase], fixture: Fixture, toolkit: Toolkit, unit: Unit = MILLIMETRE
) -> tuple[Table | str, ...]:
    """For each load the jaw or clamp force it needs, and each peg's forces at the one that is used."""
    if not cases:
        return ()
    noun = toolkit.moving.noun
    with_friction = cases[0].needed_with_friction is not None
    columns = [
        "load",
        f">{noun} force needed N",
        "peg that lets go first",
        f">worst at {unit.abbreviation}",
        ">direction deg",
    ]
    table = Table((*columns, *([">needed with friction N"] if with_friction else [])))
    for number, case in enumerate(cases, 1):
        worst = case.needed
        row = [
            case.load.name or f"load {number}",
            f"{worst.value:.1f}",
            fixture.pegs[worst.peg].hole,
            f"({unit.number(worst.point[0])}, {unit.number(worst.point[1])})",
            f"{worst.direction:.1f}",
        ]
        table.add_row(*row, *([f"{case.needed_with_friction:.1f}"] if with_friction else []))
    forces = Table(("load", *(f">{peg.hole} N" for peg in fixture.pegs), "every peg presses"))
    for number, case in enumerate(cases, 1):
        ranges = (f"{low:.1f} to {high:.1f}" for low, high in zip(case.smallest, case.largest, strict=True))
        holds = "yes" if case.keeps_contact else "no: the part can move"
        forces.add_row(case.load.name or f"load {number}", *ranges, holds)
    notes = []
    if with_friction:
        notes.append("With friction the forces are not determined; what is needed with it is the best to be hoped for.")
    told = f"For {jaw_words(cases[0].jaw_stiffness, toolkit)}, without friction; docs/quality.md tells both."
    return (
        "",
        table,
        *notes,
        "",
        f"Forces on the part at a {noun} force of {cases[0].jaw_force:.1f} N:",
        forces,
        told,
    )
