"""A motor that turning warms, against its heat balance solved by another program."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from usmbench.model.driving import driving
from usmbench.model.effects.context import Context
from usmbench.model.effects.first_order import first_order
from usmbench.model.effects.thermal_drift import DriftByTurning

Array = NDArray[np.float64]
WINDOW_S, CONSTANT_S = 0.01, 4.0
BY_DRIVE, BY_TURNING = -0.05, -0.02


def _context(speed_rad_s: Array) -> Context:
    t_s = WINDOW_S * np.arange(1.0, speed_rad_s.size + 1.0)
    linear = first_order(0.0035, 0.0, WINDOW_S)
    return Context(t_s, WINDOW_S, speed_rad_s, lambda phase_deg: phase_deg, linear)


def _drifted(speed_rad_s: Array, context: Context) -> Array:
    values = {
        "final_drift": BY_DRIVE,
        "final_drift_by_turning_s_per_rad": BY_TURNING,
        "warm_up_s": CONSTANT_S,
    }
    return DriftByTurning().apply(speed_rad_s, context, values) / speed_rad_s - 1.0


def test_what_turning_warms_follows_a_heat_balance() -> None:
    levels = np.array([10.0, -2.0, 0.5, 6.0, -10.0])
    speed_rad_s, each_s = np.repeat(levels, 300), 3.0
    context = _context(speed_rad_s)

    def rise(t_s: float, drift: Array) -> Array:
        level = levels[min(int(t_s / each_s), levels.size - 1)]
        return np.asarray((BY_DRIVE + BY_TURNING * abs(level) - drift) / CONSTANT_S)

    solved = solve_ivp(rise, (0.0, 15.0), [0.0], t_eval=context.t_s, max_step=0.01, rtol=1e-8)
    assert _drifted(speed_rad_s, context) == pytest.approx(solved.y[0], abs=2e-4)


def test_a_block_from_the_middle_of_a_run_is_as_warm_as_the_run_was() -> None:
    speed_rad_s = np.tile(np.repeat([8.0, -1.0, 3.0, -8.0], 50), 40)
    whole = _context(speed_rad_s)
    part = slice(4000, 5000)
    block = replace(_context(speed_rad_s[part]), t_s=whole.t_s[part])
    off = _drifted(speed_rad_s[part], block) - _drifted(speed_rad_s, whole)[part]
    assert np.max(np.abs(off)) < 0.5 * abs(BY_TURNING)


def test_a_block_after_a_pause_without_drive_is_colder() -> None:
    speed_rad_s = np.full(500, 8.0)
    late = replace(_context(speed_rad_s), t_s=20.0 + WINDOW_S * np.arange(1.0, 501.0))
    on_s = np.r_[WINDOW_S * np.arange(1.0, 1001.0), 10.0 + WINDOW_S * np.arange(1.0, 1501.0)]
    paused = driving(on_s, WINDOW_S, (on_s < 5.0) | (on_s > 20.0))
    warm, cold = (
        -_drifted(speed_rad_s, context)[0] for context in (late, replace(late, driving=paused))
    )
    assert warm > 0.95 * abs(BY_DRIVE + 8.0 * BY_TURNING)
    assert cold < 0.1 * warm
