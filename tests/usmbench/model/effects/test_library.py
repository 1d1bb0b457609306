"""Every effect of the library keeps the same promises."""

import numpy as np
import pytest
from numpy.typing import NDArray

from usmbench.errors import InputError
from usmbench.model.applied import Applied
from usmbench.model.effects.base import Effect
from usmbench.model.effects.context import Context
from usmbench.model.effects.registry import find_effect, library
from usmbench.model.extended import extended_run
from usmbench.model.hammerstein import LinearPart

Array = NDArray[np.float64]
WINDOW_S = 0.01
CONTRACT = [
    "phase_offset",
    "gain_asymmetry",
    "speed_scale",
    "thermal_drift",
    "dead_zone_hysteresis",
    "load_torque",
    "missed_counts",
    "encoder_eccentricity",
    "transport_delay",
    "slow_dynamics",
    "phase_quantisation",
    "count_glitches",
    "unsigned_counts",
]
BENCH = [
    "amplitude_droop",
    "crystal_error",
    "stick_slip",
    "shaft_compliance",
    "generator_imbalance",
    "phase_scale",
    "coupling_backlash",
    "swapped_channels",
    "damaged_disc",
]


def _curve(phase_deg: Array) -> Array:
    speed: Array = 10.0 * np.sign(phase_deg) * np.maximum(np.abs(phase_deg) - 10.0, 0.0) / 80.0
    return speed


def _context(n: int = 600) -> Context:
    phase_deg = np.repeat(np.random.default_rng(3).uniform(-90.0, 90.0, n // 5), 5)
    linear = LinearPart(np.array([-0.05]), np.array([0.6, 0.35]), 0, WINDOW_S)
    t_s = WINDOW_S * np.arange(1.0, n + 1.0)
    turned_rad = np.cumsum(np.full(n, 0.07))
    return Context(
        t_s,
        WINDOW_S,
        phase_deg,
        _curve,
        linear,
        turned_rad,
        detuning_rad_s=lambda p: 50 * _curve(p),
    )


def _run(applied: list[Applied]) -> Array:
    return extended_run(applied, _context()).speed_rad_s


def _ids(effect: Effect) -> str:
    return f"{effect.name} {effect.form}".strip()


def test_the_library_holds_every_cause() -> None:
    assert {effect.name for effect in library()} >= {*CONTRACT, *BENCH}


@pytest.mark.parametrize("effect", library(), ids=_ids)
class TestEveryEffect:
    def test_vanishes_at_its_null(self, effect: Effect) -> None:
        if not effect.parameters or effect.name == "unsigned_counts":  # it is there or not
            assert not np.allclose(_run([Applied(effect, effect.null)]), _run([]))
            return
        assert np.allclose(_run([Applied(effect, effect.null)]), _run([]), atol=1e-12)

    def test_changes_the_speed_by_a_finite_amount(self, effect: Effect) -> None:
        values = {
            p.name: p.null
            if p.scanned and p.null > 0.0
            else p.null + 20.0 * p.typical * (1.0 if p.high > p.null else -1.0)
            for p in effect.parameters
        }
        inside = {p.name: float(np.clip(values[p.name], p.low, p.high)) for p in effect.parameters}
        changed = _run([Applied(effect, inside)])
        assert np.all(np.isfinite(changed))
        assert np.max(np.abs(changed - _run([]))) > 1e-4

    def test_tries_scanned_values_within_its_bounds(self, effect: Effect) -> None:
        scanned = {p.name: p for p in effect.parameters if p.scanned}
        grid = effect.grid([_context()])
        assert set(grid) == set(scanned)
        for name, values in grid.items():
            assert values.size > 1
            assert np.all(np.diff(values) >= 0.0)
            assert scanned[name].low <= values[0]
            assert values[-1] <= scanned[name].high

    def test_says_what_it_is_and_where_to_look(self, effect: Effect) -> None:
        assert effect.meaning.endswith(".")
        assert effect.mend.endswith(".")
        assert all(p.low <= p.null <= p.high and p.typical > 0.0 for p in effect.parameters)


def test_a_cause_that_is_not_installed_is_refused() -> None:
    with pytest.raises(InputError, match="not installed"):
        find_effect("gremlins", "")


@pytest.mark.parametrize("effect", library(), ids=_ids)
def test_every_parameter_says_what_it_is(effect: Effect) -> None:
    for parameter in effect.parameters:
        assert len(parameter.what.split()) >= 3
        assert not parameter.what.endswith(".")
