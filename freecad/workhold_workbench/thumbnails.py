"""Thumbnails of the first choices, kept with the fixture in the document."""

import json
import re

__all__ = ["cells_of", "keep_thumbnails"]

# The frame of a thumbnail in the SVG text of a sheet, and the height of the caption in it.
CELL = re.compile(
    r'<g class="thumbnail">\s*<rect x="([\d.]+)" y="([\d.]+)" width="([\d.]+)" height="([\d.]+)"'
)
CAPTION = 44.0
# The line of the frame, which is left out too.
LINE = 3.0


def keep_thumbnails(obj, folder, first):
    """Keeps the sheet of thumbnails in the document, and which fixture each of them is.

    Where nothing holds the part it is the picture of the nearest miss, if there is one.

    Parameters
    ----------
    folder : into which the command has drawn.
    first : the first choices that differ, in the order of the thumbnails: rank, and how many are like it.
    """
    sheet, miss = folder / "thumbnails.png", folder / "nearest-miss.png"
    choices = []
    if sheet.exists():
        boxes = cells_of(sheet.with_suffix(".svg").read_text(encoding="utf-8"))
        choices = [{**one, "box": box} for one, box in zip(first, boxes)]
    drawn = next((path for path in (sheet, miss) if path.exists()), None)
    if drawn is not None:
        obj.Glance = str(drawn)
    # A file that is kept cannot be taken away: without words on it, it is an old one.
    obj.Glanced = "" if drawn is None else json.dumps(choices)


def cells_of(sheet):
    """Where the thumbnails of a sheet stand: left, top, width and height as parts of the sheet's.

    The frames and the captions are left out.
    """
    width, height = map(float, re.search(r'viewBox="0 0 (\S+) (\S+)"', sheet).groups())
    return [
        (
            (x + LINE) / width,
            (y + LINE) / height,
            (across - 2 * LINE) / width,
            (down - CAPTION - LINE) / height,
        )
        for x, y, across, down in (map(float, cell) for cell in CELL.findall(sheet))
    ]
