"""What the data acquisition takes its samples from."""

import threading
from typing import Final

from hil_sim.clock import Clock
from hil_sim.signals import Samples
from hil_sim.testbed import Testbed

_PUMP_PERIOD_S: Final = 0.01
_JOIN_TIMEOUT_S: Final = 5.0


class SampleFeed:
    """Samples of the testbed, in order; every method may be called from any thread.

    In lock step `acquire` moves simulated time. In real time the caller asks for samples when they
    have become due; while no acquisition runs, a thread keeps the testbed up with the clock.

    Parameters
    ----------
    testbed
        Where the samples come from.
    clock
        Lock step or real time.
    """

    def __init__(self, testbed: Testbed, clock: Clock):
        self._testbed = testbed
        self._clock = clock
        self._lock = threading.Lock()
        self._acquiring = False
        self._closed = threading.Event()
        self._pump = threading.Thread(target=self._keep_up, name="idle testbed", daemon=True)
        if not clock.lock_step:
            self._pump.start()

    @property
    def time_s(self) -> float:
        """Simulated time of the end of the samples taken."""
        return self._testbed.time_s

    def start(self) -> None:
        """Begin an acquisition: sample 0 is the first one after this call."""
        with self._lock:
            self._catch_up()
            self._acquiring = True

    def acquire(self, n_samples: int, sample_rate_hz: float) -> Samples:
        """Take the next samples.

        Parameters
        ----------
        n_samples
            How many.
        sample_rate_hz
            Rate of the sample clock.
        """
        return self._testbed.sample(n_samples, sample_rate_hz)

    def stop(self) -> None:
        """End an acquisition; safe to call twice."""
        with self._lock:
            self._acquiring = False

    def close(self) -> None:
        """End the thread of the real-time feed."""
        self._closed.set()
        if self._pump.is_alive():
            self._pump.join(_JOIN_TIMEOUT_S)

    def _catch_up(self) -> None:
        if not self._clock.lock_step:
            self._testbed.idle(self._clock.now_s() - self._testbed.time_s)

    def _keep_up(self) -> None:
        while not self._closed.wait(_PUMP_PERIOD_S):
            with self._lock:
                if not self._acquiring:
                    self._catch_up()
