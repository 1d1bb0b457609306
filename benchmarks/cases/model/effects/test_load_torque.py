"""A torque on a motor that leaves its dead zone gradually."""

from dataclasses import replace

import numpy as np
import pytest

from known_motor import CURVE, identified, measured
from known_motor import LINEAR as KNOWN
from usmbench.diagnose.pipeline import diagnose
from usmbench.diagnose.reference import with_knowledge
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.model.effects.first_order import first_order
from usmbench.model.hammerstein import HammersteinModel
from usmbench.model.linear import free_run
from usmbench.runs.record import Record

WINDOW_S, NOISE_RAD_S = 0.01, 0.03
LINEAR = first_order(0.0035, 0.0015, WINDOW_S)


def _driven(seed: int, drag_rad_s: float = 0.0, weight_rad_s: float = 0.0) -> Record:
    """Return a run of a motor whose friction differs over the stator: the dead zone ends softly."""
    rng, n = np.random.default_rng(seed), 3600
    phase_deg = np.repeat(rng.uniform(-89.0, 89.0, n // 12), 12)
    sides = np.array([1.0, -1.0])[:, None]
    top, steep, edge, soft = 10.0, 25.0, 14.0, 0.35
    along = (sides * phase_deg - edge) / steep
    straight = top * np.tanh(along) - drag_rad_s - sides * weight_rad_s
    forward, backward = soft * np.logaddexp(0.0, straight / soft)
    settled = np.where(np.abs(phase_deg) < 4.0, 0.0, forward - backward)
    speed = free_run(LINEAR, settled) + NOISE_RAD_S * rng.standard_normal(n)
    t_s = WINDOW_S * np.arange(1.0, n + 1.0)
    return Record(f"run {seed}", t_s, phase_deg, speed, np.full(n, WINDOW_S))


@pytest.fixture(scope="module")
def soft() -> HammersteinModel:
    runs = [_driven(1), _driven(2)]
    return with_knowledge(identify_fast(runs, FastOptions()).model, runs)


@pytest.mark.parametrize(("drag_rad_s", "weight_rad_s"), [(0.3, 0.0), (0.0, 0.4), (0.0, -0.3)])
def test_a_torque_on_a_motor_that_starts_gradually_is_named(
    soft: HammersteinModel, drag_rad_s: float, weight_rad_s: float
) -> None:
    found = diagnose([_driven(3, drag_rad_s, weight_rad_s)], soft)
    assert [cause.name for cause in found.causes] == ["load_torque"]
    size = found.causes[0].parameters[0]
    assert size.value == pytest.approx(drag_rad_s + weight_rad_s, rel=0.1)


@pytest.mark.parametrize("seed", range(2))
def test_a_weight_that_turns_the_rotor_where_it_should_stand_is_named(
    soft: HammersteinModel, seed: int
) -> None:
    draw = np.random.default_rng([seed, 79])
    weight_rad_s = draw.choice([-1.0, 1.0]) * draw.uniform(0.1, 0.5)
    healthy = _driven(90 + seed)
    found = diagnose([replace(healthy, speed_rad_s=healthy.speed_rad_s - weight_rad_s)], soft)
    (cause,) = found.causes
    assert (cause.name, found.verdict) == ("load_torque", "explained")
    assert cause.parameters[0].value == pytest.approx(weight_rad_s, rel=0.05)


@pytest.mark.parametrize("seed", range(2))
def test_a_torque_that_widens_the_dead_zone_is_named(seed: int) -> None:
    draw = np.random.default_rng([seed, 77])
    healthy, wider_deg = measured(80 + seed), draw.uniform(1.0, 6.0)
    size_deg = np.maximum(np.abs(healthy.phase_deg) - wider_deg, 0.0)
    moved = CURVE.speed_rad_s(np.sign(healthy.phase_deg) * size_deg)
    noise_rad_s = healthy.speed_rad_s - free_run(KNOWN, CURVE.speed_rad_s(healthy.phase_deg))
    found = diagnose(
        [replace(healthy, speed_rad_s=free_run(KNOWN, moved) + noise_rad_s)], identified()
    )
    (cause,) = found.causes
    assert (cause.name, found.verdict) == ("load_torque", "explained")
    assert cause.parameters[0].value == pytest.approx(wider_deg, rel=0.1)
