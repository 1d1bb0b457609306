"""What a board refuses or reports, and boards that the driver refuses."""

from collections.abc import Callable
from typing import Any

import pytest

from board_script import (
    CONNECT,
    IDENTIFY,
    READY,
    acknowledged,
    asked,
    connect,
    identity,
    refused,
    status,
)
from usmbench.errors import BoardError, BoardRefusedError, BoardResetError, InputError
from usmbench.instruments.generator import SignalGenerator
from usmbench.instruments.protocol._generated import Flags, Refusal, RequestType

NewPort = Callable[..., Any]


@pytest.mark.parametrize("reason", set(Refusal) - {Refusal.NOT_IDENTIFIED})
def test_every_refusal_has_its_name_and_a_mend(
    generator: SignalGenerator, port: Any, reason: Refusal
) -> None:
    out = asked(3, RequestType.SET_PHASE, 512)
    port.expect((out, refused(3, RequestType.SET_PHASE, reason, READY)))
    name = reason.name.lower()
    with pytest.raises(BoardRefusedError, match=rf"refused set_phase \({name}\): \w+") as caught:
        generator.phase_deg = 45.0
    assert caught.value.reason == name


NOT_IDENTIFIED = Flags.NOT_IDENTIFIED


@pytest.mark.parametrize(
    "reply",
    [
        refused(3, RequestType.HEARTBEAT, Refusal.NOT_IDENTIFIED, NOT_IDENTIFIED),
        acknowledged(3, RequestType.HEARTBEAT, NOT_IDENTIFIED),
    ],
    ids=["refusal", "flag"],
)
def test_a_reset_is_reported_with_its_cause(
    generator: SignalGenerator, port: Any, reply: bytes
) -> None:
    port.expect(
        (asked(3, RequestType.HEARTBEAT), reply),
        (asked(4, RequestType.STATUS), status(4, NOT_IDENTIFIED, cause=2, words=(0, 0))),
    )
    with pytest.raises(BoardResetError, match=r"restarted \(cause: watchdog\)"):
        generator.heartbeat()


def test_host_silence_and_internal_faults_are_reported(
    generator: SignalGenerator, port: Any
) -> None:
    kind = RequestType.HEARTBEAT
    port.expect((asked(3, kind), acknowledged(3, kind, READY | Flags.HOST_SILENCE)))
    with pytest.raises(BoardError, match="heard nothing"):
        generator.heartbeat()
    port.expect(
        (asked(4, kind), acknowledged(4, kind, Flags.INTERNAL_FAULT)),
        (asked(5, RequestType.STATUS), status(5, Flags.INTERNAL_FAULT, faults=4)),
    )
    with pytest.raises(BoardError, match=r"internal fault \(dds_mismatch\)"):
        generator.heartbeat()


@pytest.mark.parametrize(
    ("reply", "match"),
    [
        (identity(1, protocol_version=2), "version 2 of the protocol, .* version 1: update"),
        (identity(1, protocol_version=0), "version 0 of the protocol, .* version 1: flash"),
        (acknowledged(1, RequestType.IDENTIFY, 0, b"\x07more"), "version 7"),
        (identity(1, clock_hz=16_000_000), "16000000 Hz clock"),
        (identity(1, phase_bits=10), "10 phase bits"),
    ],
)
def test_another_board_is_wrong_input_and_nothing_moves(
    scripted_port: NewPort, reply: bytes, match: str
) -> None:
    with pytest.raises(InputError, match=match):
        connect(scripted_port((IDENTIFY, reply)))


def test_a_board_with_a_fault_is_not_driven(scripted_port: NewPort) -> None:
    port = scripted_port(
        (IDENTIFY, identity(1, flags=Flags.INTERNAL_FAULT)),
        CONNECT[1],
        (asked(3, RequestType.STATUS), status(3, Flags.INTERNAL_FAULT, faults=2)),
    )
    with pytest.raises(BoardError, match=r"internal fault \(stack\)"):
        connect(port)
