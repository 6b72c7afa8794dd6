"""Questions that do not apply to a file, refused by name."""

from __future__ import annotations

from collections.abc import Sequence

from workhold.errors import InputError
from workhold.files.questions import AXIS, FIT, LAYERS, SECTION

__all__ = ["refuse_axis", "refuse_fit", "refuse_layers"]


def refuse_layers(layers: Sequence[str] | None) -> None:
    """Refuse a choice of layers for a file that has none.

    Raises
    ------
    InputError
        When layers were chosen.
    """
    if layers is not None:
        raise InputError(f"layers can be chosen in DXF files only: leave {LAYERS} out.")


def refuse_fit(fit: float | None) -> None:
    """Refuse a fit for a file that holds lines and arcs only.

    Raises
    ------
    InputError
        When a fit was given.
    """
    if fit is not None:
        raise InputError(f"a JSON file holds lines and arcs only: leave {FIT} out.")


def refuse_axis(axis: str | None, section: float | None) -> None:
    """Refuse a view of a solid for a file that holds a flat drawing.

    Raises
    ------
    InputError
        When an axis or a section was chosen.
    """
    if axis is not None or section is not None:
        question = AXIS if axis is not None else SECTION
        raise InputError(f"only a STEP file can be looked at along an axis: leave {question} out.")
