"""A motor that brakes faster than it runs up, which no model of one lag can show."""

from dataclasses import replace

import numpy as np

from known_motor import identified
from tests.usmbench.diagnose.known.braking_rotor import WINDOW_S, turned_rad_s
from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.known.features_of_runs import features_of
from usmbench.model.effects.first_order import first_order
from usmbench.runs.record import Record


def test_a_time_constant_of_braking_has_a_shape_of_its_own() -> None:
    plain = identified()
    model = replace(plain, linear=first_order(0.004, 0.0012, WINDOW_S))
    phase_deg = np.repeat(np.random.default_rng(2).uniform(-88.0, 88.0, 100), 8)
    settled = model.points[0].curve.speed_rad_s(phase_deg)
    changed = turned_rad_s(settled, 0.004, 0.00396, 0.0012)
    changed -= turned_rad_s(settled, 0.004, 0.004, 0.0012)
    record = Record(
        "run",
        WINDOW_S * np.arange(1.0, phase_deg.size + 1.0),
        phase_deg,
        settled,
        np.full(phase_deg.size, WINDOW_S),
    )
    ((stretch,), _) = cut_runs([record], model, ())
    features = features_of([stretch])
    (column,) = (
        c for c, g in zip(features.columns(stretch), features.groups, strict=True) if g == "braking"
    )
    assert np.max(np.abs(changed)) > 0.01
    np.testing.assert_allclose(-0.01 * column, changed, atol=5e-4)
