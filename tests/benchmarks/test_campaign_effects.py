"""What a mechanism does to the speed, measured where single counts do not hide it."""

import numpy as np
import pytest

from benchmarks.campaign_bench import MotorBench
from benchmarks.campaign_draws import Draw, Hidden
from benchmarks.campaign_effects import enlarged
from benchmarks.campaign_runs import Excited
from hil_sim.defects import CATALOGUE, parse_defect

SHORT = Excited("staircase", 5.0, 5)


def test_what_grows_in_proportion_is_measured_at_ten_times_the_noise() -> None:
    (larger,), times = enlarged((parse_defect("worn_contact=0.036"),), 0.3)
    assert times == pytest.approx(10.0 / 0.3)
    assert larger.mechanism == "worn_contact"
    assert larger.size == pytest.approx(1.2)


@pytest.mark.parametrize(
    ("defects", "strength"),
    [
        (["worn_contact=4.0"], 30.0),
        (["sticky_friction=3.0"], 0.3),
        (["worn_contact=0.12", "hanging_weight=0.6"], 1.0),
    ],
    ids=["large", "a thing of starts and stops", "two"],
)
def test_the_rest_is_measured_as_it_is(defects: list[str], strength: float) -> None:
    made = tuple(parse_defect(text) for text in defects)
    assert enlarged(made, strength) == (made, 1.0)


@pytest.mark.parametrize("mechanism", ["worn_contact", "flywheel"])
def test_a_small_effect_is_its_share_of_a_large_one(
    motor_bench: MotorBench, mechanism: str
) -> None:
    def seen_rad_s(size: float, strength: float) -> float:
        made = (CATALOGUE[mechanism](size * CATALOGUE[mechanism].typical),)
        draw = Draw(1, Hidden("single", strength=strength), SHORT, wire=False)
        seen = motor_bench.effects.seen(draw, made)
        return float(np.sqrt(np.mean(seen.effects_rad_s.mean(axis=0)[seen.well] ** 2)))

    # The first is driven ten times as large as the noise, the second as it is.
    assert seen_rad_s(0.3, 0.3) / seen_rad_s(3.0, 10.0) == pytest.approx(0.1, rel=0.2)
