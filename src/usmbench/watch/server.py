"""The live page's server: this machine only, read-only but for one button."""

import json
import secrets
import sys
import threading
import time
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.resources import files
from socketserver import TCPServer
from typing import Any, Final

from usmbench.errors import InputError, UsmbenchError
from usmbench.runs.stop_request import request_stop
from usmbench.watch.view import LiveView

HOST: Final = "127.0.0.1"
TOKEN_HEADER: Final = "X-Usmbench-Token"  # noqa: S105 - the header's name, no secret
_TOKEN_BYTES: Final = 12
_LONGEST_BODY: Final = 1024
_LOOK_EVERY_S: Final = 0.2
_IDLE_S: Final = 15.0
_PAGE: Final = "page.html"
_NONCE: Final = "@nonce@"


class LiveServer(ThreadingHTTPServer):
    """Serves one run's page.

    Parameters
    ----------
    view
        The run.
    port
        Port of 127.0.0.1, or 0 for a free one.

    Raises
    ------
    usmbench.errors.InputError
        The port is taken.
    """

    daemon_threads = True

    def __init__(self, view: LiveView, port: int = 0):
        self.token = secrets.token_urlsafe(_TOKEN_BYTES)
        self._view = view
        self._lock = threading.Lock()
        self._looked_s = -_LOOK_EVERY_S
        self.page = files("usmbench.watch").joinpath(_PAGE).read_text("utf-8")
        try:
            super().__init__((HOST, port), _Handler)
        except OSError as error:
            message = f"port {port} of {HOST} cannot be had: {error.strerror}; give another --port"
            raise InputError(message) from error
        self.own_hosts = {f"{HOST}:{self.server_port}", f"localhost:{self.server_port}"}

    def server_bind(self) -> None:
        """Bind without asking the name service for this machine's name."""
        TCPServer.server_bind(self)
        self.server_name, self.server_port = HOST, self.socket.getsockname()[1]

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Say in one line what went wrong; a browser that went away is nothing wrong.

        Parameters
        ----------
        request, client_address
            The connection.
        """
        error = sys.exception()
        if not isinstance(error, ConnectionError | TimeoutError):
            print(f"usmbench: the live page could not answer: {error!r}", file=sys.stderr)

    def state(self, span: str) -> dict[str, Any]:
        """Return what the page shows; many pages cost no more than one.

        Parameters
        ----------
        span
            Which part of the run the traces cover.
        """
        with self._lock:
            if time.monotonic() >= self._looked_s + _LOOK_EVERY_S:
                self._view.look()
                self._looked_s = time.monotonic()
            return self._view.snapshot(span)

    def stop(self) -> str | None:
        """Ask the measuring process to stop; return why that cannot be, where it cannot."""
        with self._lock:
            self._view.look()
            if not self._view.head.can_be_stopped:
                return "the run has ended: there is nothing to stop"
            request_stop(self._view.path)
            return None


class _Handler(BaseHTTPRequestHandler):
    """One connection; every request is held to this machine's own names first."""

    server: LiveServer
    protocol_version = "HTTP/1.1"
    server_version = "usmbench"
    sys_version = ""
    timeout = _IDLE_S

    def do_GET(self) -> None:
        """Serve the page or the state."""
        path, _, query = self.path.partition("?")
        if not self._is_for_us():
            self._refuse(HTTPStatus.FORBIDDEN, "open the address that watch printed")
        elif path == "/":
            self._send_page()
        elif path == "/state":
            self._send_state("recent" if query == "span=recent" else "whole")
        else:
            self._refuse(HTTPStatus.NOT_FOUND, "there is only /")

    def do_POST(self) -> None:
        """Stop the sweep, where the token is right."""
        if not self._body_is_read():
            self.close_connection = True
            self._refuse(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, "the request is too long")
        elif not self._is_for_us() or not self._is_from_our_page():
            self._refuse(HTTPStatus.FORBIDDEN, "only the page itself may stop the sweep")
        elif self.path != "/stop":
            self._refuse(HTTPStatus.NOT_FOUND, "there is only /stop")
        elif not self._has_token():
            message = "wrong token: it stands on the terminal where watch was started"
            self._refuse(HTTPStatus.FORBIDDEN, message)
        else:
            self._stop()

    def _stop(self) -> None:
        try:
            reason = self.server.stop()
        except UsmbenchError as error:
            reason = str(error)
        if reason is None:
            self._send_json(HTTPStatus.ACCEPTED, {"says": "stop requested"})
        else:
            self._refuse(HTTPStatus.CONFLICT, reason)

    def _is_for_us(self) -> bool:
        """Return whether the browser asked by our own name: a rebound one is another's page."""
        return self.headers.get_all("Host", []) in [[host] for host in self.server.own_hosts]

    def _is_from_our_page(self) -> bool:
        """Return whether no other page sent this: they cannot hide where they are from."""
        origin = self.headers.get("Origin")
        site = self.headers.get("Sec-Fetch-Site", "same-origin")
        ours = {f"http://{host}" for host in self.server.own_hosts}
        return (origin is None or origin in ours) and site in {"same-origin", "none"}

    def _has_token(self) -> bool:
        given = self.headers.get(TOKEN_HEADER, "").encode(errors="replace")
        return secrets.compare_digest(given, self.server.token.encode())

    def _body_is_read(self) -> bool:
        length = self.headers.get("Content-Length", "0")
        if not length.isdecimal() or int(length) > _LONGEST_BODY:
            return False
        self.rfile.read(int(length))
        return "Transfer-Encoding" not in self.headers

    def _send_page(self) -> None:
        nonce = secrets.token_urlsafe(_TOKEN_BYTES)
        policy = (
            f"default-src 'none'; script-src 'nonce-{nonce}'; style-src 'nonce-{nonce}'; "
            "connect-src 'self'; img-src data:; base-uri 'none'; form-action 'none'; "
            "frame-ancestors 'none'"
        )
        page = self.server.page.replace(_NONCE, nonce).encode()
        self._send(HTTPStatus.OK, "text/html; charset=utf-8", page, policy)

    def _send_state(self, span: str) -> None:
        try:
            self._send_json(HTTPStatus.OK, self.server.state(span))
        except UsmbenchError as error:
            self._refuse(HTTPStatus.SERVICE_UNAVAILABLE, str(error))

    def _refuse(self, status: HTTPStatus, says: str) -> None:
        self._send_json(status, {"error": says})

    def _send_json(self, status: HTTPStatus, content: dict[str, Any]) -> None:
        body = json.dumps(content, allow_nan=False).encode()
        self._send(status, "application/json", body, "default-src 'none'")

    def _send(self, status: HTTPStatus, kind: str, body: bytes, policy: str) -> None:
        self.send_response(status)
        for name, value in (
            ("Content-Type", kind),
            ("Content-Length", str(len(body))),
            ("Content-Security-Policy", policy),
            ("Cache-Control", "no-store"),
            ("X-Content-Type-Options", "nosniff"),
            ("X-Frame-Options", "DENY"),
            ("Referrer-Policy", "no-referrer"),
            ("Cross-Origin-Resource-Policy", "same-origin"),
        ):
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, *_: object) -> None:
        """Keep the terminal quiet: the token must stay in sight."""
