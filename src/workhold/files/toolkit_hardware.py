"""Supports and the clamp on top in a toolkit's file: its tables ``[supports]`` and ``[top-clamp]``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from workhold.errors import InputError
from workhold.fixels.support_hardware import HARDWARE, SupportPads, TopClamp, hardware_of
from workhold.fixels.toolkit import Toolkit
from workhold.units import Unit

__all__ = ["hardware_entries", "refuse_wide_pads"]


def hardware_entries(entries: Mapping[str, Any], unit: Unit) -> dict[str, SupportPads | TopClamp]:
    """Supports and the clamp on top that a file's entries give, by the names of the toolkit's fields.

    Raises
    ------
    InputError
        For a figure that there is none of, and values that cannot be.
    """
    return {name: hardware_in_mm(name, entries[name], unit) for name in HARDWARE if name in entries}


def hardware_in_mm(name: str, figures: Mapping[str, Any], unit: Unit) -> SupportPads | TopClamp:
    """Convert the figures of supports, or of a clamp on top, to what the toolkit has of them.

    Raises
    ------
    InputError
        For a figure that there is none of, and values that cannot be.
    """
    lengths = {
        key: [[unit.length(one) for one in ring] for ring in value]
        if isinstance(value, list)
        else unit.length(value)
        for key, value in figures.items()
    }
    made = hardware_of(name, lengths)
    assert made is not None
    return made


def refuse_wide_pads(toolkit: Toolkit) -> None:
    """Refuses pads of supports that would overlap in neighbouring holes.

    Raises
    ------
    InputError
        With the distance between the holes.
    """
    apart = min(pitch for plate in toolkit.plates for pitch in plate.pitch)
    radius = None if toolkit.supports is None else toolkit.supports.pad_radius
    if radius is not None and 2 * radius > apart:
        raise InputError(
            f"supports: pads of radius {radius:g} mm would overlap in neighbouring holes {apart:g} mm apart: "
            "give a smaller pad_radius."
        )
