"""Presets of toolkits, by name, for the classes of toolkits (``files.toolkit_file`` has them)."""

from __future__ import annotations

from typing import Any

from workhold.errors import InputError
from workhold.files.toolkit_file import load_toolkit, preset, preset_names
from workhold.fixels.kinds import KINDS
from workhold.fixels.toolkit import Toolkit
from workhold.model.requirements import Tolerance

__all__ = ["preset_fields", "preset_names_of", "preset_tolerance"]


def preset_names_of(kind: type[Toolkit]) -> tuple[str, ...]:
    """Lists the presets that are toolkits of a class."""
    return tuple(name for name in preset_names() if KINDS[preset(name).kind] is kind)


def preset_fields(kind: type[Toolkit], name: str) -> dict[str, Any]:
    """The fields of a preset or of a user's file, for a class of toolkits or one that has all fields of it.

    Raises
    ------
    InputError
        As :func:`workhold.files.toolkit_file.load_toolkit`, and for a toolkit of another class.
    """
    loaded = load_toolkit(name)
    is_of = KINDS[loaded.kind]
    if not issubclass(kind, is_of):
        raise InputError(f"{loaded.name} is a {is_of.noun}: ask {is_of.__name__}.preset for it.")
    return loaded.fields


def preset_tolerance(name: str) -> Tolerance:
    """How far pegs and faces of a preset or of a user's file may be off.

    Raises
    ------
    InputError
        As :func:`workhold.files.toolkit_file.load_toolkit`.
    """
    return load_toolkit(name).tolerance
