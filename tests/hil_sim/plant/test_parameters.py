"""Motors drawn: plausible, different, and repeatable."""

import numpy as np
import pytest

from hil_sim.plant.characteristics import dead_zone_deg, static_curve
from hil_sim.plant.parameters import PlantParameters
from hil_sim.plant.rig import OperatingPoint


def test_a_seed_draws_the_same_motor() -> None:
    first, second = (PlantParameters.draw(np.random.default_rng(4)) for _ in range(2))
    assert first == second
    assert first != PlantParameters.draw(np.random.default_rng(5))


def test_no_spread_leaves_all_but_mismatch_and_disc() -> None:
    base = PlantParameters()
    drawn = PlantParameters.draw(np.random.default_rng(4), spread=0.0)
    assert (drawn.contact, drawn.rotor, drawn.thermal) == (base.contact, base.rotor, base.thermal)
    assert drawn.stator.resonance_hz == base.stator.resonance_hz
    assert drawn.disc != base.disc


def test_spread_is_the_relative_standard_deviation() -> None:
    rng = np.random.default_rng(11)
    inertias = [PlantParameters.draw(rng, spread=0.03).rotor.inertia_kg_m2 for _ in range(1000)]
    assert np.std(np.log(inertias)) == pytest.approx(0.03, rel=0.1)


@pytest.mark.parametrize("seed", range(6))
def test_drawn_motors_still_behave_like_the_type(seed: int) -> None:
    motor = PlantParameters.draw(np.random.default_rng(seed))
    (full_rad_s,) = static_curve(motor, OperatingPoint(), [90.0])
    assert full_rad_s == pytest.approx(10.25, rel=0.15)
    low_deg, high_deg = dead_zone_deg(motor, OperatingPoint())
    assert -15.0 < low_deg < 0.0 < high_deg < 15.0
    (loaded_rad_s,) = static_curve(motor, OperatingPoint(42_000.0, 0.2), [90.0])
    assert loaded_rad_s > 0.5
