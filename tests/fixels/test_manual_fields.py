"""The manual's tables of fields come from the fields of the kinds."""

from __future__ import annotations

import manual
from workhold.fixels.kinds import TABLES


def test_each_field_of_each_kind_stands_in_the_manual_with_its_option_and_help() -> None:
    """A row for each field below the name of its kind, and a cell for each heading."""
    parts = manual.on_page_markdown("::: toolkits").split("### ")[1:]
    assert len(parts) == len(TABLES)
    tables = {tuple(row.name for row in table.fields): table for table in TABLES.values()}
    for part in parts:
        lines = [line for line in part.splitlines() if line.startswith("|")]
        names = tuple(line.split("`")[1] for line in lines[2:])
        for row, line in zip(tables[names].fields, lines[2:], strict=True):
            cells = [cell.strip() for cell in line.replace("\\|", "/").strip("|").split("|")]
            assert len(cells) == 5 and cells[1] == f"`{row.option}`"
            assert (cells[3] == "must be given") == row.is_required
            assert cells[4].split()[0] == row.help.split()[0] and "{" not in cells[4]
