"""The two tables of a batch: a row for each job, and a row for each of the fixtures that are kept.

As Parquet where pyarrow is installed, else as comma-separated values with the same columns; where nothing is
known a cell is empty. Lengths are in mm, angles in degrees, forces in N.
"""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from attrs import frozen

from workhold.batch.durations import TaskDurations
from workhold.batch.run import BatchJob
from workhold.batch.store import RecordStore, parse_record
from workhold.errors import make_encodable
from workhold.files.atomic import write_binary_file, write_text_file
from workhold.files.result.strapped_text import is_strapped
from workhold.fixels.toolkit import Toolkit
from workhold.model.notes import Many, round_to_two_digits
from workhold.model.quality import FIGURES, PROGRAM_FIGURE, SEATING_FIGURES
from workhold.model.query import Query
from workhold.model.result import Result
from workhold.statics.judging import is_unfit

__all__ = [
    "BEST",
    "MARK",
    "RESULTS",
    "JobRow",
    "has_parquet",
    "list_job_rows",
    "list_table_names",
    "holds_by_friction",
    "write_tables",
]

# By which a table is known as one of workhold's own, see ``cli.outputs``.
MARK = "workhold-table/1"
FIGURE_COLUMNS = {figure.key: float for figure in (*FIGURES, *SEATING_FIGURES, PROGRAM_FIGURE)}
# Where a program's tools come nearest: in which line, which tool, and to what.
PASSING_COLUMNS: Mapping[str, type] = {"program_line": int, "program_tool": int, "program_element": str}
RESULTS: Mapping[str, type] = {
    **dict.fromkeys(("part", "file", "toolkit", "kind", "state"), str),
    **dict.fromkeys(("fixtures", "distinct"), int),
    **FIGURE_COLUMNS,
    **PASSING_COLUMNS,
    "fit": bool,
    "faces": int,
    **dict.fromkeys(("width", "height"), float),
    **dict.fromkeys(("reason", "remarks", "record"), str),
    **dict.fromkeys(("estimated_seconds", "seconds"), float),
    "worker": str,
}
BEST: Mapping[str, type] = {
    **dict.fromkeys(("part", "file", "toolkit"), str),
    "rank": int,
    **dict.fromkeys(("type", "direction"), str),
    **dict.fromkeys(("theta_deg", "x", "y", "jaw_separation"), float),
    **dict.fromkeys(("holes", "faces"), str),
    **FIGURE_COLUMNS,
    **PASSING_COLUMNS,
    "record": str,
}
# What parts that friction holds have besides, where some toolkit of a batch holds so.
FRICTION_FIGURES: Mapping[str, type] = dict.fromkeys(
    ("clamp_needed", "slip_reserve", "safety_reached"), float
)
# How they are set up: holes of the straps' bolts and of supports, height of the parallels, and side of the work stop.
FRICTION_SETTINGS: Mapping[str, type] = {
    **dict.fromkeys(("bolts", "supports"), str),
    "parallels": float,
    "stop": str,
}
# Rows written together.
BLOCK = 8192

Row = dict[str, Any]
AddRows = Callable[[Sequence[Row]], None]


@frozen(eq=False)
class JobRow:
    """A job with its row in the table of results, and the rows of its best fixtures."""

    job: BatchJob
    row: Row
    best: Sequence[Row]

    def read_job_result(self, store: RecordStore) -> Result:
        """Return the result of a job that is done, read from its record."""
        from workhold.files.result.reader import read_result

        with store.open_record(self.job.name) as path:
            return read_result(path)


def list_job_rows(jobs: Sequence[BatchJob], store: RecordStore, measured: TaskDurations) -> Iterator[JobRow]:
    """Yield each job in order with its row of results and the rows of its best fixtures.

    The values come from the job's record; without one, the row has none of the record's values and there are
    no fixtures.
    """
    for job in jobs:
        part, query = job.part, job.held_in.query
        listed = part.request.listed
        named = {"part": listed.name, "file": str(listed.path), "toolkit": job.held_in.name}
        row: Row = dict.fromkeys(RESULTS) | named | {"remarks": " ".join(part.remarks) or None}
        if isinstance(query, Query):
            row["kind"] = query.toolkit.kind
        if part.content:
            row |= {"faces": part.faces, "width": part.size[0], "height": part.size[1]}
        best: list[Row] = []
        record = store.read(job.name) if job.name else None
        if record is not None:
            best = fill_job_row(row, named, parse_record(record), job)
            row["record"] = store.get_location(job.name)
            best = [one | {"record": row["record"]} for one in best]
        elif job.refusal:
            row |= {"state": "refused" if part.content else "unreadable", "reason": job.refusal}
        else:
            row |= {"state": "failed" if job.failure else "open", "reason": job.failure or None}
        if job.name:
            seconds, worker = measured.known.get(job.name, (None, None))
            row |= {"estimated_seconds": job.estimate, "seconds": seconds, "worker": worker}
        yield JobRow(job, row, best)


def fill_job_row(row: Row, named: Row, record: Mapping[str, Any], job: BatchJob) -> list[Row]:
    """Fill a job's row from its record, in place, and return the rows of its best fixtures; [] for a refusal.

    ``named`` has the cells that every row of the job begins with.
    """
    if record["refusal"]:
        row |= {"state": "refused", "reason": record["refusal"]}
        return []
    found, distinct = (sum(record[key].values()) for key in ("found", "distinct"))
    about = next((note["count"] for note in record["note_data"] if note["kind"] == Many.kind), None)
    row |= {
        "state": "held" if found else "none",
        "fixtures": found if about is None else round_to_two_digits(about),
        "distinct": distinct if about is None else None,
    }
    row["reason"] = " ".join(record["notes"]) or None
    best = [
        dict.fromkeys(BEST) | named | make_fixture_row(fixture, job) | {"rank": rank}
        for rank, fixture in enumerate(record["fixtures"], 1)
    ]
    if best:
        row |= {
            key: best[0][key]
            for key in (*FIGURE_COLUMNS, *PASSING_COLUMNS, *FRICTION_FIGURES)
            if key in best[0]
        }
        if "closure_margin" not in record["fixtures"][0]["quality"]:
            row["fit"] = is_held_by_friction(record["fixtures"][0])
            return best
        off = record["tolerance"]["peg"] + record["tolerance"]["face"]
        row["fit"] = not bool(is_unfit(row["closure_margin"], row["location_error"], off))
    return best


def is_held_by_friction(fixture: Mapping[str, Any]) -> bool | None:
    """Return whether friction holds a fixture, given as an entry of a result file.

    Between flat jaws it is True if both jaws press over their whole contacts and neither touches corners
    only. Under straps it is True if a push by hand seats the part and all loads are held; None if straps were
    not searched.
    """
    if is_strapped(fixture):
        needs = [
            *fixture["quality"].get("clamp_needed_each", ()),
            fixture.get("program_force", {"force": 0})["force"],
        ]
        is_held = fixture["places"] is None or (bool(fixture["straps"]) and None not in needs)
        return fixture["push"] is not None and is_held if fixture["looked_at"] else None
    touched = all(fixture[jaw]["segments"] for jaw in ("fixed", "moving"))
    return touched and bool(fixture["quality"]["full_contact"])


def make_friction_row(fixture: Mapping[str, Any], toolkit: Toolkit) -> Row:
    """Return the figures and settings of a fixture that friction holds, from its entry in a result file."""
    row: Row = dict.fromkeys(FRICTION_SETTINGS) | {
        key: fixture["quality"].get(key) for key in FRICTION_FIGURES
    }
    if not is_strapped(fixture):
        return row | {"parallels": fixture["parallels"], "stop": fixture["stop"]}
    straps, plate = toolkit.strap_set, toolkit.plates[0]
    assert straps is not None
    # Tables have a slip reserve of what a file leaves to be reckoned.
    need = row["clamp_needed"]
    if straps.max_force is not None and need:
        row["slip_reserve"] = straps.max_force / need
    bolts = (straps.bolts.name_place(*one["hole"]) for one in fixture["straps"])
    supports = (plate.name_place(*one) for one in fixture.get("supports", ()))
    return row | {"bolts": " ".join(bolts) or None, "supports": " ".join(supports) or None}


def make_jaws_row(fixture: Mapping[str, Any]) -> Row:
    """Return the row of a fixture between flat jaws, from its entry in a result file;
    it has no holes and no peg figures.
    """
    faces = [number for jaw in ("fixed", "moving") for number in fixture[jaw]["segments"]]
    return {
        "type": fixture["type"],
        **fixture["pose"],
        "jaw_separation": fixture["jaw_separation"],
        "faces": " ".join(map(str, faces)),
        "tilt": fixture["quality"]["tilt"],
        "warnings": len(fixture["warnings"]),
    }


def make_fixture_row(fixture: Mapping[str, Any], job: BatchJob) -> Row:
    """Return the row of a fixture from its entry in a result file."""
    from workhold.files.result.fixture_forms import collect_seating_figures
    from workhold.files.result.reader import read_peg_place

    assert isinstance(job.held_in.query, Query)
    if "pegs" not in fixture:
        return make_jaws_row(fixture) | make_friction_row(fixture, job.held_in.query.toolkit)
    carriers = {carrier.name: carrier for carrier in job.held_in.query.toolkit.carriers}
    directions = fixture.get("directions")
    direction = fixture.get("direction") if directions is None else " ".join(directions)
    holes = []
    for peg in fixture["pegs"]:
        carrier, *place = read_peg_place(peg, direction if directions is None else peg.get("direction"))
        holes.append(carriers[carrier].name_place(*place))
    row: Row = {
        "type": fixture["type"],
        "direction": direction,
        **fixture["pose"],
        "jaw_separation": fixture.get("jaw_separation"),
        "holes": " ".join(holes),
        "faces": " ".join(str(peg["segment"]) for peg in fixture["pegs"]),
        **{key: value for key, value in fixture["quality"].items() if key in BEST},
    }
    if is_strapped(fixture):
        row |= make_friction_row(fixture, job.held_in.query.toolkit)
    if (seating := fixture.get("seating")) is not None:
        row |= collect_seating_figures(seating)
    if (passing := fixture.get("program_clearance")) is not None:
        row[PROGRAM_FIGURE.key] = passing["distance"]
        row |= {f"program_{name}": passing[name] for name in ("line", "tool", "element")}
    return row


def has_parquet() -> bool:
    """Return whether pyarrow is installed."""
    return find_spec("pyarrow") is not None


def list_table_names() -> tuple[str, str]:
    """Return the names of the two tables' files, as Parquet where pyarrow is installed, else as CSV."""
    ending = "parquet" if has_parquet() else "csv"
    return f"results.{ending}", f"best.{ending}"


def holds_by_friction(jobs: Iterable[BatchJob]) -> bool:
    """Return whether friction holds the part in the toolkit of some job."""
    queries = (job.held_in.query for job in jobs)
    return any(isinstance(query, Query) and query.toolkit.holds_by_friction for query in queries)


def write_tables(rows: Iterator[JobRow], folder: Path, by_friction: bool = False) -> Iterator[JobRow]:
    """Yield the rows unchanged while writing them to both tables in a folder.

    The files appear once all rows are taken. ``by_friction`` is whether there are columns for parts that
    friction holds.
    """
    further = {**FRICTION_FIGURES, **FRICTION_SETTINGS} if by_friction else {}
    own = {**RESULTS, **(FRICTION_FIGURES if by_friction else {})}
    columns = own, {**BEST, **further}
    table = write_parquet_table if has_parquet() else write_csv_table
    with ExitStack() as files:
        add_results, add_best = (
            files.enter_context(table(folder / name, some))
            for name, some in zip(list_table_names(), columns, strict=True)
        )
        waiting: list[JobRow] = []

        def add_waiting() -> None:
            """Write the rows that are collected and not written yet."""
            add_results([one.row for one in waiting])
            add_best([row for one in waiting for row in one.best])
            waiting.clear()

        for row in rows:
            waiting.append(row)
            if len(waiting) == BLOCK:
                add_waiting()
            yield row
        add_waiting()


def convert_cell(value: Any) -> Any:
    """Return a value as a cell of CSV: "true" or "false", a number with 12 digits, or encodable text."""
    if isinstance(value, str):
        return make_encodable(value)
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:.12g}" if isinstance(value, float) else value


@contextmanager
def write_csv_table(path: Path, columns: Mapping[str, type]) -> Iterator[AddRows]:
    """Yield a function that adds rows to a table of comma-separated values."""
    with write_text_file(path) as stream:
        writer = csv.DictWriter(stream, list(columns), lineterminator="\n")
        writer.writeheader()

        def add(rows: Sequence[Row]) -> None:
            writer.writerows({key: convert_cell(value) for key, value in row.items()} for row in rows)

        yield add


@contextmanager
def write_parquet_table(path: Path, columns: Mapping[str, type]) -> Iterator[AddRows]:
    """Yield a function that adds rows to a Parquet table; the same rows give the same bytes."""
    import pyarrow
    from pyarrow import parquet

    kinds = {str: pyarrow.string(), int: pyarrow.int64(), float: pyarrow.float64(), bool: pyarrow.bool_()}
    schema = pyarrow.schema([(name, kinds[kind]) for name, kind in columns.items()])
    with (
        write_binary_file(path) as stream,
        parquet.ParquetWriter(stream, schema, compression="zstd", store_schema=False) as writer,
    ):

        def add(rows: Sequence[Row]) -> None:
            if rows:
                written = [
                    {
                        key: make_encodable(value) if isinstance(value, str) else value
                        for key, value in row.items()
                    }
                    for row in rows
                ]
                writer.write_table(pyarrow.Table.from_pylist(written, schema=schema))

        yield add
        # Beside the schema it would stand too far from the end to be looked for.
        writer.add_key_value_metadata({"made by": MARK})
