"""What tests in several folders share: an encoder that turns at a steady speed, and a browser."""

import os
import shutil
import signal
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Browser, sync_playwright

from hil_sim.faults import FaultSchedule
from hil_sim.ni_server import NiServer
from hil_sim.signals import Samples

CHROMIUM = os.environ.get("USMBENCH_CHROMIUM") or shutil.which("chromium")
collect_ignore = [] if CHROMIUM else ["docs/test_site.py", "usmbench/watch/test_page.py"]
COUNTS_PER_REV = 2000
RATE_HZ = 1e5  # whatever the card is set to: what the tests check is samples, not seconds


def pytest_configure() -> None:
    # For the workers that are started next, as in the Makefile.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # A shell's background job, or nohup, hands on signals that are ignored.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGHUP, signal.SIG_DFL)


def pytest_report_header() -> list[str]:
    return [] if CHROMIUM else ["chromium: not there, no page is looked at in a browser"]


@pytest.fixture(scope="module")  # its event loop would be in the way of other modules
def browser() -> Iterator[Browser]:
    arguments = ["--no-sandbox"] if os.geteuid() == 0 else []
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=arguments)
        yield browser
        browser.close()


class TurningEncoder:
    """Feed whose position is known at every sample: it turns and warms at steady rates."""

    def __init__(self, counts_per_s: float = 20_000.0, start_counts: int = 0):
        self.counts_per_s = counts_per_s
        self.start_counts = start_counts
        self.taken = 0
        self.acquisitions: list[str] = []
        self.requests: list[int] = []

    @property
    def time_s(self) -> float:
        return self.taken / RATE_HZ

    def start(self) -> None:
        self.acquisitions.append("start")

    def stop(self) -> None:
        self.acquisitions.append("stop")

    def acquire(self, n_samples: int, sample_rate_hz: float) -> Samples:
        samples = np.arange(self.taken + 1, self.taken + n_samples + 1)
        turned = np.floor(samples * self.counts_per_s / RATE_HZ).astype(np.int64)
        position = self.start_counts + turned
        self.taken += n_samples
        self.requests.append(n_samples)
        return Samples(position, np.abs(position) // COUNTS_PER_REV, 25.0 + self.time_s)


ServeEncoder = Callable[..., tuple[NiServer, TurningEncoder]]


@pytest.fixture
def serve_encoder() -> Iterator[ServeEncoder]:
    """Start servers of turning encoders, and stop them after the test."""
    servers: list[NiServer] = []

    def start(
        *, lock_step: bool = True, faults: Any = (), feed: TurningEncoder | None = None, **kind: Any
    ) -> tuple[NiServer, TurningEncoder]:
        encoder = feed or TurningEncoder(**kind)
        server = NiServer(encoder, lock_step=lock_step, faults=FaultSchedule(faults))
        servers.append(server)
        return server, encoder

    yield start
    for server in servers:
        server.stop()
