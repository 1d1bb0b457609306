"""A motor that loses speed as it warms, in runs that were paused: what is known foretells it."""

from dataclasses import replace

import numpy as np

from tests.usmbench.diagnose.known.resting_motor import day, model
from usmbench.diagnose.known.warm_start_shapes import unsure_in_gaps
from usmbench.diagnose.residual.own_effects import cut_beside_own, known_of


def test_it_may_be_off_by_what_either_would_do() -> None:
    known = known_of(model(0))
    stretches, _ = cut_beside_own([day(80, 300.0, says=False)], model(0))
    off_rad_s = list(unsure_in_gaps(stretches, known.features, known.mean))
    for s, off in zip(stretches, off_rad_s, strict=True):
        assert s.unsure_warmth is not None
        driven = known.expected_rad_s(replace(s, warmth=s.warmth + s.unsure_warmth))
        np.testing.assert_allclose(driven - known.expected_rad_s(s), off[:, 0], atol=1e-9)
    assert not off_rad_s[0].any()
    assert np.max(np.abs(off_rad_s[1])) > 0.01


def test_a_motor_that_has_stood_starts_as_on_another_day() -> None:
    known = known_of(model(0))
    stretches, _ = cut_beside_own([day(90, 300.0)], model(0))
    assert [(s.run, s.start) for s in stretches] == [(0, 0), (0, 1)]
    (_, once), (shapes, twice) = (
        known.background(given) for given in ([replace(s, start=0) for s in stretches], stretches)
    )
    n_own = known.wander.deviations.size
    assert twice.shape == (once.shape[0] + n_own, once.shape[1] + n_own)
    assert not shapes[0][:, -n_own:].any()
    assert not shapes[1][:, -2 * n_own : -n_own].any()
