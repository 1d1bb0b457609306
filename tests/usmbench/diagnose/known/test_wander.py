"""What differs from run to run: what moves with it, how far, and that it is no news."""

from dataclasses import replace
from typing import Any

import pytest

from tests.usmbench.diagnose.known.wandering_motor import (
    driven,
    slipping_motor,
)
from usmbench.diagnose.known.wander import Wander, wander_from_mapping
from usmbench.diagnose.reference import with_knowledge
from usmbench.model.hammerstein import HammersteinModel


@pytest.fixture(scope="module")
def plain() -> HammersteinModel:
    return slipping_motor()


@pytest.mark.parametrize(("halvings", "rounds"), [(1, 3), (4, 5)])
def test_what_runs_wander_by_is_learnt_until_it_settles(
    plain: HammersteinModel, monkeypatch: pytest.MonkeyPatch, halvings: int, rounds: int
) -> None:
    gains: list[float] = []

    def measured(widest: Wander, *_: Any) -> Wander:
        gains.append(widest.gain * 0.5 ** min(len(gains) + 1, halvings))
        return replace(widest, gain=gains[-1])

    monkeypatch.setattr("usmbench.diagnose.reference.measured_wander", measured)
    model = with_knowledge(plain, [driven(1, 1.0, 1.0, n=600)])
    assert len(gains) == rounds
    assert wander_from_mapping(model.residual["diagnosis"]).gain == gains[-1]


def test_the_wander_comes_back_from_the_model_file() -> None:
    some = Wander(
        0.01, (1e-3, 2e-3), 1e-4, 0.02, 0.05, 1e-3, 2e-3, (0.1, 0.2), 1e-3, 0.01, 1e-3, 1e-5, 0.1, 3
    )
    kept = some.to_mapping()
    assert wander_from_mapping(kept) == some
    del kept["one_sided"], kept["one_sided_ends"]  # older files have none
    assert wander_from_mapping(kept) == replace(some, one_sided=3e-4, one_sided_ends=3e-4)
