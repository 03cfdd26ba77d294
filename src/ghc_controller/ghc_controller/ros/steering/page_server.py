"""The page over HTTP: 127.0.0.1 only, a token in every request, no other page's requests."""

from __future__ import annotations

import json
import secrets
import threading
from collections.abc import Callable, Mapping
from functools import partial
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

from ghc_controller.errors import GhcError, InvalidValue
from ghc_controller.report.valid_json import json_text

LOOPBACK = "127.0.0.1"
_PAGE = Path(__file__).with_name("page.html")
_MOST = 1 << 14  # [bytes] of a request
_TYPES = {"page": "text/html; charset=utf-8", "json": "application/json"}
_HEADERS = {
    "Cache-Control": "no-store",
    "Content-Security-Policy": "default-src 'none'; script-src 'unsafe-inline'; "
    "style-src 'unsafe-inline'; connect-src 'self'; frame-ancestors 'none'",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
}

Action = Callable[[Mapping[str, Any]], Any]  # fields of a request -> JSON; GhcError: rejected


class PageServer:
    """Serves page.html, and actions by name: POST /<action> with a JSON object.

    The token is in the address that is printed and in the header X-Token of every action. A
    request whose Host or Origin is not this server's is rejected: pages of other sites, also
    under a name that resolves to 127.0.0.1, get neither the page nor an action.
    """

    def __init__(self, actions: Mapping[str, Action], port: int = 0) -> None:
        """Listen; `port` 0 = a free one. Raises InvalidValue for one that is in use."""
        self.token = secrets.token_urlsafe(24)
        self.actions = actions
        try:
            self._server = ThreadingHTTPServer((LOOPBACK, port), partial(_Handler, self))
        except OSError as error:
            raise InvalidValue(f"port: {port} given: {error.strerror}") from error
        self._server.daemon_threads = True
        self.port = int(self._server.server_address[1])
        threading.Thread(target=self._server.serve_forever, name="page", daemon=True).start()

    @property
    def address(self) -> str:
        """For the browser, with the token behind # so that it is in no request line."""
        return f"http://{LOOPBACK}:{self.port}/#{self.token}"

    def is_own(self, headers: Mapping[str, str]) -> bool:
        """Whether a request was made to this server by its own page, or by no page at all."""
        hosts = {f"{LOOPBACK}:{self.port}", f"localhost:{self.port}"}
        origin = headers.get("Origin")
        return headers.get("Host") in hosts and (
            origin is None or origin in {f"http://{host}" for host in hosts}
        )

    def close(self) -> None:
        """Stop listening."""
        self._server.shutdown()
        self._server.server_close()


class _Handler(BaseHTTPRequestHandler):
    """One request."""

    def __init__(self, page: PageServer, *arguments: Any) -> None:
        self._page = page
        super().__init__(*arguments)

    def do_GET(self) -> None:
        """The page itself, which contains nothing secret."""
        if not self._page.is_own(self.headers):  # type: ignore[arg-type]
            self._answer(HTTPStatus.FORBIDDEN, {"error": "Host or Origin of another page"})
        elif self.path != "/":
            self._answer(HTTPStatus.NOT_FOUND, {"error": f"'{self.path}' given; known: /"})
        else:
            self._send(HTTPStatus.OK, _PAGE.read_bytes(), "page")

    def do_POST(self) -> None:
        """An action."""
        token = self.headers.get("X-Token", "")
        name = self.path.removeprefix("/")
        if not self._page.is_own(self.headers):  # type: ignore[arg-type]
            self._answer(HTTPStatus.FORBIDDEN, {"error": "Host or Origin of another page"})
        elif not secrets.compare_digest(token.encode(), self._page.token.encode()):
            self._answer(
                HTTPStatus.FORBIDDEN, {"error": "the token of the printed address is missing"}
            )
        elif name not in self._page.actions:
            known = ", ".join(self._page.actions)
            self._answer(HTTPStatus.NOT_FOUND, {"error": f"'{name}' given; known: {known}"})
        else:
            self._act(self._page.actions[name])

    def _act(self, action: Action) -> None:
        try:
            size = int(self.headers.get("Content-Length", "0"))
            if not 0 <= size <= _MOST:
                raise InvalidValue(f"{size} bytes given, at most {_MOST} expected")
            fields = json.loads(self.rfile.read(size) or b"{}")
            if not isinstance(fields, dict):
                raise InvalidValue("a JSON object expected")
            self._answer(HTTPStatus.OK, action(fields))
        except (GhcError, ValueError, TypeError, KeyError) as error:
            self._answer(HTTPStatus.BAD_REQUEST, {"error": str(error)})

    def _answer(self, status: HTTPStatus, content: Any) -> None:
        self._send(status, json_text(content).encode(), "json")

    def _send(self, status: HTTPStatus, body: bytes, kind: str) -> None:
        self.send_response(status)
        for name, value in _HEADERS.items():
            self.send_header(name, value)
        self.send_header("Content-Type", _TYPES[kind])
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, *_: Any) -> None:
        """Requests are not logged."""
