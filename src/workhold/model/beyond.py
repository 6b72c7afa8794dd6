"""What workpieces, fixtures and results do by means of layers above the model: draw themselves, become papers and tables.

The model imports none of those layers. It knows who does what by name, and imports it when a user asks for it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any

__all__ = ["HOMES", "beyond"]

HOMES: Mapping[str, str] = {
    "fixture_picture": "workhold.presenting.pictures",
    "preset_fields": "workhold.presenting.presets",
    "preset_names_of": "workhold.presenting.presets",
    "preset_tolerance": "workhold.presenting.presets",
    "result_picture": "workhold.presenting.pictures",
    "save_sheet": "workhold.presenting.papers",
    "to_arrow": "workhold.presenting.frames",
    "to_pandas": "workhold.presenting.frames",
    "workpiece_picture": "workhold.presenting.pictures",
}


def beyond(name: str) -> Callable[..., Any]:
    """The function of a name in a layer above."""
    function: Callable[..., Any] = getattr(import_module(HOMES[name]), name)
    return function
