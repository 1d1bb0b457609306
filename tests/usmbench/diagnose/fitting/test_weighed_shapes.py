"""Shapes of an effect, more than are weighed together: drops and angles."""

import numpy as np
import pytest

from known_motor import judged
from usmbench.diagnose.fitting.weighed_shapes import WeighedShapes
from usmbench.model.applied import Applied
from usmbench.model.effects.registry import find_effect

GIVEN = (Applied(find_effect("phase_offset", ""), {"offset_deg": 0.4}),)


@pytest.mark.parametrize(
    ("name", "form"), [("phase_quantisation", "rounded"), ("encoder_eccentricity", "")]
)
def test_each_drop_and_angle_is_that_of_carried_changes(name: str, form: str) -> None:
    problem, effect = judged(1.5), find_effect(name, form)
    scanned = [p for p in effect.parameters if p.scanned]
    sized = [p for p in effect.parameters if not p.scanned]
    steps = np.r_[0.0, np.geomspace(0.2, 8.0, 69)] if scanned else np.zeros(70)
    shapes = [{p.name: float(step) for p in scanned} for step in steps]
    tried = list(WeighedShapes(problem, effect, GIVEN).best(shapes, sized))
    before = problem.left(GIVEN)
    assert len(tried) == 70
    for one in tried:
        found = (*GIVEN, Applied(effect, one.values))
        drop = before @ before - problem.square(problem.left_rad_s(found))
        assert one.drop == pytest.approx(drop, rel=0.02, abs=0.02)
    if not scanned:
        assert max(one.turned for one in tried) < 1e-6
        return
    changes = [before - problem.left((*GIVEN, Applied(effect, one.values))) for one in tried[1:]]
    for one, last, change in zip(tried[2:], changes, changes[1:], strict=False):
        cosine = abs(last @ change) / np.sqrt((last @ last) * (change @ change))
        assert one.turned == pytest.approx(np.arccos(cosine), abs=1e-5)
