"""The picture of a part with numbered faces."""

from __future__ import annotations

import numpy as np
import pytest
from drawing_examples import PART_AREA, example, hole_area
from svg_reading import NAMESPACE, area, by_class, matrix, texts

from workhold import Workpiece
from workhold.contact.features import list_contact_features
from workhold.drawing import draw_features


def gear(teeth: int) -> Workpiece:
    """A part with four straight faces for every tooth."""
    step = 2 * np.pi / teeth
    shape = [(40, 0.0), (40, 0.3), (33, 0.45), (33, 0.85)]
    points = [
        (r * np.cos(step * (k + f)), r * np.sin(step * (k + f)), 0.0) for k in range(teeth) for r, f in shape
    ]
    return Workpiece.from_loops("gear", [points])


def tags(svg: str) -> list[tuple[float, float, float, float]]:
    """Boxes of the face numbers."""
    (group,) = by_class(svg, "face-numbers")
    found = []
    for element in group.iter(f"{NAMESPACE}rect"):
        x, y, width, height = (float(element.attrib[key]) for key in ("x", "y", "width", "height"))
        found.append((x, y, x + width, y + height))
    return found


@pytest.mark.parametrize("size", [1.0, 0.01, 40.0])
def test_every_face_is_numbered_once(size: float) -> None:
    """The numbers written are those of the faces, the outline is true, and width and height are dimensioned."""
    _, workpiece, _ = example(size)
    svg = draw_features(workpiece)
    (group,) = by_class(svg, "face-numbers")
    numbers = [element.text for element in group.iter(f"{NAMESPACE}text")]
    assert numbers == [str(face.number) for face in workpiece.faces]
    (part,), (outline,) = by_class(svg, "part"), by_class(svg, "outline")
    drawn = area(outline.attrib["d"]) / matrix(part)[0] ** 2 / size**2
    assert drawn == pytest.approx(PART_AREA - hole_area(), rel=1e-4)
    decimals = 4 if size < 0.1 else 3
    assert f"{60 * size:.{decimals}f} mm" in texts(svg) and f"{40 * size:.{decimals}f} mm" in texts(svg)


@pytest.mark.thorough
@pytest.mark.parametrize("teeth", [4, 15])
def test_numbers_do_not_cover_each_other(teeth: int) -> None:
    """Sixty faces, and no two of their numbers overlap."""
    boxes = np.array(tags(draw_features(gear(teeth))))
    assert len(boxes) == 4 * teeth
    wide = np.minimum(boxes[:, None, 2], boxes[None, :, 2]) - np.maximum(boxes[:, None, 0], boxes[None, :, 0])
    high = np.minimum(boxes[:, None, 3], boxes[None, :, 3]) - np.maximum(boxes[:, None, 1], boxes[None, :, 1])
    overlapping = (wide > 0) & (high > 0) & ~np.eye(len(boxes), dtype=bool)
    assert not overlapping.any()


@pytest.mark.thorough
def test_sheet_grows_with_the_number_of_faces() -> None:
    """More than eighty faces are drawn on A3, more than twice that on A2, with letters of the same size."""
    assert ['width="297mm"' in draw_features(gear(20)), 'width="420mm"' in draw_features(gear(21))] == [
        True,
        True,
    ]
    assert 'width="594mm"' in draw_features(gear(41))


def test_contact_features_are_drawn_on_request() -> None:
    """One dashed path for each contact feature; none without a peg radius."""
    _, workpiece, vise = example()
    (group,) = by_class(draw_features(workpiece, peg_radius=vise.peg_radius), "contact-features")
    assert len(list(group)) == len(list_contact_features(workpiece, vise.peg_radius))
    assert not by_class(draw_features(workpiece), "contact-features")
