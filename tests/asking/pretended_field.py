"""A program that has one field more in the question of a search, and tells where it appears; run by the test beside it."""

from __future__ import annotations

import json
import sys
from contextlib import redirect_stdout, suppress
from importlib.util import find_spec, module_from_spec
from io import StringIO
from pathlib import Path
from types import CodeType
from typing import Any

PLACE = "    best: int | None = declare("
PRETENDED = """    pretended: float | None = declare(
        "length",
        "Pretended for a test.",
        PageLabel("Pretended", "none"),
        section=RULING_OUT,
    )
"""


def declare_pretended() -> None:
    """Load the module of the question with the field in its source."""
    spec = find_spec("workhold.asking.search")
    assert spec is not None and spec.origin is not None and spec.loader is not None
    source = Path(spec.origin).read_text()
    assert source.count(PLACE) == 1
    module = module_from_spec(spec)
    code: CodeType = compile(source.replace(PLACE, PRETENDED + PLACE), spec.origin, "exec")
    sys.modules[spec.name] = module
    exec(code, vars(module))


def printed(*words: str) -> str:
    """What a command prints."""
    from workhold.cli.main import app

    out = StringIO()
    with redirect_stdout(out), suppress(SystemExit):
        app(list(words), standalone_mode=False)
    return out.getvalue()


def told(folder: Path) -> dict[str, Any]:
    """Where the field appears, and what becomes of its values."""
    import workhold
    from workhold.cli.agent_arguments import DesignArguments
    from workhold.verification.verify import verify_file
    from workhold.web.families import FamilyForm
    from workhold.web.forms import JobForm
    from workhold.web.toolkits import describe_questions

    part, vise = workhold.load("widget"), workhold.Vise(pitch=8, columns=1, peg_radius=3)
    file = folder / "r.json"
    typed = ("--pitch", "8", "--columns", "1", "--peg-radius", "3", "--best", "2")
    printed("design", "widget", *typed, "--pretended", "0.5in", "--out", str(file))
    try:
        workhold.Query(part, vise, pretended=-1)
        refusal = ""
    except workhold.InputError as error:
        refusal = str(error)
    job = JobForm.model_validate(
        {"workpiece": {"name": "w", "loops": [loop.tolist() for loop in part.loops]},
         "toolkit": {"pitch": [8, 8], "columns": 1, "peg_radius": 3}, "pretended": 4.5}
    )  # fmt: skip
    return {
        "query": workhold.Query(part, vise, pretended=3).pretended,
        "design": workhold.design(part, vise, best=1, pretended=2.5).query.pretended,
        "refusal": refusal,
        "help": "--pretended LENGTH Pretended for a test." in " ".join(printed("design", "--help").split()),
        "file": json.loads(file.read_text())["pretended"],
        "read": workhold.open(file).query.pretended,
        "faults": list(verify_file(file).faults),
        "request": job.to_queries(1000)[0][1].pretended,
        "schemas": [
            form.model_json_schema()["properties"]["pretended"]["description"]
            for form in (JobForm, FamilyForm, DesignArguments)
        ],
        "of results": "pretended" in json.loads(printed("schema", "result"))["properties"],
        "page": [one["label"] for one in describe_questions()["search"] if one["name"] == "pretended"],
    }


if __name__ == "__main__":
    declare_pretended()
    sys.stdout.write(json.dumps(told(Path(sys.argv[1]))) + "\n")
