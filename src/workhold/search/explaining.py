"""Why there is no fixture: every simultaneous contact is looked at again and asked which rule it breaks first.

The rules are asked one after the other, as a person would: what the user ruled out, whether four pegs can touch at all,
contact margin, smallest gap, closure, clamping, and the place in the jaws. The counts are of contacts as computed, in
plain numbers; the proof that there is no fixture is the search's.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from threading import Event, Timer
from typing import Any

import numpy as np
from attrs import define, evolve
from numpy.typing import NDArray

from workhold.contact.features import end_distances
from workhold.contact.problem import Problem
from workhold.conventions import GAP_SLACK, LEAST_CLAMPING, LEAST_CLOSURE
from workhold.errors import InputError
from workhold.geometry.rotation import rotated
from workhold.kernels.contact import record
from workhold.listing.canonical_form import Candidates, candidates_of, canonical_form, listed_once
from workhold.listing.placing import arranged, placed
from workhold.model.explanation import Explanation, Help, NearestMiss, Removal
from workhold.model.query import Query
from workhold.model.restrictions import Restrictions
from workhold.model.result import fixture_at
from workhold.model.units import MILLIMETRE, Unit
from workhold.model.vise import Vise
from workhold.proof.deciding import is_standing
from workhold.search.cells import run_blocks, thread_count
from workhold.search.contacts import contacts_of
from workhold.search.design import answer
from workhold.search.toolkit_search import ToolkitSearch
from workhold.statics.wrenches import outward_normals

__all__ = ["explain"]

Array = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

# Contacts kept from each block of the search; far more than a part without a fixture has.
MOST_LISTED = 5_000
# Faces to avoid that are given back one by one.
MOST_FACES = 8
# Pegs this near in x, in mm, are even.
EVEN = 1e-6
# Seconds after which a change has shown that it helps; how many fixtures there are in all is then not known.
HELP_SECONDS = 10.0
# A contact misses closure by this much at most to be called near.
ROUNDING = 1e-12


@define(frozen=True, eq=False)
class Contacts:
    """N sets of four simultaneous contacts and what the rules ask of them.

    Parameters
    ----------
    candidates : the contacts, as fixtures would be.
    margin : (N,) smallest entry of the null vector of sum of sizes 1, of the sign that makes it largest.
    null : (N, 4) that null vector.
    clamping : (N,) the clamping force for it.
    end_distance : (N,) smallest distance in mm to the end of a feature.
    """

    candidates: Candidates
    margin: Array
    null: Array
    clamping: Array
    end_distance: Array

    def take(self, chosen: BoolArray) -> Contacts:
        """Some of them."""
        rest = (values[chosen] for values in (self.margin, self.null, self.clamping, self.end_distance))
        return Contacts(self.candidates.take(chosen), *rest)


def explain(query: Query, threads: int | None = None, unit: Unit = MILLIMETRE) -> Explanation:
    """Explain why there is no fixture that a query asks for.

    Parameters
    ----------
    query : what was asked in vain.
    threads : how many threads share the work; None for one on each processor.
    unit : of the lengths in its words.
    """
    problem = Problem.of(query)
    contacts = all_contacts(problem, threads)
    first, removals = restriction_removals(problem, threads, len(contacts.margin))
    nearest = None
    for rule, keeps, miss in rules(problem, unit):
        if len(contacts.margin) == 0:
            break
        kept = keeps(contacts)
        removals.append(Removal(rule, len(kept), int(kept.sum())))
        if not kept.any():
            nearest = nearest_miss(contacts, miss(contacts), problem)
        contacts = contacts.take(kept)
    removals = [removal for removal in removals if removal.before > 0]
    return Explanation(first, tuple(removals), nearest, helps(query, threads, unit))


def all_contacts(problem: Problem, threads: int | None) -> Contacts:
    """Every set of four simultaneous contacts of a problem, whatever the rules say of it."""
    search = ToolkitSearch.of(problem, counting=True, most_listed=MOST_LISTED)
    records, _ = run_blocks(search.blocks(problem.query.arrangements), thread_count(threads), None, None)
    swapped = search.frame.swapped
    together = np.concatenate([np.zeros((0, record.RECORD_LENGTH)), *records])
    together = together[(together[:, record.STANDING] > 0.0) & np.isfinite(together).all(axis=1)]
    c = listed_once(facing(canonical_form(candidates_of(together, problem), swapped), swapped))
    rows = problem.rows[c.feature]
    normals = outward_normals(rows[..., :8], c.point)
    # All entries are -1 where the wrenches do not span the space.
    spans = (c.null > -1.0).any(axis=1)
    null = c.null * np.where(c.null.min(axis=1) >= -c.null.max(axis=1), 1.0, -1.0)[:, None]
    along, _ = rotated(normals[..., 0], normals[..., 1], c.theta[:, None])
    return Contacts(
        evolve(c, force=null),
        margin=np.where(spans, null.min(axis=1, initial=1.0), -1.0),
        null=null,
        clamping=-problem.vise.clamping * (null * along * is_standing(c.standing)).sum(axis=1),
        end_distance=end_distances(rows, c.point).min(axis=(1, 2), initial=np.inf),
    )


def facing(c: Candidates, swapped: int) -> Candidates:
    """Contacts with the moving chord on the right, where the carriers may swap their ``swapped`` pegs: those whose moving
    pegs are farther right in the middle.

    Either chord may be on the left, and each set of four contacts is found both ways. Where neither is farther right, the
    lower one is taken for the right one.
    """
    across, upward = rotated(c.point[..., 0], c.point[..., 1], c.theta[:, None])
    right, lower = (v[:, 2:].sum(axis=1) - v[:, :2].sum(axis=1) for v in (across, -upward))
    return c.take((c.standing != swapped) | (right > EVEN) | ((right > -EVEN) & (lower > 0.0)))


def restriction_removals(problem: Problem, threads: int | None, left: int) -> tuple[int, list[Removal]]:
    """Simultaneous contacts without any restriction, and what each kind of restriction takes away of them.

    Parameters
    ----------
    left : contacts that keep all restrictions.
    """
    vise, asked = problem.vise, problem.restrictions
    free_vise = evolve(vise, rows=None, blocked=(), body_radius=vise.peg_radius)
    steps: list[tuple[str, Restrictions, Vise]] = []
    if asked.avoid:
        steps.append(("faces to avoid", Restrictions(avoid=asked.avoid), free_vise))
    if asked.zones:
        thick = evolve(free_vise, body_radius=vise.body_radius)
        steps.append(("keep-out zones", Restrictions(avoid=asked.avoid, zones=asked.zones), thick))
    if vise.body_radius > vise.peg_radius or vise.blocked or vise.rows is not None:
        steps.append(("holes that the jaws do not have, or too near for the bodies", evolve(asked, angles=()), vise))
    if asked.angles:
        steps.append(("angles of the part", asked, vise))

    def count(restrictions: Restrictions, in_vise: Vise) -> int:
        asked = evolve(problem.query, toolkit=in_vise, restrictions=restrictions, contact_margin=0.0)
        return contacts_of(Problem.of(asked), threads)

    first = before = max(count(Restrictions(), free_vise), left) if steps else left
    removals = []
    for rule, restrictions, in_vise in steps:
        after = left if rule == steps[-1][0] else min(max(count(restrictions, in_vise), left), before)
        removals.append(Removal(rule, before, after))
        before = after
    return first, removals


Rule = tuple[str, Callable[[Contacts], BoolArray], Callable[[Contacts], tuple[int, str]]]


def rules(problem: Problem, unit: Unit) -> list[Rule]:
    """The rules in the order they are asked: words, which contacts keep it, and which broken one comes nearest and why."""
    vise, margin = problem.vise, problem.contact_margin
    out: list[Rule] = []
    if margin > 0.0:
        out.append(("contact margin", lambda c: c.end_distance >= margin, partial(short_of_margin, margin, unit)))
    out.append(
        (
            "smallest gap",
            lambda c: c.candidates.gap >= vise.min_gap - GAP_SLACK,
            partial(too_near, vise, unit),
        )
    )
    out.append(("closure", lambda c: c.margin > LEAST_CLOSURE, open_contact))
    out.append(("clamping", lambda c: c.clamping > LEAST_CLAMPING, partial(unclamped, vise.clamping)))
    return [*out, *placing_rules(problem), ("the exact test of what is left", no_contact, on_the_edge)]


def placing_rules(problem: Problem) -> list[Rule]:
    """The rules about where fixtures stand in the jaws, as far as the vise and the user have any."""
    vise, asked = problem.vise, problem.restrictions
    bare = evolve(vise, rows=None, max_opening=None, blocked=(), body_radius=vise.peg_radius)
    out: list[Rule] = []

    def rule(words: str, in_vise: Vise, restrictions: Restrictions) -> None:
        part = evolve(problem, query=evolve(problem.query, toolkit=in_vise, restrictions=restrictions))
        out.append((words, lambda c: arranged(c.candidates, part).fits, partial(no_place, words)))

    if vise.body_radius > vise.peg_radius:
        bare = evolve(bare, body_radius=vise.body_radius)
        rule("bodies that would overlap", bare, Restrictions())
    if asked.angles:
        rule("angles of the part", bare, asked)
    if vise.max_opening is not None:
        bare = evolve(bare, max_opening=vise.max_opening)
        rule("largest opening", bare, asked)
    if vise.rows is not None:
        bare = evolve(bare, rows=vise.rows)
        rule("rows of holes", bare, asked)
    if vise.blocked:
        rule("blocked holes", vise, asked)
    return out


def no_contact(contacts: Contacts) -> BoolArray:
    """None of the contacts."""
    return np.zeros(len(contacts.margin), np.bool_)


def short_of_margin(margin: float, unit: Unit, c: Contacts) -> tuple[int, str]:
    """The contact whose pegs are farthest from the ends of their faces."""
    index = int(c.end_distance.argmax())
    return index, (
        f"a peg touches {unit.text(c.end_distance[index])} from where its face ends for it; the contact margin is "
        f"{unit.figure(margin)} {unit.abbreviation}."
    )


def too_near(vise: Vise, unit: Unit, c: Contacts) -> tuple[int, str]:
    """The contact whose right pegs are farthest from the left ones."""
    index = int(c.candidates.gap.argmax())
    gap = c.candidates.gap[index]
    where = f"{unit.text(abs(gap))} {'to the right of the left ones' if gap >= 0 else 'to their left'}"
    least = f"{unit.figure(vise.min_gap)} {unit.abbreviation}"
    return index, f"the right pegs would stand {where}; the smallest gap is {least}."


def open_contact(c: Contacts) -> tuple[int, str]:
    """The contact that comes nearest to force closure."""
    index = int(c.margin.argmax())
    if c.margin[index] > -ROUNDING:
        return (
            index,
            "the lines of force of the pegs meet in one point or are parallel, so one peg would not press at all.",
        )
    pulls = int((c.null[index] < 0).sum())
    many = "one peg" if pulls == 1 else f"{pulls} pegs"
    return index, f"{many} would have to pull the part instead of pressing on it: the part can slip out."


def unclamped(clamping: int, c: Contacts) -> tuple[int, str]:
    """The contact that comes nearest to being clamped."""
    ways = ("the jaws are pressed apart, not when they close", "the jaws close, not when they are pressed apart")
    return int(c.clamping.argmax()), f"it holds when {ways[0 if clamping > 0 else 1]}."


def no_place(words: str, c: Contacts) -> tuple[int, str]:
    """The best of what cannot be placed."""
    return int(c.margin.argmax()), f"it would hold, but what was asked for of the vise forbids it: {words}."


def on_the_edge(c: Contacts) -> tuple[int, str]:
    """The best of what the exact test removes."""
    return int(c.margin.argmax()), "it meets every rule to within rounding, but not exactly."


def nearest_miss(contacts: Contacts, miss: tuple[int, str], problem: Problem) -> NearestMiss:
    """A contact that is no fixture, placed in jaws without ends."""
    index, words = miss
    vise = evolve(problem.vise, rows=None, max_opening=None, blocked=(), min_gap=0.0)
    part = evolve(problem, query=evolve(problem.query, toolkit=vise, restrictions=None))
    table = placed(contacts.candidates.take(np.array([index])), part)
    return NearestMiss(fixture_at(table, vise, 0), words)


def helps(query: Query, threads: int | None, unit: Unit) -> tuple[Help, ...]:
    """Single changes of what was asked for with which there are fixtures, the most first."""
    out = []
    for words, change in changes(query, unit):
        enough = Event()
        timer = Timer(HELP_SECONDS, enough.set)
        timer.start()
        try:
            asked = evolve(query, ranking="closure_margin", best=None, **change)
            result = answer(asked, threads=threads, cancel=enough)
        except InputError:
            continue
        finally:
            timer.cancel()
        if any(result.found.values()):
            out.append(Help(words, sum(result.found.values()), result.complete))
    return tuple(sorted(out, key=lambda help: -help.fixtures))


def changes(query: Query, unit: Unit) -> Iterator[tuple[str, dict[str, Any]]]:
    """Changes of a query to try, one at a time: in words, and what then is asked instead."""
    asked, vise = query.restrictions, query.toolkit
    if asked.avoid:
        if len(asked.avoid) > 1:
            faces = ", ".join(str(number) for number in asked.avoid)
            yield f"touching faces {faces} too", {"restrictions": evolve(asked, avoid=())}
        for face in asked.avoid[:MOST_FACES]:
            rest = tuple(number for number in asked.avoid if number != face)
            yield f"touching face {face} too", {"restrictions": evolve(asked, avoid=rest)}
    if asked.zones:
        yield "without the keep-out zones", {"restrictions": evolve(asked, zones=())}
    if asked.angles:
        yield "at any angle", {"restrictions": evolve(asked, angles=())}
    if query.contact_margin > 0:
        yield "without a contact margin", {"contact_margin": 0.0}
    assert isinstance(vise, Vise)
    for words, fields in vise_changes(vise, unit):
        yield words, {"toolkit": evolve(vise, **fields)}


def vise_changes(vise: Vise, unit: Unit) -> Iterator[tuple[str, dict[str, Any]]]:
    """Changes of a vise to try, one at a time: in words, and what fields then are."""
    if vise.body_radius > vise.peg_radius:
        yield "with pegs without a shoulder", {"body_radius": vise.peg_radius}
    if vise.blocked:
        yield "with no hole blocked", {"blocked": ()}
    if vise.rows is not None:
        yield "with as many rows as needed", {"rows": None}
    if vise.max_opening is not None:
        yield "with a larger opening", {"max_opening": None}
    if vise.min_gap > 2 * vise.peg_radius > 0:
        narrow = 2 * vise.peg_radius
        yield f"with a smallest gap of {unit.figure(narrow)} {unit.abbreviation}", {"min_gap": narrow}
    yield "with one more column on each jaw", {"columns": vise.columns + 1}
    if vise.row_offset == 0.0:
        offset = vise.pitch[1] / 2
        words = f"{unit.figure(offset)} {unit.abbreviation}"
        yield f"with the right jaw's rows offset by {words}", {"row_offset": offset}
    if min(vise.pitch) >= 4 * vise.peg_radius:
        half = (vise.pitch[0] / 2, vise.pitch[1] / 2)
        yield "with half the pitch", {"pitch": half, "min_gap": min(vise.min_gap, half[0]), "blocked": ()}
