import threading
import time
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from hil_sim.faults import Fault, FaultKind
from usmbench.errors import DaqError, InputError, NoDataError
from usmbench.instruments.nidaq import NiSampleSource
from usmbench.instruments.samples import SampleBlock
from usmbench.settings.bench import DaqSettings, TemperatureSettings

SENSOR = TemperatureSettings("ai1", degrees_c_per_volt=100.0, offset_c=0.0)


def settings(address: str, **changes: Any) -> DaqSettings:
    return replace(DaqSettings(address=address, no_data_timeout_s=5.0), **changes)


def blocks(source: NiSampleSource, n_blocks: int) -> list[SampleBlock]:
    source.start()
    return [source.next_block() for _ in range(n_blocks)]


def counts_at(first_sample: int, n_samples: int, counts_per_s: float) -> NDArray[np.int64]:
    samples = np.arange(first_sample + 1, first_sample + n_samples + 1)
    counts: NDArray[np.int64] = np.floor(samples * counts_per_s / 1e5).astype(np.int64)
    return counts


@pytest.mark.parametrize("sample_clock", ["ai", "PFI7", "/Dev1/RTSI0"])
@pytest.mark.parametrize(
    ("family", "bits", "counts_per_edge"), [("m_x", 32, 1), ("e_series", 24, 4)]
)
def test_blocks_are_the_encoders_samples_without_a_gap(
    serve_encoder: Any, family: Any, bits: int, counts_per_edge: int, sample_clock: str
) -> None:
    server, feed = serve_encoder(counts_per_s=20_000.0)
    daq = settings(server.address, family=family, sample_clock=sample_clock)
    with NiSampleSource(daq, lines=500) as source:
        got = blocks(source, 5)
        assert source.counter_bits == bits
        assert source.samples_acquired() == 5000
    assert [block.first_sample for block in got] == [0, 1000, 2000, 3000, 4000]
    counts = np.concatenate([block.counts for block in got])
    np.testing.assert_array_equal(counts, counts_at(0, 5000, 20_000.0) // counts_per_edge)
    assert counts.dtype == np.int64
    assert got[0].temperature_c is None
    assert feed.requests == [1000] * 5
    assert feed.acquisitions[0] == "start"
    assert feed.acquisitions[-1] == "stop"


@pytest.mark.parametrize(
    ("family", "bits", "counts_per_edge"), [("m_x", 32, 1), ("e_series", 24, 4)]
)
def test_counters_wrap_at_their_width(
    serve_encoder: Any, family: Any, bits: int, counts_per_edge: int
) -> None:
    wrap = Fault(FaultKind.COUNTER_WRAP, 0.0, counts=100)
    server, _ = serve_encoder(counts_per_s=40_000.0, faults=[wrap])
    with NiSampleSource(settings(server.address, family=family)) as source:
        counts = np.concatenate([block.counts for block in blocks(source, 3)])
    assert counts.min() >= 0
    assert counts[0] == 2**bits - 100
    assert counts[-1] == 1200 // counts_per_edge - 100
    assert np.flatnonzero(np.diff(counts) < 0).size == 1


def test_turning_backwards_wraps_below_zero(serve_encoder: Any) -> None:
    server, _ = serve_encoder(counts_per_s=-20_000.0)
    with NiSampleSource(settings(server.address)) as source:
        counts = blocks(source, 1)[0].counts
    assert counts[-1] == 2**32 - 200


def test_index_pulses_share_the_encoders_samples(serve_encoder: Any) -> None:
    server, _ = serve_encoder(counts_per_s=20_000.0, start_counts=1900)
    with NiSampleSource(settings(server.address)) as source:
        got = blocks(source, 20)
    index = [block.index_counts for block in got if block.index_counts is not None]
    assert [len(counts) for counts in index] == 2 * [*9 * [0], 10_000]
    counts = np.concatenate([block.counts for block in got])
    np.testing.assert_array_equal(np.concatenate(index), counts // 2000)
    assert set(index[9]) == {0, 1}


def test_index_is_left_out_where_it_is_not_wired(serve_encoder: Any) -> None:
    server, _ = serve_encoder()
    with NiSampleSource(settings(server.address, index_counter=None)) as source:
        assert blocks(source, 1)[0].index_counts is None


@pytest.mark.parametrize("sample_clock", ["ai", "PFI7"])
def test_temperature_is_the_blocks_mean(serve_encoder: Any, sample_clock: str) -> None:
    server, _ = serve_encoder()
    sensor = replace(SENSOR, degrees_c_per_volt=50.0, offset_c=10.0)
    daq = settings(server.address, sample_clock=sample_clock)
    with NiSampleSource(daq, sensor) as source:
        got = [block.temperature_c for block in blocks(source, 3)]
    assert got == pytest.approx([10.0 + (25.01 + 0.01 * k) / 2 for k in range(3)], abs=1e-3)


def test_lock_step_gives_the_same_blocks_every_time(serve_encoder: Any) -> None:
    runs = []
    for pause_s in (0.0, 0.002):
        server, _ = serve_encoder(counts_per_s=17_123.0)
        with NiSampleSource(settings(server.address), SENSOR) as source:
            source.start()
            run: list[SampleBlock] = []
            for _ in range(20):
                time.sleep(pause_s)
                assert source.samples_acquired() == 1000 * len(run)
                run.append(source.next_block())
        runs.append(run)
    for one, other in zip(*runs, strict=True):
        assert one.first_sample == other.first_sample
        assert one.temperature_c == other.temperature_c
        np.testing.assert_array_equal(one.counts, other.counts)


def test_in_real_time_the_card_keeps_what_is_read_late(serve_encoder: Any) -> None:
    server, _ = serve_encoder(lock_step=False)
    with NiSampleSource(settings(server.address)) as source:
        source.start()
        started_s = time.monotonic()
        time.sleep(0.3)
        assert source.samples_acquired() >= 29_000
        got = [source.next_block() for _ in range(40)]
        elapsed_s = time.monotonic() - started_s
    assert [block.first_sample for block in got] == list(range(0, 40_000, 1000))
    assert elapsed_s == pytest.approx(0.4, abs=0.25)


def test_overflow_is_named(serve_encoder: Any) -> None:
    overflow = Fault(FaultKind.DAQ_OVERFLOW, 0.035)
    server, _ = serve_encoder(faults=[overflow])
    with NiSampleSource(settings(server.address)) as source:
        assert len(blocks(source, 3)) == 3
        for _ in range(2):
            with pytest.raises(DaqError, match="buffer overflow") as caught:
                source.next_block()
            assert caught.value.code == -200279


@pytest.mark.parametrize(
    ("lock_step", "says"), [(True, "no more"), (False, "events no longer .*then begin again")]
)
def test_dead_event_stream_is_missing_data_within_the_deadline(
    serve_encoder: Any, lock_step: bool, says: str
) -> None:
    server, _ = serve_encoder(
        lock_step=lock_step, faults=[Fault(FaultKind.EVENT_STREAM_DEAD, 0.035)]
    )
    daq = settings(server.address, no_data_timeout_s=0.3)
    with NiSampleSource(daq) as source:
        assert len(blocks(source, 3)) == 3
        asked_s = time.monotonic()
        with pytest.raises(NoDataError, match=f"0.31 s after 3000 samples.*{says}"):
            source.next_block()
        assert 0.3 < time.monotonic() - asked_s < 1.0


@pytest.mark.parametrize("by_fault", [True, False])
def test_dead_server_is_named_and_the_source_closes(serve_encoder: Any, by_fault: bool) -> None:
    server, _ = serve_encoder(faults=[Fault(FaultKind.SERVER_DEAD, 0.035)] if by_fault else [])
    with NiSampleSource(settings(server.address, no_data_timeout_s=0.3)) as source:
        blocks(source, 3)
        if not by_fault:
            server.stop()
        with pytest.raises(DaqError, match=f"server at {server.address} no longer answers"):
            source.next_block()
        with pytest.raises(DaqError, match="no longer answers"):
            source.samples_acquired()
        started_s = time.monotonic()
        source.close()
        assert time.monotonic() - started_s < 2.0


def test_any_failure_of_a_read_is_one_of_ours_and_stays(
    serve_encoder: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    server, _ = serve_encoder()
    with NiSampleSource(settings(server.address)) as source:
        blocks(source, 2)

        def broken() -> None:
            raise ZeroDivisionError("by zero")

        monkeypatch.setattr(source._tasks, "read", broken)
        for _ in range(2):
            with pytest.raises(DaqError, match="ZeroDivisionError: by zero"):
                source.next_block()


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"device": "Dev9"}, "Dev9.*-200220"),
        ({"counter": "ctr9"}, "-200170"),
        ({"counter": "ctr3", "family": "e_series"}, "ctr0 and ctr1"),
    ],
)
def test_wrong_settings_show_at_opening(serve_encoder: Any, changes: Any, says: str) -> None:
    server, _ = serve_encoder()
    with pytest.raises(InputError, match=says):
        NiSampleSource(settings(server.address, **changes))


def test_no_server_shows_at_opening() -> None:
    started_s = time.monotonic()
    with pytest.raises(InputError, match="no NI gRPC device server answers"):
        NiSampleSource(settings("127.0.0.1:1"))
    assert time.monotonic() - started_s < 10.0


def test_the_driver_of_this_computer_is_asked_where_there_is_no_address() -> None:
    with pytest.raises(InputError, match=r"driver is not installed|-200220"):
        NiSampleSource(DaqSettings(device="NoSuchCard"))


def test_a_card_in_use_is_refused(serve_encoder: Any) -> None:
    server, _ = serve_encoder()
    with (
        NiSampleSource(settings(server.address)) as first,
        NiSampleSource(settings(server.address)) as second,
    ):
        first.start()
        with pytest.raises(DaqError, match="close the other program") as caught:
            second.start()
        assert caught.value.code == -50103
        assert first.next_block().first_sample == 0


def test_closed_twice_and_then_used(serve_encoder: Any) -> None:
    server, _ = serve_encoder()
    source = NiSampleSource(settings(server.address))
    source.start()
    source.close()
    source.close()
    with pytest.raises(DaqError, match="closed"):
        source.next_block()


def test_thirty_starts_and_stops_leave_nothing_behind(
    serve_encoder: Any, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level("INFO")
    server, feed = serve_encoder(lock_step=False)
    daq = settings(server.address, sample_rate_hz=1e6)
    before: set[threading.Thread] = set()
    for _ in range(30):
        with NiSampleSource(daq) as source:
            source.start()
            assert source.next_block().first_sample == 0
        # The first client makes gRPC start threads that stay.
        before = before or set(threading.enumerate())
    deadline_s = time.monotonic() + 5.0
    while (left := _nidaqmx_threads()) and time.monotonic() < deadline_s:
        time.sleep(0.01)
    assert left == []
    assert caplog.records == []  # a read after the stop would be logged, by us or by nidaqmx
    assert feed.acquisitions.count("start") == 30
    assert feed.acquisitions[-1] == "stop"
    # The server's pool may grow by a thread now and then; no other may be new.
    new = {thread.name for thread in set(threading.enumerate()) - before}
    assert [name for name in new if not name.startswith("ni_server")] == []


def _nidaqmx_threads() -> list[str]:
    names = [thread.name for thread in threading.enumerate()]
    return [name for name in names if name.startswith(("nidaqmx", "bounded call"))]
