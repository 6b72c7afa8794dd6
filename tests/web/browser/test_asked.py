"""What is drawn from the declarations of a search is asked of it."""

from __future__ import annotations

from walking import EXAMPLES, Walk


def test_what_else_is_asked_reaches_the_search_and_a_link(walk: Walk) -> None:
    """Lengths in mm whatever is shown, faces by their numbers; what cannot be is marked and not asked."""
    page = walk.page
    page.set_input_files("#file", EXAMPLES / "bracket.dxf")
    walk.seen("#faces button")
    page.fill("#restrictions-touch", "0, x")
    page.press("#restrictions-touch", "Tab")
    assert page.get_attribute("#restrictions-touch", "aria-invalid") == "true"
    page.fill("#restrictions-touch", "0, 7")
    page.select_option("#unit", "inch")
    page.fill("#search-max-location-error", "0.002")
    page.press("#search-max-location-error", "Tab")
    page.select_option("#unit", "mm")
    assert page.input_value("#search-max-location-error") == "0.0508"
    walk.search()
    job = walk.server.client.get(f"/api/jobs/{walk.job()}").json()
    assert job["request"]["restrictions"]["touch"] == [0, 7]
    assert job["request"]["max_location_error"] == 0.0508
    rows = walk.server.client.get(f"/api/jobs/{walk.job()}/fixtures").json()["rows"]
    assert rows and all(row["quality"]["location_error"] <= 0.0508 for row in rows)
    assert all({0, 7} <= set(row["faces"]) for row in rows)
    walk.reload()
    assert page.input_value("#restrictions-touch") == "0, 7"
