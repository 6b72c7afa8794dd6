"""A family on the terminal: the curve, what was left out, and the plan."""

from __future__ import annotations

from typing import TYPE_CHECKING

from workhold.cli.saying import tell
from workhold.cli.table import Table

if TYPE_CHECKING:
    from workhold.family.family import Family
    from workhold.family.plan import Plan, SetUp
    from workhold.fixels.toolkit import Toolkit
    from workhold.units import Unit

__all__ = ["report"]

# Letters of a part's name that are shown, and up to which there is room for the figure as well.
LONGEST_NAME, SHORT_NAME = 26, 16


def report(found: Family, plan: Plan | None, spent: str, unit: Unit) -> None:
    """Tell the curve, what was left out, and the plan."""
    from workhold.cli.tables import plural, print_tables

    toolkit = found.toolkit
    for part in found.left_out:
        tell(f"{part.name} is left out: {part.reason}.")
    if not found.members:
        print_tables(f"No pattern holds any of the parts {toolkit.wording.inside}; {spent}.")
        return
    assert found.table is not None
    print_tables(curve_table(found, unit))
    sentences = [
        f"{plural(len(found.members), 'part')}, {plural(len(found.table.words), 'pattern')} that hold at least one of them; "
        f"{spent}.",
        f"The loss is the {found.figure.words} over the best that each part has {toolkit.wording.inside}.",
    ]
    if not all(plan.point.is_least and plan.point.at_least == plan.point.setups for plan in found.plans):
        sentences.append("Time was over before all of it was proven: a longer --time-limit may show less.")
    print_tables(*sentences)
    if plan is None:
        print_tables("See the plan of a line with --setups K, or of the fewest set-ups within a loss with --max-loss.")
        return
    for number_, setup in enumerate(plan.setups, 1):
        heading = f"Set-up {number_} of {len(plan.setups)}: {pegs_words(setup, toolkit)}"
        place = "" if number_ == 1 else f" ({setup.moved} to place, the rest stands)"
        print_tables("", f"{heading}{place}", setup_table(setup, found, unit))
        for one in setup.holdings:
            if not one.in_place:
                holes = ", ".join(peg.hole for peg in one.fixture.pegs)
                print_tables(f"{one.member.name} needs the same pegs in other columns: {holes}.")

    if any(one.turned for setup in plan.setups for one in setup.holdings):
        print_tables("", "A number with ' is that of the list after half a turn of everything, which swaps the jaws.")


def curve_table(found: Family, unit: Unit) -> Table:
    """The curve: set-ups, the worst loss and on which part, and how many pegs are moved."""
    from workhold.cli.tables import figure_text, heading
    from workhold.family.losses import loss_text

    table = Table((">set-ups", ">worst loss", ">pegs moved", f">{heading(found.figure, unit)}", "worst part"))
    for plan in found.plans:
        point = plan.point
        worst = max((one for setup in plan.setups for one in setup.holdings), key=lambda one: one.loss)
        count = f"{point.setups}" if point.at_least == point.setups else f"{point.at_least} to {point.setups}"
        table.add_row(
            count,
            loss_text(point.loss),
            str(plan.moved),
            figure_text(found.figure, worst.figure, unit),
            short_name(worst.member.name),
        )
    return table


def pegs_words(setup: SetUp, toolkit: Toolkit) -> str:
    """The holes of a set-up."""
    return ", ".join(peg.hole for peg in setup.standing.fixture.placed)


def setup_table(setup: SetUp, found: Family, unit: Unit) -> Table:
    """The parts of a set-up and how each lies."""
    from workhold.cli.tables import figure_text, heading
    from workhold.family.losses import loss_text
    from workhold.model.setting import settings_of

    settings = settings_of(setup.standing.fixture, found.toolkit)
    names = [f">{setting.short} {unit.abbreviation}" for setting in settings]
    columns = ("part", ">fixture", ">angle", f">x {unit.abbreviation}", f">y {unit.abbreviation}", *names, ">loss")
    # Long names, or the lengths of two clamps, leave no room for it on a terminal.
    with_figure = len(settings) < 2 and max(len(one.member.name) for one in setup.holdings) <= SHORT_NAME
    table = Table((*columns, f">{heading(found.figure, unit)}") if with_figure else columns)
    for one in setup.holdings:
        fixture = one.fixture
        pose = fixture.pose
        lengths = [unit.number(setting.length) for setting in settings_of(fixture, found.toolkit)]
        table.add_row(
            short_name(one.member.name),
            f"{one.number:,}" + ("'" if one.turned else ""),
            f"{pose.theta_deg:.3f}",
            unit.number(pose.x),
            unit.number(pose.y),
            *lengths,
            loss_text(one.loss),
            *([figure_text(found.figure, one.figure, unit)] if with_figure else []),
        )
    return table


def short_name(name: str) -> str:
    """A part's name, or its beginning and end where it is long.

    >>> short_name("ell.dxf"), short_name("bracket, left, machined side up.dxf")
    ('ell.dxf', 'bracket, left… side up.dxf')
    """
    half = LONGEST_NAME // 2
    return name if len(name) <= LONGEST_NAME else f"{name[:half]}…{name[1 - half :]}"
