"""Heat goes where it must: energy in, energy stored, energy out."""

import pytest

from hil_sim.plant.parameters import ThermalParameters
from hil_sim.plant.stator import Vibration
from hil_sim.plant.thermal import Thermal
from hil_sim.signals import Drive

P = ThermalParameters()
STEP_S = 0.1


def heated(loss_w: float, n_steps: int) -> Thermal:
    thermal = Thermal(P, STEP_S)
    thermal.set_loss(0.0, loss_w)
    for k in range(n_steps):
        thermal.advance((k + 1) * STEP_S)
    return thermal


def test_steady_warming_is_loss_times_resistance() -> None:
    resistance = P.stator_resistance_k_per_w + P.housing_resistance_k_per_w
    assert heated(4.0, 100_000).warming_k == pytest.approx(4.0 * resistance, rel=1e-9)


def test_first_warming_stores_all_the_heat_in_the_stator() -> None:
    stored_j = heated(5.0, 1).warming_k * P.stator_capacity_j_per_k
    assert stored_j == pytest.approx(5.0 * STEP_S, rel=2e-3)


def test_without_loss_it_stays_at_ambient() -> None:
    assert heated(0.0, 100).temperature_c == P.ambient_c


def test_it_cools_down_again() -> None:
    thermal = heated(5.0, 5000)
    thermal.set_loss(500.0, 0.0)
    temperatures_c = []
    for k in range(50_000):
        thermal.advance(500.0 + (k + 1) * STEP_S)
        temperatures_c.append(thermal.temperature_c)
    assert temperatures_c == sorted(temperatures_c, reverse=True)
    assert temperatures_c[-1] == pytest.approx(P.ambient_c, abs=1e-3)


def test_a_loss_that_lasts_part_of_a_step_counts_for_that_part() -> None:
    part = Thermal(P, STEP_S)
    part.set_loss(0.025, 8.0)
    part.set_loss(0.075, 0.0)
    part.advance(STEP_S)
    whole = Thermal(P, STEP_S)
    whole.set_loss(0.0, 4.0)
    whole.advance(STEP_S)
    assert part.warming_k == pytest.approx(whole.warming_k, rel=1e-12)


def test_loss_grows_with_the_square_of_voltage_and_vibration() -> None:
    thermal = Thermal(P, STEP_S)
    one = thermal.loss_w(Drive(41_000.0, 90.0, 1.0, 1.0), Vibration(0.5, 1.0))
    two = thermal.loss_w(Drive(41_000.0, 90.0, 2.0, 2.0), Vibration(1.0, 1.0))
    assert two == pytest.approx(4.0 * one)
    assert thermal.loss_w(Drive(), Vibration(0.0, 0.0)) == 0.0
