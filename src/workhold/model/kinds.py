"""The kinds of toolkits there are, by the names that files and users give them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from workhold.errors import InputError
from workhold.model.vise import OpeningVise, Vise

__all__ = ["KINDS", "USUAL", "toolkit_of"]

KINDS: Mapping[str, type[Vise]] = {one.kind: one for one in (Vise, OpeningVise)}
# What is meant where nobody says.
USUAL = Vise.kind


def toolkit_of(kind: str, fields: Mapping[str, Any]) -> Vise:
    """A toolkit of a kind.

    Parameters
    ----------
    kind : its name.
    fields : keyword arguments of its class.

    Raises
    ------
    InputError
        For a kind that is not known, and fields of which there is no such toolkit.

    Examples
    --------
    >>> toolkit_of("opening-vise", {"pitch": 10, "columns": 2, "peg_radius": 3}).clamping
    -1
    """
    if kind not in KINDS:
        raise InputError(f"toolkit {kind[:40]!r} is not known: choose {' or '.join(KINDS)}.")
    return KINDS[kind](**fields)
