"""The simulated motor that a run was measured on can be made again."""

from typing import Any

import pytest

from usmbench.cli.simulated_motor import SimulatedMotor
from usmbench.errors import InputError


def test_the_testbed_is_told_seed_and_defects() -> None:
    motor = SimulatedMotor(3, ("command_queue=40", "worn_contact"))
    words = ["--seed", "3", "--defect", "command_queue=40", "--defect", "worn_contact"]
    assert motor.arguments == words
    assert SimulatedMotor().arguments == []
    assert SimulatedMotor().meta == {}


def test_a_run_keeps_its_motor_and_a_later_one_has_other_noise() -> None:
    motor = SimulatedMotor(3, ("command_queue=40",))
    assert SimulatedMotor.of_run(motor.meta) == motor
    assert SimulatedMotor.of_run(motor.meta, later=2) == SimulatedMotor(5, motor.defects)
    assert SimulatedMotor.of_run({}, later=1) == SimulatedMotor(1)
    taken_up = {"seed": 3, "resumed": ["2026-01-01", "2026-01-02"]}
    assert SimulatedMotor.of_run(taken_up, later=1) == SimulatedMotor(6)


def test_a_run_keeps_the_model_that_its_motor_followed() -> None:
    motor = SimulatedMotor(model="extended.yaml")
    assert motor.arguments == ["--model", "extended.yaml"]
    assert motor.meta == {"model_file": "extended.yaml"}
    assert SimulatedMotor.of_run(motor.meta, model="copy.yaml") == SimulatedMotor(model="copy.yaml")


@pytest.mark.parametrize(
    ("meta", "model", "says"),
    [
        ({"model_file": "a.yaml"}, None, "followed the model file a.yaml; name that file by --mo"),
        ({}, "a.yaml", "followed its physics; leave --model out"),
    ],
)
def test_no_path_is_taken_from_a_run(meta: dict[str, Any], model: str | None, says: str) -> None:
    with pytest.raises(InputError, match=says):
        SimulatedMotor.of_run(meta, model=model)


@pytest.mark.parametrize("meta", [{}, {"seed": "x", "defects": "worn_contact"}, {"defects": None}])
def test_a_run_that_says_nothing_of_use_has_the_default_motor(meta: dict[str, Any]) -> None:
    assert SimulatedMotor.of_run(meta) == SimulatedMotor()
