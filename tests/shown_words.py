"""The words of what objects show of themselves in a notebook."""

from __future__ import annotations

import re
from html import unescape
from typing import Any


def last_paragraph(shown: Any) -> str:
    """The last sentences under what is shown of an object, such as why no three supports hold a part."""
    return unescape(re.sub(r"<[^>]+>", "", re.findall(r"<p\b.*?</p>", shown._repr_html_(), re.DOTALL)[-1]))
