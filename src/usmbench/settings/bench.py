"""The bench: which port, which card, which encoder, and the limits of this lab."""

from dataclasses import dataclass, field
from typing import Final, Literal

SIMULATED: Final = "simulated"  # the bench whose testbed is a process of our own


@dataclass(frozen=True, slots=True)
class GeneratorSettings:
    """Where the signal generator board is, and how far this lab lets it go.

    Parameters
    ----------
    port
        Serial port, or "auto" to ask every port who it is.
    frequency_limits_hz
        Lowest and highest drive frequency of this lab; the board's own limits hold as well.
    phase_limits_deg
        Lowest and highest phase shift of this lab; the board's own limits hold as well.
    reply_timeout_s
        Time a reply may take before the request is sent again.
    """

    port: str = "auto"
    frequency_limits_hz: tuple[float, float] = (40_000.0, 42_000.0)
    phase_limits_deg: tuple[float, float] = (-180.0, 180.0)
    reply_timeout_s: float = 0.05


@dataclass(frozen=True, slots=True)
class TemperatureSettings:
    """A linear temperature sensor on an analogue input.

    Parameters
    ----------
    channel
        Physical channel without the device, such as "ai0".
    degrees_c_per_volt
        Sensitivity.
    offset_c
        Temperature at 0 V.
    """

    channel: str
    degrees_c_per_volt: float = 100.0
    offset_c: float = 0.0


@dataclass(frozen=True, slots=True)
class DaqSettings:
    """The data acquisition card.

    Parameters
    ----------
    device
        Device name in NI MAX, such as "Dev1".
    address
        host:port of an NI gRPC device server, or None for the driver on this machine.
    family
        "m_x": the counter decodes X4 (M and X series, 32 bit); "e_series": up/down counting of
        channel A with B as the direction (24 bit, X1).
    counter
        Counter of the encoder channels.
    index_counter
        Counter of the index pulse, or None where the index is not wired.
    sample_clock
        Terminal of the sample clock. "ai" starts an analogue input task whose clock is used.
    sample_rate_hz
        Rate of the sample clock.
    samples_per_average
        Samples in each average: the paper's 1000.
    no_data_timeout_s
        Silence of the card after which the sweep stops the drive, beyond one block's duration.
    """

    device: str = "Dev1"
    address: str | None = None
    family: Literal["m_x", "e_series"] = "m_x"
    counter: str = "ctr0"
    index_counter: str | None = "ctr1"
    sample_clock: str = "ai"
    sample_rate_hz: float = 100_000.0
    samples_per_average: int = 1000
    no_data_timeout_s: float = 0.5


@dataclass(frozen=True, slots=True)
class EncoderSettings:
    """The incremental encoder.

    Parameters
    ----------
    lines
        Lines of the code wheel: 500 for the HEDS-5140 A11.
    sign
        +1 or -1: the direction in which the counter runs at positive phase.
    speed
        Which speed goes into `speed_rad_s`: "edge_timed" or the paper's "average".
    """

    lines: int = 500
    sign: Literal[1, -1] = 1
    speed: Literal["edge_timed", "average"] = "edge_timed"


@dataclass(frozen=True, slots=True)
class InterlockSettings:
    """When the drive is switched off without being asked.

    Parameters
    ----------
    overspeed_rad_s
        Highest speed.
    no_motion_after_s
        Time without any count while driven beyond `no_motion_phase_deg`.
    no_motion_phase_deg
        Phase shift (absolute) beyond which the motor must move.
    motion_off_rad_s
        Speed that counts as motion while the outputs are off.
    motion_off_after_s
        Time after switching off from when motion trips.
    temperature_max_c
        Highest temperature, where there is a sensor.
    drive_time_max_s
        Longest uninterrupted drive.
    index_error_max_counts
        Counts by which an index pulse may come early or late before counts have been lost; None
        keeps the record going, for a study of the losses themselves.
    """

    overspeed_rad_s: float = 16.0
    no_motion_after_s: float = 0.5
    no_motion_phase_deg: float = 85.0
    motion_off_rad_s: float = 0.5
    motion_off_after_s: float = 0.3
    temperature_max_c: float = 70.0
    drive_time_max_s: float = 3600.0
    index_error_max_counts: int | None = 1


@dataclass(frozen=True, slots=True)
class BenchSettings:
    """Everything a bench file says.

    Parameters
    ----------
    name
        Name of the bench, for the run folder.
    motor
        Name of the motor, for the run folder.
    generator, daq, encoder, interlocks
        The instruments and limits.
    temperature
        The temperature sensor, or None.
    """

    name: str = "bench"
    motor: str = "Shinsei USR60"
    generator: GeneratorSettings = field(default_factory=GeneratorSettings)
    daq: DaqSettings = field(default_factory=DaqSettings)
    encoder: EncoderSettings = field(default_factory=EncoderSettings)
    interlocks: InterlockSettings = field(default_factory=InterlockSettings)
    temperature: TemperatureSettings | None = None

    @property
    def counts_per_rev(self) -> int:
        """Counts of one revolution: four a line where the card decodes X4, else one."""
        return self.encoder.lines * (4 if self.daq.family == "m_x" else 1)

    @property
    def window_s(self) -> float:
        """Duration of one window: the samples of one average."""
        return self.daq.samples_per_average / self.daq.sample_rate_hz
