import io
import os
import time
from collections.abc import Iterator

import pytest

from usmbench.errors import BenchError
from usmbench.sweep.operator import TerminalOperator


@pytest.fixture
def pipe() -> Iterator[tuple[int, int]]:
    read, write = os.pipe()
    yield read, write
    for end in (read, write):
        try:
            os.close(end)
        except OSError:
            continue


def wait_for(operator: TerminalOperator) -> None:
    deadline_s = time.monotonic() + 5.0
    while not operator.load_is_set():
        assert time.monotonic() < deadline_s
        time.sleep(0.001)


def test_enter_says_that_each_load_is_set(pipe: tuple[int, int]) -> None:
    output = io.StringIO()
    operator = TerminalOperator(output, pipe[0])
    for torque_nm in (0.1, 0.2):
        operator.set_load(torque_nm, ask=True)
        assert not operator.load_is_set()
        os.write(pipe[1], b"done\n")
        wait_for(operator)
        assert f"{torque_nm:g} N·m" in output.getvalue()
    assert operator.load_is_set()


def test_a_constant_load_needs_nobody(pipe: tuple[int, int]) -> None:
    output = io.StringIO()
    operator = TerminalOperator(output, pipe[0])
    operator.set_load(0.1, ask=False)
    assert operator.load_is_set()
    assert output.getvalue() == ""


def test_nobody_there_is_told(pipe: tuple[int, int]) -> None:
    operator = TerminalOperator(io.StringIO(), pipe[0])
    os.close(pipe[1])
    operator.set_load(0.1, ask=True)
    with pytest.raises(BenchError, match="load: constant"):
        wait_for(operator)
