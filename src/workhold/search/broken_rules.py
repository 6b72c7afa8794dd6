"""Why no contacts on a lattice make a fixture: how many contacts each rule removes until none is left.

For every simultaneous contact the first rule that it breaks is found. The rules are tested in the order in
which a person would test them: first the user's restrictions, then whether four pegs can touch at all,
contact margin, smallest gap, closure, clamping, and the place on the carriers. The contacts are counted in
floating-point arithmetic; the proof that there is no fixture comes from the search.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial

import numpy as np
from attrs import define, evolve, field, frozen
from numpy.typing import NDArray

from workhold.contact.features import measure_end_distances
from workhold.contact.problem import Problem, SearchFrame
from workhold.contact.swept import list_swept_clearances
from workhold.contact.trimming import find_line_most_in_the_way
from workhold.conventions import END_SLACK, GAP_SLACK, LEAST_CLAMPING, LEAST_CLOSURE
from workhold.errors import InputError, join_words
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.symmetry import rotate_vectors
from workhold.kernels.base.feature import HIGH_SLACK, LOW_SLACK
from workhold.kernels.contact import record
from workhold.limits import choose_thread_count
from workhold.listing.asked import are_precise, are_touching_all
from workhold.listing.canonical_form import CandidateFixtures, list_each_once, make_candidates, make_canonical
from workhold.listing.placing import are_placeable, place_candidates
from workhold.listing.ranking import measure_table
from workhold.model.fixture_table import FixtureTable, make_fixture_of_row
from workhold.model.quality import LOCATION_ERROR
from workhold.model.query import Query
from workhold.model.requirements import Restrictions
from workhold.model.search_report import NearestMiss, RuleRemoval
from workhold.proof.deciding import is_standing
from workhold.search.cells import run_blocks
from workhold.search.shares import has_body_to_pass
from workhold.search.toolkit_search import ToolkitSearch, count_problem_contacts
from workhold.statics.contact_matrix import compute_outward_normals
from workhold.units import Unit

__all__ = [
    "RuleRemovals",
    "SECOND_CLAMP",
    "find_all_contacts",
    "describe_body_rule",
    "find_program_line_in_the_way",
    "describe_program_rule",
    "count_removals",
    "describe_stroke_rule",
]

# The rule that is asked last of locators and one clamp, where two clamps are needed.
SECOND_CLAMP = "a second clamp that holds the part together with the first, and is needed for it"


def drop_removals_of_nothing(removals: Iterable[RuleRemoval]) -> tuple[RuleRemoval, ...]:
    """Return, in the same order, the removals by those rules that were tested on at least one contact."""
    return tuple(removal for removal in removals if removal.before > 0)


@frozen
class RuleRemovals:
    """Number of contacts that the rules remove, one rule after the other.

    Parameters
    ----------
    first : number of contacts before any rule.
    removals : number of contacts before and after each rule, in the order of the rules; only rules that were
        tested on at least one contact.
    nearest : the contact that comes nearest to being a fixture, and why it is not a fixture; None where no
        such contact is known.
    """

    first: int
    removals: tuple[RuleRemoval, ...] = field(converter=drop_removals_of_nothing)
    nearest: NearestMiss | None

    @classmethod
    def merge(cls, found: Sequence[RuleRemovals]) -> RuleRemovals:
        """Return the removals of several directions of the clamp, summed rule by rule.

        The nearest miss is taken from the direction in which the most rules were tested before no contact was
        left.
        """
        # A rule may be asked twice in one direction, early where that saves work and again at its place.
        counts: dict[tuple[str, int], tuple[int, int]] = {}
        for one in found:
            rules = [removal.rule for removal in one.removals]
            for number, removal in enumerate(one.removals):
                asked = removal.rule, rules[:number].count(removal.rule)
                before, after = counts.get(asked, (0, 0))
                counts[asked] = before + removal.before, after + removal.after
        nearest = max(found, key=lambda one: len(one.removals)).nearest
        removals = tuple(RuleRemoval(rule, *numbers) for (rule, _), numbers in counts.items())
        return cls(sum(one.first for one in found), removals, nearest)


Array = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

# Contact sets listed by each block of the search; far more than a part without a fixture has.
MOST_LISTED = 5_000
# mm. Pegs whose x differ by less count as equally far right.
EVEN = 1e-6
# Words for the direction +x of a frame that is turned by 0, 1, 2 or 3 quarter turns.
BESIDE = ("to the right of", "above", "to the left of", "below")
# A contact whose smallest share of force is above minus this is said to have a contact without force.
ROUNDING = 1e-12


@define(frozen=True, eq=False)
class ContactSets:
    """N sets of four simultaneous contacts, with the figures that the rules test.

    Parameters
    ----------
    candidates : the contacts as candidates for fixtures.
    null : (N, 4) null vector of the four contacts' wrenches. The absolute values of its entries sum to 1. Its
        sign is chosen so that its smallest entry is as large as possible.
    margin : (N,) smallest entry of ``null``; -1.0 if the wrenches do not span the space.
    clamping : (N,) force with which the carriers press the part between them, for the peg forces ``null``.
    end_distance : (N,) smallest distance in mm of a contact from the end of its feature, as the contact
        margin defines it.
    """

    candidates: CandidateFixtures
    margin: Array
    null: Array
    clamping: Array
    end_distance: Array

    def take(self, chosen: BoolArray) -> ContactSets:
        """Return the contact sets that a mask (N,) selects."""
        rest = (values[chosen] for values in (self.margin, self.null, self.clamping, self.end_distance))
        return ContactSets(self.candidates.take(chosen), *rest)


def count_removals(problem: Problem, threads: int | None, unit: Unit, alone: bool) -> RuleRemovals:
    """Return the number of simultaneous contacts without restrictions, and the number that each rule removes.

    If a rule leaves no contact, the result also has the contact that is nearest to being a fixture.

    Parameters
    ----------
    threads : None for one on each processor.
    unit : unit of lengths in the sentence about the nearest miss.
    alone : whether one clamp holds the part. If False, two are needed: the contacts are those of three
        locators and one clamp, the rule :data:`SECOND_CLAMP` removes all of them, and there is no nearest
        miss.
    """
    contacts = find_all_contacts(problem, threads)
    first, removals = count_restriction_removals(problem, threads, len(contacts.margin))
    if not alone:
        return RuleRemovals(first, [*removals, RuleRemoval(SECOND_CLAMP, len(contacts.margin), 0)], None)
    nearest = None
    for rule, keeps, miss in list_rules(problem, unit):
        if len(contacts.margin) == 0:
            break
        kept = keeps(contacts)
        removals.append(RuleRemoval(rule, len(kept), int(kept.sum())))
        if not kept.any():
            nearest = make_nearest_miss(contacts, miss(contacts), problem)
        contacts = contacts.take(kept)
    return RuleRemovals(first, removals, nearest)


def find_all_contacts(problem: Problem, threads: int | None) -> ContactSets:
    """Return every set of four simultaneous contacts of a problem, each once, whether or not it satisfies the
    rules.

    The search uses a contact margin of 0, and lists at most :data:`MOST_LISTED` sets per block of work.
    ``threads`` None means one thread on each processor.
    """
    workers = choose_thread_count(threads)
    search = ToolkitSearch.from_problem(problem, counting=True, most_listed=MOST_LISTED, threads=workers)
    records, _ = run_blocks(search.make_blocks(problem.query.types), workers, None, None)
    swapped = search.frame.swapped_peg_count
    together = np.concatenate([np.zeros((0, record.RECORD_LENGTH)), *records])
    together = together[(together[:, record.STANDING] > 0.0) & np.isfinite(together).all(axis=1)]
    c = list_each_once(
        select_facing_right(make_canonical(make_candidates(together, problem), swapped), swapped)
    )
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


def select_facing_right(c: CandidateFixtures, swapped: int) -> CandidateFixtures:
    """Return the contact sets, each once: two sets may differ only by exchanging the pegs of the two
    carriers.

    ``swapped`` is the number of standing pegs with which the two carriers may be exchanged. Each set with
    that many standing pegs is found twice. Of the two, the one whose moving pegs are farther in +x on average
    is kept; with equal x, the one whose moving pegs are lower in y.
    """
    across, upward = rotate_vectors(c.point[..., 0], c.point[..., 1], c.theta[:, None])
    right, lower = (v[:, 2:].sum(axis=1) - v[:, :2].sum(axis=1) for v in (across, -upward))
    return c.take((c.standing != swapped) | (right > EVEN) | ((right > -EVEN) & (lower > 0.0)))


def count_restriction_removals(
    problem: Problem, threads: int | None, left: int
) -> tuple[int, list[RuleRemoval]]:
    """Return (the number of simultaneous contacts without restrictions, the removals by each restriction).

    The restrictions, in order: faces to avoid, keep-out zones, program, blocked holes and peg bodies, angles.
    Only restrictions that the query has are listed.

    Parameters
    ----------
    left : number of contacts that satisfy all restrictions.
    """
    toolkit, asked = problem.toolkit, problem.restrictions
    holes = [limit for limit in toolkit.limits if limit.bounds == "holes"]
    bodies = [limit for limit in toolkit.limits if limit.bounds == "bodies"]
    free = toolkit.without_limits([*holes, *bodies])
    steps: list[tuple[str, Restrictions, Toolkit, Query]] = []
    whole, bare = problem.query, problem.query.without_program
    if asked.avoid:
        steps.append(("faces to avoid", Restrictions(avoid=asked.avoid), free, bare))
    if asked.zones:
        # Only bodies of pegs can reach over a zone, so their limits are kept here.
        zones = Restrictions(avoid=asked.avoid, zones=asked.zones)
        steps.append(("keep-out zones", zones, toolkit.without_limits(holes), bare))
    if whole.program is not None:
        steps.append(
            (describe_program_rule(whole), evolve(asked, angles=()), toolkit.without_limits(holes), whole)
        )
    if holes or bodies:
        steps.append((toolkit.wording.holes, evolve(asked, angles=()), toolkit, whole))
    if asked.angles:
        steps.append(("angles of the part", asked, toolkit, whole))

    def count(restrictions: Restrictions, held_in: Toolkit, query: Query) -> int:
        """Return the number of simultaneous contacts under some restrictions, in a toolkit, with a query's
        program.
        """
        asked = evolve(query, toolkit=held_in, restrictions=restrictions, contact_margin=0.0)
        return count_problem_contacts(Problem.from_query(asked), threads)

    first = before = max(count(Restrictions(), free, bare), left) if steps else left
    removals = []
    for rule, restrictions, held_in, query in steps:
        after = left if rule == steps[-1][0] else min(max(count(restrictions, held_in, query), left), before)
        removals.append(RuleRemoval(rule, before, after))
        before = after
    return first, removals


Rule = tuple[str, Callable[[ContactSets], BoolArray], Callable[[ContactSets], tuple[int, str]]]


def list_rules(problem: Problem, unit: Unit) -> list[Rule]:
    """Return the rules from contact margin to exact test, in the order in which they are tested.

    Each rule is a triple: (1) its name for the user; (2) a function that returns a mask (N,), True for
    contacts that satisfy the rule; (3) a function that takes contacts that all break the rule, and returns
    the index of the nearest one and a sentence that says why it breaks the rule.
    """
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
    """Return the rules about the place on the carriers, in the form of :func:`list_rules`.

    They are: locators clear of the clamp, each limit of the toolkit, angles of the part. Each rule's test
    includes the rules before it. The angles come after the limits on the pegs' bodies.
    """
    toolkit, asked = problem.toolkit, problem.restrictions
    limits = toolkit.limits
    first = sum(limit.bounds == "bodies" for limit in limits)
    out: list[Rule] = []

    def add_rule(words: str, kept: int, restrictions: Restrictions, asked_of: Query = problem.query) -> None:
        """Append a rule that tests the toolkit's first ``kept`` limits and some restrictions."""
        query = evolve(asked_of, toolkit=toolkit.without_limits(limits[kept:]), restrictions=restrictions)
        part = evolve(problem, query=query)
        keeps = partial(explain_no_place, toolkit.noun, words)
        out.append((words, lambda c: are_placeable(c.candidates, part), keeps))

    if problem.frame.moving.on is not None:
        add_rule("locators clear of the clamp", 0, Restrictions())
    for number, limit in enumerate(limits):
        if number == first and asked.angles:
            add_rule("angles of the part", first, asked)
        ruled_out = asked if number >= first else Restrictions()
        if limit.bounds == "travel" and has_body_to_pass(problem.query):
            # First without the program, then with the rule that tools keep clear of the clamp's body.
            add_rule(limit.rule, number + 1, ruled_out, problem.query.without_program)
            add_rule(describe_body_rule(problem.query), number + 1, ruled_out)
        else:
            add_rule(limit.rule, number + 1, ruled_out)
    if first == len(limits) and asked.angles:
        add_rule("angles of the part", first, asked)
    return out


def list_fixture_rules(problem: Problem, unit: Unit) -> list[Rule]:
    """Return the rules tested on each fixture by itself, in the form of :func:`list_rules`.

    They are the faces to touch and the largest location error, each only if the query gives it.
    """
    query, out = problem.query, list[Rule]()

    def make_table(c: ContactSets) -> FixtureTable:
        """Return the contacts as fixtures placed in the toolkit."""
        return place_candidates(c.candidates, problem)

    def find_untouched(c: ContactSets) -> tuple[int, str]:
        """Return the index of the contact with the largest closure margin, and why it breaks the rule on
        faces to touch.
        """
        names = join_words([str(face) for face in query.restrictions.touch])
        return int(
            c.margin.argmax()
        ), f"it would hold, but it does not touch all the faces that must be touched: {names}."

    def find_imprecise(c: ContactSets) -> tuple[int, str]:
        """Return the index of the contact with the least location error, and a sentence that compares it with
        the limit.
        """
        errors = measure_table(make_table(c), problem).quality[:, LOCATION_ERROR]
        index, most = int(np.nanargmin(errors)), query.max_location_error or 0.0
        return index, (
            f"it would hold with a location error of {unit.format_length(errors[index])}, but at most "
            f"{unit.format_short_length(most)} {unit.abbreviation} is asked for."
        )

    if query.restrictions.touch:
        out.append(("faces to touch", lambda c: are_touching_all(make_table(c), query), find_untouched))
    if query.max_location_error is not None:
        out.append(
            (
                "largest location error",
                lambda c: are_precise(measure_table(make_table(c), problem), query),
                find_imprecise,
            )
        )
    return out


def keep_no_contact(contacts: ContactSets) -> BoolArray:
    """Return False for every contact, as a mask (N,)."""
    return np.zeros(len(contacts.margin), np.bool_)


def find_miss_of_margin(margin: float, unit: Unit, c: ContactSets) -> tuple[int, str]:
    """Return the index of the contact farthest from the ends of its features, and a sentence that says why it
    breaks the margin.

    ``margin`` is the contact margin in mm, ``unit`` the unit of lengths in the sentence.
    """
    index = int(c.end_distance.argmax())
    return index, (
        f"a peg touches {unit.format_length(c.end_distance[index])} from where its face ends for it; "
        f"the contact margin is {unit.format_short_length(margin)} {unit.abbreviation}."
    )


def find_miss_of_gap(frame: SearchFrame, unit: Unit, c: ContactSets) -> tuple[int, str]:
    """Return the index of the contact with the largest gap, and a sentence that compares it with the smallest
    gap.
    """
    index = int(c.candidates.gap.argmax())
    gap = c.candidates.gap[index]
    beyond = BESIDE[frame.quarters if gap >= 0 else (frame.quarters + 2) % 4]
    least = f"{unit.format_short_length(frame.gap)} {unit.abbreviation}"
    return index, (
        f"the {frame.moving.name} pegs would stand {unit.format_length(abs(gap))} {beyond} "
        f"the {frame.standing.name} ones; the smallest gap is {least}."
    )


def find_miss_of_closure(c: ContactSets) -> tuple[int, str]:
    """Return the index of the contact that comes nearest to force closure, and a sentence that says why it has no
    closure.
    """
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


def find_miss_of_clamping(frame: SearchFrame, c: ContactSets) -> tuple[int, str]:
    """Return the index of the contact with the largest clamping force,
    and a sentence that says why it does not clamp.
    """
    return int(c.clamping.argmax()), f"it holds when {frame.toolkit.wording.backwards}."


def explain_no_place(noun: str, words: str, c: ContactSets) -> tuple[int, str]:
    """Return the index of the contact with the largest closure margin, and a sentence that a limit forbids
    its place.

    ``noun`` names the toolkit, ``words`` the limit.
    """
    return int(
        c.margin.argmax()
    ), f"it would hold, but the limits that were given for the {noun} forbid it: {words}."


def find_miss_of_exact_test(c: ContactSets) -> tuple[int, str]:
    """Return the index of the contact with the largest closure margin, and a sentence.

    The sentence says that the contact meets every rule to within rounding, but not exactly.
    """
    return int(c.margin.argmax()), "it meets every rule to within rounding, but not exactly."


def make_nearest_miss(contacts: ContactSets, miss: tuple[int, str], problem: Problem) -> NearestMiss:
    """Return the nearest miss of some contacts: a fixture, and a sentence that says why it is not allowed.

    The fixture is placed in the toolkit without its limits. ``miss`` is (index of the contact, sentence).
    """
    index, words = miss
    toolkit = problem.toolkit.without_limits(problem.toolkit.limits)
    part = evolve(problem, query=evolve(problem.query, toolkit=toolkit, restrictions=None))
    table = place_candidates(contacts.candidates.take(np.array([index])), part)
    return NearestMiss(make_fixture_of_row(table, toolkit, 0, problem.workpiece), words)


def find_program_line_in_the_way(query: Query) -> int | None:
    """Return the number of the program line whose tool obstructs the pegs most.

    That is the line whose tool comes too near the longest part of the peg centres' loci. The carriers are
    tried in order; the first with such a line counts. None if no line obstructs pegs, without a program, for
    toolkits that hold by friction, and if the query without the program is invalid.
    """
    if query.program is None or query.toolkit.holds_by_friction:
        return None
    try:
        problem = Problem.from_query(query.without_program)
    except InputError:
        return None
    carriers = SearchFrame.from_toolkit(query.toolkit, problem.diameter).carriers
    for locus, carrier in zip(problem.loci, carriers, strict=True):
        pieces, beyond = list_swept_clearances(query, carrier)[0]
        line = find_line_most_in_the_way([feature.segment for feature in locus], pieces, beyond)
        if line is not None:
            return line
    return None


def describe_program_rule(query: Query) -> str:
    """Return the name of the rule about the program's tools, such as
    "tools of the program, most in line 7".
    """
    line = find_program_line_in_the_way(query)
    return "tools of the program" + ("" if line is None else f", most in line {line}")


def describe_body_rule(query: Query) -> str:
    """Return the name of the rule that a clamp's body keeps clear of the program's tools."""
    return f"body of the {query.toolkit.moving.noun} clear of the program's tools"


def describe_stroke_rule(query: Query, rule: str) -> str:
    """Return the name of the rule on a clamp's stroke, given as ``rule``.

    The rule on the clamp's body is added if the query has a program that may hit it.
    """
    return f"{rule}, {describe_body_rule(query)}" if has_body_to_pass(query) else rule
