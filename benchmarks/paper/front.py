"""What stands around the sections: the abstract, how it was measured, how to cite it, and the references."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from paper.claim_words import USUAL, find_largest_force
from paper.document import Block, Figures, Heading, Inline, Line, Listing, Marked, Paragraph

__all__ = ["TITLE", "after", "before"]

TITLE = "Complete sets of lattice fixtures: Wallack and Canny's algorithm measured again"
ROOT = Path(__file__).resolve().parents[2]

REFERENCES = (
    "A. S. Wallack and J. F. Canny, Modular fixture design for generalized polyhedra, 1996. The paper "
    "of this report.",
    "A. S. Wallack and J. F. Canny, Planning for modular and hybrid fixtures, Algorithmica 19, 1997.",
    "R. C. Brost and K. Y. Goldberg, A complete algorithm for designing planar fixtures using modular "
    "components, IEEE Transactions "
    "on Robotics and Automation 12, 1996.",
    "M. Overmars, A. Rao, O. Schwarzkopf and C. Wentink, Immobilizing polygons against a wall, "
    "Symposium on Computational "
    "Geometry, 1995.",
    "B. Mishra, J. T. Schwartz and M. Sharir, On the existence and synthesis of multifinger positive "
    "grips, Algorithmica 2, 1987.",
    "D. N. Bernstein, The number of roots of a system of equations, Functional Analysis and its "
    "Applications 9, 1975.",
    "F. Johansson, Arb: efficient arbitrary-precision midpoint-radius interval arithmetic, IEEE "
    "Transactions on Computers 66, 2017.",
    "A. Neumaier, Interval methods for systems of equations, Cambridge University Press, 1990.",
)


def before(every: Mapping[str, Figures]) -> list[Block]:
    """The abstract and how it was measured."""
    return [Paragraph(abstract(every)), *notes(every), *method(every["run"])]


def abstract(every: Mapping[str, Figures]) -> Line:
    """What was found, as far as it was measured."""
    out: list[Inline] = [
        Marked("label", "Abstract. "),
        "A fixture vise holds a flat workpiece of lines and arcs by four pegs in two lattices of holes. "
        "Wallack and Canny ",
        Marked("reference", "[1]"),
        " enumerate all such fixtures, as they did for polygons before ",
        Marked("reference", "[2]"),
        ". This report runs their algorithm and a faster one, both proven, on models of their workpieces.",
    ]
    one = every.get("table-one")
    if one is not None and one.value("together"):
        out += [
            " The rows of their table, ",
            one.count("together/paper_seconds"),
            " seconds in print, take ",
            one.significant("together/seconds", 2),
            " seconds on one processor.",
        ]
    two = every.get("table-two")
    if two is not None and two.value("most"):
        out += [
            " A general system has at most ",
            two.count("most/I"),
            " complex poses of Type I and ",
            two.count("most/II"),
            " of Type II, fewer than the printed degrees.",
        ]
    claims = every.get("claims")
    if claims is not None and claims.value("doubles"):
        usual = f"doubles/{find_largest_force(claims)}/lost/{USUAL}"
        out += [
            " Roots in double precision that count as real within ",
            claims.power(f"{usual}/tolerance"),
            " lose ",
            claims.percent(f"{usual}/share"),
            " of the fixtures of one workpiece.",
        ]
    scale = every.get("scale")
    if scale is not None and scale.value("catalogue/core_hours"):
        out += [
            " A catalogue of a million parts would take ",
            scale.significant("catalogue/core_hours", 2),
            " core hours.",
        ]
    out.append(
        " Every number below was measured by the run that wrote this report and stands in a file beside it."
    )
    return tuple(out)


def notes(every: Mapping[str, Figures]) -> list[Block]:
    """What is wanting in this run, if anything is."""
    told: list[Block] = []
    partial = [one.section for name, one in every.items() if not one.complete and name != "run"]
    if partial:
        told.append(
            Paragraph(
                (
                    Marked("label", "Incomplete. "),
                    f"The run was ended before these sections were whole: {', '.join(partial)}. ",
                    "What they had measured is shown.",
                )
            )
        )
    left = [name for name in every["run"].value("sections") or [] if name not in every]
    if left:
        told.append(Paragraph((Marked("label", "Not measured: "), f"{', '.join(left)}.")))
    if every["run"].value("quick"):
        told.append(
            Paragraph((Marked("label", "A trial. "), "This is a small part of everything, for tests."))
        )
    return told


def method(run: Figures) -> list[Block]:
    """On what and how."""
    return [
        Paragraph(
            (
                "Measured on ",
                Marked("code", f"{run.value('machine/processor')}"),
                " with ",
                run.count("processors"),
                " processors, ",
                Marked("code", f"Python {run.value('machine/Python')}"),
                ", ",
                Marked("code", f"numpy {run.value('machine/numpy')}"),
                ", workhold ",
                Marked("code", run.value("version")),
                " at ",
                Marked("code", run.value("commit")),
                ". Times are seconds of the processor "
                "unless it says otherwise, "
                "kernels compiled and loaded. Each section is made again by itself with ",
                Marked("code", "python benchmarks/make_paper.py --only SECTION"),
                ", where the section is the name of the data file that a number leads to; everything is "
                "made by ",
                Marked("code", "make paper"),
                ".",
            )
        )
    ]


def after() -> list[Block]:
    """How to cite, and the references."""
    return [
        Heading("Citing"),
        Paragraph(
            (
                "Please cite the paper ",
                Marked("reference", "[1]"),
                " for the algorithm and the "
                "workpieces' names, and the program for any "
                "number, model or drawing of this report; ",
                Marked("code", "CITATION.cff"),
                " in the "
                "repository has both. Name the commit "
                "above, and the key that a number shows: with them the number can be made again. For "
                "instance: ",
                Marked(
                    "quote", "workhold, version and commit, report of make paper, table-one/rows/0/contacts"
                ),
                ". The pictures are our own and under the licence of the program; no drawing of the "
                "paper is used.",
            )
        ),
        Heading("References"),
        Listing(tuple((Marked("reference", one),) for one in REFERENCES), "references"),
    ]
