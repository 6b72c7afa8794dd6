"""Faces of the part on the drawing: their numbers stand on them, and are clicked as they are."""

from __future__ import annotations

import pytest
from walking import Walk

# Numbers with the middles of their circles, and how far in pixels each is from its face.
NUMBERS = """async () => {
  const { state } = await import("/static/state.js");
  const { partDrawing } = await import("/static/stage-panel.js");
  const { partSegments } = await import("/static/pose.js");
  const { nearest } = await import("/static/geometry.js");
  return [...document.querySelectorAll("#drawing-part .face-number")].map((one) => {
    const face = Number(one.dataset.face);
    const circle = one.querySelector("circle");
    const at = [circle.cx.baseVal.value, circle.cy.baseVal.value];
    const [ox, oy] = partDrawing.view.page([0, 0]);
    const point = [(at[0] - ox) / partDrawing.view.k, (oy - at[1]) / partDrawing.view.k];
    const own = partSegments(state.part).filter((each) => each.face === face);
    const away = Math.min(...own.map(({ segment }) => nearest(segment, point).distance)) * partDrawing.view.k;
    return [face, away];
  });
}"""


def numbers(walk: Walk) -> dict[int, float]:
    """How far each number is from its face, in pixels."""
    return {int(face): float(away) for face, away in walk.page.evaluate(NUMBERS)}


@pytest.mark.parametrize("part", ["widget", "8Handle"])
def test_numbers_stand_on_their_faces(walk: Walk, part: str) -> None:
    """Where two would lie on each other they are pushed apart, each with a line to its face."""
    walk.take(part)
    shown = numbers(walk)
    on = [away for away in shown.values() if away < 10]
    assert len(on) > len(shown) / 2 and len(shown) > 3
    leads = walk.page.locator("#drawing-part .face-lead").count()
    assert leads >= sum(away > 11 for away in shown.values())


def test_a_face_is_forbidden_by_a_click_on_its_number(walk: Walk) -> None:
    """And allowed again by another; the number, the face and the list of faces say the same."""
    page = walk.page
    walk.take()
    face = next(iter(numbers(walk)))
    number = page.locator(f"#drawing-part .face-number[data-face='{face}'] text")
    number.click()
    walk.until("state.avoid.length === 1 && state.avoid[0] === given", face)
    assert page.locator("#drawing-part .face-label.forbidden").count() == 1
    assert page.locator(f"#faces [data-face='{face}'][aria-pressed='true']").count() == 1
    number.click()
    walk.until("state.avoid.length === 0")
