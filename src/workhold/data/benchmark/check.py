"""Checks one file of the benchmark set (format workhold-benchmark/1) with nothing but Python and NumPy.

    python check.py SET.json [--manifest manifest.json] [--starts N] [--seed N]

Written from the published rules, apart from the program that made the lists: every fixture is judged (holes,
contacts, no overlap, clearances, closure, forces, figures), then the list (each once, in order, counts,
account of the search), then its completeness as far as a short program can. Images under the part's own
rotations must be listed, and so must every fixture that this program finds by itself: beside a
fence all in closed form, else from random starts by Newton's method. With the manifest, the checksums decide.

Each fault is one line on the output. The exit code is 0 where there is none, and 2 otherwise.

Rules by number are those of docs/benchmark.md. Lengths are in mm; q is a point in the part's own coordinates.
"""

from __future__ import annotations

import argparse
import json
import sys
from hashlib import sha256
from itertools import combinations, product
from math import atan, degrees, inf, isfinite, pi
from pathlib import Path
from typing import Any

import numpy as np

Fixtures = list[dict[str, Any]]
FORMAT = "workhold-benchmark/1"
# mm: coordinates are written to 1e-9. Within EDGE of a rule's limit a fixture may be listed or not.
TOL, EDGE, FIGURE_TOL = 1e-7, 1e-6, 1e-6
DIRECTIONS = {"-x": (-1.0, 0.0), "+x": (1.0, 0.0), "-y": (0.0, -1.0), "+y": (0.0, 1.0)}
FIGURES = ("closure_margin", "clamp_amplification", "wrench_radius", "location_error", "clamp_freedom")
HEAD = (
    "format",
    "set",
    "workpiece",
    "toolkit",
    "options",
    "counts",
    "distinct",
    "statistics",
    "proof",
    "fixtures",
)
ACCOUNT = ("cells", "candidates", "discarded_by_bound", "verified", "escalated")
TURNED = {"-x": "+x", "+x": "-x", "-y": "+y", "+y": "-y"}


def cross(a: Any, b: Any) -> Any:
    """Return the cross products (...), as numbers, of plane vectors a and b (..., 2)."""
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def make_rotation(theta: Any) -> Any:
    """Return rotation matrices (..., 2, 2) for angles (...) in radians."""
    c, s = np.cos(theta), np.sin(theta)
    return np.stack([np.stack([c, -s], -1), np.stack([s, c], -1)], -2)


class Outline:
    """The part's outline as arrays with one entry for each of S segments; the material is on the left of each
    segment.
    """

    def __init__(self, loops: list[list[list[float]]]) -> None:
        rows, self.loop = [], []
        for number, loop in enumerate(loops):
            for k, (x, y, bulge) in enumerate(loop):
                rows.append((x, y, *loop[(k + 1) % len(loop)][:2], bulge))
                self.loop.append(number)
        data = np.array(rows, float)
        self.a, self.b, bulges = data[:, :2], data[:, 2:4], data[:, 4]
        self.arc = np.abs(bulges) > 1e-12
        chord = self.b - self.a
        self.length = np.hypot(*chord.T)
        self.t = chord / self.length[:, None]
        self.sweep = 4 * np.arctan(np.where(self.arc, bulges, 0.0))
        half = np.where(self.arc, self.sweep, 1.0) / 2
        self.sign = np.sign(half)
        self.r = np.where(self.arc, self.length / (2 * np.sin(np.abs(half))), 0.0)
        left = np.stack([-self.t[:, 1], self.t[:, 0]], -1)
        self.c = (self.a + self.b) / 2 + left * (self.sign * self.r * np.cos(half))[:, None]
        self.c[~self.arc] = 0.0
        self.a0 = np.arctan2(*(self.a - self.c).T[::-1])
        self.normal_of_line = np.stack([self.t[:, 1], -self.t[:, 0]], -1)
        self.face = self.number_faces(len(loops))
        self.whole = np.array([self.is_whole(f) for f in self.face])
        low, high = self.compute_box()
        self.middle = (low + high) / 2
        self.diameter = self.measure_diameter()

    def continues(self, i: int, j: int) -> bool:
        """Return whether segment j continues the line or circle of segment i."""
        if self.arc[i] != self.arc[j]:
            return False
        if self.arc[i]:
            near = np.hypot(*(self.c[i] - self.c[j])) < 1e-7 and abs(self.r[i] - self.r[j]) < 1e-7
            return bool(near and self.sign[i] == self.sign[j])
        off = abs(cross(self.t[i], self.a[j] - self.a[i]))
        return bool(np.abs(self.t[i] - self.t[j]).sum() < 1e-9 and off < 1e-7)

    def number_faces(self, loops: int) -> Any:
        """Return for each segment the number of its face (S,): the smallest index of the segments that form
        this face.

        ``loops`` is the number of loops.
        """
        face = np.arange(len(self.a))
        for number in range(loops):
            here = [k for k, one in enumerate(self.loop) if one == number]
            for _ in here:
                for i, j in zip(here, here[1:] + here[:1], strict=True):
                    if self.continues(i, j):
                        face[i] = face[j] = min(face[i], face[j])
        return face

    def is_whole(self, face: int) -> bool:
        """Return whether the face with this number is a whole circle."""
        of = self.face == face
        return bool(self.arc[face] and np.abs(self.sweep[of]).sum() > 2 * pi - 1e-9)

    def has_direction(self, k: Any, angle: Any) -> Any:
        """Return whether arc k has a point in a direction (radians) from its centre; numbers or arrays."""
        return ((angle - self.a0[k]) * self.sign[k]) % (2 * pi) <= abs(self.sweep[k])

    def compute_arc_point(self, k: Any, angle: Any) -> Any:
        """Return the point (..., 2) on the whole circle of arc k in a direction (radians) from its centre."""
        return self.c[k] + self.r[k] * np.stack([np.cos(angle), np.sin(angle)], -1)

    def compute_box(self) -> tuple[Any, Any]:
        """Return the lower left and the upper right corner (2,) of the bounding box."""
        points = [*self.a]
        for k in np.flatnonzero(self.arc):
            points += [
                self.compute_arc_point(k, a) for a in np.arange(4) * pi / 2 if self.has_direction(k, a)
            ]
        return np.min(points, axis=0), np.max(points, axis=0)

    def measure_diameter(self) -> float:
        """Return the largest distance in mm between two points of the outline."""
        best = max(np.hypot(*(self.a - p).T).max() for p in self.a)
        arcs = np.flatnonzero(self.arc)
        for k in arcs:
            for p in [*self.a, *self.c[arcs]]:
                v = self.c[k] - p
                if np.hypot(*v) > 1e-12 and self.has_direction(k, np.arctan2(v[1], v[0])):
                    far = self.c[k] + v / np.hypot(*v) * self.r[k]
                    if any(np.array_equal(p, self.a[j]) for j in range(len(self.a))):
                        best = max(best, np.hypot(*(far - p)))
            for j in arcs:
                v = self.c[k] - self.c[j]
                angles = [np.arctan2(v[1], v[0])] if np.hypot(*v) > 1e-12 else np.linspace(0, 2 * pi, 721)
                if any(self.has_direction(k, a) and self.has_direction(j, a + pi) for a in angles):
                    best = max(best, np.hypot(*v) + self.r[k] + self.r[j])
        return float(best)

    def measure_distances(self, q: Any) -> tuple[Any, Any]:
        """Return two arrays (M, S) for M points q (M, 2) and S segments: distances in mm, and positions of
        the nearest points.

        A position says how far, in mm along the segment, the foot of the point is from the nearer end; it is
        negative where the foot lies beyond that end.
        """
        v = q[:, None] - self.a
        along = (v * self.t).sum(-1)
        inside = np.clip(along, 0, self.length)
        straight = np.hypot(*np.moveaxis(v - inside[..., None] * self.t, -1, 0))
        v = q[:, None] - self.c
        out = np.hypot(v[..., 0], v[..., 1])
        angle = ((np.arctan2(v[..., 1], v[..., 0]) - self.a0) * self.sign) % (2 * pi)
        sweep = np.abs(self.sweep)
        ends = np.minimum(*(np.hypot(*np.moveaxis(q[:, None] - p, -1, 0)) for p in (self.a, self.b)))
        on = angle <= sweep
        distance = np.where(self.arc, np.where(on, np.abs(out - self.r), ends), straight)
        past = np.where(on, np.minimum(angle, sweep - angle), -np.minimum(angle - sweep, 2 * pi - angle))
        return distance, np.where(self.arc, self.r * past, np.minimum(along, self.length - along))

    def compute_normals(self, q: Any, k: Any) -> Any:
        """Return for each point q (M, 2) the outward unit normal (M, 2) of its segment k (M,) at the foot of
        the point.
        """
        v = (q - self.c[k]) * self.sign[k][:, None]
        size = np.hypot(*v.T)[:, None]
        return np.where(self.arc[k][:, None], v / np.where(size == 0, 1, size), self.normal_of_line[k])

    def contains(self, q: Any) -> Any:
        """Return for each point q (M, 2) whether it lies in the material (M,).

        Two rays from the point must both cross the outline an odd number of times.
        """
        verdicts = []
        for angle in (0.7354, 2.4131):
            u = np.array([np.cos(angle), np.sin(angle)])
            v = q[:, None] - self.a
            turn = cross(u, self.t)
            turn = np.where(np.abs(turn) < 1e-15, 1e-15, turn)
            ray, at = cross(self.t, v) / turn, cross(u, v) / turn
            count = ((ray > 0) & (at >= 0) & (at < self.length) & ~self.arc).sum(-1)
            w = q[:, None] - self.c
            along, across = -(w * u).sum(-1), cross(u, w)
            root = np.sqrt(np.maximum(self.r**2 - across**2, 0.0))
            for sign in (-1, 1):
                step = along + sign * root
                p = w + step[..., None] * u
                on = ((np.arctan2(p[..., 1], p[..., 0]) - self.a0) * self.sign) % (2 * pi) <= np.abs(
                    self.sweep
                )
                count += ((step > 0) & on & (np.abs(across) < self.r) & self.arc).sum(-1)
            verdicts.append(count % 2 == 1)
        return verdicts[0] & verdicts[1]

    def find_hits(self, p: Any, u: Any, r: float) -> list[tuple[float, int]]:
        """Return where a disc of radius r (mm) that moves along a line touches the part without entering it.

        The disc's centre is p + s u, with a unit vector u. The list has (s, index of the touched segment).
        """
        found = []
        turn = cross(u, self.t)
        for k in np.flatnonzero(~self.arc & (np.abs(turn) > 1e-12)):
            base = self.a[k] + r * self.normal_of_line[k]
            found.append((cross(base - p, self.t[k]) / turn[k], k))
        for k in np.flatnonzero(self.arc):
            size = self.r[k] + r * self.sign[k]
            w = p - self.c[k]
            across = cross(u, w)
            if size > 1e-9 and abs(across) < size:
                root = np.sqrt(size**2 - across**2)
                found += [(-(w @ u) + sign * root, k) for sign in (-1, 1)]
        if not found:
            return []
        s, which = (np.array(x) for x in zip(*found, strict=True))
        q = p + s[:, None] * u
        distance, past = self.measure_distances(q)
        row = np.arange(len(q))
        good = (
            (distance.min(1) > r - 1e-9)
            & (past[row, which] > EDGE)
            & (np.abs(distance[row, which] - r) < 1e-9)
        )
        good &= ~self.contains(q)
        return [(float(a), int(b)) for a, b in zip(s[good], which[good], strict=True)]

    def find_rotations(self) -> list[float]:
        """Return the angles in radians of all rotations of the outline onto itself, ascending from 0.

        Set ``pivot``, the point about which they rotate.
        """
        marks = {f: (self.c[f], self.c[f]) if self.whole[f] else None for f in set(self.face.tolist())}
        rows = []
        for f, whole in marks.items():
            of = np.flatnonzero(self.face == f)
            first = next((k for k in of if not any(np.array_equal(self.b[j], self.a[k]) for j in of)), of[0])
            last = next((k for k in of if not any(np.array_equal(self.a[j], self.b[k]) for j in of)), of[0])
            a, b = whole or (self.a[first], self.b[last])
            rows.append((*a, *b, self.sign[f] * self.r[f] if self.arc[f] else 0.0))
        data = np.array(rows)
        joints = [k for k, f in enumerate(marks) if marks[f] is None] or list(range(len(rows)))
        self.pivot = data[joints, :2].mean(0)
        found = []
        for order in range(1, len(rows) + 1):
            if all(self.carries_faces_onto_faces(data, 2 * pi * k / order) for k in (1,)):
                found += [2 * pi * k / order for k in range(order)]
        return sorted({round(a, 12) for a in found}) if np.ptp(data[:, :4]) > 1e-9 or len(rows) > 2 else [0.0]

    def carries_faces_onto_faces(self, rows: Any, angle: float) -> bool:
        """Return whether a rotation by an angle (radians) about ``pivot`` carries each face onto a face.

        ``rows`` (F, 5) are for each of F faces its start, its end and its signed radius.
        """
        R = make_rotation(angle)
        image = rows.copy()
        for at in (slice(0, 2), slice(2, 4)):
            image[:, at] = (rows[:, at] - self.pivot) @ R.T + self.pivot
        gap = np.abs(image[:, None] - rows).max(-1)
        return bool((gap.min(1) < 1e-6).all())


class Bench:
    """The toolkit, part and options that a file is about."""

    def __init__(self, content: dict[str, Any]) -> None:
        self.kit = content["toolkit"]
        self.kind = self.kit["kind"]
        self.pitch = np.array(self.kit["pitch"], float)
        self.rho = self.kit["peg_radius"]
        self.tip = self.kit.get("clamp_radius", self.rho)
        self.outline = Outline(content["workpiece"]["loops"])
        self.scale = self.outline.diameter / 2 + max(self.rho, self.tip)
        self.tolerance = content["options"]["tolerance"]
        self.has_wall = self.kind in ("edge", "flat-jaw")
        self.base = np.array([0.0, self.kit.get("wall_offset", 0.0)])
        self.origin_free = self.kind in ("vise", "opening-vise", "flat-jaw")
        self.pairs = self.kit.get("clamps") == 2

    def list_roles(self, fixture: dict[str, Any]) -> list[str]:
        """Return the role that each peg of a fixture must have, in order.

        A role is "left", "right", "jaw", "locator", or the direction of a clamp, such as "-x".
        """
        if self.kind in ("vise", "opening-vise"):
            return {"I": ["left"] * 2 + ["right"] * 2, "II": ["left"] * 3 + ["right"]}[fixture["type"]]
        if self.kind == "flat-jaw":
            return ["jaw", "jaw"]
        ways = fixture["directions"] if self.pairs else [fixture["direction"]]
        return ["locator"] * (1 if self.has_wall else 3) + list(ways)

    def list_type_names(self) -> set[str]:
        """Return the names of the types that fixtures of this toolkit can have."""
        if self.kind in ("vise", "opening-vise"):
            return {"I", "II"}
        name = {"flat-jaw": "flat", "edge": "edge", "translating-clamp": "clamp"}[self.kind]
        return {name + "2" * self.pairs}

    def list_push_directions(self, roles: list[str]) -> Any:
        """Return the direction in which each of P pegs pushes as the toolkit clamps (P, 2); zero for pegs
        that stand still.
        """
        sign = -1.0 if self.kind == "opening-vise" else 1.0
        known = {
            "left": (sign, 0.0),
            "right": (-sign, 0.0),
            "jaw": (0.0, -1.0),
            "locator": (0.0, 0.0),
            **DIRECTIONS,
        }
        return np.array([known[role] for role in roles])

    def list_peg_radii(self, roles: list[str]) -> Any:
        """Return the radius in mm of each of P pegs (P,), from their roles."""
        return np.array([self.tip if role in DIRECTIONS else self.rho for role in roles])

    def compute_wrenches(self, q: Any, n: Any) -> Any:
        """Return the wrenches (..., 3) of unit forces along normals n (..., 2) at points q (..., 2) of the
        part.

        A wrench is the force in x and y, and the moment about the middle of the part's box divided by
        ``scale``.
        """
        return np.concatenate([n, (cross(q - self.outline.middle, n) / self.scale)[..., None]], -1)


# ---- the form of the file ----------------------------------------------------------------------------------


def find_set_form_faults(content: Any) -> list[str]:
    """Return a list of sentences on wrong keys and types of a file's content; empty where all are right."""
    if not isinstance(content, dict):
        return ["the file is not a JSON object"]
    faults = [f"the key {key} is missing" for key in HEAD if key not in content]
    if faults:
        return faults
    if content["format"] != FORMAT:
        return [f"the format is {content['format']!r}, not {FORMAT}"]
    if not isinstance(content["fixtures"], list) or not isinstance(content["set"], str):
        return ["fixtures are not a list, or the set has no name"]
    if content["workpiece"].get("units") != "mm":
        faults.append("the workpiece is not in mm")
    if content["toolkit"].get("kind") not in (
        "vise",
        "opening-vise",
        "translating-clamp",
        "edge",
        "flat-jaw",
    ):
        return [f"the kind {content['toolkit'].get('kind')!r} is not known"]
    for key in ("statistics", "counts", "distinct"):
        values = content[key].values()
        if any(type(value) is not int or value < 0 for value in values):
            faults.append(f"{key} are not whole numbers from 0")
    finite = are_all_finite({key: content[key] for key in ("workpiece", "toolkit", "options", "fixtures")})
    if not finite:
        faults.append("a number is not finite")
    return faults


def are_all_finite(value: Any) -> bool:
    """Return whether every float in nested lists and dictionaries is finite."""
    if isinstance(value, dict):
        return all(map(are_all_finite, value.values()))
    if isinstance(value, list):
        return all(map(are_all_finite, value))
    return not isinstance(value, float) or isfinite(value)


def find_form_faults(bench: Bench, fixture: Any) -> list[str]:
    """Return a list with the first fault in the keys and types of a fixture; empty where all are right."""
    try:
        if fixture["type"] not in bench.list_type_names():
            return [f"the type {fixture['type']!r} is none of this toolkit"]
        roles = bench.list_roles(fixture)
        if len(fixture["pegs"]) != len(roles):
            return ["the number of pegs"]
        for peg, role in zip(fixture["pegs"], roles, strict=True):
            name = peg["jaw"] if role in ("left", "right") else peg["role"]
            if name != ("clamp" if role in DIRECTIONS else role):
                return ["the role of a peg"]
            needed = {"-x": "row", "+x": "row", "-y": "column", "+y": "column"}.get(role)
            for key in [needed] if needed else ["column", "row"]:
                if type(peg[key]) is not int:
                    return [f"a {key} is not a whole number"]
            if type(peg["segment"]) is not int or not 0 <= peg["segment"] < len(bench.outline.a):
                return ["a segment that the part does not have"]
            if bench.pairs and role in DIRECTIONS and peg["direction"] != role:
                return ["the direction of a clamp"]
            forces = peg["force"] if bench.pairs else [peg["force"]]
            _ = float(peg["x"]) + float(peg["y"]) + sum(map(float, forces))
        _ = sum(float(fixture["pose"][key]) for key in ("theta_deg", "x", "y"))
        keys = set(FIGURES) if bench.pairs else set(FIGURES[:-1])
        if set(fixture["quality"]) != keys:
            return ["its figures are not those of the format"]
        _ = sum(map(float, fixture["quality"].values()))
        if bench.kind in ("vise", "opening-vise", "flat-jaw"):
            _ = float(fixture["jaw_separation"])
        if bench.has_wall:
            _ = [*fixture["wall"]["from"], *fixture["wall"]["to"], *fixture["wall"]["forces"]]
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        return [f"it has not the form of a fixture ({type(error).__name__}: {error})"]
    return []


# ---- one fixture -------------------------------------------------------------------------------------------


class Batch:
    """N fixtures of one type and the same roles of pegs, as arrays.

    ``faults`` has for each fixture a list of what is wrong; ``marginal`` (N,) is True where it is so near a
    rule's limit that it may be listed or not.
    """

    def __init__(self, bench: Bench, fixtures: Fixtures) -> None:
        self.bench, self.fixtures = bench, fixtures
        self.roles = bench.list_roles(fixtures[0])
        self.xy = np.array([[(p["x"], p["y"]) for p in f["pegs"]] for f in fixtures], float)
        pose = np.array([[f["pose"][key] for key in ("theta_deg", "x", "y")] for f in fixtures], float)
        self.theta, self.shift = np.radians(pose[:, 0]), pose[:, 1:]
        self.segment = np.array([[p["segment"] for p in f["pegs"]] for f in fixtures])
        self.R = make_rotation(self.theta)
        self.q = np.einsum("nji,nmj->nmi", self.R, self.xy - self.shift[:, None])
        self.faults: list[list[str]] = [[] for _ in fixtures]
        self.marginal = np.zeros(len(fixtures), bool)
        self.push = np.einsum("nji,mj->nmi", self.R, bench.list_push_directions(self.roles))

    def blame(self, wrong: Any, words: str) -> None:
        """Add the text ``words`` to the faults of each fixture that the mask ``wrong`` (N,) selects."""
        for n in np.flatnonzero(wrong):
            self.faults[n].append(words)

    def judge(self) -> None:
        """Check the fixtures against every rule; write the results into ``faults`` and ``marginal``."""
        bench = self.bench
        theta = np.array([f["pose"]["theta_deg"] for f in self.fixtures])
        self.blame((theta < 0) | (theta >= 360), "theta_deg lies outside [0, 360)")
        self.check_contacts()
        walls = self.check_wall() if bench.has_wall else np.zeros((len(self.q), 0, 3))
        self.w = np.concatenate([walls, bench.compute_wrenches(self.q, self.n)], 1)
        {"vise": self.check_jaws, "opening-vise": self.check_jaws, "flat-jaw": self.check_flat_jaw}.get(
            bench.kind, self.check_plate
        )()
        self.check_closure()
        self.check_figures()

    def check_contacts(self) -> None:
        """Check rules 1 and 2: each peg touches its face between the face's ends, and no peg enters the part.

        Set ``n`` (N, P, 2), the part's outward normals at the contacts.
        """
        outline, self.n = self.bench.outline, np.zeros_like(self.q)
        for m, radius in enumerate(self.bench.list_peg_radii(self.roles)):
            q, name = self.q[:, m], f"peg {m + 1}"
            distance, past = outline.measure_distances(q)
            same = outline.face[self.segment[:, m]][:, None] == outline.face
            k, row = np.where(same, distance, inf).argmin(1), np.arange(len(q))
            self.blame(np.abs(distance[row, k] - radius) > TOL, f"{name} does not touch its face")
            self.blame(outline.face[self.segment[:, m]] != self.segment[:, m], f"{name} names no face")
            self.blame((past[row, k] < -EDGE) & ~outline.whole[k], f"{name} is past the end of its face")
            self.blame(
                (distance.min(1) < radius - TOL) | (outline.contains(q) & (distance.min(1) > TOL)),
                f"{name} enters the part",
            )
            others = np.where(same, inf, distance)
            second = (others < radius + EDGE) & (np.abs(past) > 1e-3)
            self.marginal |= ((past[row, k] < EDGE) & ~outline.whole[k]) | second.any(1)
            self.n[:, m] = outline.compute_normals(q, k)

    def check_wall(self) -> Any:
        """Check that the part lies flush on the wall, from one stated point to the other.

        Return the wrenches (N, 2, 3) of the wall's contacts at these two points.
        """
        outline, ends = self.bench.outline, []
        lowest = np.einsum("nij,sj->nsi", self.R, outline.a) + self.shift[:, None]
        points = [lowest]
        down = np.einsum("nji,j->ni", self.R, np.array([0.0, -1.0]))
        angle = np.arctan2(down[:, 1], down[:, 0])
        for k in np.flatnonzero(outline.arc):
            p = np.einsum("nij,nj->ni", self.R, outline.compute_arc_point(k, angle)) + self.shift
            points.append(np.where(outline.has_direction(k, angle)[:, None], p, lowest[:, 0])[:, None])
        low = np.concatenate(points, 1)
        self.blame(low[..., 1].min(1) < -TOL, "the part enters the wall")
        on = np.abs(low[..., 1]) < EDGE
        x0 = np.where(on, low[..., 0], inf).min(1)
        x1 = np.where(on, low[..., 0], -inf).max(1)
        self.blame(~(x1 - x0 > EDGE), "the part does not lie flush on the wall")
        for key, x in (("from", x0), ("to", x1)):
            said = np.array([f["wall"][key] for f in self.fixtures], float)
            self.blame((np.abs(said[:, 0] - x) > EDGE) | (np.abs(said[:, 1]) > TOL), f"the wall's {key!r}")
            q = np.einsum("nji,nj->ni", self.R, said - self.shift)
            ends.append(self.bench.compute_wrenches(q, down))
        radii = self.bench.list_peg_radii(self.roles)
        self.blame((self.xy[..., 1] < radii - TOL).any(1), "a peg enters the wall")
        self.marginal |= (self.xy[..., 1] < radii + EDGE).any(1)
        return np.stack(ends, 1)

    def read_numbers(self, key: str, members: list[int]) -> Any:
        """Return a number of the pegs with the indices ``members`` (N, M): ``key`` is "column" or "row"."""
        return np.array([[f["pegs"][m][key] for m in members] for f in self.fixtures])

    def check_jaws(self) -> None:
        """Check rule 3 for a vise: holes, columns, rows, the gap between the jaws' pegs, and the opening."""
        kit, pitch, columns = self.bench.kit, self.bench.pitch, self.bench.kit["columns"]
        sides = {s: [m for m, role in enumerate(self.roles) if role == s] for s in ("left", "right")}
        S = np.array([f["jaw_separation"] for f in self.fixtures], float)
        rows = []
        for side, members in sides.items():
            i, j = self.read_numbers("column", members), self.read_numbers("row", members)
            start = 0.0 if side == "left" else ((columns - 1) * pitch[0] + S)[:, None]
            lift = 0.0 if side == "left" else kit["row_offset"]
            off = np.abs(self.xy[:, members, 0] - start - i * pitch[0])
            off = np.maximum(off, np.abs(self.xy[:, members, 1] - lift - j * pitch[1])).max(1)
            self.blame(off > TOL, f"a peg of the {side} jaw is not in its hole")
            self.blame((i < 0).any(1) | (i >= columns).any(1), "a column that the jaw does not have")
            self.refuse_shared(i, j)
            rows.append(j)
            if kit["max_opening"] is None:
                near = i.max(1) != columns - 1 if side == "left" else i.min(1) != 0
                self.blame(near, f"the pegs of the {side} jaw could stand nearer to the opening")
        j = np.concatenate(rows, 1)
        self.check_rows(j)
        gap = self.xy[:, sides["right"], 0].min(1) - self.xy[:, sides["left"], 0].max(1)
        self.blame(gap < kit["min_gap"] - TOL, "the jaws are too near to each other")
        self.marginal |= gap < kit["min_gap"] + EDGE
        self.blame(kit["min_gap"] - (columns - 1) * pitch[0] * 2 - TOL > S, "the opening")
        if kit["max_opening"] is not None:
            self.blame(kit["max_opening"] + TOL < S, "the vise does not open so far")
            self.marginal |= kit["max_opening"] - EDGE < S

    def refuse_shared(self, i: Any, j: Any) -> None:
        """Add a fault to fixtures with two pegs in one hole, from the columns i and rows j (N, M) of M
        pegs.
        """
        for a, b in combinations(range(i.shape[1]), 2):
            self.blame((i[:, a] == i[:, b]) & (j[:, a] == j[:, b]), "two pegs stand in one hole")

    def check_rows(self, j: Any) -> None:
        """Check the rows j (N, M) of M pegs: all exist, and the lowest is 0 where the format requires
        that.
        """
        most = self.bench.kit["rows"]
        self.blame(j.min(1) < 0, "a row below 0")
        if most is None or self.bench.kind == "translating-clamp":
            self.blame(j.min(1) != 0, "the lowest row is not 0")
        if most is not None:
            self.blame(j.max(1) >= most, "a row that there is not")

    def check_flat_jaw(self) -> None:
        """Check rules 2 and 3 for a vise with a flat jaw: holes, columns, rows and the opening."""
        kit, pitch = self.bench.kit, self.bench.pitch
        i, j = self.read_numbers("column", [0, 1]), self.read_numbers("row", [0, 1])
        S = np.array([f["jaw_separation"] for f in self.fixtures], float)
        off = np.maximum(
            np.abs(self.xy[..., 0] - i * pitch[0]), np.abs(self.xy[..., 1] - S[:, None] - j * pitch[1])
        )
        self.blame(off.max(1) > TOL, "a peg is not in its hole")
        self.refuse_shared(i, j)
        self.blame((i.min(1) != 0) | (j.min(1) < 0), "the lowest column is not 0")
        for values, key in ((i, "columns"), (j, "rows")):
            if kit[key] is not None:
                self.blame(np.ptp(values, axis=1) >= kit[key], f"the {key} do not suffice")
        self.blame(kit["min_gap"] - TOL > S, "the jaw is too near to the wall")
        self.marginal |= kit["min_gap"] + EDGE > S
        if kit["max_opening"] is None:
            self.blame(j.min(1) != 0, "the lowest row is not 0")
        else:
            self.blame(kit["max_opening"] + TOL < S, "the vise does not open so far")
            back = (j.min(1) > 0) & (S + pitch[1] <= kit["max_opening"] - EDGE)
            self.blame(back, "the pegs are moved back farther than needed")
            self.marginal |= np.abs((kit["max_opening"] - S) % pitch[1]) < EDGE

    def check_plate(self) -> None:
        """Check the rules for a plate or fence: holes, columns and rows, and for clamps their lines, bodies
        and clearances.
        """
        bench, kit, pitch, base = self.bench, self.bench.kit, self.bench.pitch, self.bench.base
        stops = [m for m, role in enumerate(self.roles) if role == "locator"]
        clamps = [m for m, role in enumerate(self.roles) if role in DIRECTIONS]
        i, j = self.read_numbers("column", stops), self.read_numbers("row", stops)
        off = np.abs(self.xy[:, stops] - base - np.stack([i, j], -1) * pitch).max((1, 2))
        self.blame(off > TOL, "a locator is not in its hole")
        self.refuse_shared(i, j)
        bodies = []
        for m in clamps:
            role, tip = self.roles[m], self.xy[:, m]
            d, axis = np.array(DIRECTIONS[role]), 1 if role[1] == "x" else 0
            line = self.read_numbers("row" if axis else "column", [m])
            self.blame(
                np.abs(tip[:, axis] - base[axis] - line[:, 0] * pitch[axis]) > TOL, "a clamp is off its line"
            )
            i, j = (i, np.hstack([j, line])) if axis else (np.hstack([i, line]), j)
            end = tip
            if kit["travel"] is not None:
                hole = np.array([f["pegs"][m].get("hole") or (-9, -9) for f in self.fixtures])
                end = base + hole * pitch
                way = ((tip - end) * d).sum(1)
                self.blame(np.abs(cross(tip - end, d)) > TOL, "a clamp's hole is off its line")
                low, high = kit["travel"]
                self.blame((way < low - TOL) | (way > high + TOL), "a clamp's stroke")
                self.marginal |= (np.abs(way - low) < EDGE) | (np.abs(way - high) < EDGE)
                i, j = np.hstack([i, hole[:, :1]]), np.hstack([j, hole[:, 1:]])
                self.check_clamp_bodies(tip, end)
            elif any(f["pegs"][m].get("hole") is not None for f in self.fixtures):
                self.blame(np.ones(len(tip), bool), "a hole of a clamp that has no body")
            bodies.append((tip, end))
            for s in stops:
                room = measure_from_piece(self.xy[:, s], tip, end) - bench.rho - bench.tip
                self.blame(room < -TOL, "a clamp meets a locator")
                self.marginal |= np.abs(room) < EDGE
        if len(bodies) == 2:
            room = measure_gaps(*bodies) - 2 * bench.tip
            self.blame(room < -TOL, "the clamps meet each other")
            self.marginal |= np.abs(room) < EDGE
        self.blame(i.min(1) != 0, "the lowest column is not 0")
        self.check_rows(j)
        if kit["columns"] is not None:
            self.blame(i.max(1) >= kit["columns"], "a column that the plate does not have")
        asked = {tuple(sorted(d)) if self.bench.pairs else d for d in map(to_key, kit["directions"])}
        self.blame([not self.is_asked(f, asked) for f in self.fixtures], "a direction that was not asked for")

    def is_asked(self, f: dict[str, Any], asked: set[Any]) -> bool:
        """Return whether the clamps of fixture f push in directions that the file asks for.

        ``asked`` are the file's directions, or for two clamps its pairs, each sorted.
        """
        if not self.bench.pairs:
            return f["direction"] in asked
        ways = [tuple(sorted(f["directions"])), tuple(sorted(TURNED[d] for d in f["directions"]))]
        ordered = f["directions"] == sorted(f["directions"], key=list(DIRECTIONS).index)
        return ordered and (ways[0] in asked or (not self.bench.has_wall and ways[1] in asked))

    def check_clamp_bodies(self, tip: Any, end: Any) -> None:
        """Check that the body of a clamp, from its tip (N, 2) to its hole (N, 2), does not enter the part.

        399 points along each body are tested.
        """
        away = end - tip
        size = np.hypot(*away.T)
        steps = np.linspace(0, 1, 400)[1:]
        for n in np.flatnonzero(size > 1e-3):
            p = tip[n] + steps[:, None] * away[n]
            q = (p - self.shift[n]) @ self.R[n]
            room = self.bench.outline.measure_distances(q)[0].min(1) - self.bench.tip
            wrong = (room < -EDGE).any() or self.bench.outline.contains(q[[-1]]).any()
            if wrong:
                self.faults[n].append("a clamp's body enters the part")
            self.marginal[n] |= bool((np.abs(room[8:]) < EDGE).any())

    def check_closure(self) -> None:
        """Check rules 4 and 5: force closure, the clamping, and the stated forces.

        Set ``margin`` and ``force``, and ``working``, the forces at the working ratio of two clamps.
        """
        if self.bench.pairs:
            self.check_closure_by_two()
            return
        w, N = self.w, len(self.w)
        minors = [(-1) ** k * np.linalg.det(np.delete(w, k, 1)) for k in range(4)]
        lam = np.stack(minors, 1)
        total = lam.sum(1)
        flat = np.abs(total) < 1e-13
        self.lam = lam = lam / np.where(flat, 1.0, total)[:, None]
        self.blame(flat | (lam.min(1) <= 0), "no closure")
        self.marginal |= lam.min(1) < EDGE
        pegs = lam[:, 4 - len(self.roles) :]
        pushed = -(self.n * self.push).sum(-1) * pegs
        one = np.array([role in ("right", "jaw") or role in DIRECTIONS for role in self.roles])
        self.unit = pushed[:, one].sum(1)
        self.blame(self.unit <= 0, "nothing clamps")
        self.marginal |= self.unit < EDGE
        unit = np.where(self.unit == 0, 1.0, self.unit)
        self.force = lam / unit[:, None]
        said = np.array([[p["force"] for p in f["pegs"]] for f in self.fixtures], float)
        if self.bench.has_wall:
            said = np.hstack([np.array([f["wall"]["forces"] for f in self.fixtures], float), said])
        wrong = np.abs(said - self.force) > self.bound_relative_errors()[:, None] * np.maximum(
            1, np.abs(self.force)
        )
        self.blame(wrong.any(1), "a force")
        self.margin, self.spans = lam.min(1), np.zeros((N, 0))
        self.working = self.force

    def check_closure_by_two(self) -> None:
        """Check rules 3 and 4 for two clamps: force closure, no clamp holds the part alone, stated forces and
        their ratio.
        """
        w, N = self.w, len(self.w)
        A = np.swapaxes(w[:, :3], 1, 2)
        det = np.linalg.det(A)
        self.blame(np.abs(det) < 5e-7, "the locators do not fix the pose")
        self.marginal |= np.abs(det) < 1e-5
        A = np.where((np.abs(det) < 5e-7)[:, None, None], np.eye(3), A)
        push = -(self.n * self.push).sum(-1)[:, -2:]
        self.blame((push <= EDGE / 2).any(1), "a clamp does not push")
        self.marginal |= (push < 1e-5).any(1)
        push = np.where(np.abs(push) < 1e-12, 1e-12, push)
        a = np.stack([-np.linalg.solve(A, w[:, 3 + k, :, None])[..., 0] for k in (0, 1)], 1)
        z = a.min(-1) / (1 + np.abs(a).sum(-1))
        self.blame((z > EDGE).any(1), "one clamp holds the part alone")
        self.marginal |= ((np.abs(z) > 1e-9) & (np.abs(z) < EDGE)).any(1)
        b = a / push[..., None]
        b = np.where(np.abs(b) < 1e-9, 0.0, b)
        one, two = b[:, 0], b[:, 1]
        with np.errstate(divide="ignore", invalid="ignore"):
            low = np.where(two > 0, -one / two, 0.0).max(1).clip(0)
            high = np.where(two < 0, -one / two, inf).min(1)
        self.blame(~(low < high), "no closure")
        self.margin = np.array([compute_margin(x) for x in w])
        self.marginal |= self.margin < EDGE
        first, last = np.arctan(low), np.arctan(high)
        self.freedom = np.degrees(last - first)
        t = np.tan((first + last) / 2)
        force = np.zeros((N, 5, 2))
        force[:, :3] = np.swapaxes(a / push[..., None], 1, 2)
        force[:, 3, 0], force[:, 4, 1] = 1 / push[:, 0], 1 / push[:, 1]
        said = np.array([[p["force"] for p in f["pegs"]] for f in self.fixtures], float)
        if self.bench.has_wall:
            said = np.concatenate([np.array([f["wall"]["forces"] for f in self.fixtures], float), said], 1)
        slack = self.bound_relative_errors()[:, None, None] * np.maximum(1, np.abs(force))
        self.blame((np.abs(said - force) > slack).any((1, 2)), "a force")
        for n, f in enumerate(self.fixtures):
            ends = [f["ratio"][0], inf if f["ratio"][1] is None else f["ratio"][1]]
            off = [abs(atan(x) - y) for x, y in zip(ends, (first[n], last[n]), strict=True)]
            if max(off) > FIGURE_TOL:
                self.faults[n].append("the ratio of the clamps' forces")
        self.working = (force[..., 0] + t[:, None] * force[..., 1]) / (1 + t)[:, None]

    def check_figures(self) -> None:
        """Check the stated figures of quality."""
        known = {
            "closure_margin": self.margin,
            "clamp_amplification": self.working.max(1),
            "wrench_radius": measure_nearest_facet(self.w),
            "location_error": self.compute_location_errors(),
        }
        if self.bench.pairs:
            known["clamp_freedom"] = self.freedom
        loose = self.bound_relative_errors()
        for key, value in known.items():
            said = np.array([f["quality"][key] for f in self.fixtures], float)
            slack = 1e-4 if key == "clamp_freedom" else loose * np.maximum(1, np.abs(value))
            self.blame(np.isfinite(value) & (np.abs(said - value) > slack), f"the {key.replace('_', ' ')}")

    def invert_contact_matrices(self) -> Any:
        """Return the inverse (N, M, M) of each fixture's contact matrix; NaN where it is singular.

        M is 3 with two clamps, else 4.
        """
        count = 3 if self.bench.pairs else 4
        A = np.zeros((len(self.w), count, count))
        A[..., :3] = self.w[:, :count]
        if not self.bench.pairs:
            along = (self.n * self.push).sum(-1)
            moves = np.array([role in ("right", "jaw") or role in DIRECTIONS for role in self.roles])
            A[:, 4 - len(self.roles) :, 3] = np.where(moves, along, 0.0)
        good = np.abs(np.linalg.det(A)) > 1e-12
        inverse = np.full_like(A, np.nan)
        inverse[good] = np.linalg.inv(A[good])
        return inverse

    def bound_relative_errors(self) -> Any:
        """Return the relative error (N,) that is allowed in forces and figures; larger for badly conditioned
        contacts.

        For marginal fixtures it is a thousand times larger, as arcs that are one face to 1e-7 mm may differ
        in direction.
        """
        size = np.nan_to_num(np.abs(self.invert_contact_matrices()).max((1, 2)), nan=1e9)
        if self.bench.pairs:
            size = size + 1 / np.abs((self.n * self.push).sum(-1)[:, -2:]).clip(1e-9).min(1)
        return np.where(self.marginal, 1e3, 1.0) * (FIGURE_TOL + 2e-10 * size)

    def compute_location_errors(self) -> Any:
        """Return the location error (N,) in mm: how far a point of the outline can move at most within the
        tolerances.

        All combinations of extreme tolerances of the contacts are tried.

        NaN where the contact matrix is singular.
        """
        bench, outline = self.bench, self.bench.outline
        inverse = self.invert_contact_matrices()
        count = inverse.shape[1]
        walls = len(self.w[0]) - len(self.roles)
        touched = self.segment[:, : count - walls]
        if walls:
            touched = np.hstack([self.find_wall_faces(), touched])
        first = (touched[:, :, None] == touched[:, None]).argmax(-1)
        tol, best = self.bench.tolerance, np.zeros(len(inverse))
        outer = np.array(outline.loop) == 0
        points = outline.a[outer] - outline.middle
        arcs = [k for k in np.flatnonzero(outline.arc & outer) if outline.sign[k] > 0]
        for signs in product((-1, 1), repeat=2 * count):
            if signs[0] < 0:
                continue
            s = np.array(signs, float)
            delta = tol["peg"] * s[:count] + tol["face"] * s[count:][first]
            y = np.einsum("nij,nj->ni", inverse[:, :3], delta)
            t, phi = y[:, :2], y[:, 2] / bench.scale
            for p in points:
                best = np.fmax(best, np.hypot(t[:, 0] - phi * p[1], t[:, 1] + phi * p[0]))
            for k in arcs:
                c = outline.c[k] - outline.middle
                m = np.stack([t[:, 0] - phi * c[1], t[:, 1] + phi * c[0]], -1)
                e = np.stack([m[:, 1], -m[:, 0]], -1) * np.sign(phi)[:, None]
                there = outline.has_direction(k, np.arctan2(e[:, 1], e[:, 0]))
                best = np.fmax(best, np.where(there, np.hypot(*m.T) + np.abs(phi) * outline.r[k], 0.0))
        return np.where(np.isnan(inverse).any((1, 2)), np.nan, best)

    def find_wall_faces(self) -> Any:
        """Return the number of the face at each end of the contact with the wall (N, 2).

        Where the end is a corner of two faces it is -1 for the first end, -2 for the second.
        """
        outline, found = self.bench.outline, []
        down = np.einsum("nji,j->ni", self.R, np.array([0.0, -1.0]))
        for end, key in enumerate(("from", "to")):
            k = np.array([f["wall"]["segments"][end] for f in self.fixtures])
            at = np.array([f["wall"][key] for f in self.fixtures], float)
            past = outline.measure_distances(np.einsum("nji,nj->ni", self.R, at - self.shift))[1][
                np.arange(len(k)), k
            ]
            along = np.abs((outline.t[k] * down).sum(1)) < 1e-9
            alone = np.where(outline.arc[k], (past > EDGE) | outline.whole[k], along)
            found.append(np.where(alone, outline.face[k], -1 - end))
        return np.stack(found, 1)

    def compute_places(self) -> Any:
        """Return six numbers for each of P pegs (N, P, 6), by which equal fixtures are recognized, in the
        part's frame.

        They are the peg's place, its push direction, and the direction of the lattice's axis at twice its
        angle (so that half a turn of the lattice changes nothing), all in mm.
        """
        axis = np.stack([np.cos(-2 * self.theta), np.sin(-2 * self.theta)], -1)[:, None]
        axes = np.broadcast_to(axis, self.q.shape)
        return np.concatenate([self.q, self.push * self.bench.scale, axes * self.bench.scale], -1)


def to_key(direction: Any) -> Any:
    """Return a direction unchanged and a list of two directions as a tuple, so that it can be put into a
    set.
    """
    return tuple(direction) if isinstance(direction, list) else direction


def measure_from_piece(p: Any, a: Any, b: Any) -> Any:
    """Return the distance (N,) of each point p (N, 2) from the straight line segment from a (N, 2) to b (N,
    2).
    """
    along = b - a
    size = (along**2).sum(1)
    at = np.clip(((p - a) * along).sum(1) / np.where(size == 0, 1, size), 0, 1)
    return np.hypot(*(p - a - at[:, None] * along).T)


def measure_gaps(one: tuple[Any, Any], other: tuple[Any, Any]) -> Any:
    """Return the distance (N,) between two line segments in each of N pairs.

    Each segment runs along x or y and is given by its two ends (N, 2).
    """
    low = [np.minimum(*ends) for ends in (one, other)]
    high = [np.maximum(*ends) for ends in (one, other)]
    return np.hypot(*np.maximum(0, np.maximum(low[0] - high[1], low[1] - high[0])).T)


def compute_margin(w: Any) -> float:
    """Return how far five wrenches w (5, 3) are inside force closure.

    Of all factors of sum 1 with which the wrenches add up to zero, the smallest factor is made as large as
    possible; that is the result. It is -1.0 where there are no such factors.
    """
    null = np.linalg.svd(w.T)[2][3:].T
    s = null.sum(0)
    if np.hypot(*s) < 1e-12:
        return -1.0
    a, b = null @ (s / (s @ s)), null @ (np.array([-s[1], s[0]]) / np.hypot(*s))
    at = [(a[j] - a[i]) / (b[i] - b[j]) for i, j in combinations(range(5), 2) if abs(b[i] - b[j]) > 1e-14]
    return max([float((a + b * x).min()) for x in at] or [float(a.min())])


def measure_nearest_facet(w: Any) -> Any:
    """Return the distance (N,) from the origin to the nearest facet of the convex hull of P wrenches (N, P,
    3).

    It is inf where the hull has no facets.
    """
    best = np.full(len(w), inf)
    for three in combinations(range(w.shape[1]), 3):
        p = w[:, list(three)]
        n = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
        size = np.linalg.norm(n, axis=1)
        n /= np.where(size < 1e-12, 1, size)[:, None]
        side = np.einsum("nk,nmk->nm", n, w - p[:, :1])
        outside = (side > -1e-9).all(1) | (side < 1e-9).all(1)
        distance = np.abs((n * p[:, 0]).sum(1))
        best = np.where(outside & (size > 1e-12), np.minimum(best, distance), best)
    return best


# ---- the list ----------------------------------------------------------------------------------------------


class Listed:
    """The listed fixtures, with an index to look up whether a given fixture is among them."""

    def __init__(self, bench: Bench, places: list[Any]) -> None:
        self.places, self.pivot = places, bench.outline.pivot
        self.key = np.array([p.sum(0)[:2] for p in places]).reshape(-1, 2)
        self.order = np.argsort(self.key[:, 0]) if len(places) else np.zeros(0, int)
        self.sorted = self.key[self.order, 0] if len(places) else np.zeros(0)

    def find(self, place: Any, tol: float = 1e-5) -> list[int]:
        """Return the indices, ascending, of listed fixtures whose pegs have the same places as ``place``
        within ``tol`` mm.

        ``place`` (P, 6) is a row of :meth:`Batch.compute_places`.
        """
        x, y = place.sum(0)[:2]
        low, high = np.searchsorted(self.sorted, [x - 5 * tol, x + 5 * tol])
        found = []
        for n in self.order[low:high]:
            other = self.places[n]
            if abs(self.key[n, 1] - y) < 5 * tol and other.shape == place.shape:
                near = np.abs(other[:, None] - place[None]).max(-1) < tol
                if near.any(0).all() and near.any(1).all():
                    found.append(int(n))
        return sorted(found)

    def rotate_place(self, place: Any, angle: float) -> Any:
        """Return the place (P, 6) of a fixture after the part is rotated about its pivot by an angle in
        radians.
        """
        R = make_rotation(angle)
        moved = (place[:, :2] - self.pivot) @ R.T + self.pivot
        return np.concatenate([moved, place[:, 2:4] @ R.T, place[:, 4:] @ (R @ R).T], 1)


def make_order_key(f: dict[str, Any]) -> Any:
    """Return the sort key of fixture f in the order that the format requires."""
    pegs, pose = f["pegs"], f["pose"]
    return (
        f["type"],
        list(f.get("directions", [f.get("direction", "")])),
        [(p.get("column", -1), p.get("row", -1)) for p in pegs],
        (pose["theta_deg"], pose["x"], pose["y"]),
        [p["segment"] for p in pegs],
    )


def find_account_faults(content: dict[str, Any]) -> list[str]:
    """Return a list of sentences on counts, order and the account of the search that do not agree; empty
    where all do.
    """
    fixtures, proof, faults = content["fixtures"], content["proof"], []
    for name, count in content["counts"].items():
        listed = sum(f["type"] == name for f in fixtures)
        if listed != count:
            faults.append(f"counts say {count} of type {name}, listed are {listed}")
    if {f["type"] for f in fixtures} - set(content["counts"]):
        faults.append("counts leave out a type")
    if not isinstance(proof, dict) or any(type(proof.get(key)) is not int for key in ACCOUNT):
        return [*faults, "the account of the search is missing"]
    if any(proof[key] < 0 for key in ACCOUNT):
        faults.append("a number of the account is negative")
    if proof.get("undecided") != []:
        faults.append("the account has undecided candidates: such a list is not a complete one")
    if proof["discarded_by_bound"] + proof["verified"] != proof["candidates"]:
        faults.append("candidates are not those discarded and those verified")
    if content["toolkit"].get("clamps") != 2 and proof["verified"] < len(fixtures):
        faults.append("fewer candidates are verified than fixtures listed")
    if proof["escalated"] > proof["candidates"]:
        faults.append("more candidates escalated than there are")
    if content["statistics"].get("contacts_examined", 0) < 0.5 * len(fixtures) * (
        content["toolkit"].get("clamps") != 2
    ):
        faults.append("fewer contacts examined than fixtures listed")
    if [*content["fixtures"]] != sorted(fixtures, key=make_order_key):
        faults.append("the fixtures are not in order")
    return faults


def find_manifest_faults(content: dict[str, Any], text: str, manifest: dict[str, Any]) -> list[str]:
    """Return a list of sentences on what differs from the manifest: checksums and counts.

    ``text`` is the file's text, from which checksums are computed.
    """
    known = {one["name"]: one for one in manifest["sets"]}
    if content["set"] not in known:
        return [f"the manifest has no set {content['set']!r}"]
    entry, faults = known[content["set"]], []
    lines = [line.rstrip(",") for line in text.splitlines() if line.startswith('{"type"')]
    if sha256("\n".join(lines).encode()).hexdigest() != entry["sums"]["fixtures"]:
        faults.append("the checksum of the fixtures is not that of the manifest")
    if sha256(text.encode()).hexdigest() != entry["sums"]["file"]:
        faults.append("the checksum of the file is not that of the manifest")
    if content["counts"] != entry["counts"]:
        faults.append("the counts are not those of the manifest")
    return faults


# ---- fixtures that this program finds by itself ------------------------------------------------------------


class Finder:
    """A search for fixtures from random starts.

    The pose is improved by Newton's method until the contacts that fix it touch.
    """

    def __init__(self, bench: Bench, seed: int) -> None:
        self.bench, self.outline, self.random = bench, bench.outline, np.random.default_rng(seed)
        reach = bench.outline.diameter + 2 * bench.rho
        most = (reach / bench.pitch).astype(int)
        limits = [bench.kit["columns"], bench.kit["rows"]]
        most = [m if limit is None else min(m, limit - 1) for m, limit in zip(most, limits, strict=True)]
        grid = product(range(-most[0], most[0] + 1), range(-most[1], most[1] + 1))
        self.offsets = np.array([o for o in grid if o != (0, 0)], float).reshape(-1, 2)

    def sample_locus(self, count: int) -> tuple[Any, Any]:
        """Return (1) the centres (M, 2) of pegs that touch the part at random places, (2) the indices (M,) of
        the segments touched.

        M is at most ``count``, since places where the peg would enter the part are left out.
        """
        outline, rho = self.outline, self.bench.rho
        size = np.where(outline.arc, np.abs(outline.sweep) * outline.r, outline.length)
        k = self.random.choice(
            len(size), count, p=(size + 0.02 * size.sum()) / (size + 0.02 * size.sum()).sum()
        )
        at = self.random.random(count)
        line = outline.a[k] + (at * outline.length[k])[:, None] * outline.t[k]
        angle = outline.a0[k] + at * outline.sweep[k]
        round_ = outline.c[k] + outline.r[k][:, None] * np.stack([np.cos(angle), np.sin(angle)], -1)
        p = np.where(outline.arc[k][:, None], round_, line)
        n = outline.compute_normals(np.where(outline.arc[k][:, None], round_, line), k)
        q = p + rho * n
        good = (outline.measure_distances(q)[0].min(1) > rho - 1e-9) & ~outline.contains(q)
        return q[good], k[good]

    def choose_near_holes(self, q: Any, theta: Any, offsets: Any) -> tuple[Any, Any]:
        """Return for each of N starts (1) the offset (N, 2) of a random hole, (2) the index (N,) of the
        segment nearest to it.

        Holes in which a peg nearly touches the part are chosen more often. ``q`` (N, 2) are the first pegs'
        places, ``theta`` (N,) orientations in radians, and ``offsets`` (H, 2) the holes to choose from, in
        columns and rows from the first peg.
        """
        p = q[:, None] + np.einsum("nji,hj->nhi", make_rotation(theta), offsets * self.bench.pitch)
        distance, _ = self.outline.measure_distances(p.reshape(-1, 2))
        distance = distance.reshape(*p.shape[:2], -1)
        room = np.abs(distance.min(-1) - self.bench.rho)
        weight = np.exp(-((room / (0.25 * self.bench.pitch.min())) ** 2)) + 1e-9
        pick = (weight.cumsum(1) > (self.random.random(len(q)) * weight.sum(1))[:, None]).argmax(1)
        return offsets[pick], distance[np.arange(len(q)), pick].argmin(-1)

    def refine_unknowns(self, unknown: Any, holes: Any, rights: Any, segments: Any) -> Any:
        """Return (1) the unknowns improved by Newton's method, and (2) whether each start converged (N,).

        Parameters
        ----------
        unknown : (N, 3 or 4) orientation in radians, the first peg's place, and the opening, in mm.
        holes : (N, M, 2) offset of each peg from the first peg, in columns and rows.
        rights : (N, M) 1 for pegs that move with the opening, else 0.
        segments : (N, M) index of the segment that each peg touches.
        """
        rho, pitch, outline = self.bench.rho, self.bench.pitch, self.outline
        moves = unknown.shape[1] == 4
        for _ in range(12):
            theta = unknown[:, 0]
            away = holes * pitch
            if moves:
                away = away + rights[..., None] * np.stack([unknown[:, 3], 0 * theta], -1)[:, None]
            q = unknown[:, None, 1:3] + np.einsum("nji,nmj->nmi", make_rotation(theta), away)
            flatq, k = q.reshape(-1, 2), segments.reshape(-1)
            n = outline.compute_normals(flatq, k)
            v = flatq - outline.c[k]
            round_ = outline.sign[k] * (np.hypot(*v.T) - outline.r[k])
            gap = np.where(outline.arc[k], round_, ((flatq - outline.a[k]) * n).sum(1)) - rho
            n, gap = n.reshape(q.shape), gap.reshape(q.shape[:2])
            spin = np.einsum(
                "nji,nmj->nmi", make_rotation(theta), np.stack([away[..., 1], -away[..., 0]], -1)
            )
            J = [(n * spin).sum(-1), n[..., 0], n[..., 1]]
            if moves:
                u = np.einsum("nji,j->ni", make_rotation(theta), np.array([1.0, 0.0]))
                J.append(rights * (n * u[:, None]).sum(-1))
            matrix = np.stack(J, -1)
            singular = np.abs(np.linalg.det(matrix)) < 1e-9
            matrix = np.where(singular[:, None, None], np.eye(matrix.shape[1]), matrix)
            step = np.linalg.solve(matrix, gap[..., None])[..., 0]
            unknown = unknown - np.clip(step, -5, 5) * ~singular[:, None]
        return unknown, (np.abs(gap).max(1) < 1e-10) & ~singular

    def find_fixtures(self, count: int) -> Fixtures:
        """Return the fixtures found from ``count`` random starts; an empty list for toolkits with a wall.

        They have those keys of the file that are needed to judge them.
        """
        if self.bench.has_wall or not len(self.offsets):
            return []
        q, k = self.sample_locus(count)
        theta = self.random.random(len(q)) * 2 * pi
        if self.bench.kind == "translating-clamp":
            return self.find_plate_fixtures(q, k, theta)
        return [*self.find_vise_fixtures(q, k, theta, "I"), *self.find_vise_fixtures(q, k, theta, "II")]

    def find_vise_fixtures(self, q: Any, k: Any, theta: Any, kind: str) -> Fixtures:
        """Return fixtures of a vise found from N starts; ``kind`` is their type, "I" or "II".

        A start is the place q (N, 2) of the first peg, the index k (N,) of the segment that it touches, and
        an orientation theta (N,) in radians.
        """
        bench, N = self.bench, len(q)
        zero = np.zeros((N, 2))
        columns = np.abs(self.offsets[:, 0]) < bench.kit["columns"]
        two, k2 = self.choose_near_holes(q, theta, self.offsets[columns])
        lift = bench.kit["row_offset"] / bench.pitch[1]
        span = int((self.outline.diameter + 2 * bench.rho) / bench.pitch[1]) + 1
        row = self.random.integers(-span, span + 1, N) + lift
        S, k3, good = np.zeros(N), np.zeros(N, int), np.zeros(N, bool)
        for n in range(N):
            R = make_rotation(theta[n])
            hits = self.outline.find_hits(
                q[n] + R.T @ np.array([0.0, row[n] * bench.pitch[1]]), R.T @ np.array([1.0, 0.0]), bench.rho
            )
            hits = [hit for hit in hits if hit[0] > bench.kit["min_gap"] * 0.5]
            if hits:
                S[n], k3[n] = hits[self.random.integers(len(hits))]
                good[n] = True
        right = np.stack([np.zeros(N), row], -1)
        if kind == "I":
            there = q + np.einsum(
                "nji,nj->ni", make_rotation(theta), right * bench.pitch + np.stack([S, 0 * S], -1)
            )
            four, k4 = self.choose_near_holes(there, theta, self.offsets[columns])
            holes = np.stack([zero, two, right, right + four], 1)
            rights = np.tile([0.0, 0.0, 1.0, 1.0], (N, 1))
            segments = np.stack([k, k2, k3, k4], 1)
        else:
            three, k4 = self.choose_near_holes(q, theta, self.offsets[columns])
            holes = np.stack([zero, two, three, right], 1)
            rights = np.tile([0.0, 0.0, 0.0, 1.0], (N, 1))
            segments = np.stack([k, k2, k4, k3], 1)
        start = np.column_stack([theta, q, S])[good]
        end, converged = self.refine_unknowns(start, holes[good], rights[good], segments[good])
        made = []
        for x, h, s in zip(end[converged], holes[good][converged], segments[good][converged], strict=True):
            made.append(self.make_vise_fixture(kind, x, h, s, lift))
        return [one for one in made if one is not None]

    def make_vise_fixture(
        self, kind: str, x: Any, holes: Any, segments: Any, lift: float
    ) -> dict[str, Any] | None:
        """Return a fixture of a vise, in the columns and rows that the format requires; None where it does
        not fit.

        ``x`` is the orientation in radians, the first peg's place and the opening; ``holes`` (4, 2) are
        offsets in columns and rows; ``segments`` (4,) are the indices of those touched; ``lift`` is the row
        offset of the right jaw in rows.
        """
        kit, pitch, left = self.bench.kit, self.bench.pitch, 2 if kind == "I" else 3
        i = np.rint(holes[:, 0]).astype(int)
        j = np.rint(holes[:, 1] - lift * (np.arange(4) >= left)).astype(int)
        c, low = kit["columns"], j.min()
        shift = c - 1 - i[:left].max()
        i, j = np.r_[i[:left] + shift, i[left:] - i[left:].min()], j - low
        if i.min() < 0 or i.max() >= c or (kit["rows"] is not None and j.max() >= kit["rows"]):
            return None
        first = np.array([i[0], j[0]]) * pitch
        R = make_rotation(x[0])
        pose = first - R @ x[1:3]
        S = x[3] + first[0] + (holes[left, 0] - i[left]) * pitch[0] - (c - 1) * pitch[0]
        if kit["max_opening"] is not None and kit["max_opening"] - EDGE < S:
            return None
        pegs = []
        for m in range(4):
            at = np.array([i[m], j[m]]) * pitch
            if m >= left:
                at = at + np.array([(c - 1) * pitch[0] + S, kit["row_offset"]])
            face = int(self.outline.face[segments[m]])
            name = {"jaw": "left" if m < left else "right"}
            pegs.append(
                {**name, "column": int(i[m]), "row": int(j[m]), "x": at[0], "y": at[1], "segment": face}
            )
        return {"type": kind, "pegs": pegs, "pose": self.make_pose_entry(x[0], pose), "jaw_separation": S}

    def make_pose_entry(self, theta: float, shift: Any) -> dict[str, float]:
        """Return a pose as the file has it, from an orientation in radians and a shift in mm."""
        return {"theta_deg": degrees(theta) % 360, "x": float(shift[0]), "y": float(shift[1])}

    def find_plate_fixtures(self, q: Any, k: Any, theta: Any) -> Fixtures:
        """Return fixtures of a plate found from N starts, with all possible clamps for each pose that three
        locators fix.

        A start is the place q (N, 2) of the first peg, the index k (N,) of the segment that it touches, and
        an orientation theta (N,) in radians.
        """
        two, k2 = self.choose_near_holes(q, theta, self.offsets)
        three, k3 = self.choose_near_holes(q, theta, self.offsets)
        holes = np.stack([np.zeros_like(two), two, three], 1)
        segments = np.stack([k, k2, k3], 1)
        end, good = self.refine_unknowns(
            np.column_stack([theta, q]), holes, np.zeros(holes.shape[:2]), segments
        )
        made: Fixtures = []
        for x, h, s in zip(end[good], holes[good], segments[good], strict=True):
            if len({tuple(o) for o in h}) == 3:
                made += self.list_clampings(x, h, s)
        return made

    def list_clampings(self, x: Any, holes: Any, segments: Any) -> Fixtures:
        """Return one fixture for each possible choice of clamps at a pose, where it fits the plate.

        ``x`` is the orientation in radians and the first locator's place; ``holes`` (3, 2) are offsets in
        columns and rows; ``segments`` (3,) are the indices of those that the locators touch.
        """
        bench, kit, pitch = self.bench, self.bench.kit, self.bench.pitch
        R, made, options = make_rotation(x[0]), [], []
        first = holes[0] * pitch
        shift = first - R @ x[1:3]
        ways = {d for one in kit["directions"] for d in ([one] if isinstance(one, str) else one)}
        span = ((self.outline.diameter + 2 * bench.rho) / pitch).astype(int) + 1
        for role in sorted(ways):
            axis = 1 if role[1] == "x" else 0
            d = np.array(DIRECTIONS[role])
            for line in range(-span[axis], span[axis] + 1):
                base = np.zeros(2)
                base[axis] = line * pitch[axis]
                for s, seg in self.outline.find_hits(R.T @ (base - shift), R.T @ np.abs(d), bench.tip):
                    options.append((role, line, base + s * np.abs(d), int(self.outline.face[seg])))
        chosen = combinations(options, 2) if bench.pairs else ((one,) for one in options)
        asked = {tuple(sorted(p)) for p in kit["directions"]} if bench.pairs else set()
        for clamps in chosen:
            if bench.pairs and tuple(sorted(c[0] for c in clamps)) not in asked:
                continue
            made.append(self.make_plate_fixture(clamps, x, holes, segments, shift))
        return [one for one in made if one is not None]

    def make_plate_fixture(
        self, clamps: Any, x: Any, holes: Any, segments: Any, shift: Any
    ) -> dict[str, Any] | None:
        """Return a fixture of a plate, shifted so that its lowest column and row are 0; None where the plate
        is too small.

        Each of ``clamps`` is (direction, index of the line, tip, face), and ``shift`` is the part's in mm.
        See :meth:`list_clampings` for the other parameters.
        """
        kit, pitch = self.bench.kit, self.bench.pitch
        clamps = sorted(clamps, key=lambda c: (list(DIRECTIONS).index(c[0]), c[1], c[3]))
        i = [*holes[:, 0], *(c[1] for c in clamps if c[0][1] == "y")]
        j = [*holes[:, 1], *(c[1] for c in clamps if c[0][1] == "x")]
        low = np.array([min(i), min(j)])
        for values, key in ((i, "columns"), (j, "rows")):
            if kit[key] is not None and max(values) - min(values) >= kit[key]:
                return None
        pegs: Fixtures = []
        for h, s in zip(holes - low, segments, strict=True):
            at, face = h * pitch, int(self.outline.face[s])
            hole = {"column": round(h[0]), "row": round(h[1])}
            pegs.append({"role": "locator", **hole, "x": at[0], "y": at[1], "segment": face})
        for role, line, tip, face in clamps:
            at, key = tip - low * pitch, "row" if role[1] == "x" else "column"
            place = {key: int(line - low[1 if role[1] == "x" else 0])}
            pegs.append(
                {"role": "clamp", "direction": role, **place, "x": at[0], "y": at[1], "segment": face}
            )
        ways = [c[0] for c in clamps]
        said = {"directions": ways} if self.bench.pairs else {"direction": ways[0]}
        kind = "clamp2" if self.bench.pairs else "clamp"
        return {"type": kind, **said, "pegs": pegs, "pose": self.make_pose_entry(x[0], shift - low * pitch)}


class WallFinder:
    """A search for every fixture beside a fence, without random starts.

    Each hull edge of the part gives one orientation; contacts then follow in closed form.
    """

    def __init__(self, bench: Bench) -> None:
        self.bench, self.outline = bench, bench.outline
        self.clamping = Finder(bench, 0)

    def find_flush_poses(self) -> list[tuple[float, float, float, float]]:
        """Return for each hull edge (theta, height, x0, x1): how the part lies with this edge flat on the
        wall.

        ``theta`` is its orientation in radians. ``height`` is that of the part's origin above the wall, and
        x0 and x1 are the ends of the contact for an origin at x = 0, all in mm.
        """
        o = self.outline
        arcs = [k for k in np.flatnonzero(o.arc) if o.sign[k] > 0]
        discs = [(*p, 0.0, -1) for p in o.a] + [(*o.c[k], o.r[k], k) for k in arcs]
        found: list[tuple[float, float, float, float]] = []
        for one, two in product(discs, discs):
            v = np.array(two[:2]) - np.array(one[:2])
            size = np.hypot(*v)
            if size <= abs(one[2] - two[2]) + EDGE:
                continue
            # The common tangent that has both on its left.
            along = np.arctan2(v[1], v[0]) - np.arcsin((two[2] - one[2]) / size)
            n = np.array([np.sin(along), -np.cos(along)])
            t = np.array([-n[1], n[0]])
            if any(k >= 0 and not o.has_direction(k, np.arctan2(n[1], n[0])) for k in (one[3], two[3])):
                continue
            heights = [float(n @ p) for p in o.a]
            heights += [
                float(n @ o.c[k]) + o.r[k] for k in arcs if o.has_direction(k, np.arctan2(n[1], n[0]))
            ]
            top = float(n @ np.array(one[:2])) + one[2]
            if max(heights) > top + TOL:
                continue
            at = [float(t @ np.array(p[:2])) for p in discs if self.reaches(p, n, top)]
            edge = (float(-along % (2 * pi)), top, min(at), max(at))
            new = all(abs(np.sin((edge[0] - other[0]) / 2)) > 1e-7 for other in found)
            if edge[3] - edge[2] > EDGE and new:
                found.append(edge)
        return found

    def reaches(self, disc: Any, n: Any, top: float) -> bool:
        """Return whether a corner or an arc touches the line n . q = top.

        ``disc`` is (x, y, radius, index of the arc, or -1 for a corner).
        """
        on = disc[3] < 0 or self.outline.has_direction(disc[3], np.arctan2(n[1], n[0]))
        return bool(on and abs(float(n @ np.array(disc[:2])) + disc[2] - top) < TOL)

    def find_fixtures(self) -> Fixtures:
        """Return all fixtures beside the fence, with those keys of the file that are needed to judge them.

        Some may break rules, so they must be judged.
        """
        bench, kit, pitch, made = self.bench, self.bench.kit, self.bench.pitch, list[dict[str, Any]]()
        rows = kit["rows"] or int((self.outline.diameter + 2 * bench.rho) / pitch[1]) + 2
        for theta, top, x0, x1 in self.find_flush_poses():
            R = make_rotation(theta)
            for row in range(rows):
                y = bench.base[1] + row * pitch[1]
                start = np.array([0.0, y - top])
                for x, segment in self.outline.find_hits(R.T @ start, R.T @ np.array([1.0, 0.0]), bench.rho):
                    shift = np.array([-x, top])
                    made += self.list_with_clamps(
                        R, theta, shift, (row, int(self.outline.face[segment])), (x0 - x, x1 - x)
                    )
        return made

    def list_with_clamps(self, R: Any, theta: float, shift: Any, stop: Any, ends: Any) -> Fixtures:
        """Return one fixture for each possible choice of clamps, with the locator in the hole at x = 0.

        ``R`` and ``theta`` are the part's rotation as a matrix and in radians, ``shift`` is its shift in mm.
        ``stop`` is the locator's row and the index of the segment it touches; ``ends`` are the x of both ends
        of the contact with the wall in mm.
        """
        bench, kit, pitch, options = self.bench, self.bench.kit, self.bench.pitch, []
        ways = {d for one in kit["directions"] for d in ([one] if isinstance(one, str) else one)}
        span = ((self.outline.diameter + 2 * bench.rho) / pitch).astype(int) + 2
        for role in sorted(ways):
            axis, d = (1 if role[1] == "x" else 0), np.abs(np.array(DIRECTIONS[role]))
            for line in range(0 if axis else -span[0], span[axis] + 1):
                base = bench.base * axis
                base = base + (1 - d) * line * pitch
                for s, seg in self.outline.find_hits(R.T @ (base - shift), R.T @ d, bench.tip):
                    options.append((role, line, base + s * d, int(self.outline.face[seg])))
        asked = {tuple(sorted(p)) for p in kit["directions"]} if bench.pairs else set()
        made = []
        for clamps in combinations(options, 2) if bench.pairs else ((one,) for one in options):
            if bench.pairs and tuple(sorted(c[0] for c in clamps)) not in asked:
                continue
            low = min([0, *(c[1] for c in clamps if c[0][1] == "y")])
            made.append(
                self.make_fixture(sorted(clamps, key=self.make_order_key), theta, shift, stop, ends, low)
            )
        return [one for one in made if one is not None]

    def make_order_key(self, clamp: Any) -> Any:
        """Return the sort key of a clamp (direction, index of the line, tip, face) among the clamps of a
        fixture.
        """
        return list(DIRECTIONS).index(clamp[0]), clamp[1], clamp[3]

    def make_fixture(
        self, clamps: Any, theta: float, shift: Any, stop: Any, ends: Any, low: int
    ) -> dict[str, Any] | None:
        """Return a fixture shifted so that column ``low`` becomes column 0; None where the plate has too few
        columns or rows.

        Each of ``clamps`` is (direction, index of the line, tip, face), in the order of the file. See
        :meth:`list_with_clamps` for the other parameters.
        """
        kit, away = self.bench.kit, -low * self.bench.pitch[0]
        columns = [0, *(c[1] for c in clamps if c[0][1] == "y")]
        rows = [stop[0], *(c[1] for c in clamps if c[0][1] == "x")]
        for values, lowest, key in ((columns, low, "columns"), (rows, 0, "rows")):
            if kit[key] is not None and max(values) - lowest >= kit[key]:
                return None
        y = self.bench.base[1] + stop[0] * self.bench.pitch[1]
        pegs: Fixtures = [
            {"role": "locator", "column": -low, "row": stop[0], "x": away, "y": y, "segment": stop[1]}
        ]
        for role, line, tip, face in clamps:
            place = {"row": line} if role[1] == "x" else {"column": line - low}
            at = {"x": tip[0] + away, "y": tip[1], "segment": face}
            pegs.append({"role": "clamp", "direction": role, **place, **at})
        zero: Any = [[0.0, 0.0]] * 2 if self.bench.pairs else [0.0, 0.0]
        wall = {"from": [ends[0] + away, 0.0], "to": [ends[1] + away, 0.0], "forces": zero}
        ways = [c[0] for c in clamps]
        said = {"directions": ways} if self.bench.pairs else {"direction": ways[0]}
        kind = "edge2" if self.bench.pairs else "edge"
        pose = self.clamping.make_pose_entry(theta, shift + np.array([away, 0.0]))
        return {"type": kind, **said, "pegs": pegs, "pose": pose, "wall": wall}


class Unlisted(Batch):
    """Fixtures that this program found itself, checked without stated forces and figures."""

    def check_figures(self) -> None:
        """Do nothing, since no figures are stated."""

    def check_closure(self) -> None:
        """Check rules 4 and 5 except for the stated forces."""
        zero = [0.0, 0.0] if self.bench.pairs else 0.0
        for f in self.fixtures:
            for peg in f["pegs"]:
                peg["force"] = zero
            f["ratio"] = [0.0, None]
        super().check_closure()
        ignored = ("a force", "the ratio of the clamps' forces")
        self.faults = [[words for words in one if words not in ignored] for one in self.faults]


def group_by_roles(bench: Bench, fixtures: Fixtures) -> dict[Any, list[int]]:
    """Return the indices of fixtures in groups; the key of a group is the type followed by the roles of the
    pegs.
    """
    out: dict[Any, list[int]] = {}
    for n, f in enumerate(fixtures):
        out.setdefault((f["type"], *bench.list_roles(f)), []).append(n)
    return out


def find_missing_fixtures(bench: Bench, listed: Listed, starts: int, seed: int) -> tuple[list[str], int]:
    """Return (1) at most five sentences on fixtures found here but not listed, (2) how many listed fixtures
    were found.

    Nothing is searched if ``starts`` is 0, if the clamps have bodies, or if holes are blocked; the result is then
    an empty list and 0.
    """
    if starts == 0 or (bench.kit.get("travel") is not None) or bench.kit.get("blocked"):
        return [], 0
    faults, seen = [], set()
    fence = bench.kind == "edge"
    found = WallFinder(bench).find_fixtures() if fence else Finder(bench, seed).find_fixtures(starts)
    for members in group_by_roles(bench, found).values():
        batch = Unlisted(bench, [found[n] for n in members])
        batch.judge()
        for n, place in enumerate(batch.compute_places()):
            if batch.faults[n] or batch.marginal[n] or batch.margin[n] < 1e-5:
                continue
            where = listed.find(place)
            seen.update(where)
            if not where:
                pose = batch.fixtures[n]["pose"]
                faults.append(
                    f"a fixture is missing: type {batch.fixtures[n]['type']} at theta {pose['theta_deg']:.6f}"
                )
    return sorted(set(faults))[:5], len(seen)


def check(
    content: Any,
    text: str = "",
    manifest: Any = None,
    starts: int = 400,
    seed: int = 1,
    notes: list[str] | None = None,
) -> list[str]:
    """Return the faults of a file's content, one sentence each; empty where there are none.

    Parameters
    ----------
    text : of the file, for its checksums.
    manifest : content of the manifest; None to leave checksums out.
    starts : random starts of the search for missing fixtures; 0 for no search.
    seed : of the random starts.
    notes : a list to which remarks are appended; None for none.
    """
    faults = find_set_form_faults(content)
    if faults:
        return faults
    bench, fixtures = Bench(content), content["fixtures"]
    for n, fixture in enumerate(fixtures):
        faults += [f"fixture {n + 1}: {words}" for words in find_form_faults(bench, fixture)]
    if faults:
        return faults
    faults = find_account_faults(content)
    rotations = bench.outline.find_rotations()
    places: list[Any] = [None] * len(fixtures)
    marginal = np.zeros(len(fixtures), bool)
    for members in group_by_roles(bench, fixtures).values():
        batch = Batch(bench, [fixtures[n] for n in members])
        batch.judge()
        for n, words, place, edge in zip(
            members, batch.faults, batch.compute_places(), batch.marginal, strict=True
        ):
            places[n], marginal[n] = place, edge
            faults += [f"fixture {n + 1}: {one}" for one in dict.fromkeys(words)]
    listed = Listed(bench, places)
    parent = list(range(len(fixtures)))
    for n, place in enumerate(places):
        faults += [f"fixture {m + 1} is fixture {n + 1} again" for m in listed.find(place) if m > n]
        for angle in rotations[1:]:
            images = listed.find(listed.rotate_place(place, angle), 1e-4)
            if not images and not marginal[n]:
                faults.append(f"fixture {n + 1} is listed without its image under a rotation of the part")
            for image in images:
                parent[find_root(parent, image)] = find_root(parent, n)
    for name, count in content["distinct"].items():
        sets = {find_root(parent, n) for n, f in enumerate(fixtures) if f["type"] == name}
        if len(sets) != count and not marginal.any():
            faults.append(f"distinct says {count} of type {name}, there are {len(sets)}")
    missing, met = find_missing_fixtures(bench, listed, starts, seed)
    faults += missing
    if notes is not None and fixtures:
        how = "in closed form" if bench.kind == "edge" else f"from {starts} random starts"
        by_itself = f"a search {how} met {met} of the {len(fixtures)} fixtures by itself"
        notes.append(by_itself if met else "nothing was searched for: completeness rests on the manifest")
    return faults + (find_manifest_faults(content, text, manifest) if manifest else [])


def find_root(parent: list[int], n: int) -> int:
    """Return the representative of the set that contains n in a union-find forest.

    ``parent`` has for each member its parent; paths in it are shortened in place.
    """
    while parent[n] != n:
        parent[n] = parent[parent[n]]
        n = parent[n]
    return n


def main() -> int:
    """Check the file named on the command line, and write its faults.

    Return the exit code: 0 where there are none, else 2, also for a file that cannot be read.
    """
    words = argparse.ArgumentParser(description="Checks one file of the benchmark set.")
    words.add_argument("file")
    words.add_argument("--manifest", help="the manifest, whose checksums then count")
    words.add_argument(
        "--starts", type=int, default=400, help="random starts of the search for missing fixtures"
    )
    words.add_argument("--seed", type=int, default=1)
    asked = words.parse_args()
    try:
        text = Path(asked.file).read_text(encoding="utf-8")
        content = json.loads(text)
        manifest = json.loads(Path(asked.manifest).read_text(encoding="utf-8")) if asked.manifest else None
    except (OSError, ValueError) as error:
        sys.stdout.write(f"{asked.file} cannot be read: {error}\n")
        return 2
    notes: list[str] = []
    faults = check(content, text, manifest, asked.starts, asked.seed, notes)
    for sentence in faults[:20]:
        sys.stdout.write(f"{sentence}\n")
    if len(faults) > 20:
        sys.stdout.write(f"and {len(faults) - 20} more\n")
    for sentence in notes:
        sys.stdout.write(f"{sentence}\n")
    count = (
        len(content["fixtures"])
        if isinstance(content, dict) and isinstance(content.get("fixtures"), list)
        else 0
    )
    sys.stdout.write(
        f"{asked.file}: {count} fixtures, {'holds' if not faults else f'{len(faults)} faults'}\n"
    )
    return 2 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
