"""Parts for families: rectangles, L's and brackets of 20 to 80 mm, the same for the same seed."""

from __future__ import annotations

from random import Random

from workhold.model.workpiece import Workpiece

__all__ = ["shop_parts"]


def shop_parts(count: int, seed: int = 1) -> list[Workpiece]:
    """So many parts, named by their kind and number."""
    random = Random(seed)
    parts = []
    for number in range(1, count + 1):
        w, h = (round(random.uniform(20.0, 80.0), 1) for _ in range(2))
        low, thin = round(0.5 * h, 1), round(0.4 * w, 1)
        kind, loop = [
            ("rectangle", [[0, 0, 0], [w, 0, 0], [w, h, 0], [0, h, 0]]),
            ("ell", [[0, 0, 0], [w, 0, 0], [w, low, 0], [thin, low, 0], [thin, h, 0], [0, h, 0]]),
            (
                "bracket",
                [[0, 0, 0], [w, 0, 0], [w, round(0.6 * h, 1), 0], [round(0.7 * w, 1), h, 0], [0, h, 0]],
            ),
        ][number % 3]
        parts.append(Workpiece.from_loops(f"{kind}-{number}", [loop]))
    return parts
