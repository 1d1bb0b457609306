"""Encoder samples from an NI card, by the driver on this computer or a gRPC device server."""

import logging
import threading
from functools import partial
from types import TracebackType
from typing import Final, Self

from usmbench.errors import DaqError, InputError, NoDataError
from usmbench.instruments.deadline import run_within
from usmbench.instruments.nidaq_errors import BEGIN_AGAIN, opening_error, running_error, where
from usmbench.instruments.nidaq_tasks import COUNTER_BITS, CardTasks
from usmbench.instruments.samples import SampleBlock
from usmbench.settings.bench import DaqSettings, TemperatureSettings

OPEN_TIMEOUT_S: Final = 20.0
CLOSE_TIMEOUT_S: Final = 5.0
_DIAGNOSIS_TIMEOUT_S: Final = 0.3

_log = logging.getLogger(__name__)
# nidaqmx logs a traceback when its event stream ends; the user gets our message instead.
logging.getLogger("nidaqmx").addHandler(logging.NullHandler())


class NiSampleSource:
    """Counter samples of an NI card, read as the every-N-samples callback tells of them.

    The callback only counts the blocks that are ready. They are read on the thread that wants them,
    so that every error is raised there; the driver's buffer keeps what a busy computer is late for.

    With `sample_clock` "ai" all counters start on the same edge. Another terminal must start to
    tick after `start` has returned, else the index counter and the encoder's are apart by the
    ticks between the starts of their tasks.

    Parameters
    ----------
    settings
        The card.
    temperature
        The temperature sensor, or None.
    lines
        Lines of the encoder's code wheel; the default is the HEDS-5140 A11's.

    Raises
    ------
    usmbench.errors.InputError
        There is no driver, no server at the address, no such card, or it refuses the settings.
    """

    def __init__(
        self,
        settings: DaqSettings,
        temperature: TemperatureSettings | None = None,
        *,
        lines: int = 500,
    ):
        self._settings = settings
        self._ready = threading.Semaphore(0)
        self._failure: DaqError | None = None
        self._blocks_read = 0
        self._closed = False
        work = partial(self._open, temperature, lines)
        try:
            self._tasks = run_within(OPEN_TIMEOUT_S, work, too_late=CardTasks.close)
        except InputError:
            raise
        except Exception as error:
            raise opening_error(error, settings) from error

    def _open(self, temperature: TemperatureSettings | None, lines: int) -> CardTasks:
        tasks = CardTasks(self._settings, temperature, lines=lines)
        tasks.on_block(self._on_samples)
        return tasks

    @property
    def sample_rate_hz(self) -> float:
        """Rate of the sample clock."""
        return self._settings.sample_rate_hz

    @property
    def samples_per_block(self) -> int:
        """Samples in each block."""
        return self._settings.samples_per_average

    @property
    def counter_bits(self) -> int:
        """Width of the counter: it wraps at 2**counter_bits."""
        return COUNTER_BITS[self._settings.family]

    def start(self) -> None:
        """Start the acquisition; sample 0 is the first one after this call.

        Raises
        ------
        usmbench.errors.DaqError
            The card does not start.
        """
        try:
            self._tasks.start()
        except Exception as error:
            raise running_error(error, self._settings) from error

    def _on_samples(self, *_event: object) -> int:
        """Note that a block is ready."""
        self._ready.release()
        return 0

    def next_block(self) -> SampleBlock:
        """Return the next block, waiting for it.

        Raises
        ------
        usmbench.errors.NoDataError
            No block came within a block's duration and `no_data_timeout_s`.
        usmbench.errors.DaqError
            The card reported an error, or its server has gone.
        """
        if self._closed:
            raise DaqError(f"{where(self._settings)} was closed: open it again")
        if self._failure is not None:
            raise self._failure
        try:
            return self._read_block()
        except DaqError as error:
            self._failure = error
            raise
        except Exception as error:
            self._failure = running_error(error, self._settings)
            raise self._failure from error

    def _read_block(self) -> SampleBlock:
        """Wait until a block is ready, and read it."""
        timeout_s = self._tasks.block_s + self._settings.no_data_timeout_s
        if not self._ready.acquire(timeout=timeout_s):
            raise self._silence(timeout_s)
        counts, index_counts, temperature_c = self._tasks.read()
        first_sample = self._blocks_read * self.samples_per_block
        self._blocks_read += 1
        return SampleBlock(first_sample, counts, index_counts, temperature_c)

    def _silence(self, timeout_s: float) -> DaqError:
        """Say why no block came: the clock stands, or only the events are missing."""
        try:
            acquired = run_within(_DIAGNOSIS_TIMEOUT_S, self._tasks.acquired)
        except Exception as error:  # noqa: BLE001 - it is the explanation
            return running_error(error, self._settings)
        expected = self._blocks_read * self.samples_per_block
        seen = f"{where(self._settings)}: no data for {timeout_s:.3g} s after {expected} samples"
        if acquired > expected:
            return NoDataError(
                f"{seen}, though the card has taken {acquired}: its events no longer come; "
                f"restart the device server where there is one, then {BEGIN_AGAIN}"
            )
        return NoDataError(
            f"{seen}, and the card has taken no more: the sample clock "
            f"{self._settings.sample_clock!r} stands still or the events no longer come; check the "
            "clock, and restart the device server where there is one"
        )

    def samples_acquired(self) -> int:
        """Return how many samples the card has taken by now, read or not.

        Raises
        ------
        usmbench.errors.DaqError
            The card does not answer.
        """
        try:
            return self._tasks.acquired()
        except Exception as error:
            raise running_error(error, self._settings) from error

    def close(self) -> None:
        """Stop the acquisition and release the card; never raises, safe to call twice."""
        if self._closed:
            return
        self._closed = True
        for step in (self._tasks.stop, self._tasks.close):
            try:
                run_within(CLOSE_TIMEOUT_S / 2, step)
            except Exception as error:  # noqa: BLE001 - the reason was told when it happened
                _log.info("%s was not released in order: %s", where(self._settings), error)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.close()
