"""Functions of higher layers that methods of the model call: pictures, papers, tables and presets.

The model imports none of those layers. The package registers their functions when it is imported, before any
of its modules, so a method works whatever was imported first. Each is registered as a function that imports
it, so it costs nothing unused.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

__all__ = ["delegate", "hand_over"]

IMPORTERS: dict[str, Callable[[], Callable[..., Any]]] = {}


def hand_over(importers: Mapping[str, Callable[[], Callable[..., Any]]]) -> None:
    """Registers functions that import the delegates, by the names that methods ask for."""
    IMPORTERS.update(importers)


def delegate(name: str) -> Callable[..., Any]:
    return IMPORTERS[name]()
