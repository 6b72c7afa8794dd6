"""Writes the benchmark's workpieces and its manifest into the package, from its definitions and a search of every set.

    python benchmarks/benchmark_set.py [FOLDER OF CAD DRAWINGS]

Without the folder the workpieces "from CAD" are taken as they are in the package.
"""

from __future__ import annotations

import json
import sys
from hashlib import sha256
from pathlib import Path
from time import process_time
from typing import Any

from benchmark_parts import BenchmarkPart, benchmark_parts
from benchmark_sets import AskedSet, asked_sets
from workhold.benchmark.catalogue import compute_checksums, make_set_text
from workhold.fixels.kinds import make_toolkit
from workhold.model.query import Query
from workhold.model.workpiece import Workpiece
from workhold.search.design import answer

HOME = Path(__file__).resolve().parent.parent / "src" / "workhold" / "data" / "benchmark"
VERSION = "1"


def main(cad: Path | None) -> None:
    """Write parts and manifest."""
    parts = list(benchmark_parts(cad))
    if cad is None:
        parts += keep_clear_parts()
    (HOME / "parts").mkdir(parents=True, exist_ok=True)
    workpieces = {part.workpiece.name: written(part) for part in parts}
    by_name = {part.workpiece.name: part.workpiece for part in parts}
    entries, left_out = [], []
    for asked in asked_sets(parts):
        entry = entry_of(asked, by_name[asked.part])
        undecided = entry.pop("undecided")
        if undecided:
            left_out.append({"name": asked.name, "undecided": undecided})
        else:
            entries.append(entry)
        sys.stdout.write(f"{asked.name}: {entry['counts']}, {undecided} undecided, {process_time():.1f} s\n")
        sys.stdout.flush()
    content = {
        "format": "workhold-benchmark-manifest/1",
        "version": VERSION,
        "licence": "Apache-2.0",
        "workpieces": workpieces,
        "left_out": left_out,
        "sets": entries,
    }
    text = json.dumps(content, ensure_ascii=False, indent=None)
    (HOME / "manifest.json").write_text(broken(text) + "\n", encoding="utf-8")


def broken(text: str) -> str:
    """The text of the manifest with one workpiece or set in a line."""
    content = json.loads(text)
    parts = ",\n".join(
        f"{json.dumps(k)}: {json.dumps(v, ensure_ascii=False)}" for k, v in content["workpieces"].items()
    )
    sets = ",\n".join(json.dumps(one, ensure_ascii=False) for one in content["sets"])
    head = ", ".join(
        f"{json.dumps(key)}: {json.dumps(content[key])}"
        for key in ("format", "version", "licence", "left_out")
    )
    return f'{{{head},\n"workpieces": {{\n{parts}\n}},\n"sets": [\n{sets}\n]}}'


def keep_clear_parts() -> list[BenchmarkPart]:
    """The workpieces of the package that are not made here."""
    known: dict[str, Any] = json.loads((HOME / "manifest.json").read_text(encoding="utf-8"))["workpieces"]
    kept = [
        (json.loads((HOME / "parts" / f"{name}.json").read_text(encoding="utf-8")), about)
        for name, about in known.items()
        if about["family"] == "from CAD"
    ]
    return [
        BenchmarkPart(
            Workpiece.from_loops(part["name"], part["loops"]),
            *(about[key] for key in ("family", "reason", "source", "licence")),
        )
        for part, about in kept
    ]


def written(part: BenchmarkPart) -> dict[str, str]:
    """Write a workpiece; what the manifest says of it."""
    loops = [(loop + 0.0).tolist() for loop in part.workpiece.loops]
    text = json.dumps({"name": part.workpiece.name, "units": "mm", "loops": loops}) + "\n"
    (HOME / "parts" / f"{part.workpiece.name}.json").write_text(text, encoding="utf-8")
    return {
        "family": part.family,
        "reason": part.reason,
        "source": part.source,
        "licence": part.licence,
        "sha256": sha256(text.encode("utf-8")).hexdigest(),
    }


def entry_of(asked: AskedSet, workpiece: Workpiece) -> dict[str, Any]:
    """Search a set; what the manifest says of it."""
    fields = dict(asked.toolkit)
    toolkit = make_toolkit(fields.pop("kind"), fields)
    listing = asked.options.get("listing")
    result = answer(Query(workpiece, toolkit, listing=listing), threads=1)
    undecided = -1 if result.proof is None else len(result.proof.undecided)
    head, lines = make_set_text(asked.name, result)
    return {
        "name": asked.name,
        "workpiece": asked.part,
        "toolkit": asked.toolkit,
        "listing": listing,
        "reason": asked.reason,
        "counts": head["counts"],
        "distinct": head["distinct"],
        "sums": compute_checksums(head, lines),
        "undecided": undecided,
    }


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else None)
