"""Where what holds a part presses on it, and with which forces, from the file alone.

A peg, a tip or an end of a wall presses on an upright strip, a pad and a clamp on top on level discs, a load on a
disc. The part lies with its level faces on what bears it, with an affine pressure, or on three pads.
"""

from __future__ import annotations

from math import ceil, pi

import numpy as np
from attrs import frozen
from flint import arb
from numpy.typing import NDArray

from workhold.fixels.carrier import Carrier
from workhold.fixels.contacts import FLAT_PIN, ROUND_PIN
from workhold.model.fixture import Fixture
from workhold.model.part_bending import BendingFigures
from workhold.model.query import Query
from workhold.verification.ball_geometry import BallOutline
from workhold.verification.contacts import BallPose
from workhold.verification.pins import PegBeam, find_run
from workhold.verification.rules.hardware import ToolkitRules
from workhold.verification.tolerances import STATED_FORCE

__all__ = ["BESIDE", "LevelDisc", "PressedSetup", "PegStrip", "make_level_disc", "make_pressed_setup"]

Array = NDArray[np.float64]
# How wide a peg presses in mm, how far beside it movements are read, and how its points are spread: so many across, and
# along it at most so far apart.
WIDE, BESIDE, ACROSS, APART = 2.0, 2.0, 4, 2.0
# Rings of a disc: radius over that of the disc, and points on it; and points around it.
DISC, AROUND = ((0.25, 4), (0.75, 12)), 12


@frozen(eq=False)
class PegStrip:
    """The strip on which a peg presses.

    Parameters
    ----------
    points : (M, 3) in mm, which share its force.
    beside : (K, 3) in mm, where movements are read.
    outward : (3,) unit vector out of the part.
    share : its force per unit of jaw force.
    mover : index of the thing that moves with it; None for one that stands still.
    way : (3,) unit vector along which that thing moves.
    give : how far the peg gives way in mm per N.
    """

    points: Array
    beside: Array
    outward: Array
    share: float
    mover: int | None
    way: Array
    give: float


@frozen(eq=False)
class LevelDisc:
    """A level disc, with the points (M, 3) that share its force, and the points (K, 3) around it, in mm."""

    points: Array
    beside: Array

    @property
    def middle(self) -> Array:
        return np.asarray(self.points.mean(axis=0))


def make_level_disc(middle: Array, radius: float) -> LevelDisc:
    """Return the disc about a point (3,) with this radius in mm."""

    def ring(far: float, count: int) -> list[Array]:
        angles = (np.arange(count) + 0.5) * (2 * pi / count)
        return [middle + far * np.array([np.cos(one), np.sin(one), 0.0]) for one in angles]

    inside = [point for share, count in DISC for point in ring(share * radius, count)]
    return LevelDisc(np.array(inside), np.array(ring(radius + BESIDE, AROUND)))


def spread_evenly(low: float, high: float, count: int) -> Array:
    """Return the middles of ``count`` equal pieces of an interval."""
    step = (high - low) / count
    return np.asarray(low + step * (np.arange(count) + 0.5))


@frozen(eq=False)
class PressedSetup:
    """All that holds a part.

    Parameters
    ----------
    strips : of all pegs, tips and ends of walls.
    movers : number of things that move.
    pads : three discs below the part; () where its level faces bear it.
    tip : disc of the clamp on top; None without one.
    tip_force : force of that clamp in N.
    """

    strips: tuple[PegStrip, ...]
    movers: int
    pads: tuple[LevelDisc, ...]
    tip: LevelDisc | None
    tip_force: float

    @property
    def pressed(self) -> Array:
        """Points (N, 3) in mm that are pressed, around which the surface is dented."""
        discs = [one.points for one in (*self.pads, *([] if self.tip is None else [self.tip]))]
        return np.concatenate([*(one.points for one in self.strips), *discs])


def make_pressed_setup(
    fixture: Fixture, query: Query, hardware: ToolkitRules, told: BendingFigures
) -> PressedSetup:
    """Return what holds the part of a fixture with pegs."""
    outline = BallOutline.from_workpiece(query.workpiece)
    travels = hardware.compute_travels(fixture).values()
    written = BallPose.from_written(fixture.pose)
    pose = BallPose.from_turn_and_place(written.theta, written.x, written.y, *map(arb, travels))
    contacts = hardware.find_pressed_contacts(
        fixture, hardware.make_contacts(fixture, outline), pose, outline
    )
    turn = np.radians(fixture.pose.theta_deg)
    back = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    strips, moving = list[PegStrip](), list[str]()
    for peg, contact in zip(fixture.pegs, contacts, strict=True):
        carrier = query.toolkit.find_carrier(peg.carrier)
        normal = np.array([float(value.mid()) for value in contact.compute_outward_normal(pose)])
        if peg.is_on_wall:
            point = np.array([float(value.mid()) for value in contact.compute_center_in_part(pose)])
        else:
            center = back @ (np.array([peg.x, peg.y]) - (fixture.pose.x, fixture.pose.y))
            point = center - float(contact.radius.mid()) * normal
        low, high = find_heights(peg.face, fixture, query, told.thickness, (peg.x, peg.y))
        along = np.array([-normal[1], normal[0]])
        heights = spread_evenly(low, high, max(ACROSS, ceil((high - low) / APART)))
        mover, way = None, np.zeros(3)
        if carrier.travel is not None:
            moving += [] if peg.carrier in moving else [peg.carrier]
            mover = moving.index(peg.carrier)
            way[:2] = back @ np.array(carrier.travel.unit)

        def place(
            offsets: Array, point: Array = point, along: Array = along, heights: Array = heights
        ) -> Array:
            """Return the points at these distances beside the middle line, at all heights."""
            return np.array([[*(point + off * along), z] for off in offsets for z in heights])

        strips.append(
            PegStrip(
                place(spread_evenly(-WIDE / 2, WIDE / 2, ACROSS)),
                place(np.array([-WIDE / 2 - BESIDE, WIDE / 2 + BESIDE])),
                np.array([*normal, 0.0]),
                peg.force,
                mover,
                way,
                compute_give(
                    carrier, find_run_heights(peg.face, fixture, query, told.thickness, (peg.x, peg.y))
                ),
            )
        )
    below = told.below
    pads: tuple[LevelDisc, ...] = ()
    if below is not None:
        pads = tuple(make_level_disc(np.array([x, y, 0.0]), below.pad_radius) for x, y in below.pads.tolist())
    return PressedSetup(
        tuple(strips),
        len(moving),
        pads,
        None if below is None else make_level_disc(below.clamp, below.tip_radius),
        0.0 if below is None else below.force,
    )


def compute_give(carrier: Carrier, run: tuple[float, float] | None) -> float:
    """Return how far what presses on a part gives way, in mm per N: a pin in a hole, pressed in the middle of its run of
    heights; 0 for tips and walls, and where the run is not known.
    """
    if run is None or carrier.contact not in (ROUND_PIN, FLAT_PIN) or not carrier.peg_radius:
        return 0.0
    beam = PegBeam(2 * arb(carrier.peg_radius), arb(run[0] + run[1]) / 2)
    return float(beam.compute_deflection(arb(1)).mid())


def find_heights(
    face: int, fixture: Fixture, query: Query, thickness: float, center: tuple[float, float]
) -> tuple[float, float]:
    """Return the heights in mm between which a peg presses on a face."""
    run = find_run_heights(face, fixture, query, thickness, center)
    return (0.0, thickness) if run is None else (run[0], min(run[1], thickness))


def find_run_heights(
    face: int, fixture: Fixture, query: Query, thickness: float, center: tuple[float, float]
) -> tuple[float, float] | None:
    """Return the heights in mm between which a peg can press on a face; None where they are not known."""
    if query.workpiece.solid is None:
        known = [one for one in (query.thickness, query.peg_height) if one is not None]
        return 0.0, min([thickness, *known])
    run = find_run(face, fixture.pose.inverse.apply(*center), query)
    return None if run is None else (float(run[0].mid()), float(run[1].mid()))


def find_usual_force() -> float:
    """Return the force in N for which figures are stated where nobody gives one."""
    return float(STATED_FORCE)
