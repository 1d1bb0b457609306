"""A run that the simulation follows is none that departs, whatever its model's own runs left."""

from dataclasses import replace

import numpy as np
import pytest

from known_motor import NOISE_RAD_S, driven, identified
from usmbench.diagnose.known.model_knowledge import knowledge_of
from usmbench.diagnose.naming.verdict import verdict_on
from usmbench.diagnose.pipeline import searched
from usmbench.diagnose.residual.own_effects import cut_beside_own


@pytest.mark.parametrize(
    ("asymmetry", "noise", "names"),
    [(0.0, 0.3, False), (0.02, 0.3, True), (0.0, 2.0, True)],
    ids=["as simulated", "not so", "louder than the noise"],
)
def test_a_model_as_the_motor_does_what_it_simulates(
    asymmetry: float, noise: float, *, names: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of its own runs the model is known to miss some friction, the same on each."""
    known = knowledge_of(identified())
    mean, k = known.mean.copy(), known.features.groups.index("friction")
    mean[k] += 8.0 * np.linalg.norm(known.root[k])
    missing = replace(known, mean=mean)
    monkeypatch.setattr("usmbench.diagnose.pipeline.known_of", lambda _: missing)
    phase_deg = np.repeat(np.random.default_rng(5).uniform(-88.0, 88.0, 100), 15)
    record = driven(phase_deg, 5)
    (simulated,), _ = cut_beside_own([record], identified())
    speed_rad_s = simulated.simulated_rad_s
    speed_rad_s = speed_rad_s + asymmetry * np.abs(speed_rad_s)
    noisy = noise * NOISE_RAD_S * np.random.default_rng(3).standard_normal(phase_deg.size)
    stretches, _ = cut_beside_own([replace(record, speed_rad_s=speed_rad_s + noisy)], identified())
    found = searched(stretches, identified())
    assert bool(found.names) == names
    assert (verdict_on(found, 0.0) == "no_discrepancy") != names
