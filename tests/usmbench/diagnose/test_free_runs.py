"""Runs that are kept are those that would be made anew."""

from collections.abc import Sequence

import numpy as np
import pytest

from usmbench.diagnose.free_runs import FreeRuns
from usmbench.diagnose.stretches import Stretch, cut_runs
from usmbench.model.effects.base import Context
from usmbench.model.effects.first_order import first_order
from usmbench.model.effects.registry import find_effect
from usmbench.model.extended import Applied, ExtendedRun, extended_run, shaft_run
from usmbench.model.hammerstein import HammersteinModel, OperatingPoint, StaticCurve
from usmbench.runs.record import Record

CURVE = StaticCurve(
    np.array([-90.0, -60, -30, -15, -8, -3, 3, 8, 15, 30, 60, 90]),
    np.array([-10.3, -10.1, -8, 0, 0, 0, 0, 0, 0, 8, 10.2, 10.4]),
)
LATE = [Applied(find_effect("transport_delay", ""), {"delay_s": d}) for d in (0.004, 0.02)]
RIPPLE = Applied(find_effect("encoder_eccentricity", ""), {"cosine": 0.01, "sine": 0.02})
BLIND = Applied(find_effect("unsigned_counts", ""), {})


@pytest.fixture
def stretches() -> list[Stretch]:
    """Return one run of 200 windows."""
    point = OperatingPoint(None, None, CURVE, (-90.0, 90.0), (-15.0, 15.0), 0.02)
    model = HammersteinModel(first_order(0.0035, 0.0015, 0.01), (point,), "fast")
    phase_deg = np.repeat(np.random.default_rng(0).uniform(-88.0, 88.0, 40), 5)
    t_s = 0.01 * np.arange(1.0, phase_deg.size + 1.0)
    speed_rad_s = CURVE.speed_rad_s(phase_deg)
    return cut_runs([Record("run", t_s, phase_deg, speed_rad_s, np.full(200, 0.01))], model, ())[0]


@pytest.mark.parametrize("effects", [[], [LATE[0]], [RIPPLE, LATE[0]], [BLIND], LATE])
def test_a_run_from_memory_is_the_run_itself(
    stretches: list[Stretch], effects: list[Applied]
) -> None:
    runs = FreeRuns(stretches)
    for asked in ([LATE[1]], effects, [*effects, RIPPLE], effects):
        (found,) = runs.speed_rad_s(asked)
        expected = extended_run(asked, stretches[0].context).speed_rad_s
        np.testing.assert_array_equal(found, expected)


def test_what_comes_after_the_shaft_does_not_run_it_again(
    stretches: list[Stretch], monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Sequence[Applied]] = []

    def counting(effects: Sequence[Applied], context: Context) -> ExtendedRun:
        asked.append(effects)
        return shaft_run(effects, context)

    monkeypatch.setattr("usmbench.diagnose.free_runs.shaft_run", counting)
    runs = FreeRuns(stretches)
    for after in ([], [RIPPLE], [BLIND], [RIPPLE, BLIND]):
        runs.speed_rad_s([LATE[0], *after])
    assert asked == [[LATE[0]]]
