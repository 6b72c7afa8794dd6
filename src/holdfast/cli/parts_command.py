"""``holdfast parts``: the parts that come with holdfast."""

from __future__ import annotations

__all__ = ["parts"]


def parts() -> None:
    """List the built-in parts.

    They are models of the workpieces in Wallack and Canny (1996), whose dimensions were never published. Any of the
    names can stand for PART.

    Example: holdfast design widget --pitch 8 --columns 1 --peg-radius 3
    """
    from holdfast.cli.tables import Table, print_tables
    from holdfast.files.builtin import builtin_parts
    from holdfast.files.load import load

    table = Table(("name", ">width mm", ">height mm", ">faces", "description"))
    for part in builtin_parts():
        workpiece = load(part.name)
        x0, y0, x1, y1 = workpiece.bounds
        table.add_row(part.name, f"{x1 - x0:.1f}", f"{y1 - y0:.1f}", str(len(workpiece.faces)), part.description)
    print_tables(table)
