"""What sampling misses: Type I fixtures that show as a sign change between neighbouring orientations, of all there are.

Every chord's height is computed at N orientations over half a turn, NaN where the chord does not exist. Two chords touch
together where their heights differ by a whole number of row pitches. Sampling looks for such a difference passed between
two neighbouring orientations at which both chords exist, and bisects. It is blind to a pair of roots between two samples,
and to roots between the last sample and the end of a curve. Fixtures that rest on a sliding pair (two pegs of one jaw on
parallel lines) have no curve and are left out on both sides.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from math import atan2, hypot, pi, tau
from time import perf_counter

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

import workhold
from workhold import Result, Vise
from workhold.contact.problem import Problem

Array = NDArray[np.float64]
Key = tuple[tuple[int, int, int, int], ...]

CASES = (("widget", 8, 1), ("oblongPart", 8, 2), ("small4Handle", 10, 2))
SAMPLES = (256, 1024, 4096)
# Half a turn begins where no aligned part has anything special.
FIRST_ORIENTATION = -0.7320508075688772


@frozen(eq=False)
class Chords:
    """M chords: rows (M, 8) of the tails' and heads' features, their faces, step (columns, rows) and branch of each."""

    tail: Array
    head: Array
    faces: NDArray[np.int64]
    step: NDArray[np.int64]
    shift: Array
    length: Array
    branch: Array

    @classmethod
    def of(cls, problem: Problem) -> Chords:
        """All chords of two pegs of one jaw; the two branches of a chord with an arc count as two."""
        (pitch_x, pitch_y), most = problem.toolkit.pitch, problem.toolkit.columns - 1
        longest = int(problem.diameter / problem.toolkit.pitch[1])
        steps = [(k, m) for k in range(most + 1) for m in range(-longest, longest + 1) if k > 0 or m > 0]
        arc = problem.rows[:, 0] != 0.0
        pairs = [
            (a, b) for a in range(len(arc)) for b in range(len(arc)) if not same_lines(problem.rows, a, b)
        ]
        chosen = [
            (a, b, k, m, s)
            for a, b in pairs
            for k, m in steps
            for s in ((1, -1) if arc[a] or arc[b] else (1,))
        ]
        a, b, k, m, branch = np.array(chosen).T
        shift = np.array([atan2(row * pitch_y, column * pitch_x) for column, row in zip(k, m, strict=True)])
        length = np.array([hypot(column * pitch_x, row * pitch_y) for column, row in zip(k, m, strict=True)])
        faces = np.stack([problem.faces[a], problem.faces[b]], axis=1)
        rows, step = problem.rows[:, :8], np.stack([k, m], axis=1)
        return cls(rows[a], rows[b], faces, step, shift, length, branch.astype(float))

    def name(self, chord: int) -> tuple[int, int, int, int]:
        """Faces of tail and head, and the step, of one chord."""
        (a, b), (k, m) = self.faces[chord].tolist(), self.step[chord].tolist()
        return a, b, k, m

    def heights(self, index: NDArray[np.int64], psi: Array) -> Array:
        """Heights of some chords at some orientations (arrays of one shape), NaN where a chord does not exist."""
        a, b, d, alpha = self.tail[index], self.head[index], self.length[index], psi + self.shift[index]
        w = np.stack([d * np.cos(alpha), d * np.sin(alpha)], axis=-1)
        tail = tail_places(a, b, w, self.branch[index])
        tail[~(within(a, tail) & within(b, tail + w))] = np.nan
        return np.asarray(np.cos(psi) * tail[..., 1] - np.sin(psi) * tail[..., 0])


def same_lines(rows: Array, a: int, b: int) -> bool:
    """Whether two features are parallel lines, whose chords are sliding pairs and no curves."""
    both = rows[a, 0] == rows[b, 0] == 0.0
    return bool(both and abs(rows[a, 3] * rows[b, 4] - rows[a, 4] * rows[b, 3]) <= 1e-9)


def on_line(line: Array, centre: Array, radius: Array, branch: Array) -> Array:
    """The point of a line at a radius from a centre, one of two."""
    along = ((centre - line[..., 1:3]) * line[..., 3:5]).sum(axis=-1)
    foot = line[..., 1:3] + along[..., None] * line[..., 3:5]
    half = np.sqrt(radius**2 - ((centre - foot) ** 2).sum(axis=-1))
    return np.asarray(foot + (branch * half)[..., None] * line[..., 3:5])


def tail_places(a: Array, b: Array, w: Array, branch: Array) -> Array:
    """Tails on a whose heads, by w farther, lie on b: where the carrier of a meets that of b moved by -w."""
    moved = b[..., 1:3] - w
    gap = moved - a[..., 1:3]
    normal = np.stack([b[..., 4], -b[..., 3]], axis=-1)
    along = (normal * gap).sum(axis=-1) / (normal * a[..., 3:5]).sum(axis=-1)
    lines = a[..., 1:3] + along[..., None] * a[..., 3:5]
    apart = np.sqrt((gap**2).sum(axis=-1))
    along = (apart + (a[..., 6] ** 2 - b[..., 6] ** 2) / apart) / 2
    half = branch * np.sqrt(a[..., 6] ** 2 - along**2)
    unit = gap / apart[..., None]
    across = np.stack([-unit[..., 1], unit[..., 0]], axis=-1)
    arcs = a[..., 1:3] + along[..., None] * unit + half[..., None] * across
    moved_line = np.concatenate([b[..., :1], moved, b[..., 3:]], axis=-1)
    line_arc, arc_line = (
        on_line(a, moved, b[..., 6], branch),
        on_line(moved_line, a[..., 1:3], a[..., 6], branch),
    )
    first, second = a[..., :1] != 0.0, b[..., :1] != 0.0
    return np.where(first, np.where(second, arcs, arc_line), np.where(second, line_arc, lines))


def within(row: Array, point: Array) -> NDArray[np.bool_]:
    """Whether points lie inside the ends of their features; False for NaN."""
    dx, dy = point[..., 0] - row[..., 1], point[..., 1] - row[..., 2]
    along, across = row[..., 3] * dx + row[..., 4] * dy, row[..., 3] * dy - row[..., 4] * dx
    return np.asarray(np.abs(np.where(row[..., 0] == 0.0, along, np.arctan2(across, along))) <= row[..., 5])


def key_of(jaws: list[tuple[int, int, int, int]], turned: bool) -> Key:
    """What names a fixture but its orientation: for each jaw the faces of two pegs and their step, in one order."""
    sign = -1 if turned else 1
    ways = [min((a, b, sign * k, sign * m), (b, a, -sign * k, -sign * m)) for a, b, k, m in jaws]
    return tuple(sorted(ways))


def brackets(
    heights: Array, pitch: float
) -> Iterator[tuple[int, NDArray[np.int64], NDArray[np.int64], Array]]:
    """For every chord: others whose height passes a whole number of pitches from it, the sample before, the target."""
    for one in range(len(heights)):
        (alive,) = np.nonzero(~np.isnan(heights[one]))
        if len(alive) < 2:
            continue
        span = slice(alive[0], alive[-1] + 1)
        whole = np.floor((heights[one + 1 :, span] - heights[one, span]) / pitch)
        other, place = np.nonzero(np.abs(np.diff(whole, axis=1)) >= 1.0)
        target = pitch * np.maximum(whole[other, place], whole[other, place + 1])
        yield one, other + one + 1, place + span.start, target


def sampled(problem: Problem, chords: Chords, count: int) -> dict[Key, list[float]]:
    """Orientations psi of the crossings found with a number of samples, by what names the fixture."""
    psi = FIRST_ORIENTATION + pi * np.arange(count + 1) / count
    everything = np.arange(len(chords.length))
    heights = np.stack([chords.heights(everything, np.full(len(everything), p)) for p in psi], axis=1)
    found: dict[Key, list[float]] = {}
    for one, others, place, target in brackets(heights, problem.toolkit.pitch[1]):
        first, low, high = np.full(len(others), one), psi[place], psi[place + 1]
        rising = (
            heights[others, place + 1] - heights[one, place + 1]
            > heights[others, place] - heights[one, place]
        )
        for _ in range(48):
            middle = (low + high) / 2
            above = chords.heights(others, middle) - chords.heights(first, middle) >= target
            low, high = np.where(above == rising, low, middle), np.where(above == rising, middle, high)
        for other, root in zip(others, low, strict=True):
            jaws = [chords.name(c) for c in (one, other)]
            found.setdefault(key_of(jaws, turned=False), []).append(float(root))
    return found


def expected(result: Result) -> list[tuple[Key, float]]:
    """Keys and orientations psi, in the half turn sampled, of the listed Type I fixtures that rest on no sliding pair."""
    lines = {face.number: face.segment for face in result.workpiece.faces}
    out = []
    for fixture in (f for f in result if f.type == "I"):
        jaws, sliding_pair = [], False
        for p, q in (fixture.pegs[:2], fixture.pegs[2:]):
            jaws.append((p.face, q.face, q.column - p.column, q.row - p.row))
            directions = [getattr(lines[peg.face], "tangent", None) for peg in (p, q)]
            one, two = directions
            sliding_pair |= bool(one and two and abs(one[0] * two[1] - one[1] * two[0]) <= 1e-9)
        behind = (-np.radians(fixture.pose.theta_deg) - FIRST_ORIENTATION) % tau
        if not sliding_pair:
            out.append((key_of(jaws, turned=behind >= pi), FIRST_ORIENTATION + behind % pi))
    return out


def main() -> None:
    """Print the table."""
    say = sys.stdout.write
    say(
        f"{'part':13} {'pitch':>5} {'c':>2} | {'type I':>6} {'on curves':>9} | found with a number of samples, lost\n"
    )
    for name, pitch, columns in CASES:
        start = perf_counter()
        vise = Vise(pitch=pitch, columns=columns, peg_radius=3)
        result = workhold.design(workhold.load(name), vise, types=["I"])
        problem, wanted = Problem.from_query(result.query), expected(result)
        chords = Chords.of(problem)
        say(f"{name:13} {pitch:5} {columns:2} | {len(result):6} {len(wanted):9} |")
        for count in SAMPLES:
            with np.errstate(invalid="ignore", divide="ignore"):
                found = sampled(problem, chords, count)
            hits = sum(any(abs(p - psi) < 1e-6 for p in found.get(k, ())) for k, psi in wanted)
            say(f" {count:5}: {hits:6} {100 * (1 - hits / len(wanted)):6.2f} %")
        say(f" | {perf_counter() - start:5.1f} s\n")


if __name__ == "__main__":
    main()
