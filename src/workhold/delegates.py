"""Functions of higher layers that the model's methods end in: pictures, papers, tables and presets.

The model imports none of those layers. The package hands their functions over when it is imported, before any
module of it, so that a method works whatever was imported first. Each is handed over as what imports it, so
that it costs nothing unused.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

__all__ = ["delegate", "hand_over"]

IMPORTERS: dict[str, Callable[[], Callable[..., Any]]] = {}


def hand_over(importers: Mapping[str, Callable[[], Callable[..., Any]]]) -> None:
    """Takes what imports functions, by the names that methods ask for."""
    IMPORTERS.update(importers)


def delegate(name: str) -> Callable[..., Any]:
    """The function that was handed over under a name."""
    return IMPORTERS[name]()
