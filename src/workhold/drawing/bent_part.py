"""A part coloured by how far it is bent, and drawn with that movement exaggerated, in a slanting view.

The surface of the mesh is drawn from back to front, each triangle in the colour of its middle. Contacts dent
the part locally, and the mesh does not resolve that; such places are grey. The place of the largest movement
is marked, and the part is seen from the first of several directions that shows it. Where the part would yield, so is
that of the largest stress.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, floor, log10, radians, sin

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.bending.figures import Bending
from workhold.drawing.panel import TextColumn
from workhold.drawing.scene import UNITS_PER_MM, Box, LengthUnit, Scene, measure_text
from workhold.model.part_bending import BendingFigures

__all__ = [
    "LARGEST_SHOWN",
    "compute_node_colours",
    "draw_bent_page",
    "draw_bent_part",
    "choose_exaggeration",
    "draw_bending",
]

Array = NDArray[np.float64]
# Of the part's size, the largest movement as it is drawn.
LARGEST_SHOWN = 0.05
# From where it may be seen: degrees about the upright, and above the level. The first that shows the most is taken.
VIEWS = [(turn, rise) for rise in (35.0, -35.0) for turn in (30.0, 300.0, 120.0, 210.0)]
# Of the part's size, how far what hides a place lies in front of it at least.
IN_FRONT = 0.005
# Half the side of the square around the place of the largest stress, and its corners.
HALF_SQUARE = 7.0
AROUND = ((-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1))
# How long the arrows are that show the axes.
AXIS = 24.0
# Colours from nothing to the most, from dark blue to yellow, of equal steps of lightness (B. Jin, N. Heitmann, S. van
# der Walt, "viridis", CC0), and of what is pressed.
STOPS = np.array([(68, 1, 84), (59, 82, 139), (33, 145, 140), (94, 201, 98), (253, 231, 37)]) / 255.0
PRESSED = np.array([0.72, 0.72, 0.72])
# The light that falls on what is seen from the side, of what falls on what is seen from above.
SHADED = 0.25
STEPS = 5
NO_PICTURE = (
    "These figures are those of the result file. A picture beside them takes the extra bending and, of a solid, its STEP "
    "file."
)
# Size of a picture by itself, in mm.
PICTURE = (180.0, 130.0)


def choose_exaggeration(bending: Bending) -> float:
    """Return the factor by which movements are exaggerated: 1, or a larger 1, 2 or 5 times a power of ten.

    Exaggerated, the largest movement is at most ``LARGEST_SHOWN`` (a twentieth) of the part's size, unless
    the factor is 1.
    """
    size = float(np.ptp(bending.surface.nodes, axis=0).max())
    most = bending.clamp_distortion.value
    if most <= 0.0:
        return 1.0
    times = LARGEST_SHOWN * size / most
    power = 10.0 ** floor(log10(times))
    return max(1.0, next(step * power for step in (5.0, 2.0, 1.0) if step * power <= times))


def compute_node_colours(bending: Bending) -> Array:
    """Return the colours (N, 3) of the nodes as red, green and blue from 0 to 1; pressed nodes are grey."""
    most = max(bending.clamp_distortion.value, 1e-12)
    share = np.clip(np.linalg.norm(bending.moved, axis=1) / most, 0.0, 1.0)
    colours = interpolate_colours(share)
    colours[bending.pressed] = PRESSED
    return colours


def interpolate_colours(share: Array) -> Array:
    """Return the colours (N, 3), from 0 to 1, for movements given as shares (N,) of the largest movement."""
    places = np.linspace(0.0, 1.0, len(STOPS))
    return np.stack([np.interp(share, places, STOPS[:, k]) for k in range(3)], axis=1)


def to_hex(colour: Array) -> str:
    """Return a colour (3,), 0 to 1, as "#rrggbb"."""
    return "#" + "".join(f"{round(255 * min(max(float(one), 0.0), 1.0)):02x}" for one in colour)


@frozen(eq=False)
class BentView:
    """A bent part in one view.

    Parameters
    ----------
    frame : (3, 3) rows: the unit vectors to the right, up, and towards the eye.
    flat : (N, 3) coordinates in that frame of the N nodes, moved by the exaggerated movement, in mm.
    is_seen : (T,) whether each of the T triangles faces the eye.
    is_from_below : whether the eye is below the part.
    """

    frame: Array
    flat: Array
    is_seen: NDArray[np.bool_]
    is_from_below: bool

    @classmethod
    def from_bending(cls, bending: Bending, times: float, turn: float, rise: float) -> BentView:
        """Return the view of a part bent ``times`` as far as it is.

        ``turn`` is the eye's angle about the upright axis and ``rise`` its angle above the horizontal, in
        degrees.
        """
        turn, rise = radians(turn), radians(rise)
        right = np.array([cos(turn), sin(turn), 0.0])
        back = np.array([-sin(turn), cos(turn), 0.0])
        up = sin(rise) * back + np.array([0.0, 0.0, cos(rise)])
        frame = np.stack([right, up, np.cross(right, up)])
        surface = bending.surface
        flat = (surface.nodes + times * bending.moved) @ frame.T
        a, b, c = np.moveaxis(flat[surface.triangles[:, :3]], 1, 0)
        return cls(frame, flat, np.cross(b - a, c - a)[:, 2] > 0.0, rise < 0.0)

    def shows(self, node: int, triangles: NDArray[np.int64]) -> bool:
        """Return whether a node is visible: on a triangle that faces the eye, with no other triangle in front
        of it.
        """
        own = (triangles == node).any(axis=1)
        if not (own & self.is_seen).any():
            return False
        others = triangles[self.is_seen & ~own][:, :3]
        a, b, c = np.moveaxis(self.flat[others], 1, 0)
        ab, ac, at = b - a, c - a, self.flat[node] - a
        area = ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0]
        area = np.where(area > 0.0, area, np.inf)
        second = (at[:, 0] * ac[:, 1] - at[:, 1] * ac[:, 0]) / area
        third = (ab[:, 0] * at[:, 1] - ab[:, 1] * at[:, 0]) / area
        is_over = (second >= 0.0) & (third >= 0.0) & (second + third <= 1.0) & np.isfinite(area)
        before = second * ab[:, 2] + third * ac[:, 2] - at[:, 2]
        return not (is_over & (before > IN_FRONT * np.ptp(self.flat, axis=0).max())).any()


def choose_view(bending: Bending, times: float, nodes: Sequence[int]) -> tuple[BentView, list[bool]]:
    """Return (view, is shown), where ``is shown`` says of each of the nodes whether it is seen.

    The view is the first that shows all nodes, else the first that shows the first node, else the first of all.
    """
    views = [BentView.from_bending(bending, times, *angles) for angles in VIEWS]
    seen = [[view.shows(node, bending.surface.triangles) for node in nodes] for view in views]
    best = max(range(len(views)), key=lambda k: (all(seen[k]), seen[k][0]))
    return views[best], seen[best]


def draw_bent_part(scene: Scene, box: Box, bending: Bending, lengths: LengthUnit) -> None:
    """Draw the part, bent with an exaggeration and coloured, and its colour scale, into a page box."""
    surface, times = bending.surface, choose_exaggeration(bending)
    places = [bending.clamp_distortion.at, *([bending.stress.at] if bending.yields else [])]
    marks = [int(np.linalg.norm(surface.nodes - np.array(at), axis=1).argmin()) for at in places]
    view, are_shown = choose_view(bending, times, marks)
    scale_height = 34.0
    room = Box(box.x0, box.y0, box.x1, box.y1 - scale_height)
    flat = view.flat
    low, high = flat[:, :2].min(axis=0), flat[:, :2].max(axis=0)
    factor = min(room.width / (high[0] - low[0]), room.height / (high[1] - low[1]))
    middle = (low + high) / 2
    x = (room.x0 + room.x1) / 2 + factor * (flat[:, 0] - middle[0])
    y = (room.y0 + room.y1) / 2 - factor * (flat[:, 1] - middle[1])
    shown = surface.triangles
    depth = flat[shown[:, :3], 2].mean(axis=1)
    colours = compute_node_colours(bending)[shown].mean(axis=1)
    lamp = np.array([0.35, -0.25, -0.9 if view.is_from_below else 0.9])
    light = 1.0 - SHADED * (1.0 - np.clip(surface.normals @ lamp, 0.0, 1.0))
    group = scene.group("bent")
    for number in np.flatnonzero(view.is_seen)[np.argsort(depth[view.is_seen])].tolist():
        fill = to_hex(colours[number] * light[number])
        points = [(float(x[node]), float(y[node])) for node in shown[number, :3]]
        group.add_polygon(points, fill, fill, 0.4)
    for number, (mark, is_shown) in enumerate(zip(marks, are_shown, strict=True)):
        draw_mark(scene, (float(x[mark]), float(y[mark])), is_shown, is_square=number > 0)
    draw_axes(scene, (box.x1 - 1.8 * AXIS, box.y1 - 1.4 * AXIS), view)
    notes = Box(box.x0, box.y1 - scale_height + 8, box.x1, box.y1)
    said = ["Seen from below."] if view.is_from_below else []
    said.append("Ring: most." if are_shown[0] else "Dashed ring: most, which is hidden.")
    if len(marks) > 1:
        square = (
            "Square: most stressed, might yield" if are_shown[1] else "Dashed square: most stressed, hidden"
        )
        said.append(f"{square}.")
    draw_scale(scene, notes, bending, lengths, times, " ".join([*said, "Grey: pressed, not counted."]))


def draw_axes(scene: Scene, at: tuple[float, float], view: BentView) -> None:
    """Draw the axes of the part as arrows from a page point."""
    group = scene.group("axes")
    for name, along in zip("XYZ", view.frame.T, strict=True):
        tip = (at[0] + AXIS * float(along[0]), at[1] - AXIS * float(along[1]))
        group.add_arrow(at, tip, "#555555", 0.9, 5.0)
        beyond = (at[0] + 1.35 * (tip[0] - at[0]), at[1] + 1.35 * (tip[1] - at[1]))
        group.add_text(beyond, name, 8, anchor="middle")


def draw_mark(scene: Scene, at: tuple[float, float], is_shown: bool, is_square: bool) -> None:
    """Draw a ring around the page point of the largest movement, or a square around that of the largest stress.

    It is dashed where the place is hidden.
    """
    dashes = {} if is_shown else {"stroke_dasharray": "3 2"}
    for colour, width, dashed in (("#ffffff", 3.5, {}), ("#d50000", 1.8, dashes)):
        if is_square:
            corners = [(at[0] + i * HALF_SQUARE, at[1] + j * HALF_SQUARE) for i, j in AROUND]
            scene.add_line(corners, colour, width, **dashed)
        else:
            scene.add_circle(at, 6.0, stroke=colour, width=width, **dashed)


def draw_scale(
    scene: Scene, box: Box, bending: Bending, lengths: LengthUnit, times: float, words: str
) -> None:
    """Draw the colour scale with its movements, and the factor ``times`` of exaggeration."""
    width, pieces = min(200.0, 0.45 * box.width), 50
    for k in range(pieces):
        fill = to_hex(interpolate_colours(np.array([(k + 0.5) / pieces]))[0])
        scene.add_rectangle(
            Box(box.x0 + k * width / pieces, box.y0, box.x0 + (k + 1) * width / pieces + 0.3, box.y0 + 8),
            fill,
        )
    most = bending.clamp_distortion.value
    unit = lengths.unit
    for k in range(STEPS):
        share = k / (STEPS - 1)
        label = unit.format_small_number(share * most) + (f" {unit.small_name}" if k == STEPS - 1 else "")
        left = box.x0 + share * width - (0.0 if k == 0 else measure_text(label, 9) / 2)
        scene.add_text((left, box.y0 + 19), label, 9)
    said = f"Bent {times:,.0f} times as far as it is." if times > 1 else "Bent as far as it is."
    scene.add_text((box.x0 + width + 40, box.y0 + 8), said, 10, bold=True)
    scene.add_text((box.x0 + width + 40, box.y0 + 20), words, 9)


def draw_bent_page(
    scene: Scene, box: Box, bending: BendingFigures, lengths: LengthUnit, words: Sequence[str]
) -> None:
    """Fill a page box of a setup sheet: sentences ``words``, and below them the bent part.

    There is no picture of figures without a mesh, as a result file has them.
    """
    column = TextColumn(scene.group("words"), box.x0, box.y0, box.width)
    column.write_paragraph("How clamping bends the part", 16, bold=True)
    column.y += 6.0
    material = (
        f"Reckoned for {bending.material.words}; the part is finished, and contacts neither slip nor let go."
    )
    for sentence in (*words, material):
        column.write_paragraph(sentence, 12)
    if not isinstance(bending, Bending):
        column.write_paragraph(NO_PICTURE, 12)
        return
    draw_bent_part(scene, Box(box.x0, column.y + 16.0, box.x1, box.y1 - 10.0), bending, lengths)


def draw_bending(bending: Bending, title: str, lengths: LengthUnit, words: Sequence[str]) -> str:
    """Return a picture of the bent part with sentences below it, as SVG text."""
    width, height = (UNITS_PER_MM * side for side in PICTURE)
    scene = Scene.make_page((width, height), title)
    margin = 20.0
    scene.add_text((margin, margin + 8), title, 13, bold=True)
    below = height - 62.0
    draw_bent_part(scene, Box(margin, margin + 20, width - margin, below - 6), bending, lengths)
    column = TextColumn(scene.group("words"), margin, below + 4, width - 2 * margin)
    for sentence in words:
        column.write_paragraph(sentence, 10)
    return scene.to_svg()
