"""What is read of random drawings, against the picture that resvg makes of them.

Of filled drawings, the shapes read and filled must give the same picture but for its edges; of stroked ones, each line
read must lie on a stroke and each stroke around a line. What is refused is refused with a name that is in the file, and
only where there was a reason.
"""

from __future__ import annotations

import io
import random
from itertools import groupby
from math import cos, hypot, sin
from typing import Any

import numpy as np
import pytest
import resvg_py
from numpy.typing import NDArray
from PIL import Image
from svg_drawings import SIZE, RandomDrawing, random_drawings

from workhold.errors import InputError
from workhold.files.outline.chain import Chain, Drawing
from workhold.files.svg.reader import read_svg

PIXELS = 200
CASES = 10_000
CHUNK = 250

Mask = NDArray[np.bool_]


def picture(svg: str, least: int = 60) -> Mask:
    """(200, 200) where the drawing has ink, of at least this alpha."""
    png = resvg_py.svg_to_bytes(svg_string=svg, width=PIXELS, dpi=96, skip_system_fonts=True)
    return np.asarray(Image.open(io.BytesIO(bytes(png))))[:, :, 3] >= least


def path_data(chain: Chain) -> str:
    """A chain as SVG path data on a page of the same size, y turned down again."""
    x, y = chain.points[0]
    words = [f"M{x!r} {SIZE - y!r}"]
    for (u, v), (x, y), bulge in zip(chain.points, chain.points[1:], chain.bulges, strict=False):
        radius = hypot(x - u, y - v) * (1 + bulge * bulge) / abs(4 * bulge) if bulge else 0.0
        words.append(f"A{radius!r} {radius!r} 0 {int(abs(bulge) > 1)} {int(bulge < 0)} {x!r} {SIZE - y!r}")
    return " ".join(words)


def redrawn(drawing: Drawing, attributes: str) -> str:
    """What was read as an SVG drawing: a path for each element."""
    paths = [
        f'<path d="{" ".join(map(path_data, chains))}"/>'
        for _, chains in groupby(drawing.chains, lambda c: c.entity)
    ]
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="100mm" viewBox="0 0 {SIZE} {SIZE}">'
    )
    return f"{head}<g {attributes}>{''.join(paths)}</g></svg>"


def grown(mask: Mask) -> Mask:
    """A mask and the pixels next to it."""
    padded = np.pad(mask, 1)
    rows = padded[:-2] | padded[1:-1] | padded[2:]
    return rows[:, :-2] | rows[:, 1:-1] | rows[:, 2:]


def disagreement(case: RandomDrawing, drawing: Drawing) -> str:
    """How the drawing read differs from the picture; empty when it does not."""
    seen = picture(case.plain)
    if case.filled:
        rule = "evenodd" if 'fill-rule="evenodd"' in case.author else "nonzero"
        read = picture(redrawn(drawing, f'fill-rule="{rule}"'))
        core = ~grown(~(seen ^ read))
        if not core.any():
            return ""
        # Half transparent groups in each other are faint, and some that reach far beyond the page it leaves out.
        solid = picture(case.plain.replace(":.5", ":1"))
        return f"{core.sum()} pixels" if (~grown(~(solid ^ read))).any() else ""
    thin = picture(redrawn(drawing, 'fill="none" stroke="#000" stroke-width="0.5" stroke-linejoin="round"'))
    thick = picture(
        redrawn(
            drawing,
            'fill="none" stroke="#000" stroke-width="5" stroke-linejoin="round" stroke-linecap="square"',
        )
    )
    # Strokes beyond the page leave no ink for those at its border to lie on.
    inner = slice(3, -3)
    loose = (thin & ~grown(grown(grown(picture(case.plain, least=5)))))[inner, inner]
    missed = (seen & ~thick)[inner, inner]
    return f"{loose.sum()} pixels not drawn, {missed.sum()} not read" if loose.any() or missed.any() else ""


def judged(case: RandomDrawing) -> str:
    """What is wrong with the reading of a drawing; empty when nothing is."""
    try:
        drawing = read_svg(case.author.encode(), unit=None)
    except InputError as error:
        text = str(error)
        if "no shape of the drawing is seen" in text:
            return disagreement(case, Drawing(()))
        if not case.hazards:
            return f"refused without a reason: {text}"
        named = any(f"'{name}'" in text for name in case.ids)
        return "" if named and "\n" not in text and len(text) < 400 else f"no name in: {text}"
    return disagreement(case, drawing)


def failures(start: int, stop: int) -> list[str]:
    """Seeds and what is wrong with them."""
    found = [(start + k, judged(case)) for k, case in enumerate(random_drawings(start, stop))]
    return [f"seed {seed}: {words}" for seed, words in found if words]


@pytest.mark.thorough
def test_random_drawings_are_read_as_they_look() -> None:
    """A hundred drawings."""
    assert failures(0, 100) == []


def nested_rings(chance: random.Random, x: float, y: float, radius: float) -> str:
    """Path data of a circle with up to three circles side by side inside it, and so on; each is run either way."""
    data, sweep = [], chance.randrange(2)
    data.append(
        f"M{x - radius} {y}a{radius} {radius} 0 1 {sweep} {2 * radius} 0a{radius} {radius} 0 1 {sweep} {-2 * radius} 0z"
    )
    if radius > 6:
        for turn in chance.sample(range(3), chance.randint(0, 3)):
            angle, inner = 2.1 * turn, radius * chance.uniform(0.2, 0.42)
            data.append(
                nested_rings(chance, x + 0.5 * radius * cos(angle), y + 0.5 * radius * sin(angle), inner)
            )
    chance.shuffle(data)
    return " ".join(data)


@pytest.mark.thorough
@pytest.mark.parametrize("rule", ["nonzero", "evenodd"])
def test_a_hole_is_what_is_not_painted(rule: str) -> None:
    """Circles in circles, run either way: loops sorted by how many are around them give the picture of the fill rule."""
    chance = random.Random(7)
    for _ in range(60):
        data = nested_rings(chance, 50.0, 50.0, 48.0)
        head = f'<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="100mm" viewBox="0 0 {SIZE} {SIZE}">'
        svg = f'{head}<path fill-rule="{rule}" d="{data}"/></svg>'
        different = picture(svg) ^ picture(redrawn(read_svg(svg.encode(), unit=None), 'fill-rule="evenodd"'))
        assert not (~grown(~different)).any(), svg


def test_loops_that_meet_stay_to_be_refused() -> None:
    """A square that lies across the edge of another of its direction, and one on top of the other, are not passed over."""
    for second in ("M20 20h30v30h-30z", "M0 0h30v30h-30z", "M0 5h10v10h-10z"):
        head = '<svg xmlns="http://www.w3.org/2000/svg" width="9mm" viewBox="0 0 90 90">'
        svg = f'{head}<path d="M0 0h30v30h-30z{second}"/></svg>'
        assert len(read_svg(svg.encode(), unit=None).chains) == 2


def test_a_loop_in_the_notch_of_another_is_painted() -> None:
    """Its box lies within the other's and it runs the same way round, yet nothing is around it."""
    head = '<svg xmlns="http://www.w3.org/2000/svg" width="9mm" viewBox="0 0 90 90">'
    for other in ("M20 20h9v9h-9z", "M20 20v9h9v-9z"):
        svg = f'{head}<path d="M0 0h30v10h-20v20h-10z{other}"/></svg>'
        assert len(read_svg(svg.encode(), unit=None).chains) == 2


@pytest.mark.thorough
def test_most_drawings_are_read_and_have_ink() -> None:
    """The comparison compares something: most drawings are read, and of those most show something."""
    read, inked = 0, 0
    for case in random_drawings(0, 100):
        try:
            drawing: Any = read_svg(case.author.encode(), unit=None)
        except InputError:
            continue
        read += 1
        inked += bool(drawing.chains and picture(case.plain).any())
    assert read > 45
    assert inked > 40


@pytest.mark.prove
@pytest.mark.parametrize("start", range(0, CASES, CHUNK))
def test_thousands_of_random_drawings_are_read_as_they_look(start: int) -> None:
    """Ten thousand drawings."""
    assert failures(start, start + CHUNK) == []
