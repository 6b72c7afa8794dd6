"""The paper's polynomials: a second engine, independent of the chord-curve search."""

from __future__ import annotations

from workhold.algebra.engine import find_fixtures_by_algebra

__all__ = ["find_fixtures_by_algebra"]
