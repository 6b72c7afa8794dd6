"""How good is what a rule of thumb finds, beside the complete list: for every set of the benchmark.

    python benchmarks/how_good.py      # writes docs/figures/how-good.json, how-good-location.svg and how-good-force.svg

The rule is 3-2-1 at the widest. Two locators go on the longest straight side they both fit, as far apart as the holes allow;
a third on the longest other side; what clamps comes from opposite the long side. A wall takes the longest hull edge it can.
Where several fixtures are left the one with the least location error is taken, which flatters the rule.

Glossary
--------
picked : the fixture that the rule leaves.
gain : the figure of the picked one over the least of the complete list; 1 is not a gain.
dominated : the list has a fixture with less location error and less force than the picked one, by 5 % each.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np

from line_plot import CALLED, Bar, bar_plot
from workhold.benchmark.catalogue import SetEntry, find_set, load_manifest, load_sets, make_set_query
from workhold.geometry.segment import Line
from workhold.model.fixture_table import FixtureTable, compute_peg_places
from workhold.model.quality import CLAMP_AMPLIFICATION, LOCATION_ERROR
from workhold.model.query import Query
from workhold.model.result import Result
from workhold.search.design import answer
from workhold.seating.solver import seatings
from workhold.statics.contact_matrix import TouchableFeatures

ROOT = Path(__file__).resolve().parent.parent
FIGURES = ROOT / "docs" / "figures"
SAME, BETTER = 1e-6, 0.95
# Of each vise's set the seating of so many fixtures is looked at, the best by location error.
LOOKED_AT = 12
CAPTURE_ALWAYS = 1000.0
Array = Any


def main() -> None:
    """Measure every set; write data and plots."""
    rows = []
    for entry in load_sets():
        if entry.size:
            rows.append(measured(entry))
            sys.stdout.write(f"{json.dumps(rows[-1])}\n")
    seated = seated_rows([row for row in rows if row["kind"] == "vise" and row["by_rule"]])
    by_kind = grouped(rows, "kind")
    by_family = grouped(rows, "family")
    content = {
        "command": "python benchmarks/how_good.py",
        "cpu_seconds": round(process_time()),
        "all": summary(rows),
        "kinds": by_kind,
        "families": by_family,
        "seating": seated,
        "sets": rows,
    }
    (FIGURES / "how-good.json").write_text(as_text(content), encoding="utf-8")
    for name, key, words in (
        ("location", "gain_location", "location error of the rule of thumb over the best of the list"),
        ("force", "gain_force", "largest force of the rule of thumb over the least of the list"),
    ):
        bars = [bar_of(group, one, key) for groups in (by_kind, by_family) for group, one in groups.items()]
        svg = bar_plot(bars, f"Gain of the complete list: {words}", words, 10.0)
        (FIGURES / f"how-good-{name}.svg").write_text(svg, encoding="utf-8")


def as_text(content: Mapping[str, Any]) -> str:
    """JSON with one set in a line."""
    head = {key: value for key, value in content.items() if key != "sets"}
    lines = ",\n".join(json.dumps(row) for row in content["sets"])
    return json.dumps(head)[:-1] + f', "sets": [\n{lines}\n]}}\n'


def bar_of(name: str, group: Mapping[str, Any], key: str) -> Bar:
    """The bar of a group: the median gain, with the quarter on either side of it."""
    low, middle, high = group[key]
    return Bar(name, middle, low, high, f"{middle:.2f}")


def grouped(rows: Sequence[Mapping[str, Any]], key: str) -> dict[str, dict[str, Any]]:
    """The summaries of the rows by what they say of a key."""
    names = list(dict.fromkeys(row[key] for row in rows))
    return {name: summary([row for row in rows if row[key] == name]) for name in names}


def summary(rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """What several sets have in common: how many there are, and quartiles of the gains where the rule finds anything."""
    found = [row for row in rows if row["by_rule"]]
    out: dict[str, Any] = {"sets": len(rows), "rule_finds_none": len(rows) - len(found)}
    for key in ("gain_location", "gain_force"):
        values = [row[key] for row in found] or [1.0]
        out[key] = [round(float(value), 4) for value in np.percentile(values, [25, 50, 75])]
    out["no_gain_location"] = sum(row["gain_location"] < 1.01 for row in found)
    out["no_gain_force"] = sum(row["gain_force"] < 1.01 for row in found)
    out["dominated"] = sum(row["dominated"] for row in found)
    return out


def measured(entry: SetEntry) -> dict[str, Any]:
    """What the rule finds in a set, and what the list gains over it."""
    query = make_set_query(entry)
    table = answer(query, threads=1).table
    picked = by_rule(query, table)
    error, force = table.quality[:, LOCATION_ERROR], table.quality[:, CLAMP_AMPLIFICATION]
    family = load_manifest()["workpieces"][entry.part]["family"]
    row: dict[str, Any] = {
        "set": entry.name,
        "kind": words_of(query),
        "family": family,
        "fixtures": entry.size,
        "by_rule": len(picked),
    }
    if len(picked) == 0:
        return row
    one = picked[np.argmin(error[picked])]
    better = (error < BETTER * error[one]) & (force < BETTER * force[one])
    row |= {
        "place_by_location": int((error < error[one] * (1 - SAME)).sum()) + 1,
        "place_by_force": int((force < force[one] * (1 - SAME)).sum()) + 1,
        "location_error": [significant(error[one]), significant(error.min())],
        "force": [significant(force[one]), significant(force.min())],
        "gain_location": round(float(error[one] / error.min()), 4),
        "gain_force": round(float(force[one] / force.min()), 4),
        "dominated": bool(better.any()),
    }
    return row


def significant(value: float) -> float:
    """A figure with five digits."""
    return float(f"{value:.5g}")


def words_of(query: Query) -> str:
    """The kind of a toolkit, with two clamps said."""
    return CALLED[query.toolkit.kind] + (", two clamps" if query.toolkit.tip_count > 1 else "")


def by_rule(query: Query, table: FixtureTable) -> Array:
    """Numbers of the fixtures that the rule of thumb leaves."""
    left = [rule_of_arrangement(query, table, k) for k in range(len(query.toolkit.arrangements))]
    found = [one for one in left if len(one[1])]
    if not found:
        return np.zeros(0, int)
    best = max(key for key, _ in found)
    return np.concatenate([numbers for key, numbers in found if np.allclose(key, best, atol=SAME)])


def rule_of_arrangement(
    query: Query, table: FixtureTable, arrangement: int
) -> tuple[tuple[float, ...], Array]:
    """The fixtures of one arrangement that the rule leaves, and how good they are by it: more is better."""
    carriers = [query.toolkit.carriers[k] for k in query.toolkit.arrangements[arrangement].carriers]
    rows = np.flatnonzero(table.arrangement == arrangement)
    if len(rows) == 0:
        return (), rows
    part = table.take(rows)
    lengths, normals = faces_of(query)
    x, y = compute_peg_places(part, query.toolkit, query.workpiece)
    wall = [k for k, one in enumerate(carriers) if not one.contact.is_placed]
    stops = [k for k, one in enumerate(carriers) if one.contact.is_placed and one.travel is None]
    moving = [k for k, one in enumerate(carriers) if one.travel is not None]
    if wall:
        base, apart = np.abs(x[:, wall[1]] - x[:, wall[0]]), np.zeros(len(rows))
        lowest = np.stack([-np.sin(part.theta), -np.cos(part.theta)], -1)
        rest = [[k] for k in stops]
    else:
        base, apart, lowest, rest = two_on_a_side(part, x, y, stops, lengths, normals)
    third = (
        np.max([lengths[part.face[:, k]] for one in rest for k in one], axis=0)
        if any(rest)
        else np.zeros(len(rows))
    )
    if not wall and len(stops) > 2:
        third = third_side(part, stops, lengths, base)
    facing = np.stack([-(find_contact_normals(query, part, k) * lowest).sum(-1) for k in moving], -1)
    opposite = np.round(facing.max(axis=1), 6)
    keys = np.stack([base, apart, third, opposite], -1)
    usable = base > 0
    if not usable.any():
        return (), rows[:0]
    chosen = np.flatnonzero(usable)
    for column in range(4):
        values = keys[chosen, column]
        chosen = chosen[values > values.max() - SAME * max(1.0, values.max())]
    return tuple(float(value) for value in keys[chosen[0]]), rows[chosen]


def two_on_a_side(
    part: FixtureTable, x: Array, y: Array, stops: Sequence[int], lengths: Array, normals: Array
) -> tuple[Array, Array, Array, list[list[int]]]:
    """Of each fixture the longest side that two locators share, how far apart they stand, and its normal."""
    count = len(part)
    base, apart, lowest = np.zeros(count), np.zeros(count), np.zeros((count, 2))
    for place, one in enumerate(stops):
        for other in stops[place + 1 :]:
            same = part.face[:, one] == part.face[:, other]
            length = np.where(same, lengths[part.face[:, one]], 0.0)
            gap = np.hypot(x[:, one] - x[:, other], y[:, one] - y[:, other])
            longer = (length > base + SAME) | ((np.abs(length - base) <= SAME) & (gap > apart) & (length > 0))
            base, apart = np.where(longer, length, base), np.where(longer, gap, apart)
            lowest[longer] = normals[part.face[longer, one]]
    return base, apart, lowest, []


def third_side(part: FixtureTable, stops: Sequence[int], lengths: Array, base: Array) -> Array:
    """The length (N,) of the side that the locator beside the two stands on; 0 where all stand on one."""
    each = lengths[part.face[:, list(stops)]]
    faces = part.face[:, list(stops)]
    alone = np.stack([(faces == faces[:, [k]]).sum(1) == 1 for k in range(len(stops))], -1)
    return np.where(alone, each, 0.0).max(axis=1) * (base > 0)


def faces_of(query: Query) -> tuple[Array, Array]:
    """Lengths (S,) of straight faces by number, 0 for arcs, and their outward normals (S, 2) in the part's frame."""
    every = query.workpiece.numbered
    lengths, normals = np.zeros(len(every.segments)), np.zeros((len(every.segments), 2))
    for face in every.faces:
        if isinstance(face.segment, Line):
            lengths[face.number], normals[face.number] = face.segment.length, face.segment.compute_normal()
    return lengths, normals


def find_contact_normals(query: Query, part: FixtureTable, peg: int) -> Array:
    """Outward unit normals (N, 2) at the contact of a peg, in the part's frame."""
    known = TouchableFeatures.from_workpiece(query.workpiece, query.toolkit)
    pose = np.column_stack([part.theta, part.position])
    x, y = compute_peg_places(part, query.toolkit, query.workpiece)
    carriers = query.toolkit.find_peg_carriers(part.arrangement)
    found = known.compute_contact_matrices(
        np.stack([x, y], axis=2), pose, carriers, part.face.astype(np.int64)
    )
    return found.normals[:, peg]


def seated_rows(rows: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """From how wide open a vise catches the part, for measured sets: by the rule, and the most precise of the list."""
    out = []
    for row in rows:
        query = make_set_query(find_set(row["set"]))
        if query.toolkit.carriers[0].peg_radius == 0:
            continue
        result = answer(query, threads=1)
        picked = by_rule(query, result.table)
        error = result.table.quality[:, LOCATION_ERROR]
        one = int(picked[np.argmin(error[picked])])
        few = np.argsort(error, kind="stable")[:LOOKED_AT].tolist()
        openings = captures(result, [one, *few])
        out.append(
            {
                "set": row["set"],
                "family": row["family"],
                "by_rule": openings[0],
                "widest_of_the_precise": max(openings[1:]),
                "looked_at": len(few),
            }
        )
        sys.stdout.write(f"{out[-1]}\n")
    return out


def captures(result: Result, rows: Sequence[int]) -> list[float]:
    """Capture openings in mm, those without end as a metre."""
    found = seatings(result, [result[k] for k in rows], with_cage=False)
    known = [one.capture_opening for one in found]
    return [round(CAPTURE_ALWAYS if one is None else min(one, CAPTURE_ALWAYS), 3) for one in known]


if __name__ == "__main__":
    main()
