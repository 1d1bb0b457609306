"""The board's serial port in this process, and how time passes while a host waits on it."""

import errno
import math
from collections import deque

import numpy as np

from hil_sim.line import Arrival
from hil_sim.signals import Samples
from hil_sim.testbed import Testbed


class SampleTrain:
    """Samples taken while time passed, kept for the source until it reads them.

    Parameters
    ----------
    testbed
        Where the samples come from.
    sample_rate_hz
        Rate of the sample clock.
    """

    def __init__(self, testbed: Testbed, sample_rate_hz: float):
        self.testbed = testbed
        self.sample_rate_hz = sample_rate_hz
        self.running = False
        self.taken = 0
        self._kept: deque[Samples] = deque()

    def pass_until(self, time_s: float) -> None:
        """Let time pass, to the first tick at or after an instant.

        Parameters
        ----------
        time_s
            Simulated time.
        """
        left_s = time_s - self.testbed.time_s
        # A tick that is reached but for rounding is not waited for again.
        self._take(math.ceil(left_s * self.sample_rate_hz - 1e-6))

    def _take(self, n_samples: int) -> None:
        if n_samples > 0:
            samples = self.testbed.sample(n_samples, self.sample_rate_hz)
            if self.running:
                self._kept.append(samples)
                self.taken += n_samples

    def read(self, n_samples: int) -> Samples:
        """Return the oldest samples that were not read, taking what is missing.

        Parameters
        ----------
        n_samples
            How many.
        """
        self._take(n_samples - sum(len(samples.position) for samples in self._kept))
        if len(self._kept) == 1 and len(self._kept[0].position) == n_samples:
            return self._kept.popleft()
        position = np.concatenate([samples.position for samples in self._kept])
        pulses = np.concatenate([samples.index_pulses for samples in self._kept])
        temperature_c = self._kept[-1].temperature_c
        self._kept.clear()
        if len(position) > n_samples:
            rest = Samples(position[n_samples:], pulses[n_samples:], temperature_c)
            self._kept.append(rest)
        return Samples(position[:n_samples], pulses[:n_samples], temperature_c)


class InProcessPort:
    """The board's serial port as `usmbench.instruments.serial_port.SerialPort`.

    Parameters
    ----------
    train
        Whose testbed holds the board.
    """

    def __init__(self, train: SampleTrain):
        self.timeout: float | None = 0.0
        self._train = train
        self._testbed = train.testbed
        self._pending: deque[Arrival] = deque()
        self._closed = False

    @property
    def name(self) -> str:
        """The port's name, for messages."""
        return "the simulated board"

    def _check(self) -> None:
        if self._closed:
            raise OSError(errno.EBADF, "the simulated port is closed")
        if self._testbed.time_s >= self._testbed.port_gone_s:
            raise OSError(errno.EIO, "the simulated port has gone")

    def _ready(self) -> int:
        """Count the bytes to be had; only those that a fault held up have to wait."""
        now_s = self._testbed.time_s
        for count, arrival in enumerate(self._pending):
            if arrival.late and arrival.time_s > now_s:
                return count
        return len(self._pending)

    @property
    def in_waiting(self) -> int:
        """Bytes that a read returns at once."""
        self._check()
        return self._ready()

    def read(self, size: int = 1, /) -> bytes:
        """Return up to `size` bytes, fewer when `timeout` seconds of simulated time pass first.

        Without a time-out it does not wait: nothing else would ever make a byte arrive.

        Parameters
        ----------
        size
            Most bytes to return.

        Raises
        ------
        OSError
            The port has gone or was closed.
        """
        self._check()
        deadline_s = self._testbed.time_s + (self.timeout or 0.0)
        while self._ready() < min(size, len(self._pending)):
            arrival_s = self._pending[self._ready()].time_s
            if arrival_s > deadline_s:
                break
            self._train.pass_until(arrival_s)
        if self._ready() < size:
            self._train.pass_until(deadline_s)
        self._check()
        return bytes(self._pending.popleft().byte for _ in range(min(size, self._ready())))

    def write(self, data: bytes, /) -> int:
        """Send bytes.

        Parameters
        ----------
        data
            The bytes.

        Raises
        ------
        OSError
            The port has gone or was closed.
        """
        self._check()
        # The reply before was read early; on the line the host would still be taking it.
        at_s = max(self._testbed.time_s, self._testbed.answered_s)
        self._pending += self._testbed.host_bytes(bytes(data), at_s)
        return len(data)

    def close(self) -> None:
        """Release the port."""
        self._closed = True
