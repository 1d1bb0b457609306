"""Effects as a model file lists them."""

import pytest

from usmbench.errors import InputError
from usmbench.model.applied import Applied, applied_effects, foreseen_effects
from usmbench.model.effects.base import Effect
from usmbench.model.effects.registry import find_effect, library


@pytest.mark.parametrize("effect", library(), ids=lambda e: f"{e.name} {e.form}".strip())
def test_comes_back_from_a_model_file(effect: Effect) -> None:
    applied = Applied(effect, effect.null)
    assert applied_effects([applied.to_mapping()]) == (applied,)


def test_of_single_windows_nobody_foresees_which() -> None:
    entries = [
        Applied(find_effect(name, ""), find_effect(name, "").null).to_mapping()
        for name in ("count_glitches", "phase_offset")
    ]
    assert [a.effect.name for a in foreseen_effects(entries)] == ["phase_offset"]


def test_a_missing_parameter_is_refused() -> None:
    with pytest.raises(InputError, match="phase_offset lacks offset_deg"):
        applied_effects([{"name": "phase_offset", "parameters": {}}])


@pytest.mark.parametrize("delay_s", [-0.001, 1.5, float("inf")])
def test_an_entry_beyond_its_bounds_says_which_they_are(delay_s: float) -> None:
    entry = {"name": "transport_delay", "parameters": {"delay_s": delay_s}}
    with pytest.raises(InputError, match=r"transport_delay has delay_s = .*may be 0 to 1 s$"):
        applied_effects([entry])
