"""``workhold parts``: the parts that come with workhold."""

from __future__ import annotations

from workhold.cli.json_output import JsonOption, print_json
from workhold.cli.options import SHOWN_UNIT
from workhold.cli.values import length_unit

__all__ = ["parts"]


def parts(unit: str | None = SHOWN_UNIT, json_: JsonOption = False) -> None:
    """List the built-in parts.

    They are models of the workpieces in Wallack and Canny (1996), whose dimensions were never published. Any of the
    names can stand for PART.

    Example: workhold design widget --pitch 8 --columns 1 --peg-radius 3
    """
    from workhold.cli.tables import Table, print_tables
    from workhold.files.part.builtin import builtin_parts
    from workhold.files.part.load import load

    shown = length_unit(unit)
    if json_:
        from workhold.presenting.data import part_data

        print_json(parts=[{**part_data(load(one.name)), "description": one.description} for one in builtin_parts()])
        return
    decimals = shown.decimals - 2
    width, height = f">width {shown.abbreviation}", f">height {shown.abbreviation}"
    table = Table(("name", width, height, ">faces", "description"))
    for part in builtin_parts():
        workpiece = load(part.name)
        x0, y0, x1, y1 = workpiece.bounds
        size = shown.number(x1 - x0, decimals), shown.number(y1 - y0, decimals)
        table.add_row(part.name, *size, str(len(workpiece.faces)), part.description)
    print_tables(table)
