"""Pictures of bent parts: the largest movement is seen, or said to be hidden."""

from __future__ import annotations

from math import inf

import numpy as np
import pytest
from attrs import evolve

from bent_bodies import METAL, block, bodies, need_elements
from workhold.bending.figures import Bending
from workhold.drawing.bent_part import BentView, draw_bending
from workhold.drawing.scene import LengthUnit
from workhold.model.part_bending import BentPlace, LargestStress
from workhold.units import MILLIMETRE

need_elements()

HIGH = 12.0


def bent_at(place: tuple[float, float, float]) -> Bending:
    """A block that is moved most at a place of its surface."""
    body = bodies(block, (60.0, 40.0), HIGH)[0]
    surface = body.surface
    away = np.linalg.norm(surface.nodes - np.array(place), axis=1)
    moved = np.zeros_like(surface.nodes)
    moved[:, 0] = 0.01 / (1.0 + away)
    most = BentPlace(0.01, 0.001, place)
    pressed = np.zeros(len(surface.nodes), np.bool_)
    return Bending(
        material=METAL,
        thickness=HIGH,
        jaw_force=1000.0,
        is_assumed=False,
        stiffness=inf,
        faces=(),
        below=None,
        clamp_distortion=most,
        give=None,
        stress=LargestStress(1.0, 0.1, place),
        elements=body.elements,
        surface=surface,
        moved=moved,
        pressed=pressed,
    )


def draw(bending: Bending) -> str:
    return draw_bending(bending, "A block", LengthUnit(MILLIMETRE, 2), ["Words."])


def test_what_is_on_top_is_seen_from_above() -> None:
    text = draw(bent_at((30.0, 20.0, HIGH)))
    assert "Seen from below" not in text and "Ring: most." in text and "Dashed" not in text
    assert all(f">{axis}<" in text for axis in "XYZ")


@pytest.mark.parametrize("place", [(30.0, 20.0, 0.0), (20.0, 10.0, 0.0)])
def test_what_is_on_the_lower_side_is_seen_from_below(place: tuple[float, float, float]) -> None:
    assert "Seen from below. Ring: most." in draw(bent_at(place))


@pytest.mark.parametrize("place", [(60.0, 20.0, 3.0), (0.0, 20.0, 3.0), (30.0, 0.0, 3.0), (30.0, 40.0, 3.0)])
def test_each_side_is_seen_from_above(place: tuple[float, float, float]) -> None:
    text = draw(bent_at(place))
    assert "Seen from below" not in text and "Ring: most." in text


def test_what_nothing_shows_is_said_to_be_hidden(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(BentView, "shows", lambda *_: False)
    text = draw(bent_at((30.0, 20.0, HIGH)))
    assert "Dashed ring: most, which is hidden." in text and "stroke-dasharray" in text


def test_what_stands_before_a_place_hides_it() -> None:
    bending = bent_at((30.0, 20.0, 0.0))
    nodes, triangles = bending.surface.nodes, bending.surface.triangles
    below, top = (int(np.linalg.norm(nodes - (30.0, 20.0, z), axis=1).argmin()) for z in (0.0, HIGH))
    view = BentView.from_bending(bending, 1.0, 30.0, 35.0)
    assert view.shows(top, triangles) and not view.shows(below, triangles)


def test_a_part_that_might_yield_has_a_square_at_its_stress() -> None:
    calm = bent_at((30.0, 20.0, HIGH))
    weak = evolve(calm, material=evolve(METAL, strength=1.05))
    assert calm.yields is None and weak.yields
    assert "Square" not in draw(calm)
    text = draw(weak)
    assert "Square: most stressed, might yield." in text and "Ring: most." in text
    below = draw(evolve(weak, stress=LargestStress(1.0, 0.1, (30.0, 20.0, 0.0))))
    assert "Dashed square: most stressed, hidden." in below and "Seen from below" not in below
    both = draw(evolve(weak, stress=LargestStress(1.0, 0.1, (0.0, 20.0, 4.0))))
    assert "Square: most stressed, might yield." in both
