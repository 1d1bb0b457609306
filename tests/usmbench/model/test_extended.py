"""The stages of the simulation with effects in it."""

from dataclasses import replace

import numpy as np
import pytest

from usmbench.model.applied import Applied
from usmbench.model.effects.context import Context
from usmbench.model.effects.first_order import first_order
from usmbench.model.effects.registry import find_effect
from usmbench.model.extended import at_shaft_angle, counted, shaft_run, shaft_speeds
from usmbench.model.hammerstein import LinearPart

WINDOW_S = 0.01
MOTION_RAD_S = np.repeat([2.0, 10.0, 2.0, -10.0], 200)
LOST = Applied(
    find_effect("missed_counts", "of the excess"), {"lost_of_excess": 0.5, "above_rad_s": 6.0}
)
DISC = Applied(find_effect("encoder_eccentricity", ""), {"cosine": 0.02, "sine": 0.01})


def _middle_rad(speed_rad_s: np.ndarray) -> np.ndarray:
    return (np.cumsum(speed_rad_s) - 0.5 * speed_rad_s) * WINDOW_S


def _context(counted_rad_s: np.ndarray) -> Context:
    """Return a stretch whose angle is that of a counter."""
    n = counted_rad_s.size
    linear = LinearPart(np.array([-0.05]), np.array([0.95]), 0, WINDOW_S)
    return Context(
        WINDOW_S * np.arange(1.0, n + 1.0),
        WINDOW_S,
        np.zeros(n),
        lambda phase_deg: phase_deg,
        linear,
        _middle_rad(counted_rad_s),
    )


def test_the_shaft_is_ahead_of_a_counter_by_all_that_this_has_lost() -> None:
    behind = _context(LOST.effect.apply(MOTION_RAD_S, _context(MOTION_RAD_S), LOST.values))
    shaft = at_shaft_angle([LOST], MOTION_RAD_S, behind)
    assert behind.angle_rad is not None
    assert shaft.angle_rad is not None
    assert np.max(np.abs(behind.angle_rad - _middle_rad(MOTION_RAD_S))) > 1.0
    assert shaft.angle_rad == pytest.approx(_middle_rad(MOTION_RAD_S), abs=1e-9)


def test_the_angle_stays_as_it_is_where_nothing_is_lost_by_chance() -> None:
    context = _context(MOTION_RAD_S)
    assert at_shaft_angle([DISC], MOTION_RAD_S, context) is context


@pytest.mark.parametrize("order", [[LOST, DISC], [DISC, LOST]])
def test_a_disc_in_front_of_a_counter_that_loses_counts_ripples_with_the_shaft(
    order: list[Applied],
) -> None:
    truly = _context(MOTION_RAD_S)
    passing = DISC.effect.apply(MOTION_RAD_S, truly, DISC.values)
    reported = LOST.effect.apply(passing, truly, LOST.values)
    lost_without = LOST.effect.apply(MOTION_RAD_S, truly, LOST.values)
    found = counted(order, MOTION_RAD_S, _context(lost_without))
    assert found == pytest.approx(reported, abs=1e-9)


@pytest.mark.parametrize("slip_rad_s", [None, 4.0])
@pytest.mark.parametrize("cause", ["phase_offset", "transport_delay"])
@pytest.mark.parametrize("longer", [1.0, 2.0])
def test_stretches_run_together_as_each_runs_alone(
    slip_rad_s: float | None, cause: str, longer: float
) -> None:
    lag = replace(first_order(0.0035, 0.0015, WINDOW_S), slip_limit_rad_s=slip_rad_s)
    contexts = [
        replace(_context(phase), phase_deg=phase, linear=lag, window_s=window_s)
        for phase, window_s in ((MOTION_RAD_S, WINDOW_S), (-MOTION_RAD_S[:7], longer * WINDOW_S))
    ]
    effect = find_effect(cause, "")
    effects = [Applied(effect, {p.name: p.null + p.typical for p in effect.parameters})]
    together = shaft_speeds(effects, contexts)
    for found, context in zip(together, contexts, strict=True):
        assert found == pytest.approx(shaft_run(effects, context).speed_rad_s, abs=1e-12)


def test_a_rotor_starts_at_the_phase_that_is_set() -> None:
    """An offset moves the start as it moves the speed."""
    stairs_deg = np.repeat(np.r_[np.arange(-9.0, 10.0), np.arange(9.0, -10.0, -1.0)], 3)
    t_s = WINDOW_S * np.arange(1.0, stairs_deg.size + 1.0)
    commanded = replace(
        _context(stairs_deg),
        t_s=t_s,
        phase_deg=stairs_deg,
        settled_rad_s=lambda deg: np.sign(deg) * np.maximum(np.abs(deg) - 2.0, 0.0),
    )
    sticks = Applied(
        find_effect("dead_zone_hysteresis", "sticking at rest"), {"start_later_deg": 3.0}
    )
    offset = Applied(find_effect("phase_offset", ""), {"offset_deg": -1.5})
    moved = replace(commanded, phase_deg=stairs_deg - 1.5)
    both = shaft_run([offset, sticks], commanded).settled_rad_s
    assert both == pytest.approx(shaft_run([sticks], moved).settled_rad_s)
    assert not np.allclose(both, shaft_run([offset], commanded).settled_rad_s)
