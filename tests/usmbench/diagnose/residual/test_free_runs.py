"""Runs that are kept are those that would be made anew."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.known.model_knowledge import knowledge_of
from usmbench.diagnose.noise.noise_estimate import estimate_noise
from usmbench.diagnose.residual.free_runs import FreeRuns
from usmbench.diagnose.residual.problem import Problem
from usmbench.model.applied import Applied
from usmbench.model.effects.context import Context
from usmbench.model.effects.registry import find_effect
from usmbench.model.extended import extended_run, shaft_speeds
from usmbench.model.hammerstein import HammersteinModel

Array = NDArray[np.float64]

LATE = [Applied(find_effect("transport_delay", ""), {"delay_s": d}) for d in (0.004, 0.02)]
RIPPLE = Applied(find_effect("encoder_eccentricity", ""), {"cosine": 0.01, "sine": 0.02})
BLIND = Applied(find_effect("unsigned_counts", ""), {})


@pytest.mark.parametrize("effects", [[], [LATE[0]], [RIPPLE, LATE[0]], [BLIND], LATE])
def test_a_run_from_memory_is_the_run_itself(
    stretches: list[Stretch], effects: list[Applied]
) -> None:
    runs = FreeRuns(stretches)
    for asked in ([LATE[1]], effects, [*effects, RIPPLE], effects):
        (found,) = runs.speed_rad_s(asked)
        expected = extended_run(asked, stretches[0].context).speed_rad_s
        np.testing.assert_array_equal(found, expected)


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[Sequence[Applied]]:
    """Return the effects with which the shaft was run, one entry a run."""
    effects_of_runs: list[Sequence[Applied]] = []

    def counting(effects: Sequence[Applied], contexts: Sequence[Context]) -> list[Array]:
        effects_of_runs.append(effects)
        return shaft_speeds(effects, contexts)

    monkeypatch.setattr("usmbench.diagnose.residual.free_runs.shaft_speeds", counting)
    return effects_of_runs


def test_what_comes_after_the_shaft_does_not_run_it_again(
    stretches: list[Stretch], asked: list[Sequence[Applied]]
) -> None:
    runs = FreeRuns(stretches)
    for after in ([], [RIPPLE], [BLIND], [RIPPLE, BLIND]):
        runs.speed_rad_s([LATE[0], *after])
    assert asked == [[LATE[0]]]


@pytest.mark.parametrize(("kept", "n_runs"), [(12 * 200, 12), (4 * 200, 20)])
def test_what_fits_in_memory_of_a_scan_is_run_once(
    stretches: list[Stretch],
    asked: list[Sequence[Applied]],
    kept: int,
    n_runs: int,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("usmbench.diagnose.residual.free_runs._KEPT", kept)
    monkeypatch.setattr("usmbench.diagnose.residual.free_runs._LAST", 1)
    runs = FreeRuns(stretches)
    late = [[Applied(LATE[0].effect, {"delay_s": d})] for d in np.linspace(0.001, 0.02, 12)]
    for _ in range(2):
        for at in range(0, 12, 4):
            runs.together_rad_s(late[at : at + 4])
    assert len(asked) == n_runs


@pytest.mark.parametrize("after", [[], [RIPPLE], [BLIND]])
def test_runs_that_are_kept_together_are_those_made_one_by_one(
    stretches: list[Stretch], after: list[Applied]
) -> None:
    runs = FreeRuns(stretches)
    motors = [[late, *after] for late in LATE]
    for _ in range(2):
        found = runs.together_rad_s(motors)
        for column, effects in zip(found.T, motors, strict=True):
            expected = extended_run(effects, stretches[0].context).speed_rad_s
            np.testing.assert_array_equal(column, expected)


def test_what_was_kept_of_a_counter_does_not_hold_at_another_angle(
    stretches: list[Stretch],
) -> None:
    runs = FreeRuns(stretches)
    angle_rad = np.linspace(0.0, 9.0, stretches[0].context.n)
    context = replace(stretches[0].context, angle_rad=angle_rad)
    runs.together_rad_s([[RIPPLE]])
    found = runs.turned([replace(stretches[0], context=context)]).together_rad_s([[RIPPLE]])
    expected = extended_run([RIPPLE], context).speed_rad_s
    np.testing.assert_array_equal(found[:, 0], expected)


def test_another_noise_runs_nothing_again(
    model: HammersteinModel, stretches: list[Stretch], asked: list[Sequence[Applied]]
) -> None:
    uses = [s.use for s in stretches]
    noise = estimate_noise(stretches, [s.residual_rad_s for s in stretches], uses)
    problem = Problem(stretches, knowledge_of(model), noise, uses)
    for weighed in (problem, problem.weighed(noise, uses), problem.with_masks(uses)):
        weighed.left(LATE)
    assert asked == [LATE]


def test_another_angle_is_seen_by_the_counter_and_runs_no_shaft(
    stretches: list[Stretch], asked: list[Sequence[Applied]]
) -> None:
    runs = FreeRuns(stretches)
    n = stretches[0].context.n
    angles_rad = (np.linspace(0.0, 9.0, n), np.linspace(1.0, 7.0, n))
    for angle_rad in angles_rad:
        context = replace(stretches[0].context, angle_rad=angle_rad)
        (found,) = runs.turned([replace(stretches[0], context=context)]).speed_rad_s([RIPPLE])
        expected = extended_run([RIPPLE], context).speed_rad_s
        np.testing.assert_array_equal(found, expected)
    assert asked == [[]]
