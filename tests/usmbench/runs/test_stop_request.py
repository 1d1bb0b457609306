from pathlib import Path

import pytest

from usmbench.errors import InputError
from usmbench.runs.stop_request import (
    LOOK_EVERY_S,
    STOP_FILE,
    StopSign,
    forget_stop_request,
    request_stop,
)


def test_a_request_stops_and_a_forgotten_one_does_not(tmp_path: Path) -> None:
    now_s = [0.0]
    sign = StopSign(tmp_path, lambda: now_s[0])
    sign.check()
    request_stop(tmp_path)
    request_stop(tmp_path)
    now_s[0] = 1.01 * LOOK_EVERY_S
    with pytest.raises(KeyboardInterrupt, match="stop request"):
        sign.check()
    forget_stop_request(tmp_path)
    forget_stop_request(tmp_path)
    now_s[0] = 2.1 * LOOK_EVERY_S
    sign.check()


def test_it_looks_at_most_four_times_a_second(tmp_path: Path) -> None:
    assert LOOK_EVERY_S >= 0.25
    now_s = [0.0]
    sign = StopSign(tmp_path, lambda: now_s[0])
    sign.check()
    request_stop(tmp_path)
    now_s[0] = 0.99 * LOOK_EVERY_S
    sign.check()


def test_a_request_that_cannot_be_written_names_another_way(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=f"{STOP_FILE}: .*cut the power"):
        request_stop(tmp_path / "absent")


def test_a_request_never_leaves_its_folder(tmp_path: Path) -> None:
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / STOP_FILE).symlink_to(tmp_path / "elsewhere")
    with pytest.raises(InputError):
        request_stop(tmp_path / "run")
    assert not (tmp_path / "elsewhere").exists()
