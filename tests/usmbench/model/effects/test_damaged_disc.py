"""A place of the disc without marks: what is counted, and how it is told from chance."""

from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from usmbench.model.effects.context import Context
from usmbench.model.effects.count_glitches import CountGlitches
from usmbench.model.effects.damaged_disc import DamagedDisc
from usmbench.model.effects.lone_windows import LoneWindows, SporadicEffect
from usmbench.model.effects.missed_counts import LostNowAndThen
from usmbench.model.hammerstein import LinearPart

Array = NDArray[np.float64]
COUNT_RAD, WINDOW_S, N = 2.0 * np.pi / 2000.0, 0.01, 6000
TELLING = 4.6  # half the deviance that tells two causes apart: 99 % of χ² with two


def _to_and_fro(draw: np.random.Generator) -> Array:
    """Return speeds that dwell for 20 windows each, shape (N,)."""
    return np.repeat(draw.uniform(-10.0, 10.0, N // 20), 20)


def _counted(speed_rad_s: Array, place: int, lines: int) -> Array:
    """Return the counter's position at the ends of the windows, from 0 on, shape (N + 1,).

    Every count of the true position is there but those of the lines that are gone.
    """
    turned = np.cumsum(np.concatenate([[0.0], speed_rad_s])) * WINDOW_S / COUNT_RAD
    true = np.floor(turned).astype(np.int64)
    low, high = int(true.min()), int(true.max())
    marks = (np.arange(low, high + 1) - place) % 2000 >= 4 * lines
    shown = np.concatenate([[0], np.cumsum(marks)])[true - low]
    return np.asarray(shown - shown[0], dtype=np.float64)


def _windows(seed: int, speed_rad_s: Array, counted: Array, missing: Array) -> LoneWindows:
    """Return a run's windows, of which those that miss two counts or more stand alone."""
    off_rad_s = -np.sign(speed_rad_s) * missing * COUNT_RAD / WINDOW_S
    noise_rad_s = 0.05 * np.random.default_rng(seed).standard_normal(N)
    low, high = np.sort(np.stack([counted[:-1], counted[1:]]), axis=0) * COUNT_RAD
    run = np.zeros(N, dtype=np.int64)
    return LoneWindows(
        speed_rad_s, off_rad_s + noise_rad_s, np.abs(missing) > 1.0, low, high, run, WINDOW_S
    )


def _damaged(seed: int, place: int, lines: int) -> LoneWindows:
    """Return the windows of a disc that has lost some lines."""
    speed_rad_s = _to_and_fro(np.random.default_rng(seed))
    whole, shown = (_counted(speed_rad_s, place, gone) for gone in (0, lines))
    missing = np.abs(np.diff(whole)) - np.abs(np.diff(shown))
    return _windows(seed, speed_rad_s, shown, missing)


def _by_likelihood(windows: LoneWindows) -> list[tuple[float, str]]:
    kinds: tuple[SporadicEffect, ...] = (DamagedDisc(), CountGlitches(), LostNowAndThen())
    return sorted((-kind.weigh(windows).log_likelihood, kind.name) for kind in kinds)


@pytest.mark.parametrize("lines", [1, 3])
def test_one_place_is_told_from_chance_and_found(lines: int) -> None:
    draw, held = np.random.default_rng(lines), 0
    for seed in range(20):
        place = int(draw.integers(1, 1980))
        windows = _damaged(seed, place, lines)
        (best, name), (next_best, _), _ = _by_likelihood(windows)
        assert name == "damaged_disc"
        assert next_best - best > TELLING
        found = DamagedDisc().weigh(windows).values
        low, missing_rad, high = found["missing_rad"]
        assert low <= missing_rad <= high
        assert missing_rad == pytest.approx(4 * lines * COUNT_RAD, rel=0.1)
        low, place_rad, high = found["angle_rad"]
        assert low <= place_rad <= high < low + 0.1
        held += low - COUNT_RAD <= place * COUNT_RAD <= high + COUNT_RAD
    assert held >= 17  # of 20 at 95 % fewer come in 1.6 %


@pytest.mark.parametrize("seed", range(10))
def test_one_place_is_found_among_as_many_false_counts(seed: int) -> None:
    draw = np.random.default_rng(seed)
    place = int(draw.integers(1, 1980))
    gap = _damaged(seed, place, 3)
    passes = int(np.count_nonzero(gap.alone))
    struck = draw.permutation(N)[:passes]
    off_rad_s = gap.deviation_rad_s.copy()
    off_rad_s[struck] += draw.choice([-2.5, 2.5], passes) * COUNT_RAD / WINDOW_S
    alone = gap.alone.copy()
    alone[struck] = True
    windows = replace(gap, deviation_rad_s=off_rad_s, alone=alone)
    (best, name), (next_best, _), _ = _by_likelihood(windows)
    assert name == "damaged_disc"
    assert next_best - best > TELLING
    found = DamagedDisc().weigh(windows).values
    assert found["missing_rad"][1] == pytest.approx(12 * COUNT_RAD, rel=0.1)
    assert found["angle_rad"][1] == pytest.approx(place * COUNT_RAD, abs=0.05)
    time_s = N * WINDOW_S
    assert found["rate_hz"][1] * time_s == pytest.approx(passes, rel=0.2)
    label, at_rad = DamagedDisc().shown_against(windows)
    assert label.endswith("(rad)")
    assert np.mean(np.abs(at_rad[gap.alone]) < 0.15) > 0.9


def test_false_counts_anywhere_are_no_place() -> None:
    told = 0
    for seed in range(20):
        draw = np.random.default_rng(seed)
        speed_rad_s = _to_and_fro(draw)
        missing = np.where(draw.uniform(size=N) < 0.005, draw.choice([-4.0, 4.0], N), 0.0)
        windows = _windows(seed, speed_rad_s, _counted(speed_rad_s, 0, 0), missing)
        (best, name), (next_best, _), _ = _by_likelihood(windows)
        assert name == "count_glitches"
        told += next_best - best > TELLING
    assert told >= 18


def test_lost_counts_of_a_fast_motor_are_no_place() -> None:
    for seed in range(20):
        draw = np.random.default_rng(seed)
        speed_rad_s = _to_and_fro(draw)
        struck = (np.abs(speed_rad_s) > 6.0) & (draw.uniform(size=N) < 0.01)
        windows = _windows(
            seed, speed_rad_s, _counted(speed_rad_s, 0, 0), np.where(struck, 4.0, 0.0)
        )
        assert _by_likelihood(windows)[0][1] == "missed_counts"


def test_a_line_that_is_lost_above_some_speed_is_no_damage() -> None:
    """As by a filter that swallows the narrowest pulse of the disc."""
    for seed in range(20):
        speed_rad_s = _to_and_fro(np.random.default_rng(seed))
        whole, lacking = (np.diff(_counted(speed_rad_s, 700, lines)) for lines in (0, 1))
        counts = np.where(np.abs(speed_rad_s) > 7.0, lacking, whole)
        counted = np.cumsum(np.concatenate([[0.0], counts]))
        windows = _windows(seed, speed_rad_s, counted, np.abs(whole) - np.abs(counts))
        assert _by_likelihood(windows)[0][1] == "missed_counts"


def test_angles_that_begin_anew_in_each_run_show_one_place_each() -> None:
    # Of a scratch that has grown.
    first, second = _damaged(1, 300, 1), _damaged(2, 1500, 3)
    joined: dict[str, Any] = {
        f.name: np.concatenate([getattr(first, f.name), getattr(second, f.name)])
        for f in fields(LoneWindows)[:-3]
    }
    run = np.repeat([4, 7], N)
    both = LoneWindows(**joined, run=run, window_s=WINDOW_S)
    assert _by_likelihood(both)[0][1] == "damaged_disc"
    assert DamagedDisc().weigh(both).values["angle_rad"][1] == pytest.approx(
        300 * COUNT_RAD, abs=0.05
    )
    # One that turns past no such place says nothing of it.
    healthy = replace(second, alone=np.zeros(N, dtype=np.bool_), run=run[N:])
    weighed = DamagedDisc().weigh(healthy)
    assert weighed.log_likelihood == -np.inf


def test_the_simulation_counts_what_is_there() -> None:
    speed_rad_s, place, lines = _to_and_fro(np.random.default_rng(3)), 700, 5
    counted_rad_s = np.diff(_counted(speed_rad_s, place, lines)) * COUNT_RAD / WINDOW_S
    t_s = WINDOW_S * np.arange(1.0, N + 1.0)
    linear = LinearPart(np.array([-0.05]), np.array([0.6, 0.35]), 0, WINDOW_S)
    context = Context(t_s, WINDOW_S, t_s, lambda phase_deg: phase_deg, linear)
    sizes = {"missing_rad": 4 * lines * COUNT_RAD, "angle_rad": place * COUNT_RAD}
    seen_rad_s = DamagedDisc().apply(speed_rad_s, context, {"rate_hz": 1.0, **sizes})
    # Whole counts on the one side only.
    assert np.max(np.abs(seen_rad_s - counted_rad_s)) * WINDOW_S < 1.01 * COUNT_RAD
    assert np.sum(speed_rad_s - seen_rad_s) * WINDOW_S > 4 * lines * COUNT_RAD


def test_nothing_that_stands_alone_speaks_for_no_damage() -> None:
    windows = _damaged(1, 300, 0)
    assert DamagedDisc().weigh(windows).log_likelihood == -np.inf
