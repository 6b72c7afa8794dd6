"""The plot of docs/scale.md: what the best of a plate cost against the holes under it, both logarithmic, by toolkit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import exp

from loglog import FRAME, PAGE, SMALL, Axes, draw_grid, fitted
from workhold.drawing.scene import Scene

__all__ = ["draw_large"]

COLOURS = ("#1f6fb5", "#b5541f", "#3a8a3a")
LINE = 30.0


def draw_large(points: Mapping[str, Sequence[tuple[float, float]]], best: int) -> str:
    """The plot as SVG text.

    Parameters
    ----------
    points : holes under the part and seconds of the processor, by toolkit.
    best : how many fixtures were sought.
    """
    axes = Axes.around([point for several in points.values() for point in several])
    scene = Scene.make_page(PAGE, f"What the best {best} fixtures of a plate cost, by the holes under it")
    draw_grid(scene, axes, "holes under the part", "seconds of the processor")
    for place, (kit, several) in enumerate(points.items()):
        colour, fit = COLOURS[place % len(COLOURS)], fitted(several)
        words = kit
        if fit is not None:
            ends = [several[0][0], several[-1][0]]
            scene.add_line([axes.place(holes, exp(fit[1]) * holes ** fit[0]) for holes in ends], colour, 2.0)
            words = f"{kit}: grows with their power {fit[0]:.2f}"
        for point in several:
            scene.add_circle(axes.place(*point), 7.0, colour, colour, 2.0)
        y = FRAME.y0 + LINE * (place + 1)
        scene.add_circle((FRAME.x0 + 24.0, y), 7.0, colour, colour, 2.0)
        scene.add_text((FRAME.x0 + 44.0, y), words, SMALL)
    return scene.to_svg()
