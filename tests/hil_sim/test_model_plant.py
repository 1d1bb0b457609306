"""A model file as the motor: what is measured on it is what the model says."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks.in_process_bench import in_process_bench
from hil_sim.__main__ import build_plant
from hil_sim.model_plant import ModelPlant
from hil_sim.plant.parameters import DiscParameters
from hil_sim.signals import Drive
from usmbench.cli.simulated_bench import start_testbed
from usmbench.cli.sweep_run import sweep_new
from usmbench.errors import InputError
from usmbench.model.hammerstein import (
    HammersteinModel,
    LinearPart,
    OperatingPoint,
    StaticCurve,
)
from usmbench.model.model_file import write_model
from usmbench.model.replay import replay_record
from usmbench.runs.reader import read_run
from usmbench.settings.bench import BenchSettings
from usmbench.settings.plan_file import parse_plan
from usmbench.settings.yaml_source import parse_source

RATE_HZ = 1e5
WINDOW_S = 0.01
COUNT_RAD = 2.0 * np.pi / 2000.0
PLAN = """
format: usmbench-plan/1
frequency_hz: 41000
excitation: {kind: telegraph, seed: 3, amplitude_deg: 80, duration_s: 4, levels: 9,
  switch_probability: 0.5, hold_windows: 5}
"""
ON = Drive(41_000.0, 60.0, 1.0, 1.0)


def hammerstein(*effects: dict[str, Any], window_s: float | None = WINDOW_S) -> HammersteinModel:
    curve = StaticCurve(np.array([-90.0, -20.0, 20.0, 90.0]), np.array([-4.0, 0.0, 0.0, 4.0]))
    point = OperatingPoint(41_000.0, 0.0, curve, (-90.0, 90.0), (-15.0, 15.0), 0.01)
    linear = LinearPart(np.array([-0.6]), np.array([0.3, 0.1]), 0, window_s)
    return HammersteinModel(linear, (point,), "fast", effects=effects)


def effect(name: str, form: str, stage: str, **parameters: float) -> dict[str, Any]:
    return {"name": name, "form": form, "stage": stage, "parameters": parameters}


EXTENDED = (
    effect("transport_delay", "", "settled", delay_s=0.023),
    effect("encoder_eccentricity", "", "counter", cosine=0.03, sine=0.02),
    effect("phase_offset", "", "command", offset_deg=4.0),
)


def turned_rad(plant: ModelPlant, windows: int) -> float:
    position = plant.sample(round(windows * WINDOW_S * RATE_HZ), RATE_HZ).position
    return float(position[-1] - position[0]) * COUNT_RAD


@pytest.mark.parametrize("effects", [(), EXTENDED], ids=["identified", "extended"])
@pytest.mark.parametrize("window_s", [WINDOW_S, WINDOW_S - 2.2e-9, WINDOW_S + 2.2e-9])
def test_a_sweep_on_the_model_measures_what_replay_says(
    tmp_path: Path, effects: tuple[dict[str, Any], ...], window_s: float
) -> None:
    model = hammerstein(*effects, window_s=window_s)
    plan = parse_plan(parse_source(PLAN, "telegraph.yaml"))
    interlocks = replace(BenchSettings(name="t").interlocks, index_error_max_counts=None)
    settings = replace(BenchSettings(name="t"), interlocks=interlocks)
    with in_process_bench(settings=settings, plant=ModelPlant(model)).opened() as bench:
        sweep_new(bench, plan, tmp_path / "run")
    record = read_run(tmp_path / "run")
    replayed = replay_record(record, model)
    error = np.abs(record.speed_rad_s - replayed.simulation.speed_rad_s)
    # Edges are timed to the sample; where the speed steps, a window may be a count off.
    assert np.max(error) < 1.1 * COUNT_RAD / WINDOW_S
    assert np.quantile(error, 0.7) < 0.005
    assert np.std(record.speed_rad_s) > 1.0


def test_the_motor_stands_while_the_drive_is_off() -> None:
    plant = ModelPlant(hammerstein())
    plant.drive(0.0, replace(ON, amplitude_b=0.0))
    assert turned_rad(plant, 20) == 0.0


def test_a_command_acts_in_the_window_in_whose_end_it_is_in_force() -> None:
    model = hammerstein()
    plant = ModelPlant(model)
    plant.sample(1000, RATE_HZ)
    plant.drive(0.018, ON)
    settled = float(model.points[0].curve.speed_rad_s(np.array([60.0]))[0])
    first = turned_rad(plant, 1) / (999 / 1000 * WINDOW_S)
    assert first == pytest.approx(0.3 * settled, abs=COUNT_RAD / WINDOW_S)


def test_the_speed_does_not_depend_on_how_the_samples_are_split() -> None:
    counts = []
    for split in (1, 10):
        plant = ModelPlant(hammerstein(*EXTENDED))
        plant.drive(0.0, ON)
        parts = [plant.sample(10_000 // split, RATE_HZ).position for _ in range(split)]
        counts.append(np.concatenate(parts))
    assert np.array_equal(counts[0], counts[1])


def test_a_long_run_keeps_angle_and_speed_when_the_past_is_forgotten(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    shown = []
    for remembered in (20_000, 300):
        monkeypatch.setattr("hil_sim.model_speed._REMEMBERED", remembered)
        plant = ModelPlant(hammerstein(*EXTENDED))
        plant.drive(0.0, ON)
        shown.append([turned_rad(plant, 100) for _ in range(12)])
    assert shown[0] == pytest.approx(shown[1], abs=COUNT_RAD)


def test_load_and_frequency_choose_between_operating_points() -> None:
    model = hammerstein()
    (point,) = model.points
    slower = StaticCurve(point.curve.knots_deg, 0.5 * point.curve.delta)
    loaded = replace(point, torque_nm=0.2, curve=slower)
    speeds = []
    for torque_nm in (0.0, 0.1, 0.2):
        plant = ModelPlant(replace(model, points=(point, loaded)))
        plant.set_load(0.0, torque_nm)
        plant.drive(0.0, ON)
        turned_rad(plant, 50)
        speeds.append(turned_rad(plant, 50))
    assert speeds[1] / speeds[0] == pytest.approx(0.75, abs=0.01)
    assert speeds[2] / speeds[0] == pytest.approx(0.5, abs=0.01)


def test_a_slipping_disc_and_a_dead_channel_stop_the_count() -> None:
    plant = ModelPlant(hammerstein(), DiscParameters())
    plant.drive(0.0, ON)
    assert turned_rad(plant, 50) > 0.5
    plant.set_coupling(0.5, False)
    assert turned_rad(plant, 50) == pytest.approx(0.0, abs=0.1)
    plant.set_coupling(1.0, True)
    assert turned_rad(plant, 50) > 0.5
    plant.set_dead_channel(1.5, "a")
    assert turned_rad(plant, 50) == pytest.approx(0.0, abs=0.1)


def test_settled_pairs_make_no_motor() -> None:
    with pytest.raises(InputError, match="identify it on windows"):
        ModelPlant(hammerstein(window_s=None))


def test_the_command_starts_the_motor_of_a_model_file(tmp_path: Path) -> None:
    write_model(tmp_path / "model.yaml", hammerstein())
    assert isinstance(build_plant([], 0, tmp_path / "model.yaml"), ModelPlant)
    with start_testbed(["--model", str(tmp_path / "model.yaml")]) as testbed:
        testbed.set_load(0.1)


@pytest.mark.parametrize("off_s", [0.3, 2.0])
def test_a_motor_that_drifts_cools_while_the_drive_is_off(off_s: float) -> None:
    """It starts again faster than it went off, by as much as it has cooled."""
    lost, warm_up_s = 0.5, 2.0
    drift = effect("thermal_drift", "speed", "settled", final_drift=-lost, warm_up_s=warm_up_s)
    motor = hammerstein(drift)
    plant, cold_rad_s = ModelPlant(motor), motor.points[0].curve.speed_rad_s(np.array([60.0]))[0]
    speeds = []
    for time_s, drive in ((0.0, ON), (4.0, replace(ON, amplitude_a=0.0, amplitude_b=0.0))):
        plant.drive(time_s, drive)
        plant.sample(round((4.0 if time_s == 0.0 else off_s) * RATE_HZ), RATE_HZ)
    plant.drive(4.0 + off_s, ON)
    for _ in range(2):
        counts = plant.sample(round(0.2 * RATE_HZ), RATE_HZ).position
        speeds.append((counts[-1] - counts[-10_000]) * COUNT_RAD / 0.1)
    warm = -np.expm1(-4.0 / warm_up_s) * np.exp(-off_s / warm_up_s)
    for k, speed_rad_s in enumerate(speeds):
        warmed = 1.0 - (1.0 - warm) * np.exp(-(0.15 + 0.2 * k) / warm_up_s)
        assert speed_rad_s == pytest.approx(cold_rad_s * (1.0 - lost * warmed), rel=0.02)
