"""Runs beside an offset of the phase, over random phases or stairs."""

import numpy as np
import pytest

from known_motor import applied, driven
from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.naming.found import Found
from usmbench.diagnose.residual.own_effects import cut_beside_own
from usmbench.model.applied import Applied
from usmbench.model.hammerstein import HammersteinModel


def offset(degrees: float) -> Applied:
    return applied("phase_offset", "", offset_deg=degrees)


def cut_run(model: HammersteinModel, *hidden: Applied, stairs: bool = False) -> list[Stretch]:
    phase_deg = np.repeat(np.random.default_rng(8).uniform(-88.0, 88.0, 240), 5)
    if stairs:
        up_deg = np.linspace(-88.0, 88.0, 23)
        phase_deg = np.repeat(np.concatenate([up_deg, up_deg[::-1]]), 25)
    return cut_beside_own([driven(phase_deg, 41, *hidden)], model)[0]


def assert_both_named(found: Found, offset_deg: float, other: Applied) -> None:
    """Assert that an offset and another cause of one size are named, as large as they are."""
    ((parameter, size),) = other.values.items()
    values = {a.effect.name: a.values for a in found.fit.effects}
    assert sorted(found.names) == sorted(["phase_offset", other.effect.name])
    assert values["phase_offset"]["offset_deg"] == pytest.approx(offset_deg, abs=0.02)
    assert values[other.effect.name][parameter] == pytest.approx(size, abs=1e-3)
