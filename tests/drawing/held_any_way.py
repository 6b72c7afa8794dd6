"""A fixture of every arrangement of every kind of toolkit, no two numbers of which are the same.

They hold nothing: what is drawn and written is compared with them, and a number that is taken from the wrong place shows.
"""

from __future__ import annotations

from random import Random

from attrs import evolve, frozen

from workhold import Fence, Fixture, Load, OpeningVise, Peg, Plate, Pose, Vise, Workpiece
from workhold.fixels.toolkit import Arrangement, Toolkit
from workhold.model.fixture import ClampPair
from workhold.model.quality import FIGURES
from workhold.statics.loads import LoadCase, WorstLoad

__all__ = ["AHEAD", "HELD", "PITCH", "WALL_OFFSET", "WORDS", "Held", "load_cases_of", "tips_of"]

PITCH, WALL_OFFSET, TRAVEL = (20.0, 16.0), 11.0, (7.0, 33.0)
# Of each direction the unit vector and what a machinist calls it on a plan whose y runs up.
AHEAD = {"-x": (-1, 0), "+x": (1, 0), "-y": (0, -1), "+y": (0, 1)}
WORDS = {"-x": "to the left", "+x": "to the right", "-y": "downward", "+y": "upward"}
# The pairs that a plate with all directions leaves out, as half a turn makes them of others.
TURNED = (("+x", "+x"), ("+x", "-y"), ("+x", "+y"), ("+y", "+y"))
PART = [
    [
        [0, 0, 0],
        [70, 0, 0.3],
        [95, 24, 0],
        [80, 60, 0],
        [52, 41, -0.4],
        [30, 66, 0],
        [12, 50, 0],
        [-9, 23, 0],
    ],
    [[30, 20, -1], [44, 20, -1]],
]


@frozen
class Held:
    """A part in a toolkit; ``made`` is the name of the test."""

    made: str
    fixture: Fixture
    workpiece: Workpiece
    toolkit: Toolkit

    @property
    def directions(self) -> list[str]:
        """Which way its clamps push, in the order of the pegs; of a vise none."""
        return [peg.carrier.removeprefix("clamp ") for peg in tips_of(self.fixture)]


def tips_of(fixture: Fixture) -> list[Peg]:
    """The tips of its clamps."""
    return [peg for peg in fixture.pegs if peg.carrier.startswith("clamp")]


def toolkits() -> dict[str, Toolkit]:
    """Every kind with every direction; two plates where half a turn leaves one of two directions only."""
    vise = {"pitch": PITCH, "columns": 3, "peg_radius": 3.0, "row_offset": 4.0}
    found: dict[str, Toolkit] = {
        "vise": Vise(**vise),
        "gripper": Vise(**vise | {"columns": 1}),
        "opening vise": OpeningVise(**vise),
    }
    plate = {"pitch": PITCH, "peg_radius": 3.0, "clamp_radius": 4.0}
    for kind, travel in (("bolted", TRAVEL), ("line", None)):
        found[f"plate, {kind}"] = Plate(**plate, travel=travel, directions=("-y", "-x"))
        found[f"turned plate, {kind}"] = Plate(**plate, travel=travel, directions=("+y", "+x"))
        found[f"two on a plate, {kind}"] = Plate(**plate, travel=travel, directions=tuple(WORDS), clamps=2)
        found[f"two on a turned plate, {kind}"] = Plate(**plate, travel=travel, directions=TURNED, clamps=2)
        fence = plate | {"travel": travel, "wall_offset": WALL_OFFSET, "directions": tuple(WORDS)}
        found[f"fence, {kind}"] = Fence(**fence)
        found[f"two on a fence, {kind}"] = Fence(**fence, clamps=2)
    return found


def held_in(made: str, toolkit: Toolkit, arrangement: Arrangement) -> Held:
    """Pegs in different holes with different faces and forces, in any order of size."""
    chance = Random(made)
    part = Workpiece.from_loops("any part", PART)
    numbers = [face.number for face in part.faces]
    # What lies on a wall is a face of the outline, never one of a hole.
    faces = chance.sample(
        numbers if toolkit.wall is None else numbers[: len(part.loops[0])], len(arrangement.carriers)
    )
    forces = [round(0.31 + 0.173 * k + chance.uniform(0, 0.09), 6) for k in range(len(faces))]
    chance.shuffle(forces)
    columns, rows = (chance.sample(range(6), len(faces)) for _ in range(2))
    pegs, travels, opening = [], [], round(chance.uniform(41, 63), 3)
    ends = iter(zip(sorted(chance.sample(range(20, 90), 2)), ("fence left", "fence right"), strict=True))
    for number, face, force, column, row in zip(
        arrangement.carriers, faces, forces, columns, rows, strict=True
    ):
        carrier = toolkit.carriers[number]
        if carrier.is_wall:
            beside = None if face % 2 else (face + 1) % len(part.loops[0])
            x, place = next(ends)
            pegs.append(Peg(carrier.name, 0, 0, x + 0.25, 0.0, face, force, place, beside))
        elif carrier.on is None:
            column %= carrier.columns or 6
            pegs.append(
                Peg(
                    carrier.name, column, row, *carrier.compute_hole_center(column, row, opening), face, force
                )
            )
        else:
            dx, dy = AHEAD[carrier.name.removeprefix("clamp ")]
            stroke = round(chance.uniform(*TRAVEL), 3)
            x = column * PITCH[0] + dx * stroke
            y = row * PITCH[1] + (WALL_OFFSET if toolkit.wall else 0.0) + dy * stroke
            if not carrier.has_a_hole:
                column, row = (0, row) if dx else (column, 0)
            start = carrier.compute_hole_center(column, row)
            travels.append((start[0] - x) * dx + (start[1] - y) * dy)
            pegs.append(Peg(carrier.name, column, row, x, y, face, force, carrier.name_place(column, row)))
    pair = None
    if len(travels) == 2:
        low, high = chance.choice(((0.0, 2.3), (0.41, float("inf")), (0.37, 3.1), (0.0, float("inf"))))
        pair = ClampPair(
            (travels[0], travels[1]), (low, high), ((0.0, 0.0),) * len(pegs), chance.randrange(2, 90)
        )
    quality = {figure.key: round(0.061 + 0.1307 * k, 6) for k, figure in enumerate(FIGURES)}
    pose = Pose(
        round(chance.uniform(5, 340), 4), round(chance.uniform(20, 60), 3), round(chance.uniform(10, 50), 3)
    )
    travelled = travels[0] if travels else opening
    fixture = Fixture(arrangement.name, tuple(pegs), pose, travelled, quality, arrangement.direction, pair)
    return Held(made, fixture, part, toolkit)


HELD = [
    held_in(f"{name}, {arrangement.title}", toolkit, arrangement)
    for name, toolkit in toolkits().items()
    for arrangement in toolkit.arrangements
]


def load_cases_of(held: Held) -> tuple[LoadCase, ...]:
    """Three loads, the second the hardest and the first the least; no two numbers are alike."""
    count, cases = len(held.fixture.pegs), []
    for number, needed in enumerate((310.5, 930.5, 620.5), 1):
        worst = WorstLoad(needed, number % count, (3.5 * number, 2.25 * number), 11.5 * number)
        largest = tuple(1000.0 * number + 71.0 * k + 0.25 for k in range(count))
        load = Load(
            ((4.5 * number, 1.5 * number),),
            40.0 + number,
            (10.0 * number, 10.0 * number),
            name=f"cut {number}",
        )
        smallest = tuple(0.5 * value for value in largest)
        reaction = evolve(worst, value=5000.0 + number)
        cases.append(LoadCase(load, float("inf"), 1750.0, smallest, largest, reaction, worst, 77.25 * number))
    return tuple(cases)
