"""Kinds of toolkits by name: aliases, and one sentence for what a kind does not have."""

from __future__ import annotations

import pytest

from workhold import InputError, Plate, Vise
from workhold.fixels.kinds import toolkit_of


def test_aliases_are_kinds_with_fields_of_their_own() -> None:
    """A gripper is a vise of one column, and a plate needs no columns."""
    assert toolkit_of("gripper", {"pitch": 10, "peg_radius": 3}) == Vise(pitch=10, columns=1, peg_radius=3)
    assert toolkit_of("plate", {"pitch": 10, "peg_radius": 3}) == Plate(pitch=10, peg_radius=3)


@pytest.mark.parametrize(
    ("kind", "fields", "words"),
    [
        ("plate", {"pitch": 10, "peg_radius": 3, "min_gap": 6}, "has no min gap"),
        ("vise", {"pitch": 10, "peg_radius": 3, "columns": 1, "travel": (1, 2)}, "has no travel"),
        ("vise", {"pitch": 10, "peg_radius": 3}, "the vise's columns is not given"),
        (
            "edge of nowhere",
            {},
            "is not known: choose among vise, opening-vise, translating-clamp, edge, flat-jaw, gripper, plate",
        ),
    ],
)
def test_what_a_kind_does_not_have_is_refused_in_one_sentence(
    kind: str, fields: dict[str, object], words: str
) -> None:
    with pytest.raises(InputError, match=words):
        toolkit_of(kind, fields)
