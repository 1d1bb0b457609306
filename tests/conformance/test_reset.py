"""Resets, at any point and by any cause, leave the drive off and nothing remembered."""

from typing import TYPE_CHECKING

import pytest

from usmbench.instruments.protocol._generated import Flags, RequestType, ResetCause

if TYPE_CHECKING:
    from tests.conformance.conftest import BenchHost

RESET_WORDS = [
    ("ab", 0x2128),
    *[("ab", word) for word in (0x4000, 0x4000, 0x8000, 0x8000, 0xC000, 0xE000)],
]


def test_words_at_power_on(bench_host: "BenchHost") -> None:
    assert bench_host.new_words() == RESET_WORDS


@pytest.mark.parametrize("cause", [cause for cause in ResetCause if cause is not ResetCause.STACK])
def test_a_reset_stops_the_drive_and_tells_its_cause(
    bench_host: "BenchHost", cause: ResetCause
) -> None:
    bench_host.start()
    bench_host.exchange(b"\x05\x06\0")
    bench_host.new_words()
    bench_host.line.reset(cause)
    assert not bench_host.line.drives()
    assert bench_host.new_words() == RESET_WORDS
    assert bench_host.status() == (Flags.NOT_IDENTIFIED, cause, 0, 0, 0, 0, 0, 0, 0)


@pytest.mark.parametrize("kind", [RequestType.SET_DRIVE, RequestType.OUTPUTS])
def test_a_reset_at_any_point_of_a_request(bench_host: "BenchHost", kind: RequestType) -> None:
    fields = (441_000, 30) if kind is RequestType.SET_DRIVE else (1,)
    for sent in range(len(bench_host.frame(kind, *fields)) + 1):
        bench_host.start()
        bench_host.line.send(bench_host.frame(kind, *fields)[:sent])
        bench_host.line.reset(ResetCause.EXTERNAL)
        assert not bench_host.line.drives()
        bench_host.line.received()
        bench_host.exchange(b"\0")
        status = bench_host.status()
        assert status[:7] == (Flags.NOT_IDENTIFIED, ResetCause.EXTERNAL, 0, 0, 0, 0, 0)
        bench_host.line.wait(0.1)
        assert not bench_host.line.drives()
