"""The generated constants are those of protocol.yaml, and a wrong description is refused."""

import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml

from firmware import generate
from usmbench.instruments.protocol import _generated

ROOT = Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "firmware" / "generate.py"


def test_the_generated_files_in_the_tree_are_fresh() -> None:
    done = subprocess.run([sys.executable, SCRIPT, "--check"], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")


def test_check_notices_a_stale_file_and_writing_mends_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    output = tmp_path / "_generated.py"
    monkeypatch.setattr(generate, "OUTPUTS", {output: generate.render_python})
    assert generate.main(["--check"]) == 1
    assert not output.exists()
    assert generate.main([]) == 0
    assert generate.main(["--check"]) == 0
    output.write_text(output.read_text("utf-8").replace("115200", "9600"), encoding="utf-8")
    assert generate.main(["--check"]) == 1


def test_limits_are_the_words_nearest_to_the_hertz() -> None:
    step_hz = _generated.DDS_CLOCK_HZ / 2**_generated.DDS_FREQUENCY_BITS
    assert abs(_generated.FREQUENCY_WORD_MIN * step_hz - 40_000) <= step_hz / 2
    assert abs(_generated.FREQUENCY_WORD_MAX * step_hz - 42_000) <= step_hz / 2


def _double_type(tree: dict[str, Any]) -> None:
    tree["requests"]["status"]["type"] = tree["requests"]["outputs"]["type"]


def _reply_type(tree: dict[str, Any]) -> None:
    tree["requests"]["status"]["type"] = 0x85


def _no_flags(tree: dict[str, Any]) -> None:
    tree["requests"]["identify"]["reply"].pop(0)


def _two_bits(tree: dict[str, Any]) -> None:
    tree["faults"]["stack"] = 0x03


def _too_long(tree: dict[str, Any]) -> None:
    tree["framing"]["max_payload"] = 20


def _too_large(tree: dict[str, Any]) -> None:
    tree["refusals"]["bad_value"] = 256


def _other_format(tree: dict[str, Any]) -> None:
    tree["format"] = "usmbench-protocol/2"


@pytest.mark.parametrize(
    "spoil",
    [_double_type, _reply_type, _no_flags, _two_bits, _too_long, _too_large, _other_format],
)
def test_a_description_that_contradicts_itself_is_refused(tmp_path: Path, spoil: Any) -> None:
    tree = yaml.safe_load((ROOT / "firmware" / "protocol.yaml").read_text("utf-8"))
    spoil(tree)
    path = tmp_path / "protocol.yaml"
    path.write_text(yaml.safe_dump(tree), encoding="utf-8")
    with pytest.raises(generate.DescriptionError):
        generate.load_description(path)
