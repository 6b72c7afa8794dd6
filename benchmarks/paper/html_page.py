"""The report as one page of HTML, which needs nothing from elsewhere; pictures are drawn in the page."""

from __future__ import annotations

import re
from collections.abc import Sequence
from html import escape
from pathlib import Path

from paper.document import (
    Block,
    Heading,
    Inline,
    Line,
    Listing,
    Marked,
    Number,
    Paragraph,
    Picture,
    Table,
    typographic,
)

__all__ = ["html_page"]

STYLE = Path(__file__).with_name("report.css")
TAGS = {"code": "code", "quote": "q", "label": "b", "reference": "cite", "formula": "var"}
# What stands before an SVG text, and the size of the paper it is drawn for.
PROLOGUE = re.compile(r"^.*?(?=<svg)", flags=re.S)
PAPER_SIZE = re.compile(r'(<svg[^>]*?) width="[^"]*" height="[^"]*"')


def html_page(title: str, blocks: Sequence[Block]) -> str:
    """The page."""
    body = "\n".join(html_of(block) for block in blocks)
    style = STYLE.read_text(encoding="utf-8")
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)}</title>\n<style>\n{style}</style></head>\n"
        f"<body><main>\n<h1>{escape(typographic(title))}</h1>\n{body}\n</main></body></html>\n"
    )


def html_of(block: Block) -> str:
    """A block."""
    match block:
        case Heading():
            level = block.depth + 1
            return f'<h{level} id="{anchor(block.text)}">{escape(typographic(block.text))}</h{level}>'
        case Paragraph():
            return f"<p>{html_line(block.line)}</p>"
        case Listing():
            tag = "ol" if block.kind == "references" else "ul"
            points = "\n".join(f"<li>{html_line(point)}</li>" for point in block.points)
            return f'<{tag} class="{block.kind}">\n{points}\n</{tag}>'
        case Table():
            return html_table(block)
        case Picture():
            return html_picture(block)


def anchor(text: str) -> str:
    """The name by which a heading is linked to."""
    return re.sub(r"[^a-z]+", "-", text.lower()).strip("-")


def html_line(line: Line) -> str:
    """Words, with numbers and what is marked in elements of their own."""
    return "".join(html_inline(one) for one in line)


def html_inline(one: Inline) -> str:
    """A piece of a line; a number says on hovering where it comes from, and a click opens its data file."""
    if isinstance(one, str):
        return escape(typographic(one))
    if isinstance(one, Marked):
        tag = TAGS[one.kind]
        text = one.text if one.kind == "code" else typographic(one.text)
        return f"<{tag}>{escape(text)}</{tag}>"
    return html_number(one)


def html_number(one: Number) -> str:
    """A number with its key."""
    section = one.key.partition("/")[0]
    told = f"{one.key}, made by: python benchmarks/make_paper.py --only {section}"
    return (
        f'<a class="n" href="data/{section}.json" data-key="{escape(one.key)}" data-scale="{one.scale!r}" '
        f'title="{escape(told)}">{escape(one.text)}</a>'
    )


def html_table(table: Table) -> str:
    """A table in a frame of its own, which scrolls where the window is narrow."""

    def cells(tag: str, row: Sequence[Line]) -> str:
        kinds = ("w" if k in table.left else "r" for k in range(len(row)))
        return "".join(f'<{tag} class="{k}">{html_line(c)}</{tag}>' for k, c in zip(kinds, row, strict=True))

    last = len(table.rows) - 1
    rows = "\n".join(
        f"<tr{' class=sum' if table.bold_last and k == last else ''}>{cells('td', row)}</tr>"
        for k, row in enumerate(table.rows)
    )
    groups = "".join(
        f'<th colspan="{span}" class="{"g" if words else "e"}">{escape(words)}</th>'
        for words, span in table.groups
    )
    above = f"<tr>{groups}</tr>" if groups else ""
    return (
        f"<figure><figcaption><b>{escape(table.label)}.</b> {html_line(table.caption)}</figcaption>\n"
        f'<div class="wide" tabindex="0"><table><thead>{above}<tr>{cells("th", table.headings)}</tr></thead>\n'
        f"<tbody>\n{rows}\n</tbody></table></div></figure>"
    )


def html_picture(picture: Picture) -> str:
    """Pictures side by side; below each what it is."""
    parts = "\n".join(
        f'<div class="part">{drawn(svg)}<small>{escape(words)}</small></div>' for svg, words in picture.parts
    )
    return (
        f'<figure><div class="pictures" style="--across:{picture.across}">\n{parts}\n</div>\n'
        f"<figcaption><b>{escape(picture.label)}.</b> {html_line(picture.caption)}</figcaption></figure>"
    )


def drawn(svg: str) -> str:
    """An SVG text as it stands in a page: as wide as its room."""
    return PAPER_SIZE.sub(r"\1", PROLOGUE.sub("", svg), count=1).strip()
