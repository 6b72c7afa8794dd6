"""The page that explains the method: every number in its pictures is the program's."""

from __future__ import annotations

from collections.abc import Iterator
from math import cos, degrees, hypot, pi, radians, sin
from typing import Any

import numpy as np
import pytest
from lesson_page import BRACKET, EXAMPLES, STATIC, LessonPage

import workhold
from workhold.kernels.base.tables import CURVE_REALS
from workhold.kernels.chord.evaluation import compute_chord_state, write_curve


@pytest.fixture(scope="module")
def shown(lesson_profile: Any) -> Iterator[LessonPage]:
    """One page for all of these tests: each chooses its example and puts the sliders where it wants them."""
    page = LessonPage(lesson_profile.new_page(), (STATIC / "index.html").as_uri())
    yield page
    page.page.close()
    assert page.troubles == []


def state_of(lesson: dict[str, Any], pair: int, theta: float) -> tuple[float, ...]:
    """A chord of the shown fixture at an orientation in radians, as the kernels have it."""
    tail, head, _, shift, length, branch, _, _ = lesson["fixtures"][0]["chords"][pair]
    a, b = (np.array([*lesson["features"][k], 0.0, 0.0]) for k in (tail, head))
    curve = np.zeros(CURVE_REALS)
    write_curve(curve, a, b, length, branch, shift)
    return tuple(compute_chord_state(a, b, curve, -theta, cos(theta), -sin(theta)))


def pegs_of(lesson: dict[str, Any], pair: int) -> list[list[float]]:
    """Pegs of a pair of the shown fixture, that of the chord's tail first."""
    fixture = lesson["fixtures"][0]
    pegs = fixture["pegs"][2 * pair : 2 * pair + 2]
    return list(pegs[::-1] if fixture["chords"][pair][2] else pegs)


def turned(point: Any, angle: float) -> tuple[float, float]:
    """A point turned by an angle in radians."""
    c, s = cos(angle), sin(angle)
    return c * point[0] - s * point[1], s * point[0] + c * point[1]


def height_of(state: tuple[float, ...], theta: float) -> float:
    """The height h of a chord's tail."""
    return sin(theta) * state[0] + cos(theta) * state[1]


@pytest.mark.parametrize("name", EXAMPLES)
def test_the_peg_stands_on_the_locus(shown: LessonPage, name: str) -> None:
    """Step 1: its centre is as far from the face as the peg's radius, and the normal points from face to peg."""
    lesson = shown.lesson(name)
    part = workhold.load(str(BRACKET) if name == "bracket" else name)
    segments = {face.number: face.segment for face in part.faces}
    low, high = shown.range("one-peg")
    for share in np.linspace(0.0, 1.0, 23):
        found = shown.put("one-peg", low + share * (high - low))
        segment, point = segments[found["face"]], found["point"]
        normal = segment.compute_normal(segment.find_parameter(tuple(point)))
        assert np.allclose(found["normal"], normal, atol=1e-9)
        radius = lesson["toolkit"]["peg_radius"]
        contact = np.array(point) - radius * np.array(normal)
        assert np.allclose(contact, segment.compute_point(segment.find_parameter(tuple(point))), atol=1e-9)
        words = f"x {point[0]:.2f}, y {point[1]:.2f} mm and touches face {found['face']}"
        assert words in shown.words("one-peg").replace("−", "-")


@pytest.mark.parametrize("name", EXAMPLES)
def test_the_instant_centre_is_the_kernels(shown: LessonPage, name: str) -> None:
    """Step 2: tail, head, height and instant centre at any turn equal those of the program's own chord."""
    lesson = shown.lesson(name)
    low, high = shown.range("two-pegs")
    pegs = pegs_of(lesson, 0)
    for share in (0.0, 0.21, 0.5, 0.83, 1.0):
        found = shown.put("two-pegs", low + share * (high - low))
        theta = radians(found["theta"])
        state = state_of(lesson, 0, theta)
        assert np.allclose(found["tail"], state[:2], atol=1e-7)
        assert found["height"] == pytest.approx(height_of(state, theta), abs=1e-7)
        shift = np.subtract(pegs[0][2:4], turned(state[:2], theta))
        expected = np.add(turned(state[6:8], theta), shift)
        assert np.allclose(found["centre"], expected, rtol=1e-6, atol=1e-6)
        assert f"height {found['height']:.2f} mm" in shown.words("two-pegs").replace("−", "-")


@pytest.mark.parametrize("name", EXAMPLES)
def test_the_crossing_is_the_fixture(shown: LessonPage, name: str) -> None:
    """Step 3: beside it pegs miss by the difference of heights; near it the part falls to the pose in the list."""
    lesson = shown.lesson(name)
    fixture = lesson["fixtures"][0]
    theta, x, y = fixture["pose"]
    low, high = shown.range("crossing")
    pitch = lesson["toolkit"]["pitch"][1]
    for share in (0.07, 0.4, 0.9):
        found = shown.put("crossing", low + share * (high - low))
        turn = radians(found["theta"])
        heights = [height_of(state_of(lesson, pair, turn), turn) for pair in (0, 1)]
        assert np.allclose(found["heights"], heights, atol=1e-7)
        rows = (heights[1] - heights[0] - pegs_of(lesson, 1)[0][3] + pegs_of(lesson, 0)[0][3]) / pitch
        assert found["miss"] == pytest.approx((rows - round(rows)) * pitch, abs=1e-6)
        if not found["fits"]:
            assert f"{abs(found['miss']):.2f} mm" in shown.words("crossing")
    nearly = degrees(theta) + min(0.3, (high - low) / 100)
    found = shown.put("crossing", nearly)
    assert found["fits"]
    assert found["theta"] == pytest.approx(degrees(theta), abs=1e-9)
    assert np.allclose(found["pose"], [x, y], atol=1e-7)
    assert "All four pegs touch" in shown.words("crossing")
    assert f"{degrees(theta):.3f}" in shown.words("crossing").replace("−", "-")


def gaps_of(lesson: dict[str, Any], pose: list[float], opened: float) -> list[float]:
    """How far the four pegs are from the faces they touch, in a pose with the right jaw moved."""
    fixture, out = lesson["fixtures"][0], []
    for pair in (0, 1):
        tail, head, swapped = fixture["chords"][pair][:3]
        found = []
        for number, peg in zip((tail, head), pegs_of(lesson, pair), strict=True):
            row = lesson["features"][number]
            px, py = turned((peg[2] + pair * opened - pose[1], peg[3] - pose[2]), -pose[0])
            dx, dy = px - row[1], py - row[2]
            found.append(dx * row[4] - dy * row[3] if not row[0] else row[7] * (hypot(dx, dy) - row[6]))
        out += found[::-1] if swapped else found
    return out


@pytest.mark.parametrize("name", EXAMPLES)
def test_opening_gives_the_room_that_balance_says(shown: LessonPage, name: str) -> None:
    """Step 4: all four gaps are equal, and for a small opening they are the opening over the sum of forces."""
    lesson = shown.lesson(name)
    fixture = lesson["fixtures"][0]
    forces = [peg[5] for peg in fixture["pegs"]]
    high = shown.range("closing")[1]
    for opened in (0.02 * high, high):
        found = shown.put("closing", opened)
        assert found["opening"] == pytest.approx(fixture["opening"] + opened, abs=1e-9)
        gaps = gaps_of(lesson, found["pose"], opened)
        assert np.allclose(found["gaps"], gaps, atol=1e-8)
        assert np.ptp(gaps) < 1e-8
    first = shown.put("closing", 0.02 * high)["gaps"][0]
    assert first == pytest.approx(0.02 * high / sum(forces), rel=0.1)
    found = shown.put("closing", 0.0)
    assert np.allclose(found["gaps"], 0.0, atol=1e-8)
    assert found["forces"] == forces
    assert shown.page.locator("#closing .arrow.push").count() == 4
    words = ", ".join(f"{force:.2f}" for force in forces)
    assert f"{fixture['opening']:.3f} mm, closed" in shown.words("closing")
    assert words in shown.words("closing")


@pytest.mark.parametrize("name", EXAMPLES)
def test_moments_of_the_forces_cancel_about_any_centre(shown: LessonPage, name: str) -> None:
    """Step 5: arms are those of the wrenches, forces times arms sum to zero, and both senses are stopped."""
    lesson = shown.lesson(name)
    fixture = lesson["fixtures"][0]
    theta = fixture["pose"][0]
    handle = shown.page.locator("#closure .handle")
    handle.focus()
    for key in ("ArrowUp", "ArrowUp", "ArrowLeft", "ArrowDown", "ArrowRight", "ArrowRight", "ArrowRight"):
        before = shown.numbers("closure")["point"]
        handle.press(key)
        found = shown.numbers("closure")
        point = found["point"]
        moved = np.sign(np.subtract(point, before)).tolist()
        assert (
            moved
            == {"ArrowUp": [0, 1], "ArrowDown": [0, -1], "ArrowLeft": [-1, 0], "ArrowRight": [1, 0]}[key]
        )
        arms = []
        for pair in (0, 1):
            state = state_of(lesson, pair, theta)
            rows = [lesson["features"][k] for k in fixture["chords"][pair][:2]]
            normals = [
                turned(np.multiply(n, row[7]), theta)
                for n, row in zip((state[2:4], state[4:6]), rows, strict=True)
            ]
            both = [
                n[1] * (peg[2] - point[0]) - n[0] * (peg[3] - point[1])
                for n, peg in zip(normals, pegs_of(lesson, pair), strict=True)
            ]
            arms += both[::-1] if fixture["chords"][pair][2] else both
        assert np.allclose(found["arms"], arms, atol=1e-7)
        assert found["forces"] == [peg[5] for peg in fixture["pegs"]]
        assert abs(sum(found["moments"])) < 1e-6
        assert found["left"] and found["right"]
        assert sorted(found["left"] + found["right"]) == [1, 2, 3, 4]


@pytest.mark.parametrize("name", EXAMPLES)
def test_sampling_finds_what_numpy_says(shown: LessonPage, name: str) -> None:
    """Step 6: a fixture is seen if its crossing lies between neighbours at which both its chords exist."""
    lesson = shown.lesson(name)
    pitch, every = lesson["toolkit"]["pitch"][1], {one["rank"] for one in lesson["fixtures"]}
    before = -1
    for index in (0, 3, 6, 10, 14):
        found = shown.put("every-one", index)
        count, expected = found["samples"], []
        grid = radians(0.7320508075688772) + pi * np.arange(-2 * count, 2 * count) / count
        for one in lesson["fixtures"]:
            step = int(np.searchsorted(grid, one["pose"][0], side="right")) - 1
            ends = grid[step : step + 2]
            if min(-ends) < max(c[6] for c in one["chords"]) or max(-ends) > min(c[7] for c in one["chords"]):
                continue
            alone = {**lesson, "fixtures": [one]}
            rows = []
            for theta in ends:
                heights = [height_of(state_of(alone, pair, theta), theta) for pair in (0, 1)]
                rows.append(
                    (heights[1] - heights[0] - pegs_of(alone, 1)[0][3] + pegs_of(alone, 0)[0][3]) / pitch
                )
            if rows[0] * rows[1] <= 0:
                expected.append(one["rank"])
        assert sorted(found["found"]) == sorted(expected)
        assert f"{len(expected)} of {len(every)} fixtures found" in shown.words("every-one")
        before = max(before, len(expected))
    assert before > 0
    assert len(shown.put("every-one", 0)["found"]) < len(every)


def test_distances_are_outward_of_every_kind_of_feature(shown: LessonPage) -> None:
    """A point moved off a line, a convex or a hollow arc along its outward normal is as far outside as it was moved."""
    seen = set()
    for name in EXAMPLES:
        for row in shown.lesson(name)["features"]:
            seen.add((row[0], row[7]))
            size = min(1.0, row[6]) if row[0] else 1.0
            for off in (-0.3 * size, 0.7 * size):
                found = shown.page.evaluate(
                    """([row, off]) => {
                      const along = 0.4 * featureLength(row);
                      const point = pointAlong(row, along);
                      const normal = outwardNormal(row, point);
                      const moved = [point[0] + off * normal[0], point[1] + off * normal[1]];
                      return [distanceOutside(row, moved), nearestAlong(row, moved) - along];
                    }""",
                    [row, off],
                )
                assert np.allclose(found, [off, 0.0], atol=1e-9)
    assert seen == {(0, 1), (1, 1), (1, -1)}
