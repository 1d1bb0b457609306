"""A request that is sent again acts once."""

from typing import TYPE_CHECKING

import pytest

from usmbench.instruments.protocol._generated import Flags, Refusal, RequestType, ResetCause

if TYPE_CHECKING:
    from tests.conformance.conftest import BenchHost, Host


@pytest.mark.parametrize(
    ("kind", "fields"),
    [
        (RequestType.SET_DRIVE, (441_000, 5)),
        (RequestType.SET_PHASE, (6,)),
        (RequestType.OUTPUTS, (1,)),
        (RequestType.OUTPUTS, (0,)),
        (RequestType.STATUS, ()),
        (RequestType.HEARTBEAT, ()),
    ],
)
def test_a_repeat_gets_the_same_answer_and_has_no_effect(
    bench_host: "BenchHost", kind: RequestType, fields: tuple[int, ...]
) -> None:
    bench_host.start()
    frame = bench_host.frame(kind, *fields)
    first = bench_host.ask_raw(frame)
    bench_host.new_words()
    # Noise in between changes the status, but not the answer that was given.
    bench_host.exchange(b"\x05\x06\0")
    assert [bench_host.ask_raw(frame) for _ in range(3)] == [first] * 3
    assert bench_host.new_words() == []


def test_repeats_in_one_burst(host: "Host") -> None:
    host.ask(RequestType.IDENTIFY)
    frame = host.frame(RequestType.SET_DRIVE, 440_000, 9)
    replies = host.exchange(frame * 4)
    assert len(replies) == 4
    assert len(set(replies)) == 1


def test_the_same_number_with_another_request_is_not_a_repeat(bench_host: "BenchHost") -> None:
    bench_host.start()
    bench_host.ask_raw(bench_host.frame(RequestType.SET_PHASE, 100, sequence=200))
    bench_host.ask_raw(bench_host.frame(RequestType.SET_PHASE, 101, sequence=200))
    assert bench_host.status().phase_word_b == 101


def test_the_same_request_with_another_number_acts_again(bench_host: "BenchHost") -> None:
    bench_host.start()
    for sequence in (200, 201):
        bench_host.new_words()
        bench_host.ask_raw(bench_host.frame(RequestType.SET_PHASE, 100, sequence=sequence))
        assert len(bench_host.new_words()) == 2


def test_only_the_last_acknowledged_request_is_remembered(bench_host: "BenchHost") -> None:
    bench_host.start()
    old = bench_host.frame(RequestType.SET_PHASE, 100)
    bench_host.ask_raw(old)
    bench_host.ask(RequestType.SET_PHASE, 200)
    bench_host.ask_raw(old)
    assert bench_host.status().phase_word_b == 100


def test_a_refusal_leaves_the_memory_as_it_was(bench_host: "BenchHost") -> None:
    bench_host.start()
    frame = bench_host.frame(RequestType.SET_PHASE, 100)
    first = bench_host.ask_raw(frame)
    bench_host.new_words()
    refused = bench_host.frame(RequestType.SET_PHASE, 5000)
    assert bench_host.ask_raw(refused).reason == Refusal.PHASE_OUT_OF_RANGE
    assert bench_host.ask_raw(frame) == first
    assert bench_host.new_words() == []


def test_a_refusal_is_not_remembered(bench_host: "BenchHost") -> None:
    bench_host.ask(RequestType.IDENTIFY)
    on = bench_host.frame(RequestType.OUTPUTS, 1)
    assert bench_host.ask_raw(on).reason == Refusal.NOT_CONFIGURED
    bench_host.ask(RequestType.SET_DRIVE, 440_000, 0)
    assert bench_host.ask_raw(on).acknowledged


def test_identify_empties_the_memory(bench_host: "BenchHost") -> None:
    bench_host.start()
    frame = bench_host.frame(RequestType.SET_PHASE, 100)
    bench_host.ask_raw(frame)
    bench_host.ask(RequestType.IDENTIFY)
    bench_host.new_words()
    bench_host.ask_raw(frame)
    assert len(bench_host.new_words()) == 2


def test_identify_is_always_executed(bench_host: "BenchHost") -> None:
    frame = bench_host.frame(RequestType.IDENTIFY)
    assert bench_host.ask_raw(frame).flags == 0
    bench_host.line.reset(ResetCause.EXTERNAL)
    assert bench_host.status().flags == Flags.NOT_IDENTIFIED
    assert bench_host.ask_raw(frame).flags == 0
    assert bench_host.status().flags == 0


@pytest.mark.parametrize("cause", [ResetCause.EXTERNAL, ResetCause.WATCHDOG])
def test_a_reset_empties_the_memory(bench_host: "BenchHost", cause: ResetCause) -> None:
    bench_host.start()
    frame = bench_host.frame(RequestType.SET_PHASE, 100)
    bench_host.ask_raw(frame)
    bench_host.line.reset(cause)
    assert bench_host.ask_raw(frame).reason == Refusal.NOT_IDENTIFIED


def test_silence_empties_the_memory(bench_host: "BenchHost") -> None:
    bench_host.start()
    on = bench_host.frame(RequestType.OUTPUTS, 1)
    bench_host.ask_raw(on)
    bench_host.line.wait(1.1)
    assert not bench_host.line.drives()
    assert bench_host.ask_raw(on).flags == Flags.CONFIGURED | Flags.OUTPUTS_ON
    assert bench_host.line.drives()
