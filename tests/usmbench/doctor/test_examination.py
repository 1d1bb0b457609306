"""A whole bench over pseudo-terminal and gRPC, sound and with one thing wrong at a time."""

import itertools
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import pytest

from hil_sim.board import Board
from hil_sim.fault_entries import parse_fault
from hil_sim.faults import FaultSchedule
from hil_sim.plant import MotorPlant
from hil_sim.running import RunningTestbed
from hil_sim.signals import Drive, Samples
from usmbench.doctor import card, wire
from usmbench.doctor.examination import examine
from usmbench.doctor.finding import Finding
from usmbench.instruments.protocol import _generated
from usmbench.settings.bench import BenchSettings, TemperatureSettings

ALL_CHECKS = [
    "port",
    "board",
    "protocol",
    "limits",
    "driver",
    "card",
    "samples at rest",
    "motion",
    "encoder direction",
    "counts per revolution",
]
MOTION = ALL_CHECKS[7:]


class NoLoad:
    """The operator of a motor without load."""

    def set_load(self, torque_nm: float, *, ask: bool) -> None:
        assert torque_nm == 0.0
        assert not ask

    def load_is_set(self) -> bool:
        return True


class SwappedChannels(MotorPlant):
    """Channels A and B of the encoder are swapped: the counter runs the other way."""

    def sample(self, n_samples: int, sample_rate_hz: float) -> Samples:
        samples = super().sample(n_samples, sample_rate_hz)
        return replace(samples, position=-samples.position)


class DeafAmplifier(MotorPlant):
    """The drive voltages do not reach the motor."""

    def drive(self, time_s: float, drive: Drive) -> None:
        super().drive(time_s, Drive())


class LostSign(MotorPlant):
    """The counter counts up whichever way the shaft turns."""

    def __init__(self) -> None:
        super().__init__()
        self._last, self._total = 0, 0

    def sample(self, n_samples: int, sample_rate_hz: float) -> Samples:
        samples = super().sample(n_samples, sample_rate_hz)
        steps = abs(samples.position - self._before(samples))
        self._last = int(samples.position[-1])
        position = self._total + steps.cumsum()
        self._total = int(position[-1])
        return replace(samples, position=position)

    def _before(self, samples: Samples) -> Any:
        before = samples.position.copy()
        before[1:] = samples.position[:-1]
        before[0] = self._last
        return before


@contextmanager
def examined(
    change: Callable[[BenchSettings], BenchSettings] = lambda bench: bench,
    *,
    move: bool = True,
    plant: MotorPlant | None = None,
    faults: str = "",
    board: Board | None = None,
) -> Iterator[tuple[dict[str, Finding], RunningTestbed]]:
    """Examine a testbed with one thing changed."""
    schedule = FaultSchedule([parse_fault(faults)] if faults else [])
    with RunningTestbed(plant or MotorPlant(), schedule, lock_step=True, board=board) as running:
        bench = BenchSettings()
        bench = change(
            replace(
                bench,
                generator=replace(bench.generator, port=running.port, reply_timeout_s=1.0),
                daq=replace(bench.daq, address=running.daq_address, no_data_timeout_s=10.0),
            )
        )
        findings = {f.check: f for f in examine(bench, NoLoad(), move=move)}
        assert list(findings) == ALL_CHECKS
        assert all(f.do for f in findings.values() if f.status in ("failed", "warning"))
        yield findings, running


def statuses(findings: dict[str, Finding], wanted: str) -> list[str]:
    return [check for check, finding in findings.items() if finding.status == wanted]


def with_encoder(**keys: Any) -> Callable[[BenchSettings], BenchSettings]:
    return lambda bench: replace(bench, encoder=replace(bench.encoder, **keys))


def with_generator(**keys: Any) -> Callable[[BenchSettings], BenchSettings]:
    return lambda bench: replace(bench, generator=replace(bench.generator, **keys))


def with_daq(**keys: Any) -> Callable[[BenchSettings], BenchSettings]:
    return lambda bench: replace(bench, daq=replace(bench.daq, **keys))


def test_a_sound_bench_passes_every_check_and_the_drive_is_off() -> None:
    with examined() as (findings, running):
        assert statuses(findings, "ok") == ALL_CHECKS
        assert "2000 from index to index" in findings["counts per revolution"].saw
        assert running.testbed.drive_history[-1][1].amplitude_a == 0.0


def test_without_leave_to_move_the_outputs_are_never_on() -> None:
    with examined(move=False) as (findings, running):
        assert statuses(findings, "skipped") == MOTION
        assert all("--move" in findings[check].saw for check in MOTION)
        assert all(drive.amplitude_a == 0.0 for _, drive in running.testbed.drive_history)


def test_a_port_is_searched_for_where_the_bench_file_says_auto(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def auto(bench: BenchSettings) -> BenchSettings:
        monkeypatch.setattr("usmbench.doctor.wire.find_board", lambda: bench.generator.port)
        return with_generator(port="auto")(bench)

    with examined(auto, move=False) as (findings, running):
        assert findings["port"].saw == f"{running.port}: a board answered on it"
        assert findings["board"].status == "ok"


def test_an_adapter_that_holds_replies_back(monkeypatch: pytest.MonkeyPatch) -> None:
    times_s = itertools.count(step=0.016)
    monkeypatch.setattr(wire, "perf_counter", lambda: next(times_s))
    with examined(move=False) as (findings, _):
        assert findings["board"].status == "warning"
        assert "latency timer" in findings["board"].do


def test_a_port_that_is_not_there() -> None:
    with examined(with_generator(port="/dev/no-such-port")) as (findings, _):
        assert statuses(findings, "failed") == ["port"]
        assert "/dev/no-such-port" in findings["port"].saw
        assert statuses(findings, "skipped") == ["board", "protocol", "limits", *MOTION]


def test_a_board_that_says_nothing() -> None:
    quick = with_generator(reply_timeout_s=0.05)
    with examined(quick, faults="board_silent@0") as (findings, _):
        assert statuses(findings, "failed") == ["board"]
        assert findings["driver"].status == "ok"


def test_a_board_of_another_protocol(monkeypatch: pytest.MonkeyPatch) -> None:
    class Ahead:
        """The constants of a firmware that is one version ahead."""

        PROTOCOL_VERSION = _generated.PROTOCOL_VERSION + 1

        def __getattr__(self, name: str) -> Any:
            return getattr(_generated, name)

    monkeypatch.setattr("hil_sim.board.wire", Ahead())
    with examined() as (findings, _):
        assert statuses(findings, "failed") == ["protocol"]
        assert "version 2" in findings["protocol"].saw
        assert "firmware" in findings["protocol"].do


def test_limits_that_the_board_does_not_take() -> None:
    with examined(with_generator(frequency_limits_hz=(38e3, 42e3)), move=False) as (findings, _):
        assert statuses(findings, "warning") == ["limits"]
        assert "frequency_limits_hz" in findings["limits"].do
    with examined(with_generator(frequency_limits_hz=(43e3, 44e3)), move=False) as (findings, _):
        assert statuses(findings, "failed") == ["limits"]


def test_a_server_that_is_not_there() -> None:
    with examined(with_daq(address="127.0.0.1:1")) as (findings, _):
        assert statuses(findings, "failed") == ["driver"]
        assert statuses(findings, "skipped") == ["card", "samples at rest", *MOTION]


def test_a_card_of_another_name() -> None:
    with examined(with_daq(device="Dev7")) as (findings, _):
        assert statuses(findings, "failed") == ["card"]
        assert "Dev7" in findings["card"].saw


def test_swapped_encoder_channels() -> None:
    with examined(plant=SwappedChannels()) as (findings, _):
        assert statuses(findings, "failed") == ["encoder direction"]
        assert "encoder.sign" in findings["encoder direction"].do


def test_the_sign_of_the_bench_file_mends_swapped_channels() -> None:
    with examined(with_encoder(sign=-1), plant=SwappedChannels()) as (findings, _):
        assert statuses(findings, "ok") == ALL_CHECKS


@pytest.mark.parametrize("lines", [250, 1000])
def test_wrong_counts_per_revolution(lines: int) -> None:
    with examined(with_encoder(lines=lines)) as (findings, _):
        assert statuses(findings, "failed") == ["counts per revolution"]
        assert f"the bench file says {4 * lines}" in findings["counts per revolution"].saw
        assert "encoder.lines: 500" in findings["counts per revolution"].do


@pytest.mark.parametrize("channel", ["a", "b"])
def test_a_dead_channel(channel: str) -> None:
    with examined(faults=f"dead_channel@0,channel={channel}") as (findings, running):
        assert statuses(findings, "failed") == ["motion"]
        assert "dead" in findings["motion"].do
        assert statuses(findings, "skipped") == MOTION[1:]
        assert running.testbed.drive_history[-1][1].amplitude_a == 0.0


def test_a_lost_sign() -> None:
    with examined(plant=LostSign()) as (findings, _):
        assert statuses(findings, "failed") == ["encoder direction"]
        assert "same sign" in findings["encoder direction"].saw
        assert statuses(findings, "skipped") == ["counts per revolution"]


def test_a_motor_without_drive() -> None:
    with examined(plant=DeafAmplifier()) as (findings, _):
        assert statuses(findings, "failed") == ["motion"]
        assert "amplifier" in findings["motion"].do


def test_an_interlock_that_stops_the_drive_is_told() -> None:
    def slow(bench: BenchSettings) -> BenchSettings:
        return replace(bench, interlocks=replace(bench.interlocks, overspeed_rad_s=1.0))

    with examined(slow) as (findings, running):
        assert "over-speed" in findings["motion"].saw
        assert findings["motion"].status == "failed"
        assert running.testbed.drive_history[-1][1].amplitude_a == 0.0


def test_without_index_the_rest_is_judged() -> None:
    with examined(with_daq(index_counter=None)) as (findings, _):
        assert statuses(findings, "failed") == []
        assert statuses(findings, "skipped") == ["counts per revolution"]
        assert "no index" in findings["counts per revolution"].saw


def test_one_way_is_enough_where_the_lab_allows_no_other() -> None:
    with examined(with_generator(phase_limits_deg=(0.0, 45.0))) as (findings, _):
        assert statuses(findings, "ok") == ALL_CHECKS
    with examined(with_generator(phase_limits_deg=(0.0, 0.0))) as (findings, _):
        assert statuses(findings, "failed") == ["motion"]


@pytest.mark.parametrize(
    ("degrees_c_per_volt", "status"), [(100.0, "ok"), (400.0, "failed"), (1000.0, "failed")]
)
def test_a_temperature_that_cannot_be_or_is_too_high(
    degrees_c_per_volt: float, status: str
) -> None:
    def sensor(bench: BenchSettings) -> BenchSettings:
        return replace(bench, temperature=TemperatureSettings("ai0", degrees_c_per_volt))

    with examined(sensor, move=False) as (findings, _):
        assert findings["samples at rest"].status == status


def test_a_shaft_that_is_touched(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(card, "_REST_COUNTS", -1)
    with examined(move=False) as (findings, _):
        assert statuses(findings, "warning") == ["samples at rest"]


def test_an_event_stream_that_ends() -> None:
    with examined(with_daq(no_data_timeout_s=0.2), faults="event_stream_dead@0") as (findings, _):
        assert statuses(findings, "failed") == ["samples at rest"]
        assert statuses(findings, "skipped") == MOTION


@pytest.mark.parametrize(("cause", "status"), [("external", "ok"), ("brown_out", "warning")])
def test_a_restart_that_the_board_did_not_ask_for(cause: str, status: str) -> None:
    with examined(move=False, faults=f"board_reset@0,cause={cause}") as (findings, _):
        assert findings["board"].status == status
