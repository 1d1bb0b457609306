"""A run with an effect hidden in it, and what a diagnosis has to say of it."""

import pytest

from known_motor import measured
from usmbench.diagnose.pipeline import diagnose
from usmbench.model.applied import Applied
from usmbench.model.hammerstein import HammersteinModel


def assert_named(model: HammersteinModel, hidden: Applied, parameter: str | None) -> None:
    """Hold a diagnosis to the name of what is hidden, and to one of its sizes."""
    found = diagnose([measured(7, hidden)], model)
    (cause,) = found.causes
    assert cause.name == hidden.effect.name
    assert cause.by_chance == hidden.effect.by_chance
    assert found.verdict == "explained"
    assert found.gain > 0.9
    assert len(found.extended.effects) == 1
    assert not any("identified on one run" in warning for warning in found.warnings)
    if parameter is not None:
        sizes = {p.name: p for p in cause.parameters}
        assert sizes[parameter].value == pytest.approx(hidden.values[parameter], rel=0.1)
