"""Joining of loose chains end to end into closed loops.

Ends that agree to 1e-9 mm are joined first, so that a generous tolerance cannot swallow small features. Only
the ends left over are joined across gaps, nearest first. Ends that lie close together are found in about
linear time.

Glossary
--------
end : ends are numbered; end 2 i of a set of chains is the first point of chain i, end 2 i + 1 its last.
node : a point at which ends lie, numbered.
partner : partner[end] is the end joined to an end, or -1.
gap : the distance, at most the join tolerance, between two ends that are joined.
junction : a point where three or more ends meet, so that the outline could continue in several ways.
stray : a run of chains that does not close.
loop : a closed run of segments, run in either direction.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from math import dist, hypot

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.conventions import SAME_POINT, SHORTEST
from workhold.errors import InputError
from workhold.files.budget import UNLIMITED, Budget
from workhold.files.outline.chain import (
    Chain,
    compute_moved_bulge,
    format_count,
    format_point,
    list_first_items,
    strip_segment_number,
)
from workhold.files.questions import JOIN_TOLERANCE
from workhold.geometry.segment import Point

__all__ = ["JoinedChains", "Junction", "JoinedLoop", "OpenChain", "close_pairs", "group_by_pairs", "join"]

# More distinct points than this within one tolerance: the tolerance is larger than the drawing's details.
CROWD = 64


def close_pairs(points: NDArray[np.float64], tolerance: float) -> NDArray[np.int64]:
    """Return the pairs (P, 2) of indices of points (N, 2) at most a tolerance apart, in mm, each pair sorted.

    All pairs of distinct points at that distance are returned. Among exactly equal points each is paired with
    the next only, and only the first of them is paired with other points. Raises InputError for too many
    points within the tolerance of each other.
    """
    if len(points) < 2:
        return np.empty((0, 2), dtype=np.int64)
    order = np.lexsort((points[:, 1], points[:, 0]))
    equal = np.all(points[order[1:]] == points[order[:-1]], axis=1)
    pairs = [np.column_stack((order[:-1][equal], order[1:][equal]))]
    distinct = order[np.concatenate(([True], ~equal))]
    pairs += [distinct[p] for p in find_near_pairs(points[distinct], tolerance)]
    found = np.concatenate(pairs).astype(np.int64)
    found.sort(axis=1)
    return np.unique(found, axis=0)


def find_near_pairs(points: NDArray[np.float64], tolerance: float) -> list[NDArray[np.int64]]:
    """Return arrays (P, 2) of index pairs of distinct points
    (N, 2) at most a tolerance apart; a pair may come twice.

    Vertical strips two tolerances wide, laid twice with an offset of one tolerance, put every close pair in a
    common strip.
    """
    pairs = []
    for offset in (0.0, 0.5):
        strip = np.floor(points[:, 0] / (2 * tolerance) + offset)
        order = np.lexsort((points[:, 1], strip))
        strip, x, y = strip[order], points[order, 0], points[order, 1]
        for step in range(1, len(points)):
            near = (strip[step:] == strip[:-step]) & (y[step:] - y[:-step] <= tolerance)
            if not near.any():
                break
            if step > CROWD:
                k = int(np.flatnonzero(near)[0])
                raise InputError(
                    f"More than {CROWD} ends lie within {tolerance:g} mm of each other near ({x[k]:.6g}, "
                    f"{y[k]:.6g}): give a smaller {JOIN_TOLERANCE}."
                )
            near &= np.hypot(x[step:] - x[:-step], y[step:] - y[:-step]) <= tolerance
            first = np.flatnonzero(near)
            pairs.append(np.column_stack((order[first], order[first + step])))
    return pairs


def group_by_pairs(count: int, pairs: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return (count,), for each of ``count`` items the smallest number of an item in its group.

    Two items belong to one group if a chain of the pairs (P, 2) connects them.
    """
    parent = list(range(count))

    def find_root(item: int) -> int:
        """Return the smallest item in the group of an item, as far as groups are merged yet."""
        while parent[item] != item:
            parent[item] = parent[parent[item]]
            item = parent[item]
        return item

    for i, j in pairs.tolist():
        a, b = find_root(i), find_root(j)
        if a != b:
            parent[max(a, b)] = min(a, b)
    return np.array([find_root(k) for k in range(count)], dtype=np.int64)


# A chain may close on itself only over a gap this much shorter than the chain, or every short line would.
LOOP_OVER_GAP = 3.0


@frozen
class JoinedLoop:
    """A closed run of segments.

    Parameters
    ----------
    vertices : (N, 3) array of x, y in mm and bulge.
    labels : N names of the segments for messages.
    nest : number, from 1, of the nest (see ``outline.shared_lines``) that the loop belongs to; 0 if to none.
    """

    vertices: NDArray[np.float64]
    labels: tuple[str, ...]
    nest: int = 0


@frozen
class OpenChain:
    """A run of chains that does not close.

    Parameters
    ----------
    chain : the whole run as one chain.
    first, last : names of its first and last entity.
    """

    chain: Chain
    first: str
    last: str


@frozen
class Junction:
    """A point where three or more ends meet.

    Parameters
    ----------
    point : place of the junction, (x, y) in mm.
    labels : labels of the segments that end there.
    within : how far apart the ends are, in words; empty where they are one point.
    """

    point: Point
    labels: tuple[str, ...]
    within: str = ""

    def __str__(self) -> str:
        """Return the number of ends that meet, the point and the segments in words."""
        names = list_first_items(self.labels)
        return f"{len(self.labels)} ends meet{self.within} at {format_point(self.point)} ({names})"

    @property
    def refusal(self) -> InputError:
        """The error for a drawing whose outline goes through it."""
        return InputError(
            f"{self}, so the outline could go on in more than one way: remove the extra entity, or put it on "
            "a layer that is not chosen."
        )


@frozen
class JoinedChains:
    """Loops, what stayed open, and remarks on gaps closed and entities dropped.

    Parameters
    ----------
    junctions : points where an outline could go on in more than one way.
    tangled : the chains connected to a junction, which are in no loop and no stray.
    """

    loops: tuple[JoinedLoop, ...]
    strays: tuple[OpenChain, ...]
    remarks: tuple[str, ...]
    junctions: tuple[Junction, ...] = ()
    tangled: tuple[Chain, ...] = ()


def join(chains: Sequence[Chain], tolerance: float, budget: Budget | None = None) -> JoinedChains:
    """Join chains in mm, without segments of zero length, end to end across gaps up to a tolerance in mm.

    ``budget`` is spent; None means no limit. Raises InputError for too many ends within the tolerance of each
    other.
    """
    budget = budget or Budget(UNLIMITED)
    open_chains = [c for c in chains if not c.closed]
    loops = [make_closed_loop(c) for c in chains if c.closed]
    node = number_end_points(open_chains)
    open_chains, node, repeated = drop_repeated_chains(open_chains, node, budget)
    partner, junctions = join_ends(open_chains, node, tolerance)
    is_tangled = find_chains_connected_to(node, partner, [end for _, ends in junctions for end in ends])
    gaps: list[tuple[Point, float]] = []
    strays = []
    for run, is_closed in list_joined_runs(partner):
        budget.count_steps(len(run))
        if is_tangled[run[0][0]]:
            continue
        members = [open_chains[k].reverse() if turned else open_chains[k] for k, turned in run]
        whole = connect_chains(members, is_closed, gaps)
        if is_closed:
            if len(whole.bulges) > 2 or any(whole.bulges):
                loops.append(make_closed_loop(whole))
        else:
            strays.append(OpenChain(whole, members[0].entity, members[-1].entity))
    loops, repeated_loops = drop_repeated_loops(loops)
    repeated += repeated_loops
    remarks = []
    if repeated:
        remarks.append(
            f"Left out {format_count(len(repeated), 'entity', 'entities')} drawn twice: {list_first_items(repeated)}."
        )
    if gaps:
        gaps.sort(key=lambda gap: -gap[1])
        places = list_first_items([f"{size:.3g} mm at {format_point(point)}" for point, size in gaps])
        remarks.append(f"Closed {format_count(len(gaps), 'gap', 'gaps')} between ends: {places}.")
    tangled = tuple(chain for chain, tangles in zip(open_chains, is_tangled, strict=True) if tangles)
    met = tuple(junction for junction, _ in junctions)
    return JoinedChains(tuple(loops), tuple(strays), tuple(remarks), met, tangled)


def find_chains_connected_to(
    node: NDArray[np.int64], partner: Sequence[int], ends: Sequence[int]
) -> list[bool]:
    """Return for each chain whether it is connected to one of ``ends`` through common points and joined ends,
    directly or through other chains.

    Parameters
    ----------
    node : (2 N,) the point at which each end lies; end 2 i is the first point of chain i, 2 i + 1 its last.
    partner : the end joined to each end, or -1.
    ends : indices of ends.
    """
    count = len(node) // 2
    if not ends:
        return [False] * count
    pairs = [(end // 2, other // 2) for end, other in enumerate(partner) if other >= 0]
    first: dict[int, int] = {}
    pairs += [(first.setdefault(number, end // 2), end // 2) for end, number in enumerate(node.tolist())]
    name = group_by_pairs(count, np.array(pairs, dtype=np.int64).reshape(-1, 2))
    tangled = {int(name[end // 2]) for end in ends}
    return [int(one) in tangled for one in name]


def make_closed_loop(chain: Chain) -> JoinedLoop:
    """Return a closed chain as a loop."""
    rows = [(x, y, bulge) for (x, y), bulge in zip(chain.points[:-1], chain.bulges, strict=True)]
    return JoinedLoop(np.array(rows, dtype=np.float64), chain.labels)


def number_end_points(chains: Sequence[Chain]) -> NDArray[np.int64]:
    """Return (2 N,) the node (numbered point) of each end of N chains; ends within 1e-9 mm share one.

    Ends are numbered 2 i and 2 i + 1 for the first and last point of chain i; a node's number is its smallest
    end.
    """
    ends = np.array([p for c in chains for p in (c.points[0], c.points[-1])], dtype=np.float64).reshape(-1, 2)
    return group_by_pairs(len(ends), close_pairs(ends, SAME_POINT))


def drop_repeated_chains(
    chains: Sequence[Chain], node: NDArray[np.int64], budget: Budget
) -> tuple[list[Chain], NDArray[np.int64], list[str]]:
    """Return (1) the chains, each once if drawn several times, (2) the nodes (2 N,) of the ends of these N
    chains, and (3) phrases on the chains dropped.

    ``node`` is from :func:`number_end_points`; ``budget`` is spent.
    """
    between: defaultdict[tuple[int, int, int], list[int]] = defaultdict(list)
    kept: list[int] = []
    repeated: list[str] = []
    for k, chain in enumerate(chains):
        first, last = sorted((int(node[2 * k]), int(node[2 * k + 1])))
        rivals = between[first, last, len(chain.bulges)]
        budget.count_steps(1 + len(rivals))
        twin = next((j for j in rivals if run_alike(chains[j], chain)), None)
        if twin is None:
            rivals.append(k)
            kept.append(k)
        else:
            repeated.append(f"{chain.entity} repeats {chains[twin].entity}")
    index = np.array(kept, dtype=np.int64)
    return (
        [chains[k] for k in kept],
        np.column_stack((node[2 * index], node[2 * index + 1])).ravel(),
        repeated,
    )


def run_alike(a: Chain, b: Chain) -> bool:
    """Return whether two chains with equally many segments run through the same
    points and arcs, in the same or opposite direction.
    """
    return any(
        all(dist(p, q) <= SAME_POINT for p, q in zip(a.points, c.points, strict=True))
        and all(abs(p - q) <= SAME_POINT for p, q in zip(a.bulges, c.bulges, strict=True))
        for c in (b, b.reverse())
    )


def drop_repeated_loops(loops: Iterable[JoinedLoop]) -> tuple[list[JoinedLoop], list[str]]:
    """Return (1) the loops, each once if several have the same vertices and
    arcs, and (2) phrases on the loops dropped.
    """
    kept: dict[object, JoinedLoop] = {}
    repeated = []
    for loop in loops:
        xy, bulges = np.round(loop.vertices[:, :2], 6) + 0.0, np.round(np.abs(loop.vertices[:, 2]), 6)
        middles = np.round(compute_arc_middles(loop.vertices), 6) + 0.0
        key = (
            tuple(sorted(map(tuple, xy.tolist()))),
            tuple(sorted(map(tuple, middles.tolist()))),
            len(bulges),
        )
        if key in kept:
            names = (strip_segment_number(loop.labels[0]), strip_segment_number(kept[key].labels[0]))
            repeated.append(f"{names[0]} repeats {names[1]}")
        else:
            kept[key] = loop
    return list(kept.values()), repeated


def compute_arc_middles(vertices: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the middle points (N, 2) of the segments of a loop (N, 3).

    An arc's middle is half a chord times the bulge to the right of the chord's middle.
    """
    start, end = vertices[:, :2], np.roll(vertices[:, :2], -1, axis=0)
    chord = end - start
    right = np.column_stack((chord[:, 1], -chord[:, 0]))
    middles: NDArray[np.float64] = (start + end) / 2 + right * vertices[:, 2:] / 2
    return middles


def join_ends(
    chains: Sequence[Chain], node: NDArray[np.int64], tolerance: float
) -> tuple[list[int], list[tuple[Junction, Sequence[int]]]]:
    """Return (1) for each end the end joined to it, or -1, and (2) the
    junctions, each with the ends that meet there.

    A junction is a point at which three ends or more meet. Ends are numbered 2 i and 2 i + 1 for the first
    and last point of chain i.

    Parameters
    ----------
    node : point of each end, see :func:`number_end_points`.
    tolerance : largest gap to close, in mm.
    """
    partner = [-1] * len(node)
    junctions = list[tuple[Junction, Sequence[int]]]()
    at_node: defaultdict[int, list[int]] = defaultdict(list)
    for end, number in enumerate(node.tolist()):
        at_node[number].append(end)
    for ends in at_node.values():
        if len(ends) > 2:
            junctions.append((make_junction(chains, ends), ends))
        if len(ends) == 2:
            partner[ends[0]], partner[ends[1]] = ends[1], ends[0]
    meeting = {end for _, ends in junctions for end in ends}
    loose = [end for end, other in enumerate(partner) if other < 0 and end not in meeting]
    return partner, junctions + close_gaps(chains, partner, loose, tolerance)


def close_gaps(
    chains: Sequence[Chain], partner: list[int], loose: Sequence[int], tolerance: float
) -> list[tuple[Junction, Sequence[int]]]:
    """Join open ends across gaps, nearest first: ``partner[i]`` becomes the end joined to end i.

    Return the junctions, each with its ends, where a third end lies within the tolerance of a joined one.
    Raises InputError for too many ends within the tolerance.

    Parameters
    ----------
    partner : the end joined to each end, or -1; changed in place.
    loose : the ends to join. Ends are numbered 2 i and 2 i + 1 for the first and last point of chain i.
    tolerance : largest gap in mm.
    """
    if not loose or tolerance <= 0:
        return []
    points = np.array([get_end_point(chains, end) for end in loose])
    pairs = close_pairs(points, tolerance)
    if not len(pairs):
        return []
    apart = np.hypot(*(points[pairs[:, 0]] - points[pairs[:, 1]]).T)
    candidates = []
    for position in np.argsort(apart, kind="stable").tolist():
        i, j = (loose[k] for k in pairs[position].tolist())
        if i // 2 != j // 2 or measure_chain_length(chains[i // 2]) > LOOP_OVER_GAP * apart[position]:
            candidates.append((i, j))
    for i, j in candidates:
        if partner[i] < 0 and partner[j] < 0:
            partner[i], partner[j] = j, i
    found = list[tuple[Junction, Sequence[int]]]()
    for i, j in candidates:
        if (partner[i] < 0) != (partner[j] < 0):
            joined = i if partner[j] < 0 else j
            ends = sorted({i, j, partner[joined]})
            found.append((make_junction(chains, ends, f" within {tolerance:g} mm"), ends))
    return found


def measure_chain_length(chain: Chain) -> float:
    """Return a chain's length in mm, with two chords in place of each arc, so a little short."""
    return sum(
        hypot(q[0] - p[0], q[1] - p[1]) * hypot(1.0, bulge)
        for p, q, bulge in zip(chain.points, chain.points[1:], chain.bulges, strict=False)
    )


def get_end_point(chains: Sequence[Chain], end: int) -> Point:
    """Return the point of an end; ends 2 i and 2 i + 1 are the first and last point of chain i."""
    return chains[end // 2].points[-(end % 2)]


def make_junction(chains: Sequence[Chain], ends: Sequence[int], within: str = "") -> Junction:
    """Return the junction of some ends, at the point of the first end.

    ``within`` says in words how far apart the ends are. Ends 2 i and 2 i + 1 are the first and last point of
    chain i.
    """
    names = tuple(chains[end // 2].labels[-(end % 2)] for end in ends)
    return Junction(get_end_point(chains, ends[0]), names, within)


def list_joined_runs(partner: Sequence[int]) -> Iterable[tuple[list[tuple[int, bool]], bool]]:
    """Yield (run, is closed) for each run of joined chains;
    the run is a list of (chain index, is backwards) in order.

    ``partner[e]`` is the end joined to end e, or -1; ends 2 i and 2 i + 1 are the first and last point of
    chain i.
    """
    done = [False] * (len(partner) // 2)
    starts = [end for end, other in enumerate(partner) if other < 0]
    for start in [*starts, *range(0, len(partner), 2)]:
        if done[start // 2]:
            continue
        run = []
        entry = start
        while entry >= 0 and not done[entry // 2]:
            done[entry // 2] = True
            run.append((entry // 2, entry % 2 == 1))
            entry = partner[entry ^ 1]
        yield run, entry >= 0


def connect_chains(members: Sequence[Chain], is_closed: bool, gaps: list[tuple[Point, float]]) -> Chain:
    """Return one chain from chains in running order.

    Ends that differ are moved to their mean, and (point, size in mm) of each such gap is appended to
    ``gaps``.
    """
    firsts = [c.points[0] for c in members]
    lasts = [c.points[-1] for c in members]
    for k in range(0 if is_closed else 1, len(members)):
        before, after = lasts[k - 1], firsts[k]
        gap = dist(before, after)
        if gap > SAME_POINT:
            mean = ((before[0] + after[0]) / 2, (before[1] + after[1]) / 2)
            gaps.append((mean, gap))
            lasts[k - 1] = firsts[k] = mean
        else:
            firsts[k] = before
    points: list[Point] = [firsts[0]]
    bulges: list[float] = []
    labels: list[str] = []
    for chain, first, last in zip(members, firsts, lasts, strict=True):
        moved = move_chain_ends(chain, first, last)
        for point, bulge, label in zip(moved.points[1:], moved.bulges, moved.labels, strict=True):
            if dist(points[-1], point) >= SHORTEST:
                points.append(point)
                bulges.append(bulge)
                labels.append(label)
    if is_closed and bulges:
        points[-1] = points[0]
    return Chain(tuple(points), tuple(bulges), tuple(labels))


def move_chain_ends(chain: Chain, first: Point, last: Point) -> Chain:
    """Return a chain with its ends moved a little; arcs there keep their centres as well as they can."""
    points, bulges = list(chain.points), list(chain.bulges)
    points[0], points[-1] = first, last
    for k in {0, len(bulges) - 1}:
        start, end = chain.points[k], chain.points[k + 1]
        if max(dist(start, points[k]), dist(end, points[k + 1])) > SAME_POINT:
            bulges[k] = compute_moved_bulge(start, end, bulges[k], points[k], points[k + 1])
    return evolve(chain, points=tuple(points), bulges=tuple(bulges))
