"""The NI-DAQmx tasks of a bench: encoder, index and analogue input on one sample clock."""

import math
from collections.abc import Callable
from contextlib import ExitStack
from typing import Any, Final

import nidaqmx
import numpy as np
from nidaqmx.constants import (
    AcquisitionType,
    AngleUnits,
    CountDirection,
    EncoderType,
    OverwriteMode,
    TaskMode,
)
from nidaqmx.stream_readers import AnalogSingleChannelReader, CounterReader
from numpy.typing import NDArray

from usmbench.errors import InputError
from usmbench.instruments.nidaq_channel import DeadlineChannel
from usmbench.instruments.samples import NO_INDEX_YET, blocks_per_index_read
from usmbench.settings.bench import DaqSettings, TemperatureSettings

BUFFER_S: Final = 10.0
"""Time that the driver's buffers hold."""
COUNTER_BITS: Final = {"m_x": 32, "e_series": 24}
"""Width of the counters of each family of cards."""
_UP_DOWN_TERMINALS: Final = {"ctr0": ("PFI8", "port0/line6"), "ctr1": ("PFI3", "port0/line7")}
"""Source (channel A) and up/down input (channel B) of the counters of the E series."""


class CardTasks:
    """All tasks of one card, committed: what is wrong with the settings shows here.

    Parameters
    ----------
    settings
        The card.
    temperature
        The temperature sensor, or None.
    lines
        Lines of the encoder's code wheel.

    Raises
    ------
    usmbench.errors.InputError
        The family has no such counter.
    nidaqmx.errors.Error
        The driver is absent or refuses the settings.
    """

    def __init__(
        self, settings: DaqSettings, temperature: TemperatureSettings | None, *, lines: int
    ):
        self._settings = settings
        self._temperature = temperature
        self._samples = settings.samples_per_average
        self._index_blocks = blocks_per_index_read(self._samples, settings.sample_rate_hz)
        self._blocks_read = 0
        self.block_s = self._samples / settings.sample_rate_hz
        self._read_timeout_s = self.block_s + settings.no_data_timeout_s
        self._tasks: list[Any] = []
        self._channel = None
        if settings.address is not None:
            self._channel = DeadlineChannel(settings.address, self._read_timeout_s)
        with ExitStack() as stack:
            stack.callback(self.close)
            self._open(lines)
            for task in self._tasks:
                task.control(TaskMode.TASK_COMMIT)
            stack.pop_all()

    def _open(self, lines: int) -> None:
        # The task that makes the clock comes last: it is started last, when all counters wait for
        # its first edge.
        self._encoder = self._encoder_task(lines)
        self._read_encoder = self._counter_reader(
            self._encoder, self._samples, floating=self._settings.family == "m_x"
        )
        self._read_index = None
        if self._settings.index_counter is not None:
            index = self._task()
            index.ci_channels.add_ci_count_edges_chan(self._path(self._settings.index_counter))
            self._clock(index, self._clock_terminal())
            self._read_index = self._counter_reader(
                index, self._index_blocks * self._samples, floating=False
            )
        self._read_volts = None
        if self._temperature is not None or self._settings.sample_clock == "ai":
            self._read_volts = self._open_analogue()

    def _task(self) -> Any:
        options = self._channel and nidaqmx.GrpcSessionOptions(self._channel, "")
        task = nidaqmx.Task(grpc_options=options)
        self._tasks.append(task)
        return task

    def _path(self, channel: str) -> str:
        return f"{self._settings.device}/{channel}"

    def _clock_terminal(self) -> str:
        terminal = self._settings.sample_clock
        if terminal.startswith("/"):
            return terminal
        return f"/{self._path('ai/SampleClock' if terminal == 'ai' else terminal)}"

    def _clock(self, task: Any, source: str) -> None:
        blocks = max(2, math.ceil(BUFFER_S / self.block_s))
        task.timing.cfg_samp_clk_timing(
            self._settings.sample_rate_hz,
            source=source,
            sample_mode=AcquisitionType.CONTINUOUS,
            samps_per_chan=blocks * self._samples,
        )

    def _encoder_task(self, lines: int) -> Any:
        counter = self._settings.counter
        terminals = _UP_DOWN_TERMINALS.get(counter)
        if self._settings.family == "e_series" and terminals is None:
            raise InputError(
                f"daq.counter {counter}: E-series cards have {' and '.join(_UP_DOWN_TERMINALS)}"
            )
        task = self._task()
        if self._settings.family == "m_x":
            task.ci_channels.add_ci_ang_encoder_chan(
                self._path(counter),
                decoding_type=EncoderType.X_4,
                units=AngleUnits.TICKS,
                pulses_per_rev=lines,
            )
        elif terminals is not None:
            channel = task.ci_channels.add_ci_count_edges_chan(
                self._path(counter), count_direction=CountDirection.EXTERNAL_SOURCE
            )
            channel.ci_count_edges_term = f"/{self._path(terminals[0])}"
            channel.ci_count_edges_dir_term = f"/{self._path(terminals[1])}"
        self._clock(task, self._clock_terminal())
        return task

    def _counter_reader(
        self, task: Any, n_samples: int, *, floating: bool
    ) -> Callable[[], NDArray[np.int64]]:
        reader = CounterReader(task.in_stream)
        reader.verify_array_shape = False  # it would ask the server about it at every read
        values = np.empty(n_samples, np.float64 if floating else np.uint32)
        read = reader.read_many_sample_double if floating else reader.read_many_sample_uint32

        def read_counts() -> NDArray[np.int64]:
            read(values, n_samples, self._read_timeout_s)
            return values.astype(np.int64)

        return read_counts

    def _open_analogue(self) -> Callable[[], float] | None:
        task = self._task()
        channel = "ai0" if self._temperature is None else self._temperature.channel
        task.ai_channels.add_ai_voltage_chan(self._path(channel))
        own_clock = self._settings.sample_clock == "ai"
        self._clock(task, "" if own_clock else self._clock_terminal())
        if self._temperature is None:
            # Nobody reads it: it must not overflow, for that would stop the clock.
            task.in_stream.overwrite = OverwriteMode.OVERWRITE_UNREAD_SAMPLES
            return None
        reader = AnalogSingleChannelReader(task.in_stream)
        reader.verify_array_shape = False
        volts = np.empty(self._samples)

        def read_volts() -> float:
            reader.read_many_sample(volts, self._samples, self._read_timeout_s)
            return float(volts.mean())

        return read_volts

    def on_block(self, callback: Callable[..., int]) -> None:
        """Have `callback` called after each block of samples, on a thread of the driver.

        Parameters
        ----------
        callback
            Takes NI-DAQmx's four arguments and returns 0.
        """
        self._encoder.register_every_n_samples_acquired_into_buffer_event(self._samples, callback)

    def start(self) -> None:
        """Start all tasks, the one that makes the clock last."""
        for task in self._tasks:
            task.start()

    def read(self) -> tuple[NDArray[np.int64], NDArray[np.int64] | None, float | None]:
        """Return the counts, index counts and temperature (°C) of the next block.

        The index counts are as in `usmbench.instruments.samples.SampleBlock`.
        """
        counts = self._read_encoder() & ((1 << COUNTER_BITS[self._settings.family]) - 1)
        self._blocks_read += 1
        index_counts = None
        if self._read_index is not None:
            whole = self._blocks_read % self._index_blocks == 0
            index_counts = self._read_index() if whole else NO_INDEX_YET
        if self._read_volts is None or self._temperature is None:
            return counts, index_counts, None
        volts = self._read_volts()
        sensor = self._temperature
        return counts, index_counts, sensor.offset_c + sensor.degrees_c_per_volt * volts

    def acquired(self) -> int:
        """Return how many samples the encoder's task has taken, read or not."""
        return int(self._encoder.in_stream.total_samp_per_chan_acquired)

    def stop(self) -> None:
        """Stop all tasks, the clock first."""
        with ExitStack() as stack:
            for task in self._tasks:
                stack.callback(task.stop)

    def close(self) -> None:
        """Release the card; all of it, also where a task raises."""
        with ExitStack() as stack:
            if self._channel is not None:
                stack.callback(self._channel.close)
            for task in self._tasks:
                stack.callback(task.close)
            self._tasks = []
