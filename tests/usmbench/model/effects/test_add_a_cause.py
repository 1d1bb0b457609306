"""The guide's example, installed as a user's package would be, is found, kept and simulated."""

from pathlib import Path

import numpy as np
import pytest

from usmbench.errors import InputError
from usmbench.model.applied import Applied, applied_effects
from usmbench.model.effects.context import Context
from usmbench.model.effects.registry import find_effect, library
from usmbench.model.extended import extended_run
from usmbench.model.hammerstein import LinearPart


@pytest.mark.usefixtures("users_cause")
def test_the_example_is_found_kept_and_simulated() -> None:
    effect = find_effect("brake_left_on", "")
    applied = Applied(effect, {"slowed_by": 0.5, "until_s": 0.105})
    assert applied_effects([applied.to_mapping()]) == (applied,)
    linear = LinearPart(np.empty(0), np.array([1.0]), 0, 0.01)
    context = Context(0.01 * np.arange(1.0, 21.0), 0.01, np.full(20, 8.0), lambda p: p, linear)
    speed = extended_run([applied], context).speed_rad_s
    assert np.allclose(speed, np.r_[np.full(10, 4.0), np.full(10, 8.0)])
    assert effect.grid([context])["until_s"].size == 19


@pytest.mark.parametrize("broken", ["import nowhere_at_all", "nothing_here", "1 / 0", "def ("])
def test_a_file_that_fails_is_told_with_its_cause(users_cause: Path, broken: str) -> None:
    users_cause.write_text(broken, "utf-8")
    with pytest.raises(InputError, match=r"brake_left_on .* cannot be loaded: \w+Error: .*package"):
        library()
