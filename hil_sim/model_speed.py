"""The speed that a model file gives, window by window, while the commands are still coming in."""

from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from usmbench.errors import InputError
from usmbench.model.applied import applied_effects
from usmbench.model.driving import driving
from usmbench.model.effects.context import Context
from usmbench.model.extended import extended_run, through
from usmbench.model.hammerstein import HammersteinModel
from usmbench.model.mixed_curve import settled_speed
from usmbench.model.operating_points import point_weights
from usmbench.model.resonance_slope import mixed_slope, point_slopes

_AHEAD: Final = 64
_REMEMBERED: Final = 20_000


class Window(NamedTuple):
    """What holds during a window.

    Parameters
    ----------
    t_s
        Its end, from the start of the acquisition.
    phase_deg, frequency_hz, torque_nm
        Command and load; where the drive is off, the frequency is of no account.
    driven
        Whether the drive is on.
    """

    t_s: float
    phase_deg: float
    frequency_hz: float
    torque_nm: float
    driven: bool

    def after(self, windows: int, window_s: float) -> "Window":
        """Return a later window in which nothing has changed.

        Parameters
        ----------
        windows
            How many later.
        window_s
            Duration of each.
        """
        return self._replace(t_s=self.t_s + windows * window_s)


class ModelSpeed:
    """Runs a model free, one window at a time.

    While nothing changes the run goes ahead of the windows; a change runs the past again, of which
    the last 20 000 windows at least are kept.

    Parameters
    ----------
    model
        The model.

    Raises
    ------
    usmbench.errors.InputError
        The model has no time step, or an effect that is not installed or fails.
    """

    def __init__(self, model: HammersteinModel):
        if model.linear.window_s is None:
            raise InputError(
                "the model was identified on settled pairs and has no time step, so no motor can "
                "run by it; identify it on windows, for example with --method fast"
            )
        self.window_s = model.linear.window_s
        self._model = model
        self._effects = applied_effects(model.effects)
        self._slopes = point_slopes(model.points)
        self._past: list[Window] = []
        self._ahead: NDArray[np.float64] = np.zeros(0)
        self._taken = 0
        self._forgotten_rad = 0.0
        self._try_out()

    def _try_out(self) -> None:
        """Run a window and forget it: what an effect fails at is told before anybody waits."""
        point = self._model.points[0]
        at = (point.frequency_hz or 0.0, point.torque_nm or 0.0)
        self.speed_rad_s(Window(self.window_s, 0.0, *at, driven=True))
        self._past, self._ahead, self._taken = [], np.zeros(0), 0

    def speed_rad_s(self, window: Window) -> float:
        """Return the mean speed of the next window.

        Parameters
        ----------
        window
            What holds during it.
        """
        same = bool(self._past) and self._past[-1][1:] == window[1:]
        self._past.append(window)
        if not same or self._taken == self._ahead.size:
            self._run()
        speed = float(self._ahead[self._taken])
        self._taken += 1
        return speed

    def _run(self) -> None:
        """Run over the past and some windows more, as if nothing changed."""
        last = self._past[-1]
        coming = (last.after(k, self.window_s) for k in range(1, _AHEAD))
        windows = np.array([*self._past, *coming])
        t_s, phase_deg, frequency_hz, torque_nm, driven = windows.T
        frequency_hz = np.where(driven > 0.0, frequency_hz, last.frequency_hz)
        weights, _ = point_weights(self._model.points, t_s.size, frequency_hz, torque_nm)
        weights = [weight * driven for weight in weights]
        context = Context(
            t_s,
            self.window_s,
            phase_deg,
            settled_speed(self._model.points, weights),
            self._model.linear,
            detuning_rad_s=mixed_slope(self._slopes, weights),
            driving=driving(t_s, self.window_s, driven > 0.0),
        )
        shaft = [a for a in self._effects if a.effect.stage != "counter"]
        motion = extended_run(shaft, context).speed_rad_s
        turned_rad = motion * self.window_s
        angle_rad = self._forgotten_rad + np.cumsum(turned_rad) - 0.5 * turned_rad
        seen = replace(context, angle_rad=angle_rad)
        shown = through(self._effects, "counter", motion, seen)
        self._ahead, self._taken = shown[len(self._past) - 1 :], 0
        if len(self._past) > 2 * _REMEMBERED:
            self._forgotten_rad += float(turned_rad[:_REMEMBERED].sum())
            del self._past[:_REMEMBERED]
