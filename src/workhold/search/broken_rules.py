"""Why no contacts on a lattice make a fixture: what each rule takes away of them until none is left.

Every simultaneous contact is asked which rule it breaks first. The rules are asked one after the other, as a
person would. First comes what the user ruled out, then whether four pegs can touch at all, contact margin,
smallest gap, closure, clamping, and the place on the carriers. The counts are of contacts as computed, in
plain numbers; the proof that there is no fixture is the search's.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial

import numpy as np
from attrs import define, evolve, field, frozen
from numpy.typing import NDArray

from workhold.contact.features import measure_end_distances
from workhold.contact.problem import Frame, Problem
from workhold.contact.swept import list_swept_clearances
from workhold.contact.trimming import find_line_most_in_the_way
from workhold.conventions import END_SLACK, GAP_SLACK, LEAST_CLAMPING, LEAST_CLOSURE
from workhold.errors import InputError, join_words
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.symmetry import rotate_vectors
from workhold.kernels.base.feature import HIGH_SLACK, LOW_SLACK
from workhold.kernels.contact import record
from workhold.limits import choose_thread_count
from workhold.listing.asked import are_precise, touch_all
from workhold.listing.canonical_form import Candidates, list_each_once, make_candidates, make_canonical
from workhold.listing.placing import are_placeable, place_candidates
from workhold.listing.ranking import measure_table
from workhold.model.fixture_table import FixtureTable, make_fixture_of_row
from workhold.model.quality import LOCATION_ERROR
from workhold.model.query import Query
from workhold.model.requirements import Restrictions
from workhold.model.search_report import NearestMiss, Removal
from workhold.proof.deciding import is_standing
from workhold.search.cells import run_blocks
from workhold.search.shares import has_body_to_pass
from workhold.search.toolkit_search import ToolkitSearch, contacts_of
from workhold.statics.contact_matrix import compute_outward_normals
from workhold.units import Unit

__all__ = [
    "Removals",
    "SECOND_CLAMP",
    "find_all_contacts",
    "describe_body_rule",
    "find_program_line_in_the_way",
    "describe_program_rule",
    "count_removals",
    "describe_stroke_rule",
]

# What is asked last of locators and a clamp, where two clamps are needed.
SECOND_CLAMP = "a second clamp that holds the part together with the first, and is needed for it"


def drop_removals_of_nothing(removals: Iterable[Removal]) -> tuple[Removal, ...]:
    """Removals without those of rules for which no contact was left."""
    return tuple(removal for removal in removals if removal.before > 0)


@frozen
class Removals:
    """What rules take away, one after the other.

    Parameters
    ----------
    first : how many contacts there are before any rule.
    removals : of the rules for which contacts were left, in the order in which they are asked.
    nearest : what comes nearest to a fixture, if anything is near.
    """

    first: int
    removals: tuple[Removal, ...] = field(converter=drop_removals_of_nothing)
    nearest: NearestMiss | None

    @classmethod
    def together(cls, found: Sequence[Removals]) -> Removals:
        """The removals of several directions as one, with what came nearest where the most was left
        longest."""
        # A rule may be asked twice in one direction, early where that saves work and again at its place.
        counts: dict[tuple[str, int], tuple[int, int]] = {}
        for one in found:
            rules = [removal.rule for removal in one.removals]
            for number, removal in enumerate(one.removals):
                asked = removal.rule, rules[:number].count(removal.rule)
                before, after = counts.get(asked, (0, 0))
                counts[asked] = before + removal.before, after + removal.after
        nearest = max(found, key=lambda one: len(one.removals)).nearest
        removals = tuple(Removal(rule, *numbers) for (rule, _), numbers in counts.items())
        return cls(sum(one.first for one in found), removals, nearest)


Array = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

# ContactSets kept from each block of the search; far more than a part without a fixture has.
MOST_LISTED = 5_000
# Pegs this near in x, in mm, are even.
EVEN = 1e-6
# Where something is that lies along +x of a frame so many quarter turns on.
BESIDE = ("to the right of", "above", "to the left of", "below")
# A contact misses closure by this much at most to be called near.
ROUNDING = 1e-12


@define(frozen=True, eq=False)
class ContactSets:
    """N sets of four simultaneous contacts and what the rules ask of them.

    Parameters
    ----------
    candidates : the contacts, as fixtures would be.
    margin : (N,) smallest entry of the null vector of sum of sizes 1, of the sign that makes it largest.
    null : (N, 4) that null vector.
    clamping : (N,) the clamping force for it.
    end_distance : (N,) smallest distance in mm to the end of a feature, as the contact margin counts it.
    """

    candidates: Candidates
    margin: Array
    null: Array
    clamping: Array
    end_distance: Array

    def take(self, chosen: BoolArray) -> ContactSets:
        """Some of them."""
        rest = (values[chosen] for values in (self.margin, self.null, self.clamping, self.end_distance))
        return ContactSets(self.candidates.take(chosen), *rest)


def count_removals(problem: Problem, threads: int | None, unit: Unit, alone: bool) -> Removals:
    """How many contacts there are without any restriction, what each rule takes away of them, and what comes
    nearest.

    Parameters
    ----------
    alone : whether one clamp is to hold the part; of two the contacts are those of three locators and one of
        them. None comes nearest, as each is a clamp short.
    """
    contacts = find_all_contacts(problem, threads)
    first, removals = count_restriction_removals(problem, threads, len(contacts.margin))
    if not alone:
        return Removals(first, [*removals, Removal(SECOND_CLAMP, len(contacts.margin), 0)], None)
    nearest = None
    for rule, keeps, miss in rules(problem, unit):
        if len(contacts.margin) == 0:
            break
        kept = keeps(contacts)
        removals.append(Removal(rule, len(kept), int(kept.sum())))
        if not kept.any():
            nearest = make_nearest_miss(contacts, miss(contacts), problem)
        contacts = contacts.take(kept)
    return Removals(first, removals, nearest)


def find_all_contacts(problem: Problem, threads: int | None) -> ContactSets:
    """Every set of four simultaneous contacts of a problem, whatever the rules say of it."""
    workers = choose_thread_count(threads)
    search = ToolkitSearch.of(problem, counting=True, most_listed=MOST_LISTED, threads=workers)
    records, _ = run_blocks(search.blocks(problem.query.types), workers, None, None)
    swapped = search.frame.swapped
    together = np.concatenate([np.zeros((0, record.RECORD_LENGTH)), *records])
    together = together[(together[:, record.STANDING] > 0.0) & np.isfinite(together).all(axis=1)]
    c = list_each_once(facing(make_canonical(make_candidates(together, problem), swapped), swapped))
    rows = problem.rows[c.feature]
    normals = compute_outward_normals(rows, c.point)
    # All entries are -1 where the wrenches do not span the space.
    spans = (c.null > -1.0).any(axis=1)
    null = c.null * np.where(c.null.min(axis=1) >= -c.null.max(axis=1), 1.0, -1.0)[:, None]
    along, _ = rotate_vectors(normals[..., 0], normals[..., 1], c.theta[:, None])
    return ContactSets(
        evolve(c, force=null),
        margin=np.where(spans, null.min(axis=1, initial=1.0), -1.0),
        null=null,
        clamping=-problem.toolkit.clamping * (null * along * is_standing(c.standing)).sum(axis=1),
        end_distance=(
            measure_end_distances(rows, c.point) + rows[..., LOW_SLACK : HIGH_SLACK + 1] - END_SLACK
        ).min(axis=(1, 2), initial=np.inf),
    )


def facing(c: Candidates, swapped: int) -> Candidates:
    """Contacts with the moving chord on the right, where the carriers may swap their ``swapped`` pegs: those
    whose moving pegs are farther right in the middle.

    Either chord may be on the left, and each set of four contacts is found both ways. Where neither is
    farther right, the lower one is taken for the right one.
    """
    across, upward = rotate_vectors(c.point[..., 0], c.point[..., 1], c.theta[:, None])
    right, lower = (v[:, 2:].sum(axis=1) - v[:, :2].sum(axis=1) for v in (across, -upward))
    return c.take((c.standing != swapped) | (right > EVEN) | ((right > -EVEN) & (lower > 0.0)))


def count_restriction_removals(problem: Problem, threads: int | None, left: int) -> tuple[int, list[Removal]]:
    """Simultaneous contacts without any restriction, and what each kind of restriction takes away of them.

    Parameters
    ----------
    left : contacts that keep all restrictions.
    """
    toolkit, asked = problem.toolkit, problem.restrictions
    holes = [limit for limit in toolkit.limits if limit.bounds == "holes"]
    bodies = [limit for limit in toolkit.limits if limit.bounds == "bodies"]
    free = toolkit.without([*holes, *bodies])
    steps: list[tuple[str, Restrictions, Toolkit, Query]] = []
    whole, bare = problem.query, problem.query.without_program
    if asked.avoid:
        steps.append(("faces to avoid", Restrictions(avoid=asked.avoid), free, bare))
    if asked.zones:
        # What stands over a zone is a peg's body.
        zones = Restrictions(avoid=asked.avoid, zones=asked.zones)
        steps.append(("keep-out zones", zones, toolkit.without(holes), bare))
    if whole.program is not None:
        steps.append((describe_program_rule(whole), evolve(asked, angles=()), toolkit.without(holes), whole))
    if holes or bodies:
        steps.append((toolkit.wording.holes, evolve(asked, angles=()), toolkit, whole))
    if asked.angles:
        steps.append(("angles of the part", asked, toolkit, whole))

    def count(restrictions: Restrictions, held_in: Toolkit, query: Query) -> int:
        asked = evolve(query, toolkit=held_in, restrictions=restrictions, contact_margin=0.0)
        return contacts_of(Problem.of(asked), threads)

    first = before = max(count(Restrictions(), free, bare), left) if steps else left
    removals = []
    for rule, restrictions, held_in, query in steps:
        after = left if rule == steps[-1][0] else min(max(count(restrictions, held_in, query), left), before)
        removals.append(Removal(rule, before, after))
        before = after
    return first, removals


Rule = tuple[str, Callable[[ContactSets], BoolArray], Callable[[ContactSets], tuple[int, str]]]


def rules(problem: Problem, unit: Unit) -> list[Rule]:
    """The rules in the order they are asked: words, which contacts keep it, and which broken one comes
    nearest and why."""
    margin, frame = problem.contact_margin, problem.frame
    out: list[Rule] = []
    if margin > 0.0:
        out.append(
            (
                "contact margin",
                lambda c: c.end_distance >= margin - END_SLACK,
                partial(find_miss_of_margin, margin, unit),
            )
        )
    if frame.toolkit.gap is not None:
        out.append(
            (
                "smallest gap",
                lambda c: c.candidates.gap >= frame.gap - GAP_SLACK,
                partial(find_miss_of_gap, frame, unit),
            )
        )
    out.append(("closure", lambda c: c.margin > LEAST_CLOSURE, find_miss_of_closure))
    out.append(("clamping", lambda c: c.clamping > LEAST_CLAMPING, partial(find_miss_of_clamping, frame)))
    out += [*list_placing_rules(problem), *list_fixture_rules(problem, unit)]
    return [*out, ("the exact test of what is left", keep_no_contact, find_miss_of_exact_test)]


def list_placing_rules(problem: Problem) -> list[Rule]:
    """The rules about where fixtures stand on the carriers, as far as the toolkit and the user have any.

    The angles come after the pegs' bodies, and each rule is asked together with those before it.
    """
    toolkit, asked = problem.toolkit, problem.restrictions
    limits = toolkit.limits
    first = sum(limit.bounds == "bodies" for limit in limits)
    out: list[Rule] = []

    def rule(words: str, kept: int, restrictions: Restrictions, asked_of: Query = problem.query) -> None:
        query = evolve(asked_of, toolkit=toolkit.without(limits[kept:]), restrictions=restrictions)
        part = evolve(problem, query=query)
        keeps = partial(no_place, toolkit.noun, words)
        out.append((words, lambda c: are_placeable(c.candidates, part), keeps))

    if problem.frame.moving.on is not None:
        rule("locators clear of the clamp", 0, Restrictions())
    for number, limit in enumerate(limits):
        if number == first and asked.angles:
            rule("angles of the part", first, asked)
        ruled_out = asked if number >= first else Restrictions()
        if limit.bounds == "travel" and has_body_to_pass(problem.query):
            # First without what the tools do to the body that the stroke gives the clamp.
            rule(limit.rule, number + 1, ruled_out, problem.query.without_program)
            rule(describe_body_rule(problem.query), number + 1, ruled_out)
        else:
            rule(limit.rule, number + 1, ruled_out)
    if first == len(limits) and asked.angles:
        rule("angles of the part", first, asked)
    return out


def list_fixture_rules(problem: Problem, unit: Unit) -> list[Rule]:
    """The rules that are asked of each fixture by itself, as far as the user has any."""
    query, out = problem.query, list[Rule]()

    def table(c: ContactSets) -> FixtureTable:
        return place_candidates(c.candidates, problem)

    def untouched(c: ContactSets) -> tuple[int, str]:
        names = join_words([str(face) for face in query.restrictions.touch])
        return int(
            c.margin.argmax()
        ), f"it would hold, but it does not touch all the faces that must be touched: {names}."

    def imprecise(c: ContactSets) -> tuple[int, str]:
        errors = measure_table(table(c), problem).quality[:, LOCATION_ERROR]
        index, most = int(np.nanargmin(errors)), query.max_location_error or 0.0
        return index, (
            f"it would hold with a location error of {unit.format_length(errors[index])}, but at most "
            f"{unit.format_short_length(most)} {unit.abbreviation} is asked for."
        )

    if query.restrictions.touch:
        out.append(("faces to touch", lambda c: touch_all(table(c), query), untouched))
    if query.max_location_error is not None:
        out.append(
            (
                "largest location error",
                lambda c: are_precise(measure_table(table(c), problem), query),
                imprecise,
            )
        )
    return out


def keep_no_contact(contacts: ContactSets) -> BoolArray:
    """None of the contacts."""
    return np.zeros(len(contacts.margin), np.bool_)


def find_miss_of_margin(margin: float, unit: Unit, c: ContactSets) -> tuple[int, str]:
    """The contact whose pegs are farthest from the ends of their faces."""
    index = int(c.end_distance.argmax())
    return index, (
        f"a peg touches {unit.format_length(c.end_distance[index])} from where its face ends for it; "
        f"the contact margin is {unit.format_short_length(margin)} {unit.abbreviation}."
    )


def find_miss_of_gap(frame: Frame, unit: Unit, c: ContactSets) -> tuple[int, str]:
    """The contact whose moving pegs are farthest along the travel from the others."""
    index = int(c.candidates.gap.argmax())
    gap = c.candidates.gap[index]
    beyond = BESIDE[frame.quarters if gap >= 0 else (frame.quarters + 2) % 4]
    least = f"{unit.format_short_length(frame.gap)} {unit.abbreviation}"
    return index, (
        f"the {frame.moving.name} pegs would stand {unit.format_length(abs(gap))} {beyond} "
        f"the {frame.standing.name} ones; the smallest gap is {least}."
    )


def find_miss_of_closure(c: ContactSets) -> tuple[int, str]:
    """The contact that comes nearest to force closure."""
    index = int(c.margin.argmax())
    if c.margin[index] > -ROUNDING:
        return (
            index,
            "the lines of force of the pegs meet in one point or are parallel, "
            "so one peg would not press at all.",
        )
    pulls = int((c.null[index] < 0).sum())
    many = "one peg" if pulls == 1 else f"{pulls} pegs"
    return index, f"{many} would have to pull the part instead of pressing on it: the part can slip out."


def find_miss_of_clamping(frame: Frame, c: ContactSets) -> tuple[int, str]:
    """The contact that comes nearest to being clamped."""
    return int(c.clamping.argmax()), f"it holds when {frame.toolkit.wording.backwards}."


def no_place(noun: str, words: str, c: ContactSets) -> tuple[int, str]:
    """The best of what cannot be placed."""
    return int(
        c.margin.argmax()
    ), f"it would hold, but the limits that were given for the {noun} forbid it: {words}."


def find_miss_of_exact_test(c: ContactSets) -> tuple[int, str]:
    """The best of what the exact test removes."""
    return int(c.margin.argmax()), "it meets every rule to within rounding, but not exactly."


def make_nearest_miss(contacts: ContactSets, miss: tuple[int, str], problem: Problem) -> NearestMiss:
    """A contact that is no fixture, placed in a toolkit without limits."""
    index, words = miss
    toolkit = problem.toolkit.without(problem.toolkit.limits)
    part = evolve(problem, query=evolve(problem.query, toolkit=toolkit, restrictions=None))
    table = place_candidates(contacts.candidates.take(np.array([index])), part)
    return NearestMiss(make_fixture_of_row(table, toolkit, 0, problem.workpiece), words)


def find_program_line_in_the_way(query: Query) -> int | None:
    """The line of a query's program whose tool passes the longest stretch of places for pegs.

    None without a program, where it passes none, and where there are no pegs.
    """
    if query.program is None or query.toolkit.holds_by_friction:
        return None
    try:
        problem = Problem.of(query.without_program)
    except InputError:
        return None
    carriers = Frame.of(query.toolkit, problem.diameter).carriers
    for locus, carrier in zip(problem.loci, carriers, strict=True):
        pieces, beyond = list_swept_clearances(query, carrier)[0]
        line = find_line_most_in_the_way([feature.segment for feature in locus], pieces, beyond)
        if line is not None:
            return line
    return None


def describe_program_rule(query: Query) -> str:
    """What a program asks, as the rule that takes contacts away.

    It reads such as "tools of the program, most in line 7".
    """
    line = find_program_line_in_the_way(query)
    return "tools of the program" + ("" if line is None else f", most in line {line}")


def describe_body_rule(query: Query) -> str:
    """What a program asks of the bodies of clamps, from the tip back to the hole."""
    return f"body of the {query.toolkit.moving.noun} clear of the program's tools"


def describe_stroke_rule(query: Query, rule: str) -> str:
    """The rule on a clamp's stroke, with what a program asks of the body that the clamp then has."""
    return f"{rule}, {describe_body_rule(query)}" if has_body_to_pass(query) else rule
