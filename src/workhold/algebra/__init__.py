"""The paper's polynomials: a second engine, independent of the chord-curve search."""

from __future__ import annotations

from workhold.algebra.engine import answer_by_algebra

__all__ = ["answer_by_algebra"]
