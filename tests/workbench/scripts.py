"""What the scripts share that tests run in FreeCAD."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

__all__ = ["HELD", "Scripted"]

# Runs a script, and returns what it answers.
Scripted = Callable[..., dict[str, Any]]
# A fixture of the block that every script has, before it is searched.
HELD = """
held = fixture.make(document, block, "z", "two-clamp-plate-20mm")
held.PegHeight = 8
"""
