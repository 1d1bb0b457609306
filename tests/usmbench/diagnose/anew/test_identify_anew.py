"""A model that was identified on speeds without sign is identified anew with the loss in place."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from usmbench.diagnose.pipeline import diagnose
from usmbench.diagnose.result import Diagnosis
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.model.applied import Applied
from usmbench.model.effects.context import Context
from usmbench.model.effects.registry import find_effect
from usmbench.model.extended import counted
from usmbench.model.hammerstein import LinearPart
from usmbench.model.linear import free_run
from usmbench.model.simulate import simulate
from usmbench.runs.record import Record

Array = NDArray[np.float64]

WINDOW_S, NOISE_RAD_S = 0.02, 0.02
# A lag of a tenth of a second, and a belt that rings at 4 Hz.
DYNAMICS = LinearPart(np.array([-2.45, 2.17, -0.69]), np.array([0.006, 0.018, 0.006]), 0, WINDOW_S)
PLAIN = Applied(find_effect("unsigned_counts", ""), {})
NOISY = Applied(find_effect("unsigned_counts", "with its noise"), {"noise_rad_s": 0.2})
RECTIFIED = Applied(
    find_effect("unsigned_counts", "rectified"), {"knee_rad_s": 1.0, "smoothing_s": 0.04}
)


def shaft(phase_deg: Array, backwards: float) -> Array:
    """Return the speed of a shaft that turns backwards more slowly by a factor."""
    settled_rad_s = 0.04 * np.where(phase_deg < 0.0, backwards * phase_deg, phase_deg)
    return free_run(DYNAMICS, settled_rad_s, 0.0)


def counted_run(
    seed: int,
    effects: Sequence[Applied],
    backwards: float = 1.0,
    n: int = 500,
    noise_rad_s: float = NOISE_RAD_S,
) -> Record:
    """Return windows as a counter shows them."""
    rng = np.random.default_rng(seed)
    phase_deg = np.repeat(rng.uniform(-60.0, 80.0, n), rng.integers(4, 20, n))[:n]
    t_s = WINDOW_S * np.arange(1.0, n + 1.0)
    context = Context(t_s, WINDOW_S, phase_deg, lambda deg: deg, DYNAMICS)
    shown = counted(effects, shaft(phase_deg, backwards), context)
    shown = shown + noise_rad_s * rng.standard_normal(n)
    return Record("run", t_s, phase_deg, shown, np.full(n, WINDOW_S))


def diagnosed(record: Record) -> Diagnosis:
    """Identify a model on a run, and diagnose the same run."""
    return diagnose([record], identify_fast([record], FastOptions(na=3, nb=2)).model)


@pytest.mark.parametrize("blindness", [PLAIN, NOISY, RECTIFIED])
def test_the_loss_of_sign_is_named_and_the_motor_found_again(blindness: Applied) -> None:
    found = diagnosed(counted_run(1, [blindness]))
    (cause,) = found.causes
    assert cause.name == "unsigned_counts"
    assert cause.form == blindness.effect.form
    assert found.gain > 0.8
    for estimate in cause.parameters:
        assert estimate.low <= blindness.values[estimate.name] <= estimate.high
    fresh = counted_run(2, [blindness]).phase_deg.clip(-55.0, 75.0)
    seeing = simulate(replace(found.extended, effects=()), fresh).speed_rad_s
    expected = shaft(fresh, 1.0)
    # Which way is forward cannot be seen.
    apart = min(np.std((sign * seeing - expected)[50:]) for sign in (1.0, -1.0))
    assert apart < 0.1 * np.std(expected)


@pytest.mark.parametrize("seed", range(2))
def test_short_and_noisy_runs_show_the_loss_too(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n, noise_rad_s = int(rng.integers(300, 500)), rng.uniform(0.02, 0.1)
    found = diagnosed(counted_run(seed, [PLAIN], rng.uniform(0.5, 1.0), n, noise_rad_s))
    assert [cause.name for cause in found.causes] == ["unsigned_counts"]


@pytest.mark.parametrize("seed", range(2))
def test_a_motor_that_stands_still_one_way_is_not_called_blind(seed: int) -> None:
    # Its counter tells which way: a blind one would fold what the belt swings back.
    found = diagnosed(counted_run(seed, [], backwards=0.0))
    assert not found.causes
