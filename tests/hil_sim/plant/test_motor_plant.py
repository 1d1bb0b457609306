"""The plant as the testbed uses it: determinism, splits, rest, long times, faults, speed."""

import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hil_sim.plant import MotorPlant, PlantParameters
from hil_sim.signals import Drive, Samples

RATE_HZ = 100_000.0
FULL = Drive(41_000.0, 90.0, 1.0, 1.0)
OFF = Drive()
QUIET = replace(PlantParameters(), rotor=replace(PlantParameters().rotor, noise_nm=0.0))


def joined(parts: Sequence[Samples]) -> tuple[list[int], list[int], float]:
    positions = np.concatenate([part.position for part in parts])
    pulses = np.concatenate([part.index_pulses for part in parts])
    return positions.tolist(), pulses.tolist(), parts[-1].temperature_c


# A command: samples before it, fraction of a sample period after those, and what it does.
commands = st.lists(
    st.tuples(
        st.integers(0, 700),
        st.floats(0.0, 1.0),
        st.one_of(
            st.builds(
                Drive,
                frequency_hz=st.sampled_from([41_000.0, 41_500.0, 42_000.0]),
                phase_deg=st.floats(-180.0, 180.0),
                amplitude_a=st.sampled_from([0.0, 1.0]),
                amplitude_b=st.sampled_from([0.0, 1.0]),
            ),
            st.floats(0.0, 0.2),
            st.booleans(),
            st.sampled_from(["a", "b", None]),
        ),
    ),
    max_size=8,
)


def command(plant: MotorPlant, time_s: float, what: object) -> None:
    match what:
        case Drive():
            plant.drive(time_s, what)
        case bool():
            plant.set_coupling(time_s, what)
        case float():
            plant.set_load(time_s, what)
        case "a" | "b" | None:
            plant.set_dead_channel(time_s, what)


def run(
    plan: list[tuple[int, float, object]], rate_hz: float, block: int | None
) -> tuple[list[int], list[int], float]:
    """Run a plan on a motor already turning, reading in blocks or each stretch at once."""
    plant = MotorPlant(seed=3)
    plant.drive(0.0, FULL)
    parts = []
    taken = 0
    for n_samples, fraction, what in [*plan, (500, 0.0, True)]:
        left = n_samples
        while left:
            size = min(left, block or left)
            parts.append(plant.sample(size, rate_hz))
            left -= size
        taken += n_samples
        command(plant, (taken + fraction) / rate_hz, what)
        if fraction:
            taken += 1
            parts.append(plant.sample(1, rate_hz))
    parts.append(plant.sample(10, rate_hz))
    return joined(parts)


@settings(deadline=None, max_examples=60)
@given(
    plan=commands,
    rate_hz=st.sampled_from([1e6, 1e5, 31_234.5, 1e4, 777.0]),
    block=st.sampled_from([1, 7, 50, 333]),
)
def test_samples_do_not_depend_on_how_they_are_split(
    plan: list[tuple[int, float, object]], rate_hz: float, block: int
) -> None:
    assert run(plan, rate_hz, block) == run(plan, rate_hz, None)


def test_same_seed_same_samples_and_another_seed_others() -> None:
    def samples(seed: int) -> tuple[list[int], list[int], float]:
        plant = MotorPlant(seed=seed)
        plant.drive(0.0, FULL)
        return joined([plant.sample(20_000, RATE_HZ)])

    assert samples(1) == samples(1)
    assert samples(1) != samples(2)


def test_the_motion_does_not_depend_on_the_sample_rate() -> None:
    ends = []
    for rate_hz in (1e3, 1e4, 1e5, 1e6):
        plant = MotorPlant(seed=3)
        plant.drive(0.0123, FULL)
        every = plant.sample(round(0.1 * rate_hz), rate_hz).position[:: round(rate_hz / 1e3)]
        ends.append(every.tolist())
    assert ends[0] == ends[1] == ends[2] == ends[3]


def test_commands_ahead_of_the_samples_take_effect_at_their_time() -> None:
    ahead, step_by_step = MotorPlant(QUIET), MotorPlant(QUIET)
    plan = [(0.0, FULL), (0.0412345, replace(FULL, phase_deg=-60.0)), (0.0799, OFF)]
    for time_s, drive in plan:
        ahead.drive(time_s, drive)
    position = ahead.sample(10_000, RATE_HZ).position
    parts = []
    taken = 0
    for time_s, drive in plan:
        until = int(np.ceil(time_s * RATE_HZ - 1e-6))
        if until > taken:
            parts.append(step_by_step.sample(until - taken, RATE_HZ).position)
            taken = until
        step_by_step.drive(max(time_s, taken / RATE_HZ), drive)
    parts.append(step_by_step.sample(10_000 - taken, RATE_HZ).position)
    assert np.abs(position - np.concatenate(parts)).max() <= 1


def test_never_more_than_one_count_between_samples() -> None:
    plant = MotorPlant(seed=8)
    rng = np.random.default_rng(8)
    parts = []
    for k in range(100):
        plant.drive(k * 0.01 + 0.0031, replace(FULL, phase_deg=float(rng.uniform(-180, 180))))
        parts.append(plant.sample(1000, RATE_HZ).position)
    assert np.abs(np.diff(np.concatenate(parts))).max() == 1


@pytest.mark.parametrize("phase_deg", [0.0, 3.0, -3.0])
def test_stands_exactly_still_in_the_dead_zone(phase_deg: float) -> None:
    plant = MotorPlant(seed=5)
    plant.drive(0.0, replace(FULL, phase_deg=phase_deg))
    assert set(plant.sample(500_000, RATE_HZ).position.tolist()) == {0}


def test_stops_within_milliseconds_of_the_drive_and_stays() -> None:
    plant = MotorPlant(seed=5)
    plant.drive(0.0, FULL)
    plant.sample(10_000, RATE_HZ)
    plant.drive(0.1, OFF)
    position = plant.sample(10_000, RATE_HZ).position
    assert position[0] < position[1000]
    assert set(position[1000:].tolist()) == {position[-1]}
    assert plant.speed_rad_s == 0.0


def test_index_comes_once_a_revolution() -> None:
    plant = MotorPlant(seed=5)
    plant.drive(0.0, FULL)
    samples = plant.sample(400_000, RATE_HZ)
    at = samples.position[1:][np.diff(samples.index_pulses) == 1]
    assert at.tolist() == [137 + 2000 * k for k in range(samples.index_pulses[-1])]
    assert len(at) >= 5


def test_slipped_coupling_shows_no_counts_though_the_shaft_turns() -> None:
    plant = MotorPlant(seed=5)
    plant.drive(0.0, FULL)
    before = plant.sample(5000, RATE_HZ).position[-1]
    plant.set_coupling(0.05, False)
    assert set(plant.sample(5000, RATE_HZ).position.tolist()) <= {before, before + 1}
    assert plant.speed_rad_s > 9.0
    plant.set_coupling(0.1, True)
    assert plant.sample(5000, RATE_HZ).position[-1] > before + 100


def test_dead_channel_counts_up_and_down_by_one() -> None:
    plant = MotorPlant(seed=5)
    plant.drive(0.0, FULL)
    plant.sample(5000, RATE_HZ)
    plant.set_dead_channel(0.05, "b")
    position = plant.sample(5000, RATE_HZ).position
    assert np.ptp(position) == 1
    assert np.count_nonzero(np.diff(position)) > 50


def test_after_a_day_it_moves_as_on_the_first_second() -> None:
    """Time, angle and temperature keep their precision over 24 h (without noise, to one count)."""
    day_s = 86_400.0
    fresh, aged = MotorPlant(QUIET), MotorPlant(QUIET)
    assert set(aged.sample(8640, 0.1).position.tolist()) == {0}
    fresh.drive(0.0, FULL)
    aged.drive(day_s, FULL)
    difference = aged.sample(20_000, RATE_HZ).position - fresh.sample(20_000, RATE_HZ).position
    assert np.abs(difference).max() <= 1
    assert np.count_nonzero(difference) < 20


def test_memory_does_not_grow_with_the_time_driven() -> None:
    plant = MotorPlant(seed=5)
    plant.drive(0.0, FULL)
    for k in range(200):
        plant.drive(k * 0.01, replace(FULL, phase_deg=float(k % 90)))
        plant.sample(1000, RATE_HZ)
        assert len(plant._motion.path) <= 2
        assert not plant._commands


def test_a_command_in_the_past_is_refused() -> None:
    plant = MotorPlant()
    plant.sample(1000, RATE_HZ)
    with pytest.raises(ValueError, match="has passed"):
        plant.drive(0.0099, FULL)
    plant.drive(0.02, FULL)
    with pytest.raises(ValueError, match="has passed"):
        plant.set_load(0.015, 0.1)


@pytest.mark.parametrize("torque_nm", [-0.1, float("nan")])
def test_a_brake_that_pushes_is_refused(torque_nm: float) -> None:
    with pytest.raises(ValueError, match="at least 0"):
        MotorPlant().set_load(0.0, torque_nm)


@pytest.mark.parametrize(("n_samples", "rate_hz"), [(0, 1e5), (1000, 0.0)])
def test_an_empty_block_is_refused(n_samples: int, rate_hz: float) -> None:
    with pytest.raises(ValueError, match="cannot be taken"):
        MotorPlant().sample(n_samples, rate_hz)


def test_driven_it_runs_far_faster_than_real_time() -> None:
    """A generous bound; benchmarks/motor_characteristics.py --speed prints the figure."""
    plant = MotorPlant(seed=5)
    plant.drive(0.0, FULL)
    plant.sample(10_000, RATE_HZ)
    best_s = np.inf
    for _ in range(20):
        start_s = time.process_time()
        for _ in range(20):
            plant.sample(1000, RATE_HZ)
        best_s = min(best_s, time.process_time() - start_s)
    assert 20 * 0.01 / best_s > 25.0
