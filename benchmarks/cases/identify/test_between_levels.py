"""Curves between the few phases that were driven."""

import numpy as np
import pytest
from numpy.typing import NDArray

from benchmarks.identification_few_phases import PHASES_DEG, off_share


def test_a_curve_that_is_faster_than_both_levels_beside_is_nearer_where_it_is_held(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def off_shares() -> NDArray[np.float64]:
        return np.array([off_share(seed, PHASES_DEG[0], ["default"])[0] for seed in range(3)])

    held = off_shares()
    monkeypatch.setattr(
        "usmbench.identify.curve_choice._between_levels", lambda rows, free, *_: (free, rows)
    )
    share = held / off_shares()
    assert np.max(share) < 1.3
    assert np.exp(np.mean(np.log(share))) < 0.7
