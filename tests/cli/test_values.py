"""Values of options, as text."""

from __future__ import annotations

from math import inf

import pytest

from workhold.cli.values import number, positive_number
from workhold.errors import InputError


def test_a_positive_number_is_above_zero_and_finite() -> None:
    assert positive_number("--jaw-force", None) is None
    assert positive_number("--jaw-force", " 1e-3 ") == 0.001
    for text in ("0", "-5", "inf", "nan", "much", ""):
        with pytest.raises(InputError, match="is not a positive number"):
            positive_number("--jaw-force", text)


def test_fractions_have_signs() -> None:
    """Of the whole of them."""
    assert [number(text) for text in ("-1/2", "-1-1/2", "+1 1/4", "1/0")] == [-0.5, -1.5, 1.25, inf]
