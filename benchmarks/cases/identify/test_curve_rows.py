"""Samples that glide between dwells bring a curve nearer to the motor's."""

import numpy as np
import pytest

from benchmarks.plain_motor import motor_of
from tests.usmbench.identify.shaped_runs import shape_of, shaped_run
from usmbench.identify.selection import fitted_curve


@pytest.mark.parametrize("beside", [("multisine",), ("triangle",), ("multisine", "triangle")])
def test_what_glides_between_the_dwells_brings_the_curve_nearer(
    beside: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    def off_rad_s(seed: int) -> float:
        shape = shape_of(*(shaped_run(kind, 1500, 0.01, seed) for kind in ("staircase", *beside)))
        table_deg = np.linspace(-88.0, 88.0, 1761)
        found = fitted_curve(shape.rows[0], shape.choices[0]).speed_rad_s(table_deg)
        true_rad_s = motor_of(np.random.default_rng(seed)).settled_rad_s(table_deg)
        return float(np.sqrt(np.mean((found - true_rad_s) ** 2)))

    glided = np.array([off_rad_s(seed) for seed in range(5)])
    monkeypatch.setattr("usmbench.identify.curve_choice._gliding", lambda *_: None)
    share = glided / [off_rad_s(seed) for seed in range(5)]
    assert np.max(share) < 1.05
    assert np.exp(np.mean(np.log(share))) < 0.8
