"""A seventh kind of toolkit, which is nothing but data, and the commands and files that take it as it is.

Run as a script in a folder of its own with the path of a part: it makes the kind one of those that there are before anything
else is loaded, as a line in ``fixels.kinds`` would, and then does what a user does.
"""

from __future__ import annotations

import json
import sys
from typing import ClassVar

from workhold.fixels import kinds
from workhold.fixels.carrier import Carrier, Travel
from workhold.fixels.fields import MIN_GAP, PEG_RADIUS, PITCH
from workhold.fixels.making import complete_and_check, make_class_from_table, make_lattice_carrier
from workhold.fixels.setup_words import PageWords, SetupWords
from workhold.fixels.table import FieldTable, PageLabel
from workhold.fixels.toolkit import Arrangement, Toolkit, ToolkitWording


@make_class_from_table
class Press(Toolkit):
    """A press whose bed is a plate with three pegs, and whose ram carries one: they hold what lies between."""

    kind = "press"
    table = FieldTable(
        "press",
        "A press with pegs on its bed and its ram",
        (PITCH, PEG_RADIUS, MIN_GAP.relabel(PageLabel("Smallest gap", "pitch"))),
    )
    noun = "press"
    locked = "a press, its ram"
    law = "vise"
    arrangements = (Arrangement("press", (3, 1)),)
    wording = ToolkitWording(
        two="two pegs of the bed",
        four="three pegs of the bed and one of the ram",
        inside="in this press",
        within="the press as asked",
        rules="keeps the smallest gap, closes and clamps",
        backwards="the ram is lifted",
        holes="holes that the press does not have",
    )
    setup_words = SetupWords(
        standing="Pegs",
        located_by="Pegs of the bed",
        put="Put {peg}s in {holes}.",
        against="",
        touching="four pegs",
    )
    page = PageWords("Press", "Close press", {"pitch": [15.0, 15.0], "peg_radius": 2.0})

    pitch: tuple[float, float]
    peg_radius: float
    min_gap: float

    columns: ClassVar[int] = 2
    rows: ClassVar[None] = None
    flat: ClassVar[None] = None

    def __attrs_post_init__(self) -> None:
        complete_and_check(self, noun="bed", peg="peg")

    @property
    def carriers(self) -> tuple[Carrier, ...]:
        """The bed, and the ram beside it, which slides along x."""
        beside = {"offset": (self.pitch[0], 0.0), "travel": Travel(0.0, self.min_gap, None)}
        return make_lattice_carrier(self, "bed", noun="jaw"), make_lattice_carrier(
            self, "ram", noun="jaw", **beside
        )

    @property
    def gap(self) -> float:
        """The smallest gap in mm."""
        return self.min_gap


def become_known() -> None:
    """Make the kind one of those that there are, as a line in ``fixels.kinds`` would."""
    for register, entry in ((kinds.KINDS, Press), (kinds.TABLES, Press.table), (kinds.PAGES, Press.page)):
        register[Press.kind] = entry  # type: ignore[index]


def commands(drawing: str) -> dict[str, list[str]]:
    """What a user does with it, by name."""
    press = ["--toolkit", "press", "--pitch", "15", "--peg-radius", "2"]
    return {
        "design": ["design", drawing, *press, "--out", "r.json", "--draw", "pictures"],
        "design from a file": [
            "design",
            drawing,
            "--toolkit",
            "press.toml",
            "--best",
            "3",
            "--out",
            "few.json",
        ],
        "none": ["design", drawing, *press, "--angle", "1..1.001"],
        "verify": ["verify", "r.json", "--complete"],
        "show": ["show", "r.json", "1"],
        "sheet": ["sheet", "r.json", "1", "-o", "sheet.pdf", "--jaw-force", "1000"],
        "sheet for CAM": ["sheet", "r.json", "1", "-o", "set-up.dxf"],
        "pins": ["sheet", "r.json", "1", "-o", "pins.csv"],
        "convert": ["convert", "r.json", "r.npz"],
        "convert back": ["convert", "r.npz", "again.json"],
        "seat": ["seat", "r.json", "1"],
        "explore": ["explore", drawing, "--toolkit", "press", "--pitch", "15,20", "--peg-radius", "2"],
        "toolkits": ["toolkits", "press.toml"],
        "schema": ["schema", "toolkit"],
        "family": ["family", "parts", "--toolkit", "press.toml", "--out", "family.json"],
        "batch": ["batch", "parts", "--toolkit", "press.toml", "--out", "batch"],
    }


def main(drawing: str) -> None:
    """Do all of it in the folder of work, and print what came of each as JSON."""
    become_known()
    from typer.testing import CliRunner

    from workhold.cli.main import app
    from workhold.web.forms import FORMS
    from workhold.web.toolkits import describe_kinds

    outcomes = {}
    for name, words in commands(drawing).items():
        outcome = CliRunner().invoke(app, words)
        outcomes[name] = [outcome.exit_code, outcome.output]
    asked = {"kind": "press", "pitch": [15, 15], "peg_radius": 2}
    outcomes["page"] = [0, json.dumps([one for one in describe_kinds() if one["name"] == "press"])]
    outcomes["request"] = [0, str(FORMS["press"].model_validate(asked).to_toolkit())]
    sys.stdout.write(json.dumps(outcomes))


if __name__ == "__main__":
    main(sys.argv[1])
