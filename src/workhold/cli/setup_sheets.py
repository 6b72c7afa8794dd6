"""Files that commands write of a set-up: setup sheets, and bodies in GLB and STEP files.

The sheets are those of a design's first choice, with supports or with the part's other side if wanted.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from datetime import date
from pathlib import Path
from typing import TYPE_CHECKING, Any

from attrs import frozen

from workhold.cli.commands import make_flag, make_option, print_remark
from workhold.cli.outputs import STANDARD_OUTPUT, refuse_output
from workhold.cli.support_words import describe_stopped_search, find_supports_within_limit
from workhold.errors import InputError
from workhold.units import Unit

if TYPE_CHECKING:
    from workhold.model.first_side import FirstSide
    from workhold.model.requirements import Load
    from workhold.model.result import Result
    from workhold.model.support_triples import ChosenSupports, Supports
    from workhold.presenting.assembly import Assembly

__all__ = [
    "PART_FILE",
    "BodyOptions",
    "list_asked_model_files",
    "choose_supports_from_file",
    "choose_best_supports",
    "write_first_sheet",
    "compare_with_earlier_result",
    "refuse_sheet",
    "write_bodies",
]

PART_FILE = make_option(
    None,
    "FILE",
    "The STEP file that the result was designed from, so that the GLB and STEP show the part's own shape, "
    "not a prism.",
    "--part",
)


@frozen
class BodyOptions:
    """The options of a set-up in three dimensions, as typed; None for those not given."""

    glb: str | None = make_option(
        None, "FILE", "Write it in three dimensions into this file, whose name ends in .glb."
    )
    step: str | None = make_option(
        None, "FILE", "The same as a STEP assembly, for CAD and CAM; its name ends in .step."
    )
    supports: bool = make_flag(
        None,
        "Add the best three supports under the part and a clamp on top, of the usual sizes, to "
        "the GLB and STEP.",
        "--supports",
    )
    thickness: str | None = make_option(
        None,
        "LENGTH",
        "Height of the part in the GLB and STEP; that of its solid, or 10 mm, if not given.",
    )
    part: str | None = PART_FILE

    def list_given_model_files(self, inputs: Sequence[str | None], force: bool) -> list[Path]:
        """Return the GLB and STEP files to write.

        Raises InputError where an option is given that needs such a file and there is none.
        """
        of_files = {"thickness": self.thickness, "supports": self.supports, "part": self.part}
        return list_asked_model_files(self.glb, self.step, (*inputs, self.part), force, **of_files)


PAPER = (".pdf", ".svg", ".png")
# So many of the best are asked for supports, a millisecond each.
MOST_ASKED = 200


def list_asked_model_files(
    glb: str | None, step: str | None, inputs: Sequence[str | None], force: bool, **of_files: object
) -> list[Path]:
    """Return the paths of the GLB and STEP files asked for: none, one or two.

    ``of_files`` are further options, by name, that need such a file; None or False means not given. Raises
    InputError for such an option without a file, a wrong ending, and a file that must not be replaced.
    """
    paths = []
    for name, given, endings in (("--glb", glb, (".glb",)), ("--step", step, (".step", ".stp"))):
        if given is None:
            continue
        path = Path(given)
        if path.suffix.lower() not in endings:
            raise InputError(
                f"{name} {given} is not the name of such a file: let the name end in {endings[0]}."
            )
        refuse_output(path, inputs, force)
        paths.append(path)
    for option_name, value in of_files.items():
        if not paths and value is not None and value is not False:
            words = option_name.replace("_", "-")
            raise InputError(f"--{words} belongs to a file in three dimensions: give --glb or --step too.")
    return paths


def write_bodies(assembly: Assembly, paths: Sequence[Path], unit: Unit) -> None:
    """Write a set-up as GLB and STEP files;
    print remarks where the part's height was assumed or its shape simplified.
    """
    for path in paths:
        assembly.write(path)
    if not paths:
        return
    files, sizes = " and ".join(map(str, paths)), assembly.sizes
    if sizes.is_assumed:
        print_remark(
            f"in {files} the part is taken to be {unit.format_length(sizes.thickness)} high, because no "
            "thickness is given: give --thickness."
        )
    if assembly.is_simplified:
        print_remark(
            f"in {files} the part is drawn as a prism of its outline; for its own shape give --part with the "
            "STEP file that it was read from."
        )


def refuse_sheet(sheet: str | None, inputs: Iterable[str | None], out: str | None, force: bool) -> None:
    """Raise InputError for a setup sheet that cannot be written; None means no sheet."""
    if sheet is None:
        return
    path = Path(sheet)
    if path.suffix.lower() not in PAPER:
        raise InputError(f"--sheet {sheet} names no setup sheet: let the name end in .pdf, .svg or .png.")
    if out is not None and out != STANDARD_OUTPUT and path.absolute() == Path(out).absolute():
        raise InputError(f"--sheet and --out are both {sheet}: give them different names.")
    refuse_output(path, inputs, force)


def write_first_sheet(
    result: Result,
    sheet: str,
    out: str | None,
    thickness: float | None,
    unit: Unit,
    before: str | None,
    supported: Sequence[Supports] = (),
) -> int | None:
    """Write the sheet of the first choice and return its rank from 1; None where there is no fixture.

    Parameters
    ----------
    out : path of the result file; its hash is printed on the sheet.
    thickness : thickness of the part in mm where supports are wanted, else None. With it, the first choice is
        the first fixture that has supports.
    before : result file of the previous set-up, on the part's other side.
    supported : supports of the best fixtures, in order, as far as they are known; () for none.
    """
    from workhold.presenting.papers import write_paper

    if not len(result):
        return None
    rank, supports = 1, None
    if thickness is not None:
        rank, supports = find_first_supported(result, thickness, supported)
    settings = {
        "day": date.today(),
        "unit": unit,
        "thickness": thickness,
        "supports": supports,
        "first_side": None if before is None else compare_with_earlier_result(result, rank, before),
    }
    write_paper(sheet, result, rank, None if out == STANDARD_OUTPUT else out, settings)
    return rank


def find_first_supported(
    result: Result, thickness: float, supported: Sequence[Supports]
) -> tuple[int, ChosenSupports | None]:
    """Return (rank, supports) of the best fixture that three supports hold up; (1, None) where there is none.

    Supports already known (``supported``) are tried first, then new ones, larger pads before smaller. Remarks
    are printed.
    """
    from workhold.model.support_triples import ChosenSupports
    from workhold.supports.asking import try_smaller_requests

    query = result.query
    # What is known is for the jaw force that the loads ask for.
    found = supported if query.jaw_force is None else ()
    if not any(one.triples for one in found):
        # Fixtures that are alike stand in other holes, which three supports may find room between.
        fixtures = [result[k] for k in range(min(len(result), MOST_ASKED))]
        requests = try_smaller_requests(query, thickness)
        found, _ = find_supports_within_limit(
            fixtures,
            query,
            requests,
            jaw_force=query.jaw_force,
            first_only=True,
            drops_weak_force=True,
        )
        if found[-1].stopped:
            print_remark(describe_stopped_search(len(found), len(fixtures)))
    for rank, one in enumerate(found, 1):
        if one.triples:
            if rank > 1:
                print_remark(f"no such supports hold up fixture 1, so the sheet shows fixture {rank}.")
            return rank, ChosenSupports.from_supports(one)
    print_remark(
        "no three supports hold the part under any of the best, so the sheet has none: another side up "
        "(--axis) or a finer pitch may help, or parallels under it instead."
    )
    return 1, None


def choose_supports_from_file(
    path: str, number: int, settings: dict[str, Any], loads: Sequence[Load] | None
) -> ChosenSupports:
    """Return one set of three supports, chosen by its number, from a file of supports.

    Raises InputError for a thickness, a jaw force or loads, because the file fixes them already.
    """
    from workhold.files.supports_file import read_supports
    from workhold.model.support_triples import ChosenSupports

    for name, key in (("--thickness", "thickness"), ("--jaw-force", "jaw_force")):
        if settings[key] is not None:
            raise InputError(
                f"{path} already gives what {name} would give: leave it out, or list the supports again."
            )
    if loads:
        raise InputError(f"{path} has the loads for which its supports were chosen: leave --load out.")
    return ChosenSupports.from_supports(read_supports(path), number)


def choose_best_supports(
    result: Result,
    rank: int,
    thickness: float | None,
    loads: Sequence[Load] | None,
    jaw_force: float | None,
) -> ChosenSupports:
    """Return the best three supports under the fixture of a rank: of the usual sizes, else of smaller ones.

    A jaw force under which a load would lift the part off a peg is not used, since the sheet warns of it.
    Raises InputError where there are no supports, and where the part's thickness is not known.
    """
    from workhold.model.support_triples import ChosenSupports
    from workhold.supports.asking import support_with_smaller_sizes, try_smaller_requests

    if thickness is None and result.workpiece.solid is None:
        raise InputError("the thickness of the part is not known: give --thickness.")
    query = result.query
    requests = try_smaller_requests(query, thickness)
    (found,), _ = support_with_smaller_sizes(
        [result[rank - 1]], query, requests, loads, jaw_force, drops_weak_force=True
    )
    if not found.triples:
        raise InputError(
            f"under fixture {rank} no three supports hold the part: see workhold supports with its "
            "--pad-radius, --tip-radius and --out, or leave --supports out."
        )
    return ChosenSupports.from_supports(found)


def compare_with_earlier_result(result: Result, rank: int, before: str) -> FirstSide:
    """Return what the fixture of a rank has in common with the best fixture of another result, in which
    another side of the solid is up.

    Raises InputError if the parts are not from one solid.
    """
    from workhold.files.result.reader import read_result
    from workhold.model.first_side import compare_with_first_side

    other = read_result(before)
    return compare_with_first_side(
        result[rank - 1], result.query, other.query, other[0] if len(other) else None
    )
