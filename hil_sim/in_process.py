"""The testbed in this process: the same machines without pseudo-terminal and server.

Simulated time moves when a block is read, or when a read on the port has nothing to return: then
it passes up to the port's time-out, and its samples wait for the source.
"""

from collections.abc import Iterable
from typing import Final, Self

import numpy as np
from numpy.typing import NDArray

from hil_sim.counter import SENSOR_DEGREES_C_PER_VOLT, Counter, Family, card_counter, sensor_volts
from hil_sim.faults import Fault, FaultKind, FaultSchedule
from hil_sim.in_process_port import InProcessPort, SampleTrain
from hil_sim.plant import MotorPlant
from hil_sim.testbed import FaultablePlant, Testbed
from usmbench.errors import DaqError, NoDataError
from usmbench.instruments.samples import NO_INDEX_YET, SampleBlock, blocks_per_index_read

OVERFLOW_CODE: Final = -200279
"""NI-DAQmx: the reader did not keep up with the card."""


class InProcessSource:
    """The card's samples as `usmbench.instruments.samples.SampleSource`.

    Parameters
    ----------
    train
        Where the samples come from.
    samples_per_block
        Samples in each block.
    counter
        The card's counter.
    no_data_timeout_s
        Silence beyond a block's duration after which `next_block` gives up.
    temperature
        Whether a sensor is connected.
    """

    def __init__(
        self,
        train: SampleTrain,
        *,
        samples_per_block: int,
        counter: Counter,
        no_data_timeout_s: float,
        temperature: bool,
    ):
        self._train = train
        self._testbed = train.testbed
        self._samples_per_block = samples_per_block
        self._counter = counter
        self._no_data_timeout_s = no_data_timeout_s
        self._temperature = temperature
        self._read = 0
        self._index_blocks = blocks_per_index_read(samples_per_block, train.sample_rate_hz)
        self._pulses: list[NDArray[np.int64]] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def sample_rate_hz(self) -> float:
        """Rate of the sample clock."""
        return self._train.sample_rate_hz

    @property
    def samples_per_block(self) -> int:
        """Samples in each block."""
        return self._samples_per_block

    @property
    def counter_bits(self) -> int:
        """Width of the counter."""
        return self._counter.bits

    def start(self) -> None:
        """Start the acquisition; sample 0 is the first one after this call."""
        self._train.running = True

    def next_block(self) -> SampleBlock:
        """Return the next block, moving simulated time on where it has not passed yet.

        Raises
        ------
        usmbench.errors.NoDataError
            The event stream is dead.
        usmbench.errors.DaqError
            The card's buffer has overflowed, or the server is dead.
        """
        samples = self._train.read(self._samples_per_block)
        self._raise_faults()
        first_sample = self._read
        self._read += self._samples_per_block
        return SampleBlock(
            first_sample=first_sample,
            counts=self._counter.values(samples.position),
            index_counts=self._read_index(samples.index_pulses),
            temperature_c=_read_sensor(samples.temperature_c) if self._temperature else None,
        )

    def _read_index(self, pulses: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return all index samples since the last read where one is due, none where not."""
        self._pulses.append(pulses)
        if len(self._pulses) < self._index_blocks:
            return NO_INDEX_YET
        whole = np.concatenate(self._pulses)
        self._pulses.clear()
        return whole

    def _raise_faults(self) -> None:
        faults, now_s = self._testbed.faults, self._testbed.time_s
        if faults.active(FaultKind.DAQ_OVERFLOW, now_s):
            raise DaqError(
                "the card overwrote samples before they were read (simulated overflow); "
                "take longer blocks or a lower sample rate",
                code=OVERFLOW_CODE,
            )
        if faults.active(FaultKind.SERVER_DEAD, now_s):
            raise DaqError("the simulated NI device server does not answer; start it again")
        if faults.active(FaultKind.EVENT_STREAM_DEAD, now_s):
            self._train.pass_until(now_s + self._no_data_timeout_s)
            raise NoDataError(
                f"no samples for {self._no_data_timeout_s:g} s beyond a block's duration "
                "(simulated event stream); look at the card and its sample clock"
            )

    def samples_acquired(self) -> int:
        """Return how many samples the card has taken by now, read or not."""
        return self._train.taken

    def close(self) -> None:
        """Stop the acquisition; safe to call twice."""
        self._train.running = False


def _read_sensor(temperature_c: float) -> float:
    return sensor_volts(temperature_c) * SENSOR_DEGREES_C_PER_VOLT


class InProcessBench:
    """Port, source and clock of one testbed, for a sweep in this process.

    Parameters
    ----------
    seed
        Seed of the motor's noise.
    sample_rate_hz
        Rate of the sample clock.
    samples_per_block
        Samples in each block.
    family
        "m_x" or "e_series", as in the bench file.
    faults
        What goes wrong, and when.
    no_data_timeout_s
        Silence beyond a block's duration after which the source gives up.
    temperature
        Whether a temperature sensor is connected.
    plant
        The motor; None for the one that `seed` makes.
    """

    def __init__(
        self,
        seed: int = 0,
        *,
        sample_rate_hz: float = 100_000.0,
        samples_per_block: int = 1000,
        family: Family = "m_x",
        faults: Iterable[Fault] = (),
        no_data_timeout_s: float = 0.5,
        temperature: bool = False,
        plant: FaultablePlant | None = None,
    ):
        schedule = FaultSchedule(tuple(faults))
        self.testbed = Testbed(MotorPlant(seed=seed) if plant is None else plant, schedule)
        train = SampleTrain(self.testbed, sample_rate_hz)
        self.port = InProcessPort(train)
        self.source = InProcessSource(
            train,
            samples_per_block=samples_per_block,
            counter=card_counter(family, schedule),
            no_data_timeout_s=no_data_timeout_s,
            temperature=temperature,
        )

    def clock(self) -> float:
        """Return the simulated time in seconds."""
        return self.testbed.time_s

    def set_load(self, torque_nm: float) -> None:
        """Change the load torque now.

        Parameters
        ----------
        torque_nm
            Load torque.
        """
        self.testbed.set_load(torque_nm)
