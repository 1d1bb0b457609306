from itertools import pairwise

import numpy as np
import pytest

from usmbench.errors import InputError
from usmbench.settings.plan import Excitation
from usmbench.settings.yaml_source import Source
from usmbench.sweep.excitation import check_excitation, held_phases, multisine, n_holds

WINDOW_S = 0.01
SOURCE = Source("plan.yaml", {})


def phases(excitation: Excitation) -> np.ndarray:
    return np.array(list(held_phases(excitation, WINDOW_S, SOURCE)))


def test_a_telegraph_jumps_between_its_levels_as_often_as_it_should() -> None:
    telegraph = Excitation(
        "telegraph", 80.0, 4000.0, seed=5, centre_deg=5.0, levels=5, switch_probability=0.3
    )
    driven = phases(telegraph)
    assert len(driven) == n_holds(telegraph, WINDOW_S) == 80_000
    levels, visits = np.unique(driven, return_counts=True)
    np.testing.assert_allclose(levels, [-75, -35, 5, 45, 85])
    # Visits come in runs, so a share's deviation is that of some 80 000 · 0.3 / 2 draws.
    np.testing.assert_allclose(visits / len(driven), 0.2, atol=5 * np.sqrt(0.16 / 12_000))
    jumps = np.mean(driven[1:] != driven[:-1])
    assert jumps == pytest.approx(0.3, abs=5 * np.sqrt(0.21 / 80_000))


def test_a_telegraph_of_two_levels_has_a_flat_spectrum() -> None:
    telegraph = Excitation("telegraph", 1.0, 0.05 * 64 * 4096, seed=2)
    segments = phases(telegraph).reshape(4096, 64)
    power = np.mean(np.abs(np.fft.rfft(segments, axis=1)) ** 2, axis=0) / 64
    # White of variance 1: each bin averages 4096 draws of an exponential (at the ends, of χ²₁).
    np.testing.assert_allclose(power, 1.0, atol=5 * np.sqrt(2 / 4096))


def test_the_multisine_has_its_power_in_the_band_alone_and_flat() -> None:
    excitation = Excitation(
        "multisine", 70.0, 60.0, seed=3, hold_windows=4, period_s=20.0, band_hz=(0.5, 5.0)
    )
    driven = phases(excitation)
    assert len(driven) == 1500
    assert np.max(np.abs(driven)) == pytest.approx(70.0)
    amplitude = np.abs(np.fft.rfft(driven[:500])) / 250
    inside = amplitude[10:101]
    np.testing.assert_allclose(inside, inside[0], rtol=1e-9)
    assert np.max(np.delete(amplitude, slice(10, 101))) < 1e-9
    np.testing.assert_array_equal(driven[:500], driven[500:1000])


def test_the_ends_of_the_band_are_not_lost_to_rounding() -> None:
    period = multisine(2000, 0.05 * 20.0, 0.1 * 3 * 20.0, 0)
    assert period is not None
    assert np.count_nonzero(np.abs(np.fft.rfft(period)) > 1e-6) == 6


@pytest.mark.parametrize("kind", ["telegraph", "multisine"])
def test_a_seed_gives_the_same_phases_and_another_seed_others(kind: str) -> None:
    def of(seed: int) -> np.ndarray:
        return phases(Excitation(kind, 50.0, 20.0, seed=seed, levels=2))  # type: ignore[arg-type]

    np.testing.assert_array_equal(of(1), of(1))
    assert not np.array_equal(of(1), of(2))


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"band_hz": (1.0, 11.0)}, "choose at most 10"),
        ({"band_hz": (0.01, 0.09)}, "widen the band"),
        ({"period_s": 1e6}, "shorter period_s"),
    ],
)
def test_a_multisine_that_cannot_be_made(keys: dict[str, object], words: str) -> None:
    excitation = Excitation("multisine", 50.0, 10.0, **keys)  # type: ignore[arg-type]
    with pytest.raises(InputError, match=words):
        check_excitation(excitation, WINDOW_S, SOURCE)


def test_all_that_the_hold_can_carry() -> None:
    driven = phases(Excitation("multisine", 50.0, 10.0))
    spectrum = np.abs(np.fft.rfft(driven))
    assert np.all(spectrum[1:-1] > 0.1)
    assert all(a != b for a, b in pairwise(driven))
