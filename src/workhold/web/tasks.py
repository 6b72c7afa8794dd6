"""Tasks of the workers.

Every task takes its payload and an :class:`workhold.web.worker.TaskContext`, and returns plain data or objects of
the model. Heavy modules are imported by the tasks that need them, or by :func:`warm_up`; what is returned
needs none of them.
"""

from __future__ import annotations

from functools import partial
from multiprocessing.connection import Connection
from typing import TYPE_CHECKING, Any

from workhold.model.result import Result
from workhold.model.search_report import Explanation
from workhold.model.workpiece import Workpiece
from workhold.web.families import find_family, make_family_paper
from workhold.web.fixture_tasks import find_seating, make_paper, simulate_closing
from workhold.web.part_tasks import check_part, describe_builtin_part, find_shape, read_part, survey_part
from workhold.web.program_forms import look_at_program
from workhold.web.request_forms import check_body
from workhold.web.searching import AskedQueries, search
from workhold.web.support_tasks import find_supports
from workhold.web.worker import TaskContext, Tasks, run_tasks

if TYPE_CHECKING:
    from workhold.fixels.toolkit import Toolkit
    from workhold.model.fixture import Fixture
    from workhold.web.families import FamilyForm
    from workhold.web.forms import ExploreForm, JobForm, LoadsForm
    from workhold.web.request_forms import WorkpieceForm

__all__ = ["TASKS", "warm_up", "run_worker"]

# Best fixtures listed when loads are asked for over all of them.
MOST_RESISTING = 10


def warm_up(kind: str) -> None:
    """Import and, on a first run, compile the modules that workers of a kind ("search" or "desk") need."""
    from workhold.search.design import design

    if kind == "search":
        from workhold.fixels.vise import Vise

        corners = [[0.0, 0.0, 0.0], [30.0, 0.0, 0.2], [34.0, 25.0, 0.0], [0.0, 20.0, 0.0]]
        design(Workpiece.from_loops("warm", [corners]), Vise(8, 2, 2))
        return
    import workhold.drawing.sheet
    import workhold.files.dxf.reader
    import workhold.files.svg.reader
    import workhold.statics.loads
    import workhold.web.forms  # noqa: F401


def explore_toolkits(payload: AskedQueries, order: TaskContext) -> None:
    """Search with each query, one after the other.

    Each outcome is reported as ("row", row), progress as ("progress", fraction, found).
    """
    from workhold.files.result.writer import make_toolkit_fields
    from workhold.presenting.figure_words import find_edgeless_distance, is_edgeless
    from workhold.search.design import explore

    total, queries = 0, payload.queries
    for number, (row, (_, query)) in enumerate(zip(explore(queries, order.cancel), queries, strict=False), 1):
        total += row.fixtures
        entry = {
            "title": row.name,
            "toolkit": {"kind": query.toolkit.kind, **make_toolkit_fields(query.toolkit)},
            "counts": dict(row.found),
            "fixtures": row.fixtures,
            "estimated": row.about is not None,
            "figures": dict(row.figures),
            "edgeless": is_edgeless(row.figures, find_edgeless_distance(query.workpiece, query.toolkit)),
            "fit": row.fit,
            "note": row.reason,
        }
        order.report(("row", entry))
        order.report(("progress", number / len(queries), total))


def explain_result(payload: AskedQueries, order: TaskContext) -> Explanation:
    """Return why the query of a search has no fixture; the payload has this one query."""
    from workhold.search.explaining import explain

    return explain(payload.query)


def check_job(payload: tuple[JobForm | ExploreForm | FamilyForm, int], order: TaskContext) -> AskedQueries:
    """Return the queries of a request, pickled; raise InputError for faults that can be found before the
    search.

    The payload is (form of the request, most segments of a part).
    """
    from workhold.contact.problem import Problem
    from workhold.search.seat_search import make_locating_query
    from workhold.search.seated import refuse_unasked

    form, most_segments = payload
    queries = form.to_queries(most_segments)
    if len(queries) == 1:
        asked = queries[0][1]
        Problem.from_query(asked if asked.toolkit.strap_set is None else make_locating_query(asked))
        if queries[0][1].seating is not None:
            refuse_unasked(queries[0][1])
    return AskedQueries.from_queries(queries)


def make_lesson(payload: tuple[WorkpieceForm, int], order: TaskContext) -> dict[str, Any]:
    """Return as plain data what the page on the method shows of a part: features and Type I fixtures.

    The payload is (form of the part, most segments).
    """
    from workhold.presenting.lesson import compute_lesson

    form, most_segments = payload
    return compute_lesson(form.to_workpiece(most_segments), order.cancel)


def compute_loads(
    payload: tuple[Fixture, Workpiece, Toolkit, LoadsForm], order: TaskContext
) -> list[dict[str, Any]]:
    """Return as plain data the effect of each load of a form on a fixture.

    The payload is (fixture, part, toolkit, form).
    """
    from workhold.presenting.data import describe_load_case
    from workhold.statics.loads import compute_load_cases

    fixture, workpiece, toolkit, form = payload
    asked = [load.to_load() for load in form.loads]
    cases = compute_load_cases(fixture, workpiece, toolkit, asked, form.jaw_force, form.friction, form.jaw)
    return [describe_load_case(case) for case in cases]


def list_warnings(payload: tuple[Result, bool, dict[str, Any]], order: TaskContext) -> dict[str, Any]:
    """Return the warnings of the first fixture of a result and, if ``is_first``, why it is ranked first.

    The payload is (result, is_first, keyword arguments).
    """
    from workhold.drawing.sheet_facts import list_result_cautions
    from workhold.statics.why_first import explain_why_first

    result, is_first, asked = payload
    cautions = list_result_cautions(result, 1, **asked)
    return {
        "warnings": [{"kind": caution.kind, "sentence": caution.sentence} for caution in cautions],
        "why_first": explain_why_first(result, asked["unit"]) if is_first else "",
    }


def rank_by_load_reaction(payload: tuple[Result, LoadsForm], order: TaskContext) -> list[tuple[int, float]]:
    """Return (rank from 1, load reaction in N) of the ten fixtures with the least load reaction, ascending."""
    import numpy as np

    from workhold.model.quality import LOAD_REACTION
    from workhold.statics.quality import measure_quality

    result, form = payload
    asked = [load.to_load() for load in form.loads]
    reaction = measure_quality(result.table, result.workpiece, result.toolkit, result.query.tolerance, asked)[
        :, LOAD_REACTION
    ]
    order_of = np.argsort(reaction, kind="stable")[:MOST_RESISTING]
    return [(int(index) + 1, float(reaction[index])) for index in order_of if np.isfinite(reaction[index])]


TASKS: Tasks = {
    "search": search,
    "explore": explore_toolkits,
    "explanation": explain_result,
    "check_body": check_body,
    "check_job": check_job,
    "check_part": check_part,
    "make_lesson": make_lesson,
    "builtin_part": describe_builtin_part,
    "read_part": read_part,
    "survey_part": survey_part,
    "look_at_program": look_at_program,
    "loads": compute_loads,
    "warnings": list_warnings,
    "resist": rank_by_load_reaction,
    "paper": make_paper,
    "seating": find_seating,
    "closing": simulate_closing,
    "supports": find_supports,
    "shape": find_shape,
    "family": find_family,
    "family_paper": make_family_paper,
}


def run_worker(connection: Connection, kind: str, memory_bytes: int) -> None:
    """Run a worker of a kind until its pipe ends, see :func:`warm_up` and
    :func:`workhold.web.worker.run_tasks`.
    """
    run_tasks(connection, memory_bytes, TASKS, partial(warm_up, kind))
