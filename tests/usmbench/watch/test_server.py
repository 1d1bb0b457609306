import json
import re
import threading
from collections.abc import Iterator
from http.client import HTTPConnection
from typing import Any

import numpy as np
import pytest

from usmbench.errors import InputError
from usmbench.runs.stop_request import STOP_FILE
from usmbench.watch.server import HOST, TOKEN_HEADER, LiveServer
from usmbench.watch.view import LiveView


class Served:
    """A run, its server, and a client that may send what it likes."""

    def __init__(self, run: Any):
        self.run = run
        self.server = LiveServer(LiveView(run.folder))
        self.thread = threading.Thread(target=self.server.serve_forever, args=(0.02,))
        self.thread.start()

    @property
    def host(self) -> str:
        return f"{HOST}:{self.server.server_port}"

    @property
    def stop_is_requested(self) -> bool:
        return bool((self.run.folder / STOP_FILE).exists())

    def ask(
        self, method: str, path: str, headers: dict[str, str] | None = None, body: str = ""
    ) -> tuple[int, dict[str, str], str]:
        connection = HTTPConnection(HOST, self.server.server_port, timeout=5.0)
        try:
            connection.putrequest(method, path, skip_host="Host" in (headers or {}))
            for name, value in (headers or {}).items():
                connection.putheader(name, value)
            connection.putheader("Content-Length", str(len(body)))
            connection.endheaders(body.encode())
            reply = connection.getresponse()
            return reply.status, dict(reply.getheaders()), reply.read().decode()
        finally:
            connection.close()

    def stop(self, **headers: str) -> tuple[int, str]:
        sent = {name.replace("_", "-"): value for name, value in headers.items()}
        status, _, body = self.ask("POST", "/stop", {TOKEN_HEADER: self.server.token} | sent)
        return status, body


@pytest.fixture
def served(make_run: Any) -> Iterator[Served]:
    served = Served(make_run())
    yield served
    served.server.shutdown()
    served.thread.join(5.0)
    served.server.server_close()


def test_the_state_follows_the_run(served: Served) -> None:
    assert served.server.server_address[0] == "127.0.0.1"
    served.run.windows(np.full(8, 90.0))
    status, headers, body = served.ask("GET", "/state?span=recent")
    assert (status, headers["Content-Type"]) == (200, "application/json")
    assert headers["Cache-Control"] == "no-store"
    content = json.loads(body)
    assert content["windows"] == 8
    assert len(content["trace"]["t_s"]) == 2


def test_the_page_runs_its_own_script_and_nothing_else(served: Served) -> None:
    status, headers, page = served.ask("GET", "/")
    assert (status, headers["Content-Type"]) == (200, "text/html; charset=utf-8")
    nonce = re.search(r"script-src 'nonce-([\w-]+)'", headers["Content-Security-Policy"])
    assert nonce is not None
    assert f'<script nonce="{nonce[1]}">' in page
    assert "default-src 'none'" in headers["Content-Security-Policy"]
    assert "frame-ancestors 'none'" in headers["Content-Security-Policy"]
    assert served.server.token not in page
    assert "@nonce@" not in page
    assert not re.search(r"https?://", page)
    assert nonce[1] not in served.ask("GET", "/")[2]


def test_the_right_token_asks_the_sweep_to_stop(served: Served) -> None:
    status, body = served.stop()
    assert (status, json.loads(body)) == (202, {"says": "stop requested"})
    assert served.stop_is_requested
    assert served.stop(Origin=f"http://{served.host}", Sec_Fetch_Site="same-origin")[0] == 202


@pytest.mark.parametrize("token", ["", "wrong", "ä", "x" * 300])
def test_a_wrong_token_is_refused(served: Served, token: str) -> None:
    status, body = served.stop(**{TOKEN_HEADER: token})
    assert status == 403
    assert "wrong token" in body
    assert served.server.token not in body
    assert not served.stop_is_requested


@pytest.mark.parametrize(
    "headers",
    [
        {"Origin": "http://evil.example"},
        {"Origin": "null"},
        {"Sec_Fetch_Site": "cross-site"},
        {"Sec_Fetch_Site": "same-site"},
        {"Host": "evil.example"},
        {"Host": "evil.example:80"},
        {"Host": ""},
    ],
)
def test_another_page_cannot_stop_even_with_the_token(
    served: Served, headers: dict[str, str]
) -> None:
    status, _ = served.stop(**headers)
    assert status == 403
    assert not served.stop_is_requested


def test_a_rebound_name_reads_nothing(served: Served) -> None:
    for path in ("/", "/state"):
        status, _, body = served.ask("GET", path, {"Host": "evil.example"})
        assert (status, "motor" in body, "<html" in body) == (403, False, False)
    assert served.ask("GET", "/state", {"Host": served.host})[0] == 200


@pytest.mark.parametrize(
    ("method", "path", "status"),
    [
        ("GET", "/stop", 404),
        ("GET", "/../run.yaml", 404),
        ("POST", "/", 404),
        ("PUT", "/stop", 501),
        ("OPTIONS", "/stop", 501),
    ],
)
def test_there_is_nothing_else(served: Served, method: str, path: str, status: int) -> None:
    assert served.ask(method, path, {TOKEN_HEADER: served.server.token})[0] == status
    assert not served.stop_is_requested


def test_a_long_request_is_refused_unread(served: Served) -> None:
    headers = {TOKEN_HEADER: served.server.token}
    assert served.ask("POST", "/stop", headers, body=" " * 1025)[0] == 413
    assert not served.stop_is_requested


def test_a_run_that_has_ended_has_nothing_to_stop(served: Served) -> None:
    served.run.writer.close("completed")
    status, body = served.stop()
    assert status == 409
    assert "nothing to stop" in body
    assert not served.stop_is_requested


def test_a_folder_that_has_gone_is_said_on_the_page(served: Served) -> None:
    moved = served.run.folder.rename(served.run.folder.with_name("moved"))
    status, _, body = served.ask("GET", "/state")
    assert status == 503
    assert "run.yaml" in json.loads(body)["error"]
    moved.rename(served.run.folder)


def test_a_port_that_is_taken_is_said(served: Served) -> None:
    with pytest.raises(InputError, match="another --port"):
        LiveServer(LiveView(served.run.folder), served.server.server_port)
