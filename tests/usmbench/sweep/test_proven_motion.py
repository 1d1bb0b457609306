import numpy as np
import pytest

from usmbench.settings.bench import InterlockSettings
from usmbench.sweep.proven_motion import (
    MARGIN_DEG,
    NOTHING_PROVEN,
    WINDOWS_TO_PROVE,
    ProvenMotion,
    must_move,
    prove,
)

LIMITS = InterlockSettings()


def moved(
    phase_deg: float, windows: int = WINDOWS_TO_PROVE, torque_nm: float = 0.0
) -> ProvenMotion:
    proven = NOTHING_PROVEN
    for _ in range(windows):
        proven = prove(proven, (41_000.0, torque_nm), phase_deg, True)
    return proven


@pytest.mark.parametrize(
    ("phase_deg", "moves"), [(85, True), (-95, True), (84, False), (96, False), (180, False)]
)
def test_without_proof_the_bench_file_says_where_it_must_move(
    phase_deg: float, moves: bool
) -> None:
    assert must_move(NOTHING_PROVEN, phase_deg, LIMITS) is moves


def test_motion_proves_the_phases_well_beyond_it_on_its_own_side() -> None:
    proven = moved(30.0)
    assert must_move(proven, 30.0 + MARGIN_DEG, LIMITS)
    assert not must_move(proven, 29.0 + MARGIN_DEG, LIMITS)
    assert not must_move(proven, -60.0, LIMITS)
    assert must_move(proven, 180.0 - 30.0 - MARGIN_DEG, LIMITS)


def test_running_down_after_a_step_proves_nothing() -> None:
    assert not must_move(moved(2.0, WINDOWS_TO_PROVE - 1), 60.0, LIMITS)


def test_another_load_or_frequency_must_prove_itself() -> None:
    proven = prove(moved(30.0), (41_000.0, 0.2), 30.0, True)
    assert not must_move(proven, 60.0, LIMITS)


def test_standing_still_forgets_nothing() -> None:
    proven = prove(moved(30.0), (41_000.0, 0.0), 5.0, False)
    assert must_move(proven, 60.0, LIMITS)


def test_of_phases_that_glide_the_farthest_may_have_moved_it() -> None:
    proven = NOTHING_PROVEN
    for phase_deg in np.linspace(-40.0, -20.0, WINDOWS_TO_PROVE):
        assert not must_move(proven, -60.0, LIMITS)
        proven = prove(proven, (41_000.0, 0.0), float(phase_deg), True)
    assert must_move(proven, -40.0 - MARGIN_DEG, LIMITS)
    assert not must_move(proven, -39.0 - MARGIN_DEG, LIMITS)
    assert not must_move(proven, 60.0, LIMITS)


def test_what_moves_to_and_fro_proves_nothing() -> None:
    proven = NOTHING_PROVEN
    for n in range(100):
        proven = prove(proven, (41_000.0, 0.0), 30.0 * (-1.0) ** (n // 4), True)
    assert not must_move(proven, 60.0, LIMITS)
