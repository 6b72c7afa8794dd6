"""Common parts of interactive pictures: moving elements are in separate groups.

A group of the class ``moves`` has two attributes: ``data-way`` is its clamping direction on the page, in page
units per mm, and ``data-most`` the distance in mm by which it can be drawn back. A clamp that is bolted to a
plate stays there, and its bars lengthen as its tip moves out.
"""

from __future__ import annotations

from attrs import evolve

from workhold.drawing.bench import BenchDrawing, draw_part, draw_pegs
from workhold.drawing.carriers import (
    draw_clamp,
    draw_flat_jaws,
    draw_holes,
    draw_plate,
    draw_push,
    draw_wall,
    limit_holes_drawn,
)
from workhold.drawing.scene import Scene, View, format_number
from workhold.drawing.straps_drawn import draw_straps
from workhold.geometry.segment import Point
from workhold.model.clamps import ShownClamp
from workhold.model.straps import StrappedHold

__all__ = ["draw_ground", "draw_peg", "measure_draw_back", "add_moving_group", "find_clamping_directions"]


def add_moving_group(scene: Scene, view: View, clamping: Point | None, **attributes: str) -> Scene:
    """Add a group of the class ``moves`` for a carrier that clamps along ``clamping``, a vector of the plan.

    If ``clamping`` is None, the group has the class ``stands``.
    """
    if clamping is None:
        return scene.group("stands", None, **attributes)
    (x, y), scale = clamping, view.scale
    return scene.group("moves", None, data_way=f"{x * scale:.9g} {-y * scale:.9g}", **attributes)


def find_clamping_directions(bench: BenchDrawing) -> dict[str, Point | None]:
    """Return by carrier name the direction in which each carrier clamps, a vector of the plan; None for fixed
    carriers.
    """
    ways = {one.carrier.name: one.clamping for one in bench.shown.carriers}
    return ways | {one.carrier.name: one.clamping for one in bench.shown.clamps}


def measure_draw_back(clamp: ShownClamp) -> float | None:
    """Return the distance in mm by which a clamp can be drawn back from where it clamps.

    It is negative for a clamp that cannot reach its tip from its hole, and None where its hole or stroke is
    unknown.
    """
    travel = clamp.carrier.travel
    if clamp.hole is None or travel is None or travel.most is None:
        return None
    (x, y), (dx, dy) = clamp.hole, clamp.clamping
    return (clamp.tip.x - x) * dx + (clamp.tip.y - y) * dy + travel.most


def draw_ground(scene: Scene, bench: BenchDrawing, view: View) -> None:
    """Draw everything below the pegs: plates, walls, clamps, and the part in a group of
    the class ``part``.
    """
    for carrier in bench.shown.carriers:
        group = add_moving_group(scene, view, carrier.clamping)
        draw_plate(group, carrier, view, 5.0)
        draw_holes(group, carrier, view, limit_holes_drawn(view, bench.shown))
    for wall in bench.shown.walls:
        draw_wall(scene.group("wall"), wall.bar, view, has_ends=wall.standouts is not None)
    for clamp in bench.shown.clamps:
        back = measure_draw_back(clamp)
        most = {} if back is None else {"data_most": format_number(max(back, 0.0))}
        group = add_moving_group(scene, view, clamp.clamping, **most)
        draw_clamp(group, clamp, bench.shown.carriers[0], view, 1.0)
    if bench.shown.jaws is not None:
        draw_flat_jaws(scene.group("jaws"), bench.shown.jaws, view)
    draw_part(scene, bench, view, 1.0)
    if isinstance(bench.fixture.hold, StrappedHold):
        draw_straps(scene, bench.fixture.hold, bench.toolkit, view, 1.0)
    for clamp in bench.shown.clamps:
        draw_push(
            add_moving_group(scene, view, clamp.clamping if clamp.hole is None else None), clamp, view, 1.0
        )


def draw_peg(scene: Scene, bench: BenchDrawing, view: View, number: int) -> None:
    """Draw the peg with index ``number``, from 0."""
    draw_pegs(
        scene, evolve(bench, fixture=evolve(bench.fixture, pegs=(bench.fixture.pegs[number],))), view, 1.0
    )
