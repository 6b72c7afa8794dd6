"""What a toolkit has for three dimensions, typed on the page: heights of carriers, supports, a clamp on top."""

from __future__ import annotations

from typing import Any

import pytest
from step_shapes import box, filleted, fused, upright, write_step
from test_solids_shown import sets, stands
from test_toolkits_shown import fill, held_in
from walking import Walk

JOB = "async () => (await import('/static/state.js')).state.job"


@pytest.fixture(scope="module")
def block(tmp_path_factory: pytest.TempPathFactory) -> str:
    """A base of 100 x 70 x 12 mm with a boss of 60 x 40 x 18 mm on it."""
    shape = fused(filleted(box(100, 70, 12), 8, upright), box(60, 40, 18, (20, 15, 12)))
    return str(write_step(tmp_path_factory.mktemp("blocks") / "block.step", shape))


def on_a_plate(walk: Walk, block: str) -> None:
    """The part on a plate with a clamp whose fields are open."""
    stands(walk, block, "8")
    walk.page.select_option("#preset", "clamp-plate-20mm")
    walk.page.click("#more-title")


def test_a_clamp_touches_between_heights_of_its_own(walk: Walk, block: str) -> None:
    """The outline that it meets is read before the search; another pair of heights, another one; a reload keeps it."""
    page = walk.page
    on_a_plate(walk, block)
    fill(walk, clamp_heights_least="14", clamp_heights_most="24")
    walk.search()
    shown = walk.shown()
    part = page.evaluate("async () => (await import('/static/state.js')).state.part")
    assert part["outlines"]["clamp"]["heights"] == [14, 24]
    assert max(shown["faces"]) >= len(part["segments"])
    surveys = [address for address in walk.asked if "heights=" in address]
    assert len(surveys) == 1
    found = walk.count()
    page.click("#next")
    walk.until("state.selected.rank > 1")
    walk.reload()
    walk.searched()
    assert walk.count() == found
    # Without the file nobody knows what other heights meet.
    page.click("#more-title")
    fill(walk, clamp_heights_most="20")
    walk.until("state.job?.state === 'failed'")
    assert "open it again" in page.evaluate(JOB)["error"]
    page.set_input_files("#file", block)
    walk.seen("#file-asks .standing")
    walk.search()
    assert page.evaluate(
        "async () => (await import('/static/state.js')).state.part.outlines.clamp.heights"
    ) == [
        14,
        20,
    ]


def test_hardware_is_typed_and_used(walk: Walk, block: str) -> None:
    """In mm, from inches too; what is emptied is the usual again, and what is wrong is marked."""
    page = walk.page
    on_a_plate(walk, block)
    fill(walk, supports_pad_radius="2.5", supports_height="14", top_clamp_tip_radius="3")
    fill(walk, top_clamp_reach="0, 0, 5, 400; 100, 0, 5, 400")

    def hardware() -> list[Any]:
        toolkit = held_in(walk)
        return [toolkit.get("supports"), toolkit.get("top_clamp")]

    wanted = [
        {"pad_radius": 2.5, "height": 14},
        {"tip_margin": 1, "tip_radius": 3, "reach": [[0, 0, 5, 400], [100, 0, 5, 400]]},
    ]
    assert hardware() == wanted
    page.select_option("#unit", "inch")
    assert float(page.input_value("#supports-height")) == pytest.approx(14 / 25.4)
    assert float(page.input_value("#top-clamp-reach").split(",")[3].split(";")[0]) == pytest.approx(
        400 / 25.4
    )
    fill(walk, supports_pad_margin="0.1")
    wanted[0]["pad_margin"] = pytest.approx(2.54)
    assert hardware() == wanted
    # A limit of stress is typed in thousands of pounds to the square inch there: 50 ksi are 344.7 MPa.
    assert page.inner_text("label:has(#pins-stress-limit)").strip() == "Bending stress ksi"
    fill(walk, pins_stress_limit="50")
    assert held_in(walk)["pins"]["stress_limit"] == pytest.approx(344.738, abs=1e-3)
    page.focus("#unit")
    page.select_option("#unit", "mm")
    assert page.inner_text("label:has(#pins-stress-limit)").strip() == "Bending stress MPa"
    fill(walk, pins_stress_limit="")
    walk.search()
    walk.seen("#supports-sets tr")
    thick = len(sets(walk, pad_radius=9.0, bottom_zones=[]))
    assert len(sets(walk)) >= thick
    walk.reload()
    walk.searched()
    assert hardware() == wanted
    page.click("#more-title")
    fill(walk, top_clamp_reach="1, 2, 3")
    assert page.get_attribute("#top-clamp-reach", "aria-invalid") == "true"
    assert "Reaches about" in walk.seen("#toolkit-trouble").inner_text()
    fill(walk, top_clamp_reach="", top_clamp_tip_radius="")
    page.wait_for_selector("#toolkit-trouble", state="hidden")
    walk.until("!state.toolkit.top_clamp.reach")
    assert hardware() == [wanted[0], {"tip_margin": 1}]
