"""The server as any client of nidaqmx finds it, ours or not."""

import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from typing import Any

import grpc
import nidaqmx
import numpy as np
import pytest
from nidaqmx.constants import AcquisitionType, AngleUnits
from nidaqmx.errors import DaqError, DaqReadError, RpcError
from nidaqmx.stream_readers import AnalogSingleChannelReader, CounterReader

from hil_sim.faults import Fault, FaultKind

AI_CLOCK = "/Dev1/ai/SampleClock"
NewTask = Callable[..., Any]

# A client that starts an acquisition with events and then only waits.
VANISHING_CLIENT = """
import sys, time
from usmbench.instruments.nidaq import NiSampleSource
from usmbench.settings.bench import DaqSettings
source = NiSampleSource(DaqSettings(address=sys.argv[1]))
source.start()
source.next_block()
print("running", flush=True)
time.sleep(60)
"""


@pytest.fixture
def new_task(serve_encoder: Any) -> Iterator[NewTask]:
    """Make tasks on one server; the keywords of the first are the server's."""
    with ExitStack() as stack:
        channels: list[grpc.Channel] = []

        def make(name: str = "", **server: Any) -> Any:
            if not channels:
                channels.append(grpc.insecure_channel(serve_encoder(**server)[0].address))
                stack.callback(channels[0].close)
            options = nidaqmx.GrpcSessionOptions(channels[0], "")
            return stack.enter_context(nidaqmx.Task(name, grpc_options=options))

        yield make


def encoder(task: Any, *, source: str = "/Dev1/PFI7", buffer_samples: int = 100_000) -> Any:
    task.ci_channels.add_ci_ang_encoder_chan("Dev1/ctr0", units=AngleUnits.TICKS)
    return clocked(task, source, buffer_samples)


def clocked(task: Any, source: str, buffer_samples: int = 100_000) -> Any:
    task.timing.cfg_samp_clk_timing(
        1e5, source, sample_mode=AcquisitionType.CONTINUOUS, samps_per_chan=buffer_samples
    )
    return task


def read(task: Any, n_samples: int, timeout: float = 10.0) -> list[float]:
    values = np.empty(n_samples)
    if task.channel_names[0].startswith("Dev1/ai"):
        AnalogSingleChannelReader(task.in_stream).read_many_sample(values, n_samples, timeout)
    else:
        CounterReader(task.in_stream).read_many_sample_double(values, n_samples, timeout)
    return list(values)


def test_reads_follow_on_each_other(new_task: NewTask) -> None:
    task = encoder(new_task(counts_per_s=1e5))
    task.start()
    assert task.name
    assert read(task, 3) == [1.0, 2.0, 3.0]
    assert read(task, 5) == [4.0, 5.0, 6.0, 7.0, 8.0]
    assert task.in_stream.total_samp_per_chan_acquired == 8
    assert task.in_stream.avail_samp_per_chan == 0


def test_tasks_on_the_analogue_clock_share_sample_0(new_task: NewTask) -> None:
    counter = encoder(new_task(counts_per_s=1e5), source=AI_CLOCK)
    analogue = new_task()
    analogue.ai_channels.add_ai_voltage_chan("Dev1/ai0")
    clocked(analogue, "")
    counter.start()
    with pytest.raises(DaqReadError) as caught:
        read(counter, 1, timeout=0.05)  # nothing ticks before the analogue task runs
    assert caught.value.error_code == -200284
    assert caught.value.samps_per_chan_read == 0
    analogue.start()
    assert read(analogue, 10) == pytest.approx([0.25] * 10, abs=1e-3)
    assert read(counter, 10) == list(range(1, 11))


def test_a_restarted_task_starts_again_at_its_first_sample(new_task: NewTask) -> None:
    task = encoder(new_task(counts_per_s=1e5))
    for first in (1.0, 6.0):
        task.start()
        assert read(task, 5)[0] == first
        assert task.in_stream.total_samp_per_chan_acquired == 5
        task.stop()


def test_lock_step_events_come_ahead_of_their_blocks_and_no_time_passes(new_task: NewTask) -> None:
    task = encoder(new_task())
    events = threading.Semaphore(0)

    def count(*_: object) -> int:
        events.release()
        return 0

    task.register_every_n_samples_acquired_into_buffer_event(10, count)
    task.start()
    for blocks_read in (0, 8, 16):
        assert task.in_stream.total_samp_per_chan_acquired == 10 * blocks_read
        for _ in range(8 if blocks_read else 16):
            assert events.acquire(timeout=10.0)
        assert not events.acquire(timeout=0.1)
        for _ in range(8):
            read(task, 10)


def test_real_time_read_waits_for_its_samples_or_its_deadline(new_task: NewTask) -> None:
    task = encoder(new_task(lock_step=False))
    task.start()
    started_s = time.monotonic()
    read(task, 20_000, timeout=5.0)
    assert time.monotonic() - started_s == pytest.approx(0.2, abs=0.15)
    with pytest.raises(DaqReadError, match="-200284"):
        read(task, 50_000, timeout=0.05)


def test_unread_samples_overflow_the_buffer(new_task: NewTask) -> None:
    task = encoder(new_task(lock_step=False), buffer_samples=1000)
    task.start()
    time.sleep(0.2)
    for _ in range(2):
        with pytest.raises(DaqReadError, match="-200279"):
            read(task, 100)


def test_simulated_time_goes_on_where_nobody_reads(serve_encoder: Any) -> None:
    server, feed = serve_encoder(lock_step=False)
    with (
        grpc.insecure_channel(server.address) as channel,
        nidaqmx.Task(grpc_options=nidaqmx.GrpcSessionOptions(channel, "")) as task,
    ):
        encoder(task).start()
        time.sleep(0.5)
        assert feed.time_s > 0.3
    assert feed.acquisitions[-1] == "stop"


@pytest.mark.parametrize(
    ("act", "code"),
    [
        (lambda task: task.start(), -200478),
        (lambda task: read(encoder(task), 1), -200973),
        (lambda task: task.ci_channels.add_ci_count_edges_chan("Dev2/ctr0"), -200220),
        (lambda task: task.ci_channels.add_ci_count_edges_chan("Dev1/ctr7"), -200170),
        (lambda task: task.ai_channels.add_ai_voltage_chan("Dev1/ctr0"), -200170),
        (lambda task: task.in_stream.curr_read_pos, -200197),
    ],
)
def test_errors_carry_the_drivers_number(
    new_task: NewTask, act: Callable[[Any], Any], code: int
) -> None:
    with pytest.raises(DaqError) as caught:
        act(new_task())
    assert caught.value.error_code == code


def test_a_name_is_given_once(new_task: NewTask) -> None:
    new_task("encoder")
    with pytest.raises(DaqError, match="-50103"):
        new_task("encoder")


def test_an_event_is_registered_once(new_task: NewTask) -> None:
    task = encoder(new_task())
    register = task.register_every_n_samples_acquired_into_buffer_event
    register(100, lambda *_: 0)
    with pytest.raises(DaqError, match="-200966"):
        register(100, lambda *_: 0)
    register(100, None)
    register(100, lambda *_: 0)


def test_what_is_not_built_says_so(new_task: NewTask) -> None:
    with pytest.raises(RpcError, match="not supported"):
        new_task().triggers.start_trigger.cfg_dig_edge_start_trig("/Dev1/PFI0")


def test_a_client_that_vanished_leaves_the_card_free(serve_encoder: Any) -> None:
    server, feed = serve_encoder(lock_step=False)
    command = [sys.executable, "-c", VANISHING_CLIENT, server.address]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as client:
        assert client.stdout is not None
        assert client.stdout.readline() == "running\n"
        client.send_signal(signal.SIGKILL)
    deadline_s = time.monotonic() + 30.0
    while feed.acquisitions[-1:] != ["stop"] and time.monotonic() < deadline_s:
        time.sleep(0.01)
    with (
        grpc.insecure_channel(server.address) as channel,
        nidaqmx.Task(grpc_options=nidaqmx.GrpcSessionOptions(channel, "")) as task,
    ):
        encoder(task).start()
        read(task, 10)


def test_the_dead_server_lets_the_testbed_go_on(serve_encoder: Any) -> None:
    server, feed = serve_encoder(lock_step=False, faults=[Fault(FaultKind.SERVER_DEAD, 0.1)])
    with grpc.insecure_channel(server.address) as channel:
        task = encoder(nidaqmx.Task(grpc_options=nidaqmx.GrpcSessionOptions(channel, "")))
        task.start()
        with pytest.raises(RpcError):
            read(task, 50_000)
        with pytest.raises(RpcError):
            task.close()
    assert feed.acquisitions[-1] == "stop"


def test_stops_twice_and_only_listens_here(serve_encoder: Any) -> None:
    server, _ = serve_encoder()
    assert server.address.startswith("127.0.0.1:")
    server.stop()
    server.stop()
