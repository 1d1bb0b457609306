"""However a session ends, the drive is off after it, or the user is told that it may not be."""

import io
from collections.abc import Callable
from typing import Any

import pytest

from board_script import (
    CONNECT,
    DRIVING,
    KHZ_41,
    acknowledged,
    asked,
    connect,
    identity,
    off,
    phase,
    status,
)
from usmbench.errors import BenchError, BoardError, PortError
from usmbench.instruments.generator import SignalGenerator
from usmbench.instruments.protocol._generated import RequestType

NewPort = Callable[..., Any]


@pytest.mark.parametrize("error", [ValueError("ours"), KeyboardInterrupt(), BoardError("its")])
def test_the_context_switches_off_after_any_error(
    generator: SignalGenerator, port: Any, error: BaseException
) -> None:
    port.expect(off(3))
    with pytest.raises(type(error)) as caught, generator:
        raise error
    assert caught.value is error
    assert port.steps == []
    assert port.closed


def test_the_context_switches_off_without_an_error(generator: SignalGenerator, port: Any) -> None:
    port.expect(off(3))
    with generator:
        pass
    assert port.steps == []
    assert port.closed


@pytest.mark.parametrize("step", ["write", "read"])
def test_ctrl_c_inside_an_exchange_leaves_the_next_one_sound(
    generator: SignalGenerator, port: Any, step: str
) -> None:
    """The reply to the exchange that was broken off arrives first, and is not taken for ours."""
    out, reply = phase(3, 512)
    port.expect(KeyboardInterrupt() if step == "write" else (out, KeyboardInterrupt()))
    with pytest.raises(KeyboardInterrupt):
        generator.phase_deg = 45.0
    port.expect(
        (b"\0" + asked(4, RequestType.STATUS), reply + status(4, DRIVING, words=(KHZ_41, 512)))
    )
    assert generator.phase_deg == 45.0


def test_a_second_ctrl_c_while_switching_off_does_not_leave_the_drive_on(
    generator: SignalGenerator, port: Any
) -> None:
    port.expect(KeyboardInterrupt(), off(4, resend=True))
    with pytest.raises(KeyboardInterrupt), generator:
        pass
    assert port.steps == []
    assert port.closed


def test_ctrl_c_with_the_board_gone_is_reported_as_the_failure_it_is(
    generator: SignalGenerator, port: Any
) -> None:
    gone = OSError(5, "Input/output error")
    port.expect(gone)
    # Without a way to open the port again each further attempt identifies on the same port.
    port.steps += [gone, gone]
    with pytest.raises(PortError, match="1 s silence watchdog"), generator:
        raise KeyboardInterrupt
    assert port.closed


def test_another_error_with_the_board_gone_says_so_in_a_note(
    generator: SignalGenerator, port: Any
) -> None:
    gone = OSError(5, "Input/output error")
    port.expect(gone, gone, gone)
    with pytest.raises(ValueError, match="ours") as caught, generator:
        raise ValueError("ours")
    assert "1 s silence watchdog" in caught.value.__notes__[0]


@pytest.mark.parametrize("step", ["write", "read"])
@pytest.mark.parametrize("n_before", [0, 1])
def test_a_port_that_goes_while_connecting(
    scripted_port: NewPort, step: str, n_before: int
) -> None:
    gone = OSError(5, "Input/output error")
    broken = gone if step == "write" else (CONNECT[n_before][0], gone)
    with pytest.raises(PortError, match=r"/dev/script has gone .*Input/output error"):
        connect(scripted_port(*CONNECT[:n_before], broken))


@pytest.mark.parametrize("step", ["write", "read"])
def test_a_port_that_goes_in_use_is_opened_anew_to_switch_off(
    scripted_port: NewPort, port: Any, step: str
) -> None:
    gone = OSError(5, "Input/output error")
    out, _ = phase(3, 512)
    again = scripted_port(
        (b"\0" + asked(5, RequestType.IDENTIFY), identity(5)),
        (asked(6, RequestType.OUTPUTS, 0), acknowledged(6, RequestType.OUTPUTS, 0)),
    )
    generator = connect(port, reopen=lambda: again)
    port.expect(gone if step == "write" else (out, gone), gone)
    with pytest.raises(PortError) as caught, generator:
        generator.phase_deg = 45.0
    assert again.steps == []
    assert port.closed
    assert again.closed
    assert not hasattr(caught.value, "__notes__")


def test_a_frame_log_without_room_fails_once_and_the_drive_goes_off(port: Any) -> None:
    class Full(io.StringIO):
        full = False

        def write(self, text: str) -> int:
            if self.full:
                raise OSError(28, "No space left on device")
            return super().write(text)

    log = Full()
    generator = connect(port, frame_log=log)
    log.full = True
    port.expect(phase(3, 512), off(4, resend=True))
    with pytest.raises(BenchError, match=r"frame log .*No space left") as caught, generator:
        generator.phase_deg = 45.0
    # The board's answer was read: nobody is told that the drive may be on.
    assert not hasattr(caught.value, "__notes__")
    assert port.steps == []
    assert port.closed
