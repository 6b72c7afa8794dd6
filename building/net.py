"""Hashes of what the program writes, over all kinds of toolkits, to compare before and after a change of the inside.

``python building/net.py record FILE`` runs some forty commands and a few requests of the page, and writes a hash of each
output. ``python building/net.py compare FILE`` runs them again, names what differs, and exits with 1 if anything does.
Commands whose output tells a time or a path are left out of the terminal's share; their files are hashed all the same.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
EXAMPLES = ROOT / "examples"
BRACKET, RECTANGLE, NEMA = "bracket.dxf", "rectangle.dxf", "nema34.dxf"
JAWS = ["--pitch", "10", "--columns", "2", "--peg-radius", "3"]
PLATE = ["--toolkit", "plate", "--pitch", "20", "--peg-radius", "3"]
FENCE = ["--toolkit", "fence", "--pitch", "20", "--peg-radius", "3", "--wall-offset", "10"]
LOAD = ["--load", "force=200 at=10,5 direction=30..60", "--load", "moment=4"]

# Queries by name: the part, the toolkit, and whatever else is asked.
QUERIES: dict[str, list[str]] = {
    "vise": [BRACKET, *JAWS],
    "vise-loads": [BRACKET, *JAWS, *LOAD, "--best", "20"],
    "vise-limits": [
        BRACKET,
        *JAWS,
        "--rows",
        "6",
        "--max-opening",
        "60",
        "--row-offset",
        "5",
        "--blocked",
        "L-B3,R-A",
    ],
    "vise-body": [
        BRACKET,
        *JAWS,
        "--body-radius",
        "4.5",
        "--min-gap",
        "12",
        "--min-opening",
        "15",
        "--best",
        "9",
    ],
    "vise-restricted": [BRACKET, *JAWS, "--avoid", "3", "--keep-out", "circle=20,15,8", "--angle=-10..10"],
    "vise-margin": [BRACKET, *JAWS, "--contact-margin", "1", "--prefer", "precise", "--best", "5"],
    "vise-flat": [BRACKET, *JAWS, "--flat", "2.5,1.5", "--best", "20"],
    "vise-none": [RECTANGLE, *JAWS, "--angle", "0..0.001"],
    "vise-preset": [BRACKET, "--toolkit", "plate-20mm", "--best", "20", "--unit", "inch"],
    "vise-ranked": [
        "widget",
        "--pitch",
        "8",
        "--columns",
        "1",
        "--peg-radius",
        "3",
        "--rank-by",
        "end-distance",
    ],
    "gripper": ["widget", "--toolkit", "gripper", "--pitch", "10", "--peg-radius", "3"],
    "algebra": ["small4Handle", *JAWS, "--engine", "algebra", "--best", "20"],
    "opening": ["widget", "--toolkit", "opening-vise", "--pitch", "8", "--columns", "2", "--peg-radius", "2"],
    "opening-gap": ["widget", "--toolkit", "opening-vise", *JAWS, "--min-gap", "6", "--best", "9"],
    "plate": [BRACKET, *PLATE, "--best", "30"],
    "plate-travel": [
        BRACKET,
        *PLATE,
        "--travel",
        "10,40",
        "--columns",
        "6",
        "--rows",
        "5",
        "--best",
        "30",
        *LOAD,
    ],
    "plate-directions": [BRACKET, *PLATE, "--direction=-x,+y", "--clamp-radius", "5", "--best", "20"],
    "plate-none": [RECTANGLE, *PLATE, "--best", "5", "--angle", "0..1"],
    "plate-flat": [BRACKET, *PLATE, "--flat", "2.5", "--best", "10"],
    "plate-preset": [NEMA, "--toolkit", "clamp-plate-20mm", "--avoid", "8,9,10,11,12", "--best", "10"],
    "plate-inch": [BRACKET, "--toolkit", "clamp-plate-one-inch", "--best", "10", "--unit", "inch"],
    "two-clamps": [RECTANGLE, "--toolkit", "two-clamp-plate-20mm", "--best", "20"],
    "two-clamps-all": [
        RECTANGLE,
        *PLATE,
        "--clamps",
        "2",
        "--columns",
        "5",
        "--rows",
        "4",
        "--listing",
        "all",
    ],
    "two-clamps-pairs": [
        RECTANGLE,
        *PLATE,
        "--clamps",
        "2",
        "--direction=-x:-y,-x:+x",
        "--columns",
        "6",
        "--rows",
        "5",
    ],
    "fence": [BRACKET, *FENCE, *LOAD],
    "fence-travel": [BRACKET, "--toolkit", "fence-20mm", "--best", "30"],
    "fence-direction": [BRACKET, *FENCE, "--direction=-x,-y", "--rows", "4", "--columns", "5"],
    "fence-none": [RECTANGLE, *FENCE],
    "fence-two": [RECTANGLE, *FENCE, "--clamps", "2", "--rows", "4", "--columns", "6", "--best", "20"],
    "fence-two-all": [
        RECTANGLE,
        *FENCE,
        "--clamps",
        "2",
        "--rows",
        "3",
        "--columns",
        "4",
        "--listing",
        "all",
    ],
}
# Of these the files that a shop takes away are made too.
SHOWN = (
    "vise",
    "vise-loads",
    "vise-flat",
    "opening",
    "plate",
    "plate-travel",
    "two-clamps",
    "fence",
    "fence-travel",
    "fence-two",
)
SEATED = ("vise", "opening", "plate", "fence", "two-clamps")
# What else is printed, with no times in it.
PRINTED: dict[str, list[str]] = {
    "help": ["--help"],
    **{
        f"help-{name}": [name, "--help"]
        for name in (
            "design",
            "show",
            "seat",
            "sheet",
            "convert",
            "explore",
            "copies",
            "family",
            "batch",
            "features",
            "toolkits",
            "drill",
            "verify",
            "schema",
            "serve",
        )
    },
    **{f"schema-{name}": ["schema", name] for name in ("part", "toolkit", "loads", "query", "result")},
    "toolkits": ["toolkits", "--json"],
    "toolkit-vise": ["toolkits", "plate-20mm"],
    "toolkit-plate": ["toolkits", "two-clamp-plate-20mm"],
    "toolkit-fence": ["toolkits", "fence-20mm"],
    "explore": ["explore", BRACKET, "--toolkit", "plate-20mm,clamp-plate-20mm,fence-20mm", "--json"],
    "no-such-kind": ["design", BRACKET, "--toolkit", "bench"],
    "no-pitch": ["design", BRACKET, "--toolkit", "plate", "--peg-radius", "3"],
    "not-of-plates": ["design", BRACKET, *PLATE, "--row-offset", "5"],
    "not-of-vises": ["design", BRACKET, *JAWS, "--travel", "5,10"],
    "no-wall": ["design", BRACKET, "--toolkit", "fence", "--pitch", "20", "--peg-radius", "3"],
    "fat-pegs": ["design", BRACKET, "--pitch", "10", "--columns", "2", "--peg-radius", "6"],
}


def compute_hash(content: bytes) -> str:
    """The hash of some content, without the times of a search, which differ from run to run."""
    text = re.sub(rb'"seconds": ?[0-9.e-]+|\$TDU?UPDATE\s+40\s+[0-9.]+', b"", content)
    return hashlib.sha256(text).hexdigest()[:24]


def run(*arguments: str) -> tuple[int, bytes]:
    """The exit code of a command in this process, and what it prints, without what differs from run to run.

    A time moves the words behind it to other lines, so spaces and ends of lines are left out.
    """
    from typer.testing import CliRunner

    from workhold.cli.main import app

    outcome = CliRunner().invoke(app, list(arguments))
    text = re.sub(r"[0-9.]+\s+s\b", "", outcome.output)
    return outcome.exit_code, re.sub(r"\s+", "", text).replace(
        ",compilingonthisfirstrunincluded", ""
    ).encode()


def list_outputs(folder: Path) -> Iterator[tuple[str, str]]:
    """The name and the hash of every output."""
    for name, words in PRINTED.items():
        code, text = run(*words)
        yield f"printed/{name}", f"{code} {compute_hash(text)}"
    for name, words in QUERIES.items():
        path = folder / f"{name}.json"
        code, text = run("design", *words, "--out", str(path))
        yield f"design/{name}", f"{code} {compute_hash(text)}"
        if path.exists():
            yield f"result/{name}", compute_hash(path.read_bytes())
    for name in SHOWN:
        yield from list_fixture_files(name, folder)
    for name in SEATED:
        code, text = run("seat", str(folder / f"{name}.json"), "1", "--json")
        yield f"seat/{name}", f"{code} {compute_hash(text)}"
    yield from list_family_outputs(folder)
    yield from list_page_outputs()


def list_fixture_files(name: str, folder: Path) -> Iterator[tuple[str, str]]:
    """What a shop takes away of the first fixture of a result."""
    result = str(folder / f"{name}.json")
    for ending in ("svg", "dxf", "step"):
        path = folder / f"{name}.{ending}"
        command = (
            ["show", result, "1", "--draw", str(path)]
            if ending == "svg"
            else ["sheet", result, "1", "-o", str(path)]
        )
        code, text = run(*command)
        content = path.read_bytes() if path.exists() else text
        yield f"{ending}/{name}", f"{code} {compute_hash(content)}"
    code, _ = run("sheet", result, "1", "-o", str(folder / f"{name}.pdf"), "--jaw-force", "2000")
    yield f"pdf/{name}", f"{code} {compute_hash((folder / f'{name}.pdf').read_bytes())}"
    for words in (["show", result, "1"], ["show", result, "1", "--json"], ["verify", result]):
        code, text = run(*words)
        yield f"{' '.join(words[0:1] + words[3:])}/{name}", f"{code} {compute_hash(text)}"
    for ending in ("npz", "csv"):
        path = folder / f"{name}.{ending}"
        run("convert", result, str(path))
        yield f"{ending}/{name}", compute_hash(path.read_bytes())


def list_family_outputs(folder: Path) -> Iterator[tuple[str, str]]:
    """A family, copies and the plates of a vise."""
    drawings = folder / "drawings"
    drawings.mkdir()
    for path in (BRACKET, RECTANGLE):
        shutil.copy(EXAMPLES / path, drawings)
    for toolkit in ("plate-20mm", "clamp-plate-20mm", "fence-20mm"):
        out = folder / f"family-{toolkit}.json"
        code, _ = run("family", str(drawings), "--toolkit", toolkit, "--out", str(out))
        yield f"family/{toolkit}", f"{code} {compute_hash(out.read_bytes()) if out.exists() else ''}"
    for name in ("plate-travel", "fence-direction"):
        code, text = run("copies", str(folder / f"{name}.json"), "1", "--json")
        yield f"copies/{name}", f"{code} {compute_hash(text)}"
    path = folder / "drill.dxf"
    code, text = run("drill", "--toolkit", "plate-20mm", "--rows", "6", "--blocked", "L-B3", "-o", str(path))
    yield "drill", f"{code} {compute_hash(path.read_bytes() if path.exists() else text)}"


def list_page_outputs() -> Iterator[tuple[str, str]]:
    """What the page is told before anything is searched, and the server's own description of itself."""
    from workhold.web.toolkits import describe_kinds

    yield "page/kinds", compute_hash(json.dumps(describe_kinds(), sort_keys=True).encode())


def main() -> int:
    """Record or compare."""
    if len(sys.argv) != 3 or sys.argv[1] not in ("record", "compare"):
        sys.exit("usage: python building/net.py record|compare FILE")
    os.environ["COLUMNS"], os.environ["NO_COLOR"] = "80", "1"
    file = Path(sys.argv[2]).resolve()
    with tempfile.TemporaryDirectory() as folder:
        # Paths that are printed are the same everywhere.
        for name in (BRACKET, RECTANGLE, NEMA):
            shutil.copy(EXAMPLES / name, folder)
        os.chdir(folder)
        now = dict(list_outputs(Path()))
        os.chdir(ROOT)
    if sys.argv[1] == "record":
        file.write_text(json.dumps(now, indent=1) + "\n", encoding="utf-8")
        sys.stdout.write(f"{len(now)} outputs recorded\n")
        return 0
    before = json.loads(file.read_text(encoding="utf-8"))
    differing = sorted(name for name in before | now if before.get(name) != now.get(name))
    sys.stdout.write("".join(f"differs: {name}\n" for name in differing))
    sys.stdout.write(f"{len(now)} outputs, {len(differing)} differ\n")
    return int(bool(differing))


if __name__ == "__main__":
    sys.exit(main())
