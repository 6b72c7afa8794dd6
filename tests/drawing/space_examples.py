"""Set-ups in space for the tests of sheets: a solid by height in every kind of toolkit, and supports under it."""

from __future__ import annotations

from datetime import date
from functools import cache

import pypdfium2
from sheet_reading import collisions, page_of, words_of

from body_examples import BLOCK, TOOLKITS
from workhold import Load, Result, Workpiece, design
from workhold.drawing import draw_setup_sheet
from workhold.drawing.pdf import convert_svg_to_pdf
from workhold.drawing.scene import UNITS_PER_MM
from workhold.model.solid import SolidOutline
from workhold.model.support_request import SupportRequest
from workhold.model.support_triples import ChosenSupports
from workhold.supports.listing import find_supports

HEIGHT, PEG_HEIGHT, HEAD_ROOM = 24.0, 9.0, 0.75
# The block as the outline of a solid: its faces are touched at different heights, one of them never.
BANDS = [
    (0.0, 9.0),
    (1.5, 9.0),
    (0.0, 7.25),
    (2.0, 8.0),
    (0.0, 9.0),
    (3.0, 9.0),
    None,
    (0.0, 9.0),
    (0.0, 9.0),
]
# It lies on less than its outline, and a flange above the pegs reaches farther.
FOOT = [(4.0, 6.0, 0.0), (60.0, 6.0, 0.0), (60.0, 12.0, 0.0), (4.0, 12.0, 0.0)]
FLANGE = [(-6.0, 0.0, 0.0), (70.0, 0.0, 0.0), (70.0, 10.0, 0.0), (-6.0, 10.0, 0.0)]
SOLID = Workpiece.from_loops(
    "block",
    [loop.tolist() for loop in BLOCK.loops],
    solid=SolidOutline(
        axis="-z",
        height=HEIGHT,
        peg_height=PEG_HEIGHT,
        head_room=HEAD_ROOM,
        least_band=1.0,
        bands=BANDS,
        faces=[(10 + k,) for k in range(9)],
        bottom=[FOOT],
        top=[FLANGE],
    ),
)
LOADS = (Load(((30.0, 20.0), (50.0, 10.0)), 120.0, name="milling"),)
NAMES = [name for name in TOOLKITS if name != "touching holes"]
DAY = date(2026, 3, 31)
# Printers leave at least this blank, mm.
PRINTABLE = 5.0


@cache
def result_of(name: str, solid: bool = True, loaded: bool = False) -> Result:
    """The best fixture of the block in a toolkit."""
    return design(SOLID if solid else BLOCK, TOOLKITS[name], best=1, loads=LOADS if loaded else ())


@cache
def chosen(name: str, loaded: bool = False) -> ChosenSupports | None:
    """Three supports under the block as a prism 24 mm thick; None where there are none."""
    result = result_of(name, False, loaded)
    request = SupportRequest(HEIGHT, pad_radius=2.0, tip_radius=2.5, band=(1.0, 8.0))
    found = find_supports(result[0], result.query, request, best=1)
    return ChosenSupports.from_supports(found) if found.triples else None


def sheet(result: Result, **asked: object) -> tuple[str, ...]:
    """The pages of the sheet of the best fixture."""
    return draw_setup_sheet(result, 1, day=DAY, **asked)


def printed(pages: tuple[str, ...]) -> str:
    """All words of the sheet as a PDF has them."""
    document = pypdfium2.PdfDocument(convert_svg_to_pdf(pages, DAY))
    return " ".join(" ".join(page.get_textpage().get_text_bounded() for page in document).split())


def faults(pages: tuple[str, ...]) -> list[object]:
    """Words that cover one another, and words off the paper."""
    found: list[object] = []
    for page in pages:
        inside = page_of(page).grow(-PRINTABLE * UNITS_PER_MM)
        found += collisions(page) + [word for word, box in words_of(page) if not inside.contains(box)]
    return found
