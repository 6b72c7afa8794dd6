"""Pages of other sites that may use the server from a browser: none, unless their origins are named.

A browser sends the origin of a page with a request to another site, and hands the answer to the page only
where the answer names that origin. Before a request that is not a simple one, it asks for permission (a
preflight): see the Fetch standard, section 3.2, *CORS protocol*.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from urllib.parse import urlsplit

from attrs import frozen

from workhold.errors import InputError

__all__ = ["AllowedOrigins", "check_origin"]

METHODS = "GET, HEAD, POST, DELETE"
ASKED = "Authorization, Content-Type, Last-Event-ID, X-Filename"
SHOWN = "Content-Disposition, Location, Retry-After"
# Seconds for which a browser need not ask again.
REMEMBERED = "600"
PORTS = {"http": 80, "https": 443}

Headers = list[tuple[bytes, bytes]]


@frozen
class AllowedOrigins:
    """The origins of other sites whose pages may use the server as the server's own page does.

    Parameters
    ----------
    names : origins such as ``https://shop.example``, in the form that :func:`check_origin` returns.
    """

    names: Collection[str] = ()

    def allows(self, headers: Mapping[str, str]) -> bool:
        """Return whether the header "origin" of a request is one of the allowed origins.

        >>> AllowedOrigins(("https://shop.example",)).allows({"origin": "https://shop.example"})
        True
        """
        return headers.get("origin", "").lower() in self.names

    def is_preflight(self, method: str, headers: Mapping[str, str]) -> bool:
        """Return whether a request is a CORS preflight for a page of an allowed origin."""
        return method == "OPTIONS" and "access-control-request-method" in headers and self.allows(headers)

    def answer_preflight(self, headers: Mapping[str, str]) -> Headers:
        """Return the headers that answer a preflight: the methods and headers that a page of an allowed
        origin may send.
        """
        may = [
            (b"access-control-allow-methods", METHODS.encode()),
            (b"access-control-allow-headers", ASKED.encode()),
            (b"access-control-max-age", REMEMBERED.encode()),
        ]
        # A page from the internet that asks a server of the own machine or network.
        if headers.get("access-control-request-private-network") == "true":
            may.append((b"access-control-allow-private-network", b"true"))
        return may

    def make_sharing_headers(self, headers: Mapping[str, str]) -> Headers:
        """Return the headers with which a browser hands the answer to the page.

        For an origin that is not allowed it is only "vary"; where no origin is allowed at all the list is
        empty.
        """
        if not self.names:
            return []
        varies = (b"vary", b"Origin")
        if not self.allows(headers):
            return [varies]
        return [
            varies,
            (b"access-control-allow-origin", headers["origin"].encode("latin-1")),
            (b"access-control-expose-headers", SHOWN.encode()),
        ]


def check_origin(text: str) -> str:
    """Return an origin in the form in which browsers send it.

    Raises
    ------
    InputError
        For text that is not an origin of pages, and for ``*`` and ``null``, which may stand for any page.

    >>> check_origin("HTTPS://Shop.example:443/")
    'https://shop.example'
    """
    try:
        parts = urlsplit(text.strip())
        port = parts.port
    except ValueError:
        parts, port = urlsplit(""), None
    extra = parts.path.strip("/") or parts.query or parts.fragment or parts.username or parts.password
    if parts.scheme not in PORTS or not parts.hostname or extra:
        raise InputError(
            f"{text!r} is not an origin: name the site of the page alone, such as https://shop.example or "
            "http://localhost:5173."
        )
    host = f"[{parts.hostname}]" if ":" in parts.hostname else parts.hostname
    return f"{parts.scheme}://{host}" + ("" if port in (None, PORTS[parts.scheme]) else f":{port}")
