"""What a model file keeps of how to judge runs is blamed for its own faults alone."""

from dataclasses import replace
from pathlib import Path

import pytest

from known_motor import identified
from usmbench.diagnose.known.model_knowledge import knowledge_of
from usmbench.errors import CauseError
from usmbench.model.hammerstein import HammersteinModel

HABIT = {"name": "phase_offset", "form": "", "parameters": {"offset_deg": 1.0}}


@pytest.fixture(scope="module")
def habitual() -> HammersteinModel:
    """Return a model whose runs show an offset anyhow."""
    model = identified()
    known = {**model.residual["diagnosis"], "habits": [HABIT]}
    return replace(model, residual={**model.residual, "diagnosis": known})


def test_a_users_cause_that_fails_is_no_fault_of_the_models(
    habitual: HammersteinModel, users_cause: Path
) -> None:
    users_cause.write_text("1 / 0", "utf-8")
    with pytest.raises(CauseError, match=r"^the cause brake_left_on .* cannot be loaded"):
        knowledge_of(habitual)
