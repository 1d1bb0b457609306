"""A torque where the curve leaves the dead zone gradually."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from usmbench.model.driving import driving
from usmbench.model.effects.context import Context
from usmbench.model.effects.first_order import first_order
from usmbench.model.effects.load_torque import (
    CreepingWeight,
    DragAlongBend,
    Weight,
    WeightAlongBend,
)

Array = NDArray[np.float64]

WINDOW_S, NOISE_RAD_S = 0.01, 0.03
LINEAR = first_order(0.0035, 0.0015, WINDOW_S)
CONTEXT = Context(np.zeros(1), WINDOW_S, np.zeros(1), lambda phase_deg: phase_deg, LINEAR)
RUNS = st.floats(0.01, 20.0)
T_S, ON = np.array([1.0, 2.0]), np.array([True, False])


def _bent(straight: float, rounded: float) -> float:
    return 0.5 * (straight + float(np.hypot(straight, rounded)))


@given(straight=st.floats(-5.0, 20.0), rounded=st.floats(0.01, 2.0), loss=st.floats(-3.0, 3.0))
def test_it_moves_along_the_bend(straight: float, rounded: float, loss: float) -> None:
    speeds = np.array([1.0, -1.0]) * _bent(straight, rounded)
    drag = DragAlongBend().apply(speeds, CONTEXT, {"drag_rad_s": loss, "rounded_rad_s": rounded})
    slower = _bent(straight - loss, rounded)
    assert drag == pytest.approx([slower, -slower], rel=1e-6, abs=1e-6)
    sizes = {"one_sided_rad_s": loss, "rounded_rad_s": rounded}
    weight = WeightAlongBend().apply(speeds, CONTEXT, sizes)
    assert weight == pytest.approx([slower, -_bent(straight + loss, rounded)], rel=1e-6, abs=1e-6)


@given(speed=RUNS, rounded=st.floats(0.01, 2.0))
def test_no_torque_starts_a_rotor_that_stands_and_none_changes_nothing(
    speed: float, rounded: float
) -> None:
    signal = np.array([0.0, speed, -speed])
    none = {"one_sided_rad_s": 0.0, "rounded_rad_s": rounded}
    assert WeightAlongBend().apply(signal, CONTEXT, none) == pytest.approx(signal, rel=1e-9)
    lifted = WeightAlongBend().apply(signal, CONTEXT, {**none, "one_sided_rad_s": -2.0})
    assert lifted[0] == 0.0
    assert lifted[1] > speed


def test_a_weight_moves_no_rotor_where_a_curve_is_but_nearly_zero() -> None:
    context = replace(CONTEXT, phase_deg=np.array([10.0, -10.0, 0.004, -0.004]))
    for some in (slice(0, 4), slice(2, 4)):
        lifted = Weight().apply(context.phase_deg[some], context, {"one_sided_rad_s": -0.5})
        assert lifted == pytest.approx(np.array([10.5, -9.5, 0.004, -0.004])[some])


@given(loss=st.floats(-3.0, 3.0), speed=st.floats(-20.0, 20.0))
def test_a_weight_that_creeps_acts_at_rest_too_but_not_without_drive(
    loss: float, speed: float
) -> None:
    context = replace(CONTEXT, t_s=np.array([1.0, 2.0]), driving=driving(T_S, 1.0, ON))
    slower = CreepingWeight().apply(np.full(2, speed), context, {"one_sided_rad_s": loss})
    assert slower == pytest.approx([speed - loss, speed])
