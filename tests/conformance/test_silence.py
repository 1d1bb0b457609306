"""A host that falls silent while the motor is driven."""

from typing import TYPE_CHECKING

import pytest

from usmbench.instruments.protocol._generated import Flags, RequestType
from usmbench.instruments.protocol.frames import encode_frame

if TYPE_CHECKING:
    from tests.conformance.conftest import BenchHost, Host

DRIVEN = Flags.CONFIGURED | Flags.OUTPUTS_ON
TRIPPED = Flags.CONFIGURED | Flags.HOST_SILENCE
HEARTBEAT = encode_frame(3, RequestType.HEARTBEAT, b"")


def stop_time_s(host: "BenchHost") -> float:
    """Wait for the stop; return the time from now to it."""
    began_s = host.line.now_s
    host.line.wait(1.2)
    host.line.received()
    assert not host.line.drives()
    return host.line.board.drive_changes[-1][0] - began_s


def test_the_drive_stops_after_one_second(bench_host: "BenchHost") -> None:
    bench_host.start()
    bench_host.line.send(HEARTBEAT)
    assert 1.0 <= stop_time_s(bench_host) <= 1.002
    status = bench_host.status()
    assert (status.flags, status.silence_trips) == (TRIPPED, 1)


@pytest.mark.parametrize("sent", range(len(HEARTBEAT)))
def test_the_drive_stops_at_any_point_of_a_frame(bench_host: "BenchHost", sent: int) -> None:
    bench_host.start()
    bench_host.line.send(HEARTBEAT)
    stop_s = bench_host.line.now_s + 1.0
    bench_host.line.wait(0.5)
    bench_host.line.send(HEARTBEAT[:sent])
    bench_host.line.wait(0.8)
    assert not bench_host.line.drives()
    assert stop_s <= bench_host.line.board.drive_changes[-1][0] <= stop_s + 0.002
    bench_host.exchange(b"\0")
    assert bench_host.status().flags == TRIPPED


@pytest.mark.parametrize("noise", [b"\x05\x41\0", b"\0", encode_frame(3, 0x86, b"")])
def test_noise_and_replies_do_not_keep_the_drive_on(bench_host: "BenchHost", noise: bytes) -> None:
    bench_host.start()
    for _ in range(13):
        bench_host.exchange(noise)
        bench_host.line.wait(0.1)
    assert not bench_host.line.drives()


@pytest.mark.parametrize(
    "frame",
    [
        HEARTBEAT,
        encode_frame(3, RequestType.STATUS, b""),
        encode_frame(3, 0x30, b"refused"),
        encode_frame(3, RequestType.OUTPUTS, b"\2"),
    ],
)
def test_any_request_keeps_the_drive_on(bench_host: "BenchHost", frame: bytes) -> None:
    bench_host.start()
    for _ in range(4):
        bench_host.exchange(frame)
        bench_host.line.wait(0.95)
    assert bench_host.line.drives()
    assert bench_host.status().flags == DRIVEN


def test_silence_while_off_is_no_trip(bench_host: "BenchHost") -> None:
    bench_host.start()
    bench_host.ask(RequestType.OUTPUTS, 0)
    bench_host.line.wait(2.5)
    assert bench_host.status().flags == Flags.CONFIGURED
    assert bench_host.ask(RequestType.OUTPUTS, 1).acknowledged
    bench_host.line.wait(0.5)
    assert bench_host.line.drives()


@pytest.mark.parametrize(("value", "flags"), [(0, Flags.CONFIGURED), (1, DRIVEN)])
def test_the_next_outputs_request_clears_the_flag(host: "Host", value: int, flags: int) -> None:
    host.start()
    host.line.wait(1.2)
    trips = host.status().silence_trips
    assert host.ask(RequestType.HEARTBEAT).flags == TRIPPED
    assert host.ask(RequestType.SET_PHASE, 3).flags == TRIPPED
    assert host.ask(RequestType.OUTPUTS, value).flags == flags
    assert host.status().silence_trips == trips


def test_every_trip_is_counted(bench_host: "BenchHost") -> None:
    bench_host.start()
    for trips in range(1, 4):
        bench_host.line.wait(1.1)
        assert bench_host.status().silence_trips == trips
        bench_host.ask(RequestType.OUTPUTS, 1)
