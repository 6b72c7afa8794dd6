"""The claims that do not hold as printed, in words: the paper's sentence, ours, the witness and how to check it."""

from __future__ import annotations

from attrs import frozen

from paper.document import Figures, Inline, Line, Marked

__all__ = ["USUAL", "Claim", "claims", "find_largest_force"]

# Which of the tolerances of a real root is the one that a program would try.
USUAL = 3


@frozen
class Claim:
    """A claim for print.

    Parameters
    ----------
    title : the subject.
    quoted : the paper's sentence and its section.
    ours : what holds.
    files : witnesses beside the report.
    check : the command.
    """

    title: str
    quoted: tuple[str, str]
    ours: Line
    files: tuple[str, ...]
    check: str


def claims(figures: Figures) -> list[Claim]:
    """The claims whose witnesses are there."""
    out = [clamp(figures)] if figures.value("clamp") else []
    out += [degrees(figures), printed_equation()] if figures.value("divisible") else []
    out += [finite(figures)] if figures.value("sliding") else []
    return [*out, complete(figures)] if figures.value("doubles") else out


def clamp(figures: Figures) -> Claim:
    """The translating clamp's sentence."""
    shares: list[Inline] = []
    for k in figures.every("clamp"):
        shares += [
            ", " if k else "",
            figures.count(f"clamp/{k}/held"),
            " of ",
            figures.count(f"clamp/{k}/clamp"),
            f" of the {figures.value(f'clamp/{k}/part')}",
        ]
    return Claim(
        "The translating clamp",
        (
            "all translating clamp configurations correspond to Type II fixture vise configurations",
            "Section 1",
        ),
        (
            "About half do. A vise's right peg stands to the right of every left peg, or the jaws would "
            "overlap; a clamp on a plate ",
            Marked("reference", "[3]"),
            " "
            "may stand beside or behind a locator, or inside a hole. With one direction of the clamp, "
            "holes ",
            figures.fixed("clamp_pitch", 0),
            " mm apart and a gap of ",
            figures.fixed("gap", 0),
            " mm, a vise of any number of columns holds ",
            *shares,
            ". In the witness, fixture ",
            figures.count("clamp_number"),
            " of its file, the clamp's tip stands ",
            figures.fixed("clamp_behind", 1),
            " mm behind a locator. What does hold: the Type II "
            "fixtures of a vise are exactly the fixtures of the clamp with that gap whose "
            "locators span no more columns than the vise has.",
        ),
        ("clamp.json", "clamp.svg"),
        "workhold verify paper/witnesses/clamp.json",
    )


def degrees(figures: Figures) -> Claim:
    """The numbers of roots."""

    def told(kind: str) -> Line:
        path = f"degree_{kind}"
        return (
            f"Type {kind}: printed ",
            figures.count(f"{path}/printed"),
            ", whole resultant ",
            figures.count(f"{path}/eliminated"),
            ", complex poses ",
            figures.count(f"{path}/poses"),
        )

    return Claim(
        "The numbers of roots",
        (
            "this approach reduces to solving 8th order polynomials for Type II configurations, and 24th "
            "order polynomials for Type I "
            "configurations",
            "Section 1.1",
        ),
        (
            "The printed orders are above the numbers of solutions: what else there is in a resultant "
            "are factors that vanish only for "
            "complex rotations without meaning. ",
            *told("I"),
            "; ",
            *told("II"),
            ", each for arcs alone. ",
            Marked("label", "Table 2"),
            " has all rows.",
        ),
        ("degrees.json",),
        "python benchmarks/paper/elimination.py paper/witnesses/degrees.json",
    )


def printed_equation() -> Claim:
    """A slip in equations 3 and 5."""
    return Claim(
        "A slip in two equations",
        ("Fortunately the circular constraint expression is divisible by (1+t²)(1+u²)", "Section 4.3"),
        (
            "It is where the centre of the circle is weighted as the point is. As equations ",
            Marked("reference", "(3) and (5)"),
            " stand in the text that we have, ",
            Marked("formula", "(xc, yc, (1+t²)(1+u²))"),
            " is subtracted from the point, and dividing leaves a rest. With ",
            Marked("formula", "(1+t²)(1+u²) (xc, yc, 1)"),
            " it divides, and that is what we use.",
        ),
        (),
        "python benchmarks/paper/elimination.py paper/witnesses/degrees.json",
    )


def finite(figures: Figures) -> Claim:
    """Four contacts with force closure need not be finite in number."""
    return Claim(
        "A finite number of ways",
        (
            "Since there are only a finite number of ways to fixture an arbitrary workpiece, fixtures can "
            "be enumerated",
            "Section 6",
        ),
        (
            "By the paper's own test, simultaneous contact and force closure ",
            Marked("reference", "[5]"),
            ", there are parts with "
            "infinitely many. In the witness two "
            "left pegs hold an upright from both sides and two right pegs a cross bar from above and "
            "below. In rational numbers all "
            "four touch and the forces close at a separation of ",
            figures.count("sliding/0/separation"),
            " mm as at ",
            figures.count("sliding/1/separation"),
            " mm and everywhere between, with the same forces, ",
            figures.fixed("sliding/0/forces/0", 1),
            " and ",
            figures.fixed("sliding/0/forces/2", 1),
            " of their sum at each peg of the left and of the right jaw. No force works against the "
            "jaw: its share is ",
            figures.fixed("sliding/0/jaw_force", 1),
            ", so closing the vise does not clamp. Finite is "
            "the number of fixtures that "
            "clamp, because a double or a sliding solution never does; of those this part has ",
            figures.count("sliding_listed"),
            " in two columns.",
        ),
        ("bar.json", "bar.svg"),
        "workhold design paper/witnesses/bar.json --pitch 10 --columns 2 --peg-radius 3",
    )


def find_largest_force(figures: Figures) -> int:
    """The row of which the usual tolerance loses the largest share."""
    rows = figures.value("doubles")
    return max(range(len(rows)), key=lambda k: rows[k]["lost"][USUAL]["share"])


def complete(figures: Figures) -> Claim:
    """What complete needs in floating point."""
    rows = figures.value("doubles")
    worst = find_largest_force(figures)
    loosest = len(rows[worst]["lost"]) - 1
    left = max(range(len(rows)), key=lambda k: rows[k]["lost"][loosest]["share"])
    return Claim(
        "What complete needs in floating point",
        ("we present a complete algorithm to automatically design fixtures", "Abstract"),
        (
            "The algorithm is complete in exact arithmetic. The paper takes roots numerically, and a "
            "program has to say when a computed "
            "root is real. With the least polynomials there are, their roots from companion matrices in "
            "double precision, and every "
            "later step proven, a tolerance of ",
            figures.power(f"doubles/{worst}/lost/{USUAL}/tolerance"),
            " loses ",
            figures.percent(f"doubles/{worst}/lost/{USUAL}/share"),
            " of the fixtures of ",
            Marked("label", rows[worst]["part"]),
            ". Even one of ",
            figures.power(f"doubles/{left}/lost/{loosest}/tolerance"),
            " loses ",
            figures.percent(f"doubles/{left}/lost/{loosest}/share"),
            " of those of ",
            Marked("label", rows[left]["part"]),
            ": in symmetric parts roots lie close together or coincide, and rounding moves them off the "
            "real line by the square root of "
            "its size. What complete needs is a bound on every rounding: roots that are isolated, or "
            "ranges of orientation that are "
            "discarded only when a bound says so, and a name for what no bound decides. Sampling the "
            "orientation is no way round (",
            Marked("label", "Table 4"),
            "): it misses pairs of roots between samples, and roots at the "
            "ends of curves. The witness is a "
            "fixture of ",
            Marked("label", figures.value("doubles_part") or "none"),
            " that the roots in doubles lose; its file holds it, and is proven and complete.",
        ),
        ("doubles.json", "doubles.svg"),
        "workhold verify paper/witnesses/doubles.json --complete",
    )
