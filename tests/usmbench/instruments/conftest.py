"""A serial port that plays a script: what must be written, and what then can be read."""

from collections.abc import Callable
from typing import Any

import pytest

from board_script import CONNECT, connect
from usmbench.instruments.generator import SignalGenerator


class ScriptedPort:
    """Each write must be the next step's; its answer can then be read. Time passes in reads only.

    An answer is bytes, or an exception that the next read raises; a step may also be an exception
    alone, which the write raises.
    """

    def __init__(self, *steps: tuple[bytes, bytes | BaseException] | BaseException):
        self.steps = list(steps)
        self.timeout: float | None = 0.0
        self.name = "/dev/script"
        self.now_s = 100.0
        self.closed = False
        self._input = bytearray()
        self._error: BaseException | None = None

    def clock(self) -> float:
        return self.now_s

    def expect(self, *steps: tuple[bytes, bytes | BaseException] | BaseException) -> None:
        assert self.steps == []
        self.steps = list(steps)

    @property
    def in_waiting(self) -> int:
        return len(self._input)

    def write(self, data: bytes, /) -> int:
        assert self.steps, f"nothing more was to be written, not {data.hex(' ')}"
        step = self.steps.pop(0)
        if isinstance(step, BaseException):
            raise step
        expected, answer = step
        assert data.hex(" ") == expected.hex(" ")
        if isinstance(answer, BaseException):
            self._error = answer
        else:
            self._input += answer
        return len(data)

    def read(self, size: int = 1, /) -> bytes:
        assert self.timeout is not None
        assert 0.0 < self.timeout <= 0.05
        if self._error is not None:
            error, self._error = self._error, None
            raise error
        if len(self._input) < size:
            self.now_s += self.timeout
        data = bytes(self._input[:size])
        del self._input[:size]
        return data

    def close(self) -> None:
        self.closed = True


@pytest.fixture
def scripted_port() -> Callable[..., Any]:
    return ScriptedPort


@pytest.fixture
def port(scripted_port: Callable[..., Any]) -> Any:
    return scripted_port(*CONNECT)


@pytest.fixture
def generator(port: Any) -> SignalGenerator:
    return connect(port)
