"""A bench opened for bluesky."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

from usmbench.bluesky.encoder import Encoder, Windows
from usmbench.bluesky.knobs import Frequency, Phase
from usmbench.bluesky.loop import BenchLoop
from usmbench.bluesky.signals import Signal
from usmbench.cli.bench_session import Bench, open_bench
from usmbench.instruments.drive_limits import DriveLimits
from usmbench.settings.bench import BenchSettings
from usmbench.settings.plan import USUAL_FREQUENCY_HZ, DwellSettings
from usmbench.sweep.drive import Setting


@dataclass(frozen=True, slots=True)
class Devices:
    """The devices of an open bench.

    Parameters
    ----------
    phase, frequency
        The drive's settings; setting a phase switches the drive on, the end of the plan off.
    encoder
        The settled speed.
    windows
        Every window, as a flyer.
    ready
        False from the moment an interlock has switched the drive off until `acknowledge`: for
        ``SuspendBoolLow``.
    speed, temperature
        The latest window's, to be monitored or for ``SuspendCeil``.
    loop
        What talks to the bench.
    """

    phase: Phase
    frequency: Frequency
    encoder: Encoder
    windows: Windows
    ready: Signal
    speed: Signal
    temperature: Signal
    loop: BenchLoop

    def acknowledge(self) -> None:
        """Say that what tripped an interlock has been mended: commands are taken again."""
        self.loop.acknowledge()


@contextmanager
def open_devices(
    bench: str | BenchSettings,
    *,
    frequency_hz: float = USUAL_FREQUENCY_HZ,
    torque_nm: float = 0.0,
    dwell: DwellSettings | None = None,
    testbed_arguments: Sequence[str] = (),
) -> Iterator[Devices]:
    """Open a bench for bluesky; whatever happens, the drive is off when the context ends.

    Parameters
    ----------
    bench
        Bench file, the settings of one, or "simulated" for the embedded testbed.
    frequency_hz
        Drive frequency until the plan sets another.
    torque_nm
        Load torque that is there, as it is recorded.
    dwell
        When a speed counts as settled; None for what a plan has by default.
    testbed_arguments
        Further arguments for the embedded testbed's process.

    Raises
    ------
    usmbench.errors.InputError
        The bench file is wrong, the frequency beyond a limit, or port or card are not there.
    usmbench.errors.BenchError
        The board or the card does not answer.
    """
    with (
        open_bench(bench, testbed_arguments=testbed_arguments) as opened,
        devices_of(opened, frequency_hz=frequency_hz, torque_nm=torque_nm, dwell=dwell) as devices,
    ):
        yield devices


@contextmanager
def devices_of(
    bench: Bench,
    *,
    frequency_hz: float = USUAL_FREQUENCY_HZ,
    torque_nm: float = 0.0,
    dwell: DwellSettings | None = None,
) -> Iterator[Devices]:
    """Make the devices of a bench that is open; the drive is off when the context ends.

    Parameters
    ----------
    bench
        The bench.
    frequency_hz
        Drive frequency until the plan sets another.
    torque_nm
        Load torque that is there, as it is recorded.
    dwell
        When a speed counts as settled; None for what a plan has by default.

    Raises
    ------
    usmbench.errors.InputError
        The frequency is beyond a limit.
    usmbench.errors.BenchError
        The card cannot be started.
    """
    settings, board = bench.settings, bench.generator.identity
    limits = DriveLimits(
        settings.generator.frequency_limits_hz, settings.generator.phase_limits_deg
    )
    limits.frequency_word(frequency_hz, board)
    at_rest = Setting(frequency_hz=frequency_hz, torque_nm=torque_nm)
    loop = BenchLoop(bench.generator, bench.source, settings, at_rest)
    loop.start()
    try:
        yield Devices(
            Phase(loop, lambda phase_deg: limits.phase_word(phase_deg, board)),
            Frequency(loop, lambda hz: limits.frequency_word(hz, board)),
            Encoder(loop, dwell or DwellSettings()),
            Windows(loop),
            loop.ready,
            loop.speed,
            loop.temperature,
            loop,
        )
    finally:
        loop.close()
