"""Both ways into the testbed give the same samples: over pty and server, and in process."""

import time
from collections.abc import Callable

import numpy as np
import pytest
import serial

from hil_sim.counter import Family
from hil_sim.in_process import InProcessBench
from hil_sim.plant import MotorPlant
from hil_sim.running import RunningTestbed
from usmbench.instruments.generator import SignalGenerator
from usmbench.instruments.nidaq import NiSampleSource
from usmbench.instruments.samples import SampleSource
from usmbench.instruments.serial_port import SerialPort
from usmbench.settings.bench import DaqSettings, TemperatureSettings

SEED = 11
LIMITS = {"frequency_limits_hz": (40e3, 42e3), "phase_limits_deg": (-180.0, 180.0)}
SENSOR = TemperatureSettings("ai0")
Block = tuple[int, bytes, bytes, float | None, int]


def patient_clock() -> float:
    """A hundredth of the wall's: in lock step a busy machine must not make the driver resend."""
    return time.monotonic() / 100.0


def scan(
    port: SerialPort,
    source: SampleSource,
    set_load: Callable[[float], None],
    **clock: Callable[[], float],
) -> list[Block]:
    """Drive a short scan with a load and a heartbeat in it; every block as it was read."""
    blocks = []
    with SignalGenerator(port, **LIMITS, **clock) as generator:  # type: ignore[arg-type]
        source.start()
        generator.set_drive(41_000.0, 90.0)
        generator.outputs_on = True
        for n in range(60):
            if n % 8 == 0:
                generator.phase_deg = 90.0 - 3.0 * n
            if n == 30:
                set_load(0.1)
            if n % 7 == 0:
                generator.heartbeat()
            block = source.next_block()
            assert block.index_counts is not None
            assert len(block.index_counts) == (10_000 if n % 10 == 9 else 0)
            blocks.append(
                (
                    block.first_sample,
                    block.counts.tobytes(),
                    block.index_counts.astype(np.int64).tobytes(),
                    block.temperature_c,
                    source.samples_acquired(),
                )
            )
    return blocks


@pytest.mark.parametrize("family", ["m_x", "e_series"])
def test_pty_and_server_in_lock_step_give_what_in_process_gives(family: Family) -> None:
    bench = InProcessBench(SEED, family=family, temperature=True)
    in_process = scan(bench.port, bench.source, bench.set_load, clock=bench.clock)
    with RunningTestbed(MotorPlant(seed=SEED), lock_step=True) as running:
        daq = DaqSettings(address=running.daq_address, family=family)
        source = NiSampleSource(daq, SENSOR)
        try:
            with serial.Serial(running.port, 115200, timeout=1.0) as port:
                set_load = running.testbed.set_load
                over_edges = scan(port, source, set_load, clock=patient_clock)
        finally:
            source.close()
    assert over_edges == in_process


def test_in_real_time_a_sweep_finds_the_motor_turning() -> None:
    with RunningTestbed(MotorPlant(seed=SEED)) as running:
        source = NiSampleSource(DaqSettings(address=running.daq_address))
        try:
            with serial.Serial(running.port, 115200, timeout=1.0) as port:
                blocks = scan(port, source, running.testbed.set_load)
        finally:
            source.close()
        history = [drive for _, drive in running.testbed.drive_history]
    position = [np.frombuffer(counts, dtype=np.int64)[-1] for _, counts, *_ in blocks]
    assert position[0] < 100
    full_speed_counts = 11.0 / (2 * np.pi) * 2000 * 0.6
    assert 300 < max(position) < full_speed_counts
    assert max(drive.amplitude_a for drive in history) == 1.0
    assert history[-1].amplitude_a == 0.0
