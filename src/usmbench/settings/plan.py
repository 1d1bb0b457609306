"""The plan: what a sweep drives."""

from dataclasses import dataclass, field
from typing import Final, Literal

from usmbench.settings.yaml_source import Source

Direction = Literal["rising", "falling", "both", "as_listed"]

# Where nobody names a frequency: that of the paper's first figure.
USUAL_FREQUENCY_HZ: Final = 41_000.0


@dataclass(frozen=True, slots=True)
class Settle:
    """When a dwell counts as settled.

    The drift is the mean speed of the later half of the last `over_windows` windows less that of
    the earlier half; the dwell is settled once it is within max(`tolerance_rad_s`, `relative`·|ω|).

    Parameters
    ----------
    min_windows
        Windows at the start of a dwell that never count: the command took effect in the first.
    over_windows
        Windows over which the drift is taken; 0 where `min_windows` alone decide.
    tolerance_rad_s
        Drift that counts as standing still.
    relative
        The same as a share of the speed.
    """

    min_windows: int = 5
    over_windows: int = 10
    tolerance_rad_s: float = 0.1
    relative: float = 0.01


@dataclass(frozen=True, slots=True)
class DwellSettings:
    """How long each phase of a pass is held.

    Parameters
    ----------
    windows
        Windows of a dwell that settles in time.
    extend_to_windows
        Windows after which a dwell that has not settled ends all the same.
    settle
        When it counts as settled.
    """

    windows: int = 50
    extend_to_windows: int = 200
    settle: Settle = Settle()


@dataclass(frozen=True, slots=True)
class WarmUp:
    """The drive before the first pass.

    Parameters
    ----------
    phase_deg
        Phase shift.
    duration_s
        Duration.
    frequency_hz
        Drive frequency, or None for that of the first operating point.
    """

    phase_deg: float
    duration_s: float
    frequency_hz: float | None = None


@dataclass(frozen=True, slots=True)
class Pass:
    """One pass over φ, repeated.

    Parameters
    ----------
    phase_deg
        Phases in the order of the file.
    direction
        In which order they are driven; "both" is a rising pass and then a falling one.
    repeats
        How often.
    """

    phase_deg: tuple[float, ...]
    direction: Direction = "rising"
    repeats: int = 1


@dataclass(frozen=True, slots=True)
class Excitation:
    """Free excitation: a random phase, held for a few windows at a time.

    Parameters
    ----------
    kind
        "telegraph" jumps between levels, "multisine" follows a sum of sines of random phase.
    amplitude_deg
        Largest distance from the centre.
    duration_s
        Duration at each operating point.
    seed
        Seed of the random numbers.
    centre_deg
        Centre of the excitation.
    hold_windows
        Windows for which each phase is held.
    levels
        Telegraph: number of levels, evenly spaced over ±amplitude.
    switch_probability
        Telegraph: chance of another level after each hold.
    period_s
        Multisine: the period after which it repeats; None makes it the duration.
    band_hz
        Multisine: lowest and highest frequency; None takes all that the hold can carry.
    """

    kind: Literal["telegraph", "multisine"]
    amplitude_deg: float
    duration_s: float
    seed: int = 0
    centre_deg: float = 0.0
    hold_windows: int = 5
    levels: int = 2
    switch_probability: float = 0.5
    period_s: float | None = None
    band_hz: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True)
class PlanLimits:
    """Limits tighter than the bench's; None leaves the bench's.

    Parameters
    ----------
    overspeed_rad_s
        Highest speed.
    temperature_max_c
        Highest temperature.
    drive_time_max_s
        Longest uninterrupted drive.
    """

    overspeed_rad_s: float | None = None
    temperature_max_c: float | None = None
    drive_time_max_s: float | None = None


@dataclass(frozen=True, slots=True)
class Plan:
    """A checked plan.

    Parameters
    ----------
    source
        The file, for messages and for the run folder.
    name
        Name of the plan.
    frequency_hz
        Drive frequencies.
    torque_nm
        Load torques.
    ask_operator
        Whether the operator is asked to set each torque; else the load is there and stays.
    outer
        Which of the two changes least often.
    warm_up
        The drive before the first pass, or None.
    passes
        The passes at each operating point; empty with free excitation.
    excitation
        Free excitation in place of passes, or None.
    dwell
        How long each phase of a pass is held.
    limits
        Limits tighter than the bench's.
    """

    source: Source
    name: str
    frequency_hz: tuple[float, ...]
    torque_nm: tuple[float, ...] = (0.0,)
    ask_operator: bool = False
    outer: Literal["torque_nm", "frequency_hz"] = "torque_nm"
    warm_up: WarmUp | None = None
    passes: tuple[Pass, ...] = ()
    excitation: Excitation | None = None
    dwell: DwellSettings = DwellSettings()
    limits: PlanLimits = field(default_factory=PlanLimits)
