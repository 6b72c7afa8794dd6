"""Drawn lines and arcs as a planar map, to find outlines of neighbours that share lines, and doubled lines.

Where three ends or more meet, an outline could go on in more than one way, but together the lines still bound
regions: the parts of a nest along their common cuts. Lines that lie partly on each other count once.

Glossary
--------
node : a point where edges end.
edge : a piece of a line or an arc from node to node, with no other node on it. A piece drawn twice is one
    edge.
half-edge : an edge run one way: number 2 e runs edge e forward, 2 e + 1 backward.
face : a region that half-edges bound, with the region on their left (doubly connected edge list; de Berg et
    al., "Computational Geometry", chapter 2).
dangle : an edge with the same region on both sides, such as a dead end.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from math import asin, atan2, dist, pi

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.files.outline.chain import Chain, compute_moved_bulge
from workhold.files.outline.joining import JoinedLoop, close_pairs, group_by_pairs
from workhold.geometry.loop import ComparisonBudget, compute_signed_area, make_loop_segments
from workhold.geometry.segment import Arc, Point, Segment, compute_bounding_box, make_segment_from_bulge
from workhold.geometry.subdivision import CutCurve, subdivide

__all__ = ["CurveCluster", "make_clusters"]

# More lines and arcs are not a nest, and pairs of them that come near each other.
MOST_SEGMENTS, MOST_PAIRS = 20_000, 1_000_000
# mm. Ends of pieces this near are one node: twice what the subdivision rounds.
NODE = 4e-6


@frozen
class PlaneEdge:
    """A piece of a drawn line or arc, between two nodes.

    Parameters
    ----------
    first, last : indices of its nodes.
    bulge : bulge of the piece, run from the first node to the last.
    owners : indices of the segments to which the piece belongs.
    """

    first: int
    last: int
    bulge: float
    owners: tuple[int, ...]


@frozen
class CurveCluster:
    """Connected lines and arcs.

    Parameters
    ----------
    faces : the closed outlines that they make, each counter-clockwise.
    open : the pieces that bound no outline.
    chains : indices of the chains to which the lines and arcs belong.
    shared : label, start and end of every line or arc between two faces.
    doubled : both labels, start and end of every stretch that was drawn twice.
    box : (smallest x, smallest y, largest x, largest y) in mm.
    """

    faces: tuple[JoinedLoop, ...]
    open: tuple[Chain, ...]
    chains: frozenset[int]
    shared: tuple[tuple[str, Point, Point], ...]
    doubled: tuple[tuple[str, str, Point, Point], ...]
    box: tuple[float, float, float, float]


def make_clusters(chains: Sequence[Chain], tolerance: float) -> list[CurveCluster]:
    """Return the connected groups of the lines and arcs of some chains, cut where they meet.

    An end within the tolerance in mm of another end, a line or an arc is taken to lie on it. Raises
    InputError if there are too many segments to compare.
    """
    segments, labels, numbers = list[Segment](), list[str](), list[int]()
    for number, chain in enumerate(chains):
        segments += chain.segments
        labels += [
            label for label, p, q in zip(chain.labels, chain.points, chain.points[1:], strict=False) if p != q
        ]
        numbers += [number] * (len(segments) - len(numbers))
    comparisons = ComparisonBudget("the drawing", MOST_PAIRS)
    if len(segments) > MOST_SEGMENTS:
        comparisons.spend(MOST_PAIRS + 1)
    points, edges = make_plane_map(segments, tolerance, comparisons)
    faces = trace_region_borders(points, edges)
    return [
        make_cluster(points, edges, faces, members, labels, numbers)
        for members in group_connected_edges(len(points), edges)
    ]


def make_plane_map(
    segments: Sequence[Segment], tolerance: float, comparisons: ComparisonBudget
) -> tuple[NDArray[np.float64], list[PlaneEdge]]:
    """Return (1) points (N, 2) in mm and (2) the edges between them: the
    pieces of segments cut where they meet.

    Segment ends within the tolerance in mm of another segment are taken to lie on it. ``comparisons`` is
    spent.
    """
    touching = find_ends_on_segments(segments, max(tolerance, NODE), comparisons)
    carriers = subdivide(segments, [(segments[k], point) for k, point in touching], comparisons)
    pieces = [
        (carrier, low, high, find_owners_at(carrier, (low + high) / 2))
        for carrier in carriers
        for low, high in carrier.list_covered_pieces()
    ]
    drawn = [end for segment in segments for end in (segment.start, segment.end)]
    ends = [carrier.compute_point(position) for carrier, low, high, _ in pieces for position in (low, high)]
    places = np.array([*drawn, *ends], dtype=np.float64).reshape(-1, 2)
    # A group is named by its smallest number: what was drawn comes before what was computed.
    pairs = close_pairs(places, NODE)
    across = [
        (int(np.hypot(*(places - point).T).argmin()), find_nearest_place(places, segments[k], point))
        for k, point in touching
    ]
    pairs = np.concatenate([pairs, np.array(across, dtype=np.int64).reshape(-1, 2)])
    node = group_by_pairs(len(places), pairs)
    first_end = len(drawn)
    edges: dict[tuple[int, int], list[tuple[PlaneEdge, Point]]] = defaultdict(list)
    for k, (carrier, low, high, owners) in enumerate(pieces):
        one, other = int(node[first_end + 2 * k]), int(node[first_end + 2 * k + 1])
        if one == other:
            continue
        bulge = compute_bulge_between(carrier, low, high)
        start, end = ends[2 * k], ends[2 * k + 1]
        new = tuple(places[one].tolist()), tuple(places[other].tolist())
        if max(dist(start, new[0]), dist(end, new[1])) > NODE:
            bulge = compute_moved_bulge(start, end, bulge, new[0], new[1])
        if one > other:
            one, other, bulge = other, one, -bulge
        middle = carrier.compute_point((low + high) / 2)
        twins = edges[one, other]
        comparisons.spend(len(twins))
        twin = next((at for at, (_, place) in enumerate(twins) if dist(place, middle) <= tolerance), None)
        if twin is None:
            twins.append((PlaneEdge(one, other, bulge + 0.0, owners), middle))
        else:
            kept, place = twins[twin]
            twins[twin] = PlaneEdge(one, other, kept.bulge, (*kept.owners, *owners)), place
    found = [edge for twins in edges.values() for edge, _ in twins]
    return places, close_dead_ends(places, found, tolerance)


def find_ends_on_segments(
    segments: Sequence[Segment], tolerance: float, comparisons: ComparisonBudget
) -> list[tuple[int, Point]]:
    """Return (segment index, end point) for each segment end that lies within a tolerance in mm of another
    segment, but not near the ends of that segment.
    """
    ends = np.unique(
        np.array([end for one in segments for end in (one.start, one.end)]).reshape(-1, 2), axis=0
    )
    boxes = np.array([compute_bounding_box(one) for one in segments]).reshape(-1, 4)
    boxes += np.array([-tolerance, -tolerance, tolerance, tolerance])
    found = []
    for k, (x0, y0, x1, y1) in enumerate(boxes):
        inside = (ends[:, 0] >= x0) & (ends[:, 0] <= x1) & (ends[:, 1] >= y0) & (ends[:, 1] <= y1)
        near = ends[inside]
        segment = segments[k]
        if isinstance(segment, Arc):
            (cx, cy), radius = segment.center, segment.radius
            away = np.abs(np.hypot(near[:, 0] - cx, near[:, 1] - cy) - radius)
        else:
            (px, py), (tx, ty) = segment.middle, segment.tangent
            away = np.abs((near[:, 0] - px) * ty - (near[:, 1] - py) * tx)
        near = near[away <= tolerance]
        comparisons.spend(len(near))
        slack = tolerance if not isinstance(segment, Arc) else tolerance / segment.radius
        for x, y in near.tolist():
            if abs(segment.find_parameter((x, y))) < segment.half_extent - slack:
                found.append((k, (x, y)))
    return found


def find_nearest_place(places: NDArray[np.float64], segment: Segment, point: Point) -> int:
    """Return the index of the row of ``places`` (N, 2) that is nearest
    to the foot of a point on a segment.
    """
    foot = segment.compute_point(segment.find_parameter(point))
    return int(np.hypot(*(places - foot).T).argmin())


def find_owners_at(carrier: CutCurve, position: float) -> tuple[int, ...]:
    """Return the indices of the segments that cover a position of a line or circle."""
    turns = (0.0, -2 * pi, 2 * pi) if isinstance(carrier.segment, Arc) else (0.0,)
    return tuple(
        owner
        for owner, (low, high) in zip(carrier.owners, carrier.spans, strict=True)
        if any(low <= position + turn <= high for turn in turns)
    )


def compute_bulge_between(carrier: CutCurve, low: float, high: float) -> float:
    """Return the bulge of a piece of a line or circle that runs in the direction of growing positions
    (counter-clockwise on a circle).
    """
    return float(np.tan((high - low) / 4)) if isinstance(carrier.segment, Arc) else 0.0


def close_dead_ends(places: NDArray[np.float64], edges: list[PlaneEdge], tolerance: float) -> list[PlaneEdge]:
    """Return the edges with each dead end moved onto its nearest other
    node, where that is within a tolerance in mm.

    A dead end is a node of one edge only. An edge whose two ends become the same node is left out.
    """
    degree = count_edges_at_nodes(edges)
    loose = [node for node, count in degree.items() if count == 1]
    nodes = np.array(sorted(degree), dtype=np.int64)
    moved: dict[int, int] = {}
    for node in loose:
        away = np.hypot(*(places[nodes] - places[node]).T)
        away[nodes == node] = np.inf
        if len(away) and away.min() <= tolerance:
            other = int(nodes[away.argmin()])
            moved[node] = moved.get(other, other)
    out = []
    for edge in edges:
        first, last = moved.get(edge.first, edge.first), moved.get(edge.last, edge.last)
        if first == last:
            continue
        bulge = edge.bulge
        if (first, last) != (edge.first, edge.last):
            ends = [tuple(places[node].tolist()) for node in (edge.first, edge.last, first, last)]
            bulge = compute_moved_bulge(ends[0], ends[1], bulge, ends[2], ends[3])
        out.append(PlaneEdge(first, last, bulge, edge.owners))
    return out


def count_edges_at_nodes(edges: Iterable[PlaneEdge]) -> dict[int, int]:
    """Return the number of edges that end at each node, by node."""
    degree: dict[int, int] = defaultdict(int)
    for edge in edges:
        degree[edge.first] += 1
        degree[edge.last] += 1
    return degree


def group_connected_edges(count: int, edges: Sequence[PlaneEdge]) -> list[list[int]]:
    """Return the indices of the edges of each connected group; ``count`` is the number of nodes."""
    pairs = np.array([(edge.first, edge.last) for edge in edges], dtype=np.int64).reshape(-1, 2)
    name = group_by_pairs(count, pairs)
    members: dict[int, list[int]] = defaultdict(list)
    for k, edge in enumerate(edges):
        members[int(name[edge.first])].append(k)
    return list(members.values())


def trace_region_borders(points: NDArray[np.float64], edges: Sequence[PlaneEdge]) -> list[list[int]]:
    """Return the border of each region that edges bound, as
    half-edges in running order with the region on the left.

    Half-edge 2 e runs edge e forward, 2 e + 1 backward. Edges with the same region on both sides are left
    out. The unbounded region outside has borders too, run clockwise.
    """
    kept = set(range(len(edges)))
    while True:
        kept = drop_loose_ends(edges, kept)
        walks = trace_closed_walks(points, edges, kept)
        dangles = set()
        for walk in walks:
            seen = set(walk)
            dangles |= {half // 2 for half in walk if half ^ 1 in seen}
        if not dangles:
            return walks
        kept -= dangles


def drop_loose_ends(edges: Sequence[PlaneEdge], kept: set[int]) -> set[int]:
    """Return the indices of the edges that are left of ``kept`` when edges with a dead end are removed until
    there are none.
    """
    at: dict[int, set[int]] = defaultdict(set)
    for k in kept:
        at[edges[k].first].add(k)
        at[edges[k].last].add(k)
    loose = [node for node, some in at.items() if len(some) == 1]
    left = set(kept)
    while loose:
        node = loose.pop()
        for k in tuple(at[node]) if len(at[node]) == 1 else ():
            left.discard(k)
            for end in (edges[k].first, edges[k].last):
                at[end].discard(k)
                if len(at[end]) == 1:
                    loose.append(end)
    return left


def trace_closed_walks(
    points: NDArray[np.float64], edges: Sequence[PlaneEdge], kept: set[int]
) -> list[list[int]]:
    """Return closed walks of half-edges; each half-edge is followed by the one
    that turns farthest to the left at its end.

    Half-edge 2 e runs edge e forward, 2 e + 1 backward; only edges whose index is in ``kept`` are walked.
    """
    leaving: dict[int, list[int]] = defaultdict(list)
    for k in sorted(kept):
        leaving[edges[k].first].append(2 * k)
        leaving[edges[k].last].append(2 * k + 1)
    after: dict[int, int] = {}
    for halves in leaving.values():
        near = min(measure_edge_chord(points, edges[half // 2]) for half in halves) / 2
        around = sorted(halves, key=lambda half: compute_edge_direction(points, edges, half, near))
        for k, half in enumerate(around):
            # Counter-clockwise about the node, the walk that comes in along a half-edge leaves by the one
            # before it.
            after[half ^ 1] = around[k - 1]
    walks, done = [], set[int]()
    for half in sorted(after):
        walk = []
        while half not in done:
            done.add(half)
            walk.append(half)
            half = after[half]
        if walk:
            walks.append(walk)
    return walks


def measure_edge_chord(points: NDArray[np.float64], edge: PlaneEdge) -> float:
    """Return the distance between the ends of an edge in mm."""
    return float(np.hypot(*(points[edge.last] - points[edge.first])))


def compute_edge_direction(
    points: NDArray[np.float64], edges: Sequence[PlaneEdge], half: int, near: float
) -> float:
    """Return the direction in radians, in [0, 2 pi), in
    which a half-edge crosses a circle about its first node.

    The circle has the radius ``near`` in mm: edges that are tangent at the node differ there by their
    curvature. Half-edge 2 e runs edge e forward, 2 e + 1 backward.
    """
    edge = edges[half // 2]
    start, end = (edge.first, edge.last) if half % 2 == 0 else (edge.last, edge.first)
    bulge = edge.bulge if half % 2 == 0 else -edge.bulge
    along = points[end] - points[start]
    heading = atan2(along[1], along[0])
    if abs(bulge) > 0:
        segment = make_segment_from_bulge(tuple(points[start].tolist()), tuple(points[end].tolist()), bulge)
        if isinstance(segment, Arc):
            # The tangent leads half the sweep away from the chord, and the arc bends back by the angle of
            # the chord to the circle.
            heading -= segment.sign * segment.half_sweep
            heading += segment.sign * asin(min(near / (2 * segment.radius), 1.0))
    return (heading + pi) % (2 * pi)


def make_cluster(
    points: NDArray[np.float64],
    edges: Sequence[PlaneEdge],
    walks: Sequence[Sequence[int]],
    members: Sequence[int],
    labels: Sequence[str],
    numbers: Sequence[int],
) -> CurveCluster:
    """Return the connected edges ``members`` with the closed outlines that they make.

    Parameters
    ----------
    points : (N, 2) nodes.
    walks : borders of all regions, see :func:`trace_region_borders`.
    labels, numbers : label and chain index of each segment.
    """
    own = set(members)
    place = [tuple(row) for row in points.tolist()]
    faces, inner = [], defaultdict[int, int](int)
    used = set[int]()
    for walk in walks:
        if walk[0] // 2 not in own:
            continue
        used.update(half // 2 for half in walk)
        loop = make_loop_from_walk(place, edges, walk, labels)
        if compute_signed_area(make_loop_segments(loop.vertices)) > 0:
            faces.append(loop)
            for half in walk:
                inner[half // 2] += 1

    def get_ends(k: int) -> tuple[Point, Point]:
        """Return both nodes of an edge as points."""
        return place[edges[k].first], place[edges[k].last]

    shared = tuple((labels[edges[k].owners[0]], *get_ends(k)) for k in members if inner[k] == 2)
    doubled = []
    for k in members:
        owners = edges[k].owners
        if len(owners) > 1:
            doubled.append((labels[owners[0]], labels[owners[1]], *get_ends(k)))
    corners = np.array([place[node] for k in members for node in (edges[k].first, edges[k].last)])
    return CurveCluster(
        tuple(faces),
        tuple(join_edges_to_chains(place, [edges[k] for k in members if k not in used], labels)),
        frozenset(numbers[owner] for k in members for owner in edges[k].owners),
        shared,
        tuple(doubled),
        (*corners.min(axis=0).tolist(), *corners.max(axis=0).tolist()),
    )


def make_loop_from_walk(
    place: Sequence[Point], edges: Sequence[PlaneEdge], walk: Sequence[int], labels: Sequence[str]
) -> JoinedLoop:
    """Return a closed walk of half-edges (2 e runs edge e forward, 2 e + 1 backward) as a loop."""
    rows, names = [], []
    for half in walk:
        edge = edges[half // 2]
        start, bulge = (edge.first, edge.bulge) if half % 2 == 0 else (edge.last, -edge.bulge)
        rows.append((*place[start], bulge + 0.0))
        names.append(labels[edge.owners[0]])
    return JoinedLoop(np.array(rows, dtype=np.float64), tuple(names))


def join_edges_to_chains(
    place: Sequence[Point], edges: Sequence[PlaneEdge], labels: Sequence[str]
) -> Iterable[Chain]:
    """Yield the given edges as chains; edges are joined at each node where exactly two of them meet.

    Edges that form a closed ring, with no other edge at it, are left out.
    """
    at: dict[int, list[int]] = defaultdict(list)
    for k, edge in enumerate(edges):
        at[edge.first].append(k)
        at[edge.last].append(k)
    done = set[int]()
    starts = [node for node, some in at.items() if len(some) != 2]
    for node in starts:
        for k in at[node]:
            here, points, bulges, names = node, [place[node]], list[float](), list[str]()
            while k not in done:
                done.add(k)
                edge = edges[k]
                forward = edge.first == here
                here = edge.last if forward else edge.first
                points.append(place[here])
                bulges.append(edge.bulge if forward else 0.0 - edge.bulge)
                names.append(labels[edge.owners[0]])
                if len(at[here]) == 2:
                    k = next((other for other in at[here] if other not in done), k)
            if bulges:
                yield Chain(tuple(points), tuple(bulges), tuple(names))
