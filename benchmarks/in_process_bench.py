"""The sweep's own code on the testbed in this process: what campaigns run on."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from hil_sim.faults import Fault
from hil_sim.in_process import InProcessBench
from hil_sim.testbed import FaultablePlant, Testbed
from usmbench.cli.bench_session import Bench
from usmbench.instruments.generator import SignalGenerator
from usmbench.settings.bench import BenchSettings


@dataclass(frozen=True, slots=True)
class HandOnTheLoad:
    """Turns the simulated load."""

    testbed: InProcessBench

    def set_load(self, torque_nm: float, *, ask: bool) -> None:
        """Set the load; nobody has to be asked."""
        self.testbed.set_load(torque_nm)

    def load_is_set(self) -> bool:
        """Return True: it was set at once."""
        return True


@dataclass(frozen=True, slots=True)
class InProcess:
    """A simulated testbed, and how to open its bench."""

    simulated: InProcessBench
    settings: BenchSettings

    @property
    def testbed(self) -> Testbed:
        """The machines."""
        return self.simulated.testbed

    @contextmanager
    def opened(self) -> Iterator[Bench]:
        """Open the bench through the driver; its drive is off when the context ends."""
        limits = self.settings.generator
        generator = SignalGenerator(
            self.simulated.port,
            clock=self.simulated.clock,
            frequency_limits_hz=limits.frequency_limits_hz,
            phase_limits_deg=limits.phase_limits_deg,
        )
        with self.simulated.source as source, generator:
            operator = HandOnTheLoad(self.simulated)
            yield Bench(self.settings, generator, source, operator, self.simulated.clock)


def in_process_bench(
    seed: int = 0,
    *,
    settings: BenchSettings | None = None,
    faults: Iterable[Fault] = (),
    plant: FaultablePlant | None = None,
) -> InProcess:
    """Return the simulated testbed in this process, for the driver and the sweep's own loop."""
    settings = settings or BenchSettings(name="simulated in process")
    daq = settings.daq
    simulated = InProcessBench(
        seed,
        sample_rate_hz=daq.sample_rate_hz,
        samples_per_block=daq.samples_per_average,
        family=daq.family,
        faults=faults,
        no_data_timeout_s=daq.no_data_timeout_s,
        temperature=settings.temperature is not None,
        plant=plant,
    )
    return InProcess(simulated, settings)
