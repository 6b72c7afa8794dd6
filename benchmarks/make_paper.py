"""The report of the paper: every table and figure of it measured again, as HTML and PDF, by one command.

    make paper                                            everything, into paper/
    python benchmarks/make_paper.py --quick               a small part of everything, in two minutes
    python benchmarks/make_paper.py --only table-two      one section again; the others as they are
    python benchmarks/make_paper.py --keep                only what this program has not measured yet

Each section leaves a data file in paper/data; report.html, report.pdf and the witnesses are made from these files alone.
Ctrl-C ends the section that runs and writes the report of what there is, marked incomplete.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from collections.abc import Sequence
from datetime import UTC, date, datetime
from hashlib import sha256
from pathlib import Path
from time import perf_counter
from types import ModuleType
from typing import Any

from paper import (
    benchmark_set,
    claims,
    engines,
    growth,
    proofs,
    scale,
    seating,
    sketches,
    stages,
    table_one,
    table_two,
)
from paper.bar import Bar
from paper.document import Block, Figures
from paper.front import TITLE, after, before
from paper.html_page import html_page
from paper.pdf_pages import pdf_pages
from report import machine
from workhold.version import __version__

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
# In the order of the report.
SECTIONS: tuple[ModuleType, ...] = (
    table_one, table_two, claims, sketches, growth, engines, proofs, stages, seating, scale, benchmark_set,
)  # fmt: skip
COMMAND = "python benchmarks/make_paper.py --only {}"
INTERRUPTED, FAILED = 130, 1


def main() -> None:
    """Run as a script."""
    options = asked()
    out = Path(options.out)
    (out / "data").mkdir(parents=True, exist_ok=True)
    chosen = [one for one in SECTIONS if options.only is None or one.NAME in options.only]
    if not options.render:
        write_run(out, options.quick)
    code = 0 if options.render else measure(chosen, out, options.quick, options.keep)
    write_report(out)
    sys.stdout.write(f"{out / 'report.html'} and {out / 'report.pdf'} are written.\n")
    sys.exit(code)


def asked() -> argparse.Namespace:
    """The options."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    names = [one.NAME for one in SECTIONS]
    parser.add_argument("--quick", action="store_true", help="a small part of everything")
    parser.add_argument(
        "--keep", action="store_true", help="reuse sections that the same program has measured"
    )
    parser.add_argument("--only", action="append", choices=names, help="one section; may be repeated")
    parser.add_argument("--render", action="store_true", help="measure nothing, write the report anew")
    parser.add_argument("--out", default=str(ROOT / "paper"), help="the folder of the report")
    return parser.parse_args()


def write_run(out: Path, quick: bool) -> None:
    """What the figures of this run depend on."""
    told = machine()
    data = {
        "machine": told,
        "processors": int(told["processors used"]),
        "version": __version__,
        "commit": commit(),
        "made": datetime.now(UTC).date().isoformat(),
        "quick": quick,
        "sections": [one.NAME for one in SECTIONS],
    }
    write_json(out / "data" / "run.json", {"section": "run", "complete": True, "data": data})


def commit() -> str:
    """The commit measured, with a plus where files differ from it."""
    try:
        words = ["git", "describe", "--always", "--dirty=+", "--abbrev=12"]
        return subprocess.run(words, cwd=ROOT, check=True, capture_output=True, text=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return "unknown commit"


def fingerprint(section: ModuleType) -> str:
    """A hash of what a section's numbers depend on: the program and what measures it."""
    files = [*sorted((ROOT / "src").rglob("*.py")), *sorted(HERE.glob("*.py")), Path(str(section.__file__))]
    files += [HERE / "paper" / "elimination.py", HERE / "paper" / "witnesses.py"]
    return sha256(b"".join(path.read_bytes() for path in files)).hexdigest()[:16]


def measure(chosen: Sequence[ModuleType], out: Path, quick: bool, keep: bool) -> int:
    """Measure the sections; the exit code."""
    code = 0
    needed = [one for one in chosen if not (keep and is_kept(one, out, quick))]
    for section in needed:
        path_of(section, out).unlink(missing_ok=True)
    bar = Bar({one.NAME: one.QUICK_SECONDS if quick else one.SECONDS for one in needed})
    for section in needed:
        data: dict[str, Any] = {}
        start, complete, reason = perf_counter(), False, ""
        try:
            for share, words in section.measure(data, quick):
                bar.show(section.NAME, share, words)
            complete = True
        except KeyboardInterrupt:
            code, reason = INTERRUPTED, "interrupted"
        except Exception as error:
            code, reason = FAILED, f"{type(error).__name__}: {error}"
        bar.done(section.NAME, perf_counter() - start, reason)
        whole = {
            "section": section.NAME,
            "title": section.TITLE,
            "command": COMMAND.format(section.NAME),
            "complete": complete,
            "reason": reason,
            "quick": quick,
            "fingerprint": fingerprint(section),
            "seconds": perf_counter() - start,
            "data": data,
        }
        write_json(path_of(section, out), whole)
        if code == INTERRUPTED:
            break
    return code


def is_kept(section: ModuleType, out: Path, quick: bool) -> bool:
    """Whether there is a whole data file that the same program made."""
    path = path_of(section, out)
    if not path.exists():
        return False
    told = json.loads(path.read_text(encoding="utf-8"))
    return bool(told["complete"] and told["quick"] == quick and told["fingerprint"] == fingerprint(section))


def path_of(section: ModuleType, out: Path) -> Path:
    """The data file of a section."""
    return out / "data" / f"{section.NAME}.json"


def write_json(path: Path, content: Any) -> None:
    """Write a file whole or not at all."""
    beside = path.with_suffix(".part")
    beside.write_text(json.dumps(content, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    beside.replace(path)


def read_figures(out: Path) -> dict[str, Figures]:
    """The figures of every data file, by the names of their sections."""
    every = {}
    for name in ("run", *(one.NAME for one in SECTIONS)):
        path = out / "data" / f"{name}.json"
        if path.exists():
            told = json.loads(path.read_text(encoding="utf-8"))
            every[name] = Figures(name, told["data"], told["complete"])
    return every


def write_report(out: Path) -> None:
    """Write both forms of the report and the witnesses, from the data files alone."""
    every = read_figures(out)
    blocks: list[Block] = list(before(every))
    witnesses = out / "witnesses"
    witnesses.mkdir(exist_ok=True)
    for section in SECTIONS:
        figures = every.get(section.NAME)
        if figures is None or not figures.data:
            continue
        blocks += section.render(figures)
        for name, text in section.files(figures).items() if hasattr(section, "files") else ():
            (witnesses / name).write_text(text, encoding="utf-8")
    blocks += after()
    (out / "report.html").write_text(html_page(TITLE, blocks), encoding="utf-8")
    made = date.fromisoformat(every["run"].value("made"))
    (out / "report.pdf").write_bytes(pdf_pages(TITLE, blocks, made))


if __name__ == "__main__":
    main()
