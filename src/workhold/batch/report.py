"""Output of a batch for people and other programs: a report, two tables and, if asked for, setup sheets.

The report is one self-contained page of plain HTML, with the failures and their reasons, and a sortable
table. Records and sheets beside the page are linked; everything else, including pictures, is in the page.
"""

from __future__ import annotations

import re
from base64 import b64encode
from collections import Counter
from collections.abc import Sequence
from datetime import date
from html import escape
from pathlib import Path
from shlex import quote
from typing import Any

from attrs import define, field, frozen

from workhold.batch.durations import TaskDurations
from workhold.batch.run import BatchState
from workhold.batch.store import RecordStore
from workhold.batch.tables import JobRow, Row, holds_by_friction, list_job_rows, write_tables
from workhold.drawing.panel import format_count
from workhold.errors import make_printable
from workhold.files.atomic import explain_system_errors, write_bytes, write_text_file
from workhold.presenting.figure_words import ROUNDED_DOWN
from workhold.units import format_rounded_down

__all__ = ["Report", "Summary", "write_results"]

# Rows on the page, and pictures among them; the tables have everything.
MOST_ROWS, MOST_PICTURES = 5000, 400
# What stands about a first choice: heading, column of the table of results, decimals.
FIGURES = (
    ("location error mm", "location_error", 3),
    ("clamp amplification", "clamp_amplification", 2),
    ("closure margin", "closure_margin", 3),
    ("edge distance mm", "edge_distance", 1),
    ("warnings", "warnings", 0),
)
# Where some toolkit of the batch holds by friction.
OF_FRICTION = (("clamp needed N", "clamp_needed", 0), ("safety reached", "safety_reached", 2))
# That of a program, where some job has one.
CLEARANCE = ("program clearance mm", "program_clearance", 1)
# How a job may come out: said of one, and of some.
STATES = {
    "held": ("held", "held"),
    "none": ("no fixture", "without a fixture"),
    "refused": ("cannot be asked", "that cannot be asked"),
    "unreadable": ("not readable", "not readable"),
    "failed": ("failed", "failed"),
    "open": ("not done yet", "not done yet"),
}
BAD = ("unreadable", "refused", "failed")

HEAD = """<!DOCTYPE html>
<!-- workhold -->
<html lang="en"><head><meta charset="utf-8">\
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy"
 content="default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'">
<title>workhold batch</title><style>
body{font:14px/1.45 "DejaVu Sans",Verdana,Arial,sans-serif;color:#1a1a1a;margin:24px;background:#fff}
h1{font-size:24px;margin:0 0 4px}h2{font-size:18px;margin:28px 0 8px}p{margin:4px 0;max-width:60em}
table{border-collapse:collapse}\
th,td{padding:5px 7px;border-bottom:1px solid #d5d9df;vertical-align:middle;text-align:left}
.box{overflow-x:auto}th{background:#eef1f5;position:sticky;top:0}\
th button{all:unset;cursor:pointer;font-weight:bold}
th button:focus-visible{outline:2px solid #0b3a82}th[aria-sort=ascending] button::after{content:" \\25B2"}
th[aria-sort=descending] button::after{content:" \\25BC"}\
td.n{text-align:right;font-variant-numeric:tabular-nums}
td.bad{color:#b3122a}td.once{white-space:nowrap}\
small{display:block;color:#5f6670;min-width:8em;max-width:26em}
td code{white-space:normal;display:block;max-width:26em}\
img{display:block;width:160px;height:120px}code{font-size:12px}
input{font:inherit;padding:4px 8px;width:22em;max-width:90%;margin:6px 0}
</style></head><body>
"""

SCRIPT = """<script>
const table=document.getElementById("jobs"),body=table.tBodies[0];
table.tHead.addEventListener("click",event=>{
 const head=event.target.closest("th");if(!head||!event.target.closest("button"))return;
 const up=head.getAttribute("aria-sort")!=="ascending",place=head.cellIndex;
 for(const other of table.tHead.rows[0].cells)other.removeAttribute("aria-sort");
 head.setAttribute("aria-sort",up?"ascending":"descending");
 const key=row=>row.cells[place].dataset.key??row.cells[place].textContent;
 const rows=[...body.rows].map((row,number)=>[key(row),row,number]);
 rows.sort(([a,,i],[b,,j])=>{
  if((a==="")!==(b===""))return a===""?1:-1;
  const x=Number(a),y=Number(b),\
way=Number.isNaN(x)||Number.isNaN(y)?a.localeCompare(b,"en",{numeric:true}):x-y;
  return way===0?i-j:up?way:-way;});
 body.append(...rows.map(entry=>entry[1]));});
document.getElementById("filter").addEventListener("input",event=>{
 const words=event.target.value.toLowerCase().split(/\\s+/).filter(Boolean);
 for(const row of body.rows){const text=row.textContent.toLowerCase();\
row.hidden=!words.every(word=>text.includes(word));}});
</script></body></html>
"""


@frozen
class Summary:
    """Headline and sentences above the table.

    Parameters
    ----------
    headline : headline that describes the request.
    sentences : description of the run.
    events : events during the run, such as the death of a worker, one sentence each.
    """

    headline: str
    sentences: Sequence[str]
    events: Sequence[str]


@define(eq=False)
class Report:
    """Collects rows and writes the page.

    Parameters
    ----------
    folder : folder of the page; files in it are linked.
    store : store of the records.
    by_friction : whether friction holds the part in some toolkit; then its figures have columns.
    rows : HTML of each row of the page's table.
    bad : failures: part and reason, with the toolkits that each holds for.
    states : number of jobs in each state.
    left_out : number of rows left out for want of room.
    """

    folder: Path
    store: RecordStore
    by_friction: bool = False
    rows: list[str] = field(factory=list, init=False)
    bad: dict[tuple[str, str], list[str]] = field(factory=dict, init=False)
    states: Counter[str] = field(factory=Counter, init=False)
    pictures: int = field(default=0, init=False)
    left_out: int = field(default=0, init=False)

    @property
    def figures(self) -> tuple[tuple[str, str, int], ...]:
        """Figures that have columns: heading, column of the table of results, and decimals of each."""
        return (*FIGURES, *(OF_FRICTION if self.by_friction else ()), CLEARANCE)

    def add_job(self, job: JobRow, sheet: Path | None = None) -> None:
        """Add a job's row to the page; ``sheet`` is the setup sheet of its first choice, None where there is
        none.

        Every job is counted, but only the first :data:`MOST_ROWS` have a row on the page.
        """
        row = job.row
        self.states[row["state"]] += 1
        if row["state"] in BAD and len(self.bad) < MOST_ROWS:
            self.bad.setdefault((row["part"], row["reason"] or ""), []).append(row["toolkit"])
        if len(self.rows) >= MOST_ROWS:
            self.left_out += 1
            return
        self.rows.append(self.make_row(row, self.draw_first_choice(job), sheet))

    def draw_first_choice(self, job: JobRow) -> str:
        """Return a picture of a job's first choice as HTML; "" if it has none, and beyond
        :data:`MOST_PICTURES`.
        """
        row = job.row
        if row["state"] != "held" or self.pictures >= MOST_PICTURES:
            return ""
        from workhold.drawing.fixture_pictures import draw_thumbnail

        self.pictures += 1
        result = job.read_job_result(self.store)
        svg = draw_thumbnail(result[0], result.workpiece, result.toolkit)
        words = f"First choice for {row['part']} in {row['toolkit']}"
        return f'<img alt="{escape_html(words)}" src="data:image/svg+xml;base64,{b64encode(svg.encode()).decode()}">'

    def make_row(self, row: Row, picture: str, sheet: Path | None) -> str:
        """Return the HTML of a table row; ``picture`` is HTML."""
        state = STATES[row["state"]][0] + (
            ", but none that a workshop can use" if row["fit"] is False else ""
        )
        why = " ".join(filter(None, (row["reason"], row["remarks"])))
        cells = [
            make_cell(picture, key=""),
            make_cell(escape_html(row["part"]) + self.make_links(row, sheet), key=escape_html(row["part"])),
            make_cell(escape_html(row["toolkit"]), name="once"),
            make_cell(
                state + (f"<small>{escape_html(why)}</small>" if why else ""),
                key=state,
                bad=row["state"] in BAD,
            ),
            format_figure(row["fixtures"], 0),
            *(
                format_figure(row.get(key), decimals, key in ROUNDED_DOWN)
                for _, key, decimals in self.figures
            ),
            format_figure(row["seconds"], 2),
            format_figure(row["estimated_seconds"], 2),
        ]
        return f"<tr>{''.join(cells)}</tr>\n"

    def make_links(self, row: Row, sheet: Path | None) -> str:
        """Return HTML with links to a job's record and setup sheet; "" where the part is not held.

        Without a sheet, the command that makes it is shown.
        """
        if row["state"] != "held":
            return ""
        if "://" in row["record"]:
            # In an object store: no command opens it there.
            return f"<small>{escape_html(row['record'])}</small>"
        record = Path(row["record"])
        link = (
            f'<a href="{escape_html(record.relative_to(self.folder).as_posix())}">the best</a>'
            if record.is_relative_to(self.folder)
            else ""
        )
        if sheet is not None:
            place = escape_html(sheet.relative_to(self.folder).as_posix())
            return f'<small>{link} <a href="{place}">setup sheet</a></small>'
        name = Path(row["part"]).stem
        line = f"workhold sheet {quote(str(record))} 1 --part-name {quote(name)} -o {quote(f'{name}.pdf')}"
        code = f"<code>{escape_html(line)}</code>"
        return f"<small>{link}<details><summary>setup sheet</summary>{code}</details></small>"

    def write(self, path: Path, summary: Summary) -> None:
        """Write the page: summary, failures, and the table of all rows."""
        headings = [
            "first choice",
            "part",
            "toolkit",
            "state",
            "fixtures",
            *(words for words, _, _ in self.figures),
        ]
        headings += ["seconds", "predicted s"]
        with write_text_file(path) as stream:
            stream.write(f"{HEAD}<h1>{escape_html(summary.headline)}</h1>\n")
            for sentence in (self.counts, *summary.sentences):
                stream.write(f"<p>{escape_html(sentence)}</p>\n")
            if self.left_out:
                stream.write(f"<p>The table of results lists {self.left_out:,} further jobs.</p>\n")
            if summary.events:
                items = "".join(f"<li>{escape_html(event)}</li>\n" for event in summary.events)
                stream.write(f"<h2>What happened on the way</h2>\n<ul>\n{items}</ul>\n")
            if self.bad:
                stream.write(f"<h2>What failed, and why</h2>\n{self.list_failures()}")
            stream.write(
                '<h2>All jobs</h2>\n<label>Only rows with <input id="filter" type="search"></label>\n'
            )
            heads = "".join(
                f'<th scope="col"><button type="button">{escape_html(words)}</button></th>'
                for words in headings
            )
            stream.write(f'<div class="box"><table id="jobs"><thead><tr>{heads}</tr></thead><tbody>\n')
            stream.writelines(self.rows)
            stream.write(f"</tbody></table></div>\n{SCRIPT}")

    @property
    def counts(self) -> str:
        """Sentence with the number of jobs in each state."""
        counted = [
            f"{self.states[state]:,} {words}" for state, (_, words) in STATES.items() if self.states[state]
        ]
        return f"{format_count(self.states.total(), 'job')}: {', '.join(counted)}." if counted else "No jobs."

    def list_failures(self) -> str:
        """Return a table of the failures, with part, toolkit and reason, as HTML."""
        rows = "".join(
            f"<tr><td>{escape_html(part)}</td><td>{escape_html(', '.join(toolkits))}</td>"
            f"<td>{escape_html(reason)}</td></tr>\n"
            for (part, reason), toolkits in self.bad.items()
        )
        heads = "".join(f'<th scope="col">{words}</th>' for words in ("part", "in", "why"))
        return (
            f'<div class="box"><table><thead><tr>{heads}</tr></thead><tbody>\n{rows}</tbody></table></div>\n'
        )


def escape_html(words: Any) -> str:
    """Return words as text in HTML, without characters that cannot be printed."""
    return escape(make_printable(str(words)))


def make_cell(content: str, *, key: str | None = None, name: str = "", bad: bool = False) -> str:
    """Return a table cell of HTML.

    ``key`` is the value to sort by, the text if None; ``name`` is the CSS class.
    """
    classes = " ".join(filter(None, (name, "bad" if bad else "")))
    attributes = (f' class="{classes}"' if classes else "") + ("" if key is None else f' data-key="{key}"')
    return f"<td{attributes}>{content}</td>"


def format_figure(value: float | None, decimals: int, is_rounded_down: bool = False) -> str:
    """Return a table cell with a number rounded to a number of decimals; an empty cell for None.

    ``is_rounded_down`` rounds it down to two decimals instead.
    """
    if value is None:
        return make_cell("", name="n")
    text = format_rounded_down(value) if is_rounded_down else f"{value:,.{decimals}f}"
    return make_cell(text, key=f"{value:.12g}", name="n")


# Letters of a sheet's name that come of its part and toolkit, and of its record's name.
LONGEST_NAME, LETTERS = 80, 8


def write_results(
    batch: BatchState,
    store: RecordStore,
    measured: TaskDurations,
    folder: Path,
    report_name: str,
    summary: Summary,
    sheets: Path | None,
) -> Report:
    """Write the tables and the report of all jobs into a folder, and sheets of first choices; return the
    report.

    Parameters
    ----------
    summary : headline and sentences that stand over the report.
    """
    with explain_system_errors(folder):
        folder.mkdir(parents=True, exist_ok=True)
    by_friction = holds_by_friction(batch.jobs)
    report = Report(folder, store, by_friction)
    for row in write_tables(list_job_rows(batch.jobs, store, measured), folder, by_friction):
        report.add_job(row, None if sheets is None else write_first_sheet(row, store, sheets))
    report.write(folder / report_name, summary)
    return report


def write_first_sheet(row: JobRow, store: RecordStore, folder: Path) -> Path | None:
    """Return the path of the setup sheet of a job's first choice; None where it has no fixture.

    The sheet is written unless the file exists.
    """
    if row.row["state"] != "held":
        return None
    name = re.sub(r"[^\w.-]+", "_", f"{Path(row.row['part']).stem} in {row.job.held_in.name}")[:LONGEST_NAME]
    path = folder / f"{name}_{row.job.name[:LETTERS]}.pdf"
    if not path.exists():
        from workhold.drawing.pdf import convert_svg_to_pdf
        from workhold.drawing.sheet import draw_setup_sheet

        with explain_system_errors(folder):
            folder.mkdir(parents=True, exist_ok=True)
        part_name = Path(row.row["part"]).stem
        result = row.read_job_result(store)
        pages = draw_setup_sheet(result, 1, result_hash=row.job.name, part_name=part_name, day=date.today())
        write_bytes(path, convert_svg_to_pdf(pages, date.today()))
    return path
