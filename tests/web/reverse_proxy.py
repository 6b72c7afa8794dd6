"""A reverse proxy in a few lines, as nginx would be one: it serves another server below a path of its own."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import httpx

# Headers of one connection, which are not handed on.
OWN = ("connection", "keep-alive", "transfer-encoding", "content-length", "date", "server")


@contextmanager
def reverse_proxy(upstream: str, prefix: str) -> Iterator[str]:
    """The address of a proxy that hands ``prefix``/... on to ``upstream``/..., telling for whom it asks."""

    class Handler(BaseHTTPRequestHandler):
        protocol_version = "HTTP/1.1"

        def do_GET(self) -> None:
            if not self.path.startswith(prefix):
                self.send_error(404)
                return
            body = self.rfile.read(int(self.headers.get("Content-Length", 0)))
            headers = [
                (k, v) for k, v in self.headers.items() if k.lower() not in ("connection", "x-forwarded-for")
            ]
            headers.append(("X-Forwarded-For", self.headers.get("X-Pretend", self.client_address[0])))
            with httpx.stream(
                self.command, upstream + self.path[len(prefix) :], headers=headers, content=body, timeout=None
            ) as answer:
                self.send_response(answer.status_code)
                for name, value in answer.headers.multi_items():
                    if name.lower() not in OWN:
                        self.send_header(name, value)
                self.send_header("Connection", "close")
                self.end_headers()
                for piece in answer.iter_raw():
                    self.wfile.write(piece)
                    self.wfile.flush()
            self.close_connection = True

        def do_POST(self) -> None:
            self.do_GET()

        def log_message(self, format: str, *args: object) -> None:
            """Say nothing."""

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    server.daemon_threads = True
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    try:
        yield f"http://127.0.0.1:{server.server_address[1]}{prefix}"
    finally:
        server.shutdown()
        server.server_close()
