"""What must hold of the contact whatever its parameters."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hil_sim.plant.contact import Contact, traction
from hil_sim.plant.parameters import ContactParameters
from hil_sim.plant.stator import Vibration

CONTACT = Contact(ContactParameters())
vibrations = st.builds(
    Vibration, amplitude=st.floats(0.0, 1.2), travelling_share=st.floats(-1.0, 1.0)
)


def test_nothing_vibrates_everything_holds() -> None:
    grip = CONTACT.grip(Vibration(0.0, 0.0))
    assert grip.surface_speed_rad_s == 0.0
    assert grip.clamp_nm == ContactParameters().clamp_limit_nm


def test_a_pure_travelling_wave_does_not_clamp() -> None:
    assert CONTACT.grip(Vibration(0.3, 1.0)).clamp_nm == pytest.approx(0.0, abs=1e-9)


def test_vibration_frees_a_standing_wave_contact() -> None:
    clamps_nm = [CONTACT.grip(Vibration(a, 0.0)).clamp_nm for a in (0.0, 0.2, 0.4, 0.6, 0.8)]
    assert clamps_nm == sorted(clamps_nm, reverse=True)
    assert clamps_nm[-1] < 0.01 * clamps_nm[0]


@settings(deadline=None)
@given(vibration=vibrations, speed_rad_s=st.floats(-20.0, 20.0))
def test_traction_is_bounded_and_falls_with_speed(vibration: Vibration, speed_rad_s: float) -> None:
    grip = CONTACT.grip(vibration)
    torque_nm, slope = traction(grip, speed_rad_s)
    assert abs(torque_nm) <= grip.traction_limit_nm
    assert slope <= 0.0
    step = 1e-4
    rise_nm = traction(grip, speed_rad_s + step)[0] - traction(grip, speed_rad_s - step)[0]
    assert rise_nm / (2.0 * step) == pytest.approx(slope, abs=1e-7)


@settings(deadline=None)
@given(vibration=vibrations)
def test_turning_the_wave_round_turns_the_grip_round(vibration: Vibration) -> None:
    grip = CONTACT.grip(vibration)
    mirrored = CONTACT.grip(vibration._replace(travelling_share=-vibration.travelling_share))
    assert mirrored.surface_speed_rad_s == -grip.surface_speed_rad_s
    assert mirrored.clamp_nm == grip.clamp_nm
