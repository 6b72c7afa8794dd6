"""What a batch leaves for people and other programs: two tables, a report, and setup sheets where they are asked for."""

from __future__ import annotations

import re
from datetime import date
from pathlib import Path

from workhold.batch.measured import Measured
from workhold.batch.report import Report, Summary
from workhold.batch.run import Batch
from workhold.batch.store import Store
from workhold.batch.tables import JobRow, job_rows, write_tables
from workhold.files.atomic import plain_errors, write_bytes

__all__ = ["write_results"]

# Letters of a sheet's name that come of its part and toolkit, and of its record's name.
LONGEST_NAME, LETTERS = 80, 8


def write_results(
    batch: Batch,
    store: Store,
    measured: Measured,
    folder: Path,
    report_name: str,
    summary: Summary,
    sheets: Path | None,
) -> Report:
    """Write tables and report of all jobs into a folder, and the sheet of each first choice into another, if one is named.

    Parameters
    ----------
    summary : what stands over the report.

    Raises
    ------
    InputError
        When they cannot be written.
    """
    with plain_errors(folder):
        folder.mkdir(parents=True, exist_ok=True)
    report = Report(folder, store)
    for row in write_tables(job_rows(batch.jobs, store, measured), folder):
        report.add(row, None if sheets is None else sheet_of(row, store, sheets))
    report.write(folder / report_name, summary)
    return report


def sheet_of(row: JobRow, store: Store, folder: Path) -> Path | None:
    """The setup sheet of a job's first choice, which is written if it is not there; None where there is no fixture.

    Raises
    ------
    InputError
        When it cannot be written.
    """
    if row.row["state"] != "held":
        return None
    name = re.sub(r"[^\w.-]+", "_", f"{Path(row.row['part']).stem} in {row.job.held_in.name}")[:LONGEST_NAME]
    path = folder / f"{name}_{row.job.name[:LETTERS]}.pdf"
    if not path.exists():
        from workhold.drawing.pdf import svg_to_pdf
        from workhold.drawing.result_sheet import result_sheet

        with plain_errors(folder):
            folder.mkdir(parents=True, exist_ok=True)
        part_name = Path(row.row["part"]).stem
        result = row.result(store)
        pages = result_sheet(result, 1, result_hash=row.job.name, part_name=part_name, day=date.today())
        write_bytes(path, svg_to_pdf(pages, date.today()))
    return path
