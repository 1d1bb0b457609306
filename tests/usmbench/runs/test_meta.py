"""What run.yaml may say, and what is said of one that cannot be."""

import math
from pathlib import Path
from typing import Any

import pytest

from usmbench.errors import InputError
from usmbench.runs.meta import read_meta, said_motor
from usmbench.runs.reader import read_run

HEAD = "format: usmbench-run/1\n"


def _read(folder: Path, run_yaml: str) -> dict[str, Any]:
    """Return what run.yaml says."""
    (folder / "run.yaml").write_text(run_yaml)
    return read_meta(folder)


@pytest.mark.parametrize(
    ("run_yaml", "says"),
    [
        ("\nformat: usmbench-run/2\n", ":2: format: 'usmbench-run/2', this version reads"),
        ("- 1\n", ": has no keys"),
        (HEAD + "plan: [1\n", ":3: is not YAML"),
        (HEAD + "encoder: 7\n", ":2: encoder: 7 is not a mapping of keys or null"),
        (HEAD + "encoder: {sample_rate_hz: a}\n", ":2: encoder.sample_rate_hz: 'a' is not a num"),
        (HEAD + "encoder: {samples_per_average: 0}\n", ":2: encoder.samples_per_average: 0 is be"),
        (HEAD + "encoder:\n  counts_per_rev: many\n", ":3: encoder.counts_per_rev: 'many' is not"),
        (HEAD + "encoder:\n  counts_per_rev: -1\n", ":3: encoder.counts_per_rev: -1 is below"),
        (HEAD + "encoder:\n  counts_per_rev: .nan\n", ":3: encoder.counts_per_rev: nan is not a"),
        (HEAD + "generator: {phase_step_deg: 0}\n", ":2: generator.phase_step_deg: 0 is below"),
        (HEAD + "encoder: {counts_per_rev: yes}\n", ":2: encoder.counts_per_rev: True is not a"),
        (HEAD + "id: {}\n", ":2: id: {} is not text or a whole number or null"),
        (HEAD + "started: 2026-99-99\n", ":2: started: '2026-99-99' does not fit (ISO 8601, s"),
        (HEAD + "stopped: 12.5\n", ":2: stopped: 12.5 is not text or null"),
        (HEAD + "resumed: [yesterday]\n", ":2: resumed[0]: 'yesterday' does not fit (ISO 8601"),
        (HEAD + "exit: gone\n", ":2: exit: 'gone' does not fit (how the run ended: completed,"),
        (
            HEAD + "a: &a [x, x, x, x]\nmotor: [*a" + 99 * ",*a" + "]\n",
            ":2: its aliases (*name) m",
        ),
    ],
)
def test_a_wrong_run_yaml_is_named(tmp_path: Path, run_yaml: str, says: str) -> None:
    with pytest.raises(InputError) as caught:
        _read(tmp_path, run_yaml)
    assert f"{tmp_path / 'run.yaml'}{says}" in str(caught.value)


KEYS = [
    "id",
    "started",
    "resumed",
    "stopped",
    "exit",
    "software",
    "motor",
    "encoder",
    "generator",
    "plan",
    "bench",
    "seed",
    "defects",
]


@pytest.mark.parametrize("key", KEYS)
def test_a_key_that_is_null_says_nothing(tmp_path: Path, key: str) -> None:
    assert _read(tmp_path, f"{HEAD}{key}:\n")[key] is None


def test_what_a_user_adds_to_run_yaml_is_kept(tmp_path: Path) -> None:
    text = (
        HEAD + "room: {1: [.nan, 1.0e+300]}\n2: on\nencoder: {glued_on: 2026-01-01}\nplan: mine\n"
    )
    meta: dict[Any, Any] = _read(tmp_path, text)
    assert meta["room"] == {1: [pytest.approx(math.nan, nan_ok=True), 1e300]}
    assert meta[2] is True
    assert meta["encoder"] == {"glued_on": "2026-01-01"}
    assert meta["plan"] == "mine"


@pytest.mark.parametrize(
    "text",
    [
        "motor: {name: USR60, serial: 17}",
        "motor: [USR60]",
        "software: {name: theirs, version: 3}",
        "plan: [1]",
        "plan: {frequency_hz: fast, torque_nm: none}",
        "bench: {generator: 3, daq: [USB-6210]}",
        "generator: AD9833",
        "seed: many",
        "defects: {none: yes}",
    ],
)
def test_what_others_write_there_may_be_anything(tmp_path: Path, text: str) -> None:
    meta = _read(tmp_path, f"{HEAD}{text}\n")
    assert meta[text.split(":")[0]] is not None
    (tmp_path / "windows.csv").write_text("t_s,phase_deg,speed_rad_s\n0.01,60,5\n0.02,-60,-5\n")
    assert read_run(tmp_path).phase_step_deg is None


@pytest.mark.parametrize(
    ("motor", "said"),
    [
        ("USR60", "USR60"),
        ({"name": "USR60", "serial": 17, "preload_n": 160}, "USR60 17"),
        ({"preload_n": 160}, "preload_n 160"),
        (7, "7"),
        ({}, None),
        (None, None),
    ],
)
def test_a_motor_is_said_by_what_tells_it_from_others(motor: object, said: str | None) -> None:
    assert said_motor({"motor": motor}) == said
