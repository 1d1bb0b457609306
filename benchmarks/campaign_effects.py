"""What mechanisms do to the speed of a motor of the campaign, measured from runs with and without.

Each day's pair has the same noise, yet an effect of less than a count shows as single counts that
fall into other windows, and some of them do so on every day. Where an effect grows in proportion to
its size, it is measured larger than it is hidden.
"""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from benchmarks.campaign_draws import Draw
from benchmarks.campaign_runs import Excited, Measured, Motor, TurnedDisc
from benchmarks.campaign_sizes import well_counted
from hil_sim.defects import Defect
from usmbench.runs.reader import read_run

Array = NDArray[np.float64]

_DAYS: Final = (700, 701, 702)  # on which an effect is measured
_WIDER: Final = 0.05  # enough that it moves more than single counts
_LARGE: Final = 10.0  # times the noise: so large it is measured
_BY_CHANCE: Final = {"scratched_disc", "slow_input_filter", "spikes"}
# In steps, at starts only, all at once, or as a resonance moves.
_NOT_IN_PROPORTION: Final = _BY_CHANCE | {
    "dead_direction",
    "dry_bearing",
    "loose_coupling",
    "missing_phase_bits",
    "other_code_wheel",
    "soft_coupling",
    "sticky_friction",
    "swapped_wires",
    "swapped_outputs",
}


@dataclass(frozen=True, slots=True)
class Seen:
    """What defects do to a run.

    Parameters
    ----------
    effects_rad_s
        Their effect as some days show it, shape (D, N).
    well
        Windows that it does not move by single counts only, shape (N,).
    by_chance
        Whether it strikes other windows every day.
    """

    effects_rad_s: Array
    well: NDArray[np.bool_]
    by_chance: bool = False


class Effects:
    """What mechanisms do to one motor.

    Parameters
    ----------
    runs
        Folder of the runs, which are driven where they are not there yet.
    motor
        The motor.
    """

    def __init__(self, runs: Path, motor: Motor):
        self._runs, self._motor = runs, motor

    def seen(self, draw: Draw, defects: tuple[Defect, ...]) -> Seen:
        """Return what defects change in the run of a draw."""
        if any(defect.mechanism in _BY_CHANCE for defect in defects):
            days = [self._speed_rad_s(draw.excited, draw.number, made) for made in (defects, ())]
            effects_rad_s = (days[0] - days[1])[None]
            return Seen(effects_rad_s, np.ones(days[0].size, dtype=np.bool_), by_chance=True)
        larger, times = enlarged(defects, draw.hidden.strength)
        healthy, hidden = self.speeds_rad_s(draw.excited), self.speeds_rad_s(draw.excited, larger)
        return Seen((hidden - healthy) / times, well_counted(np.concatenate([healthy, hidden])))

    def effects_rad_s(self, excited: Excited, defects: tuple[Defect, ...]) -> Array:
        """Return what defects of their own size change on some days, the noise the same, (D, N)."""
        return self.speeds_rad_s(excited, defects) - self.speeds_rad_s(excited)

    def speeds_rad_s(self, excited: Excited, defects: tuple[Defect, ...] = ()) -> Array:
        """Return the speed on those days, shape (D, N)."""
        # Where the shaft creeps, a disc that sits alike would put the same count into the same
        # window every day.
        turned = np.random.default_rng([self._motor.seed, 9]).uniform(size=len(_DAYS))
        days = zip(_DAYS, turned.tolist(), strict=True)
        return np.stack(
            [self._speed_rad_s(excited, day, (*defects, TurnedDisc(u))) for day, u in days]
        )

    def wanders(self, excited: Excited) -> Array:
        """Return what a standard deviation of the gain and of the dead zone change, (N, 2)."""
        quiet, wider = self._quiet(excited), self._quiet(excited, _WIDER)
        return self._motor.wander * np.column_stack((quiet, (wider - quiet) / _WIDER))

    def _quiet(self, excited: Excited, clamp_error: float = 0.0) -> Array:
        """Speed of the healthy motor without noise and wander."""
        motor = replace(self._motor, quiet=True, wander=0.0, clamp_error=clamp_error)
        return read_run(Measured(motor, excited, 0).folder(self._runs)).speed_rad_s

    def _speed_rad_s(self, excited: Excited, day: int, defects: tuple[Defect, ...]) -> Array:
        run = Measured(self._motor, excited, day, defects).folder(self._runs)
        return read_run(run).speed_rad_s


def enlarged(defects: tuple[Defect, ...], strength: float) -> tuple[tuple[Defect, ...], float]:
    """Return one mechanism so large that single counts hide nothing of it, and how many times.

    What does not grow in proportion to its size is left as it is, and so are several.

    Parameters
    ----------
    defects
        The mechanisms.
    strength
        Size that they were aimed at, in noise of a window.
    """
    if len(defects) > 1 or defects[0].mechanism in _NOT_IN_PROPORTION:
        return defects, 1.0
    times = max(1.0, _LARGE / strength)
    return (replace(defects[0], size=times * defects[0].size),), times
