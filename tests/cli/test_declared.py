"""Words that are typed for declared fields are read by their forms."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from workhold.asking.declaring import Declaration
from workhold.cli.declared import read_words
from workhold.errors import InputError
from workhold.units import MILLIMETRE

FORCE = Declaration("cutting_force", "force", "A force.", least="0")
LENGTH = Declaration("margin", "length", "A length.", least="0")


@pytest.mark.parametrize(("typed", "force"), [("0", 0.0), (" 0 ", 0.0), ("1.5kN", 1500.0), (None, None)])
def test_a_force_may_be_none_at_all_where_that_means_something(
    typed: str | None, force: float | None
) -> None:
    assert read_words([FORCE], SimpleNamespace(cutting_force=typed), MILLIMETRE) == {"cutting_force": force}


def test_an_empty_word_is_no_option_left_out() -> None:
    with pytest.raises(InputError, match="--margin '' is not a length"):
        read_words([LENGTH], SimpleNamespace(margin=""), MILLIMETRE)
    assert read_words([LENGTH], SimpleNamespace(margin=None), MILLIMETRE) == {"margin": None}
