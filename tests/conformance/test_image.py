"""What only the image has: faults of its surroundings, its watchdog, its sync pin, its times."""

from typing import TYPE_CHECKING

import pytest

from hil_sim.gpsim_board import BYTE_CYCLES
from hil_sim.gpsim_bridge import BUILD, CYCLES_PER_SECOND
from usmbench.instruments.protocol._generated import Faults, Flags, Refusal, RequestType, ResetCause

if TYPE_CHECKING:
    from tests.conformance.conftest import ImageHost

NS_PER_CYCLE = 1e9 / CYCLES_PER_SECOND
UNUSED_FLASH = 0x7000
LATC, TRISC, SSPCON1, HLVDCON, PIR2 = "f8b", "f94", "fc6", "fd2", "fa1"
HLVD_STEADY, HLVDIF = 0x3D, 0x04


def assert_stopped_by(host: "ImageHost", fault: Faults) -> None:
    assert not host.line.drives()
    status = host.status()
    assert (status.flags, status.faults) == (Flags.CONFIGURED | Flags.INTERNAL_FAULT, fault)
    for kind, fields in ((RequestType.SET_PHASE, (0,)), (RequestType.OUTPUTS, (1,))):
        assert host.ask(kind, *fields).reason == Refusal.INTERNAL_FAULT
    host.line.reset(ResetCause.EXTERNAL)
    host.start()
    assert host.line.drives()
    assert host.status().faults == 0


def test_a_program_astray_is_caught_by_the_watchdog(image_host: "ImageHost") -> None:
    image_host.start()
    image_host.disturb(f"goto {UNUSED_FLASH:x}")
    assert image_host.line.drives()
    began_s = image_host.line.now_s
    image_host.line.wait(0.1)
    assert image_host.line.board.drive_changes[-1][0] - began_s < 0.07
    assert not image_host.line.drives()
    assert image_host.status()[:2] == (Flags.NOT_IDENTIFIED, ResetCause.WATCHDOG)


@pytest.mark.parametrize(
    ("kind", "fields"), [(RequestType.SET_DRIVE, (441_000, 30)), (RequestType.OUTPUTS, (1,))]
)
def test_a_reset_at_any_point_of_the_execution(
    image_host: "ImageHost", kind: RequestType, fields: tuple[int, ...]
) -> None:
    image_host.start()
    # From the request's last stop bit to the reply, in steps that meet each part of a word.
    for after_cycles in range(0, round(200e-6 * CYCLES_PER_SECOND), 23):
        frame = image_host.frame(kind, *fields)
        (now,) = image_host.image.disturb("measure")
        end = now["cycle"] + BYTE_CYCLES * len(frame) + after_cycles
        image_host.image.disturb(f"send {frame.hex()}", f"run {end}", "reset watchdog")
        image_host.line.now_s = image_host.image.time_s + 0.001
        image_host.line.wait(0.002)
        assert not image_host.line.drives()
        image_host.line.received()
        status = image_host.status()
        assert status == (Flags.NOT_IDENTIFIED, ResetCause.WATCHDOG, 0, 0, 0, 0, 0, 0, 0)
        image_host.start()


def test_the_watchdog_also_sees_a_tick_that_stopped(image_host: "ImageHost") -> None:
    image_host.start()
    image_host.disturb("register fca 0")  # T2CON: the timer is off
    image_host.line.wait(0.1)
    assert not image_host.line.drives()
    assert image_host.status().reset_cause == ResetCause.WATCHDOG


@pytest.mark.parametrize("level", [0, 1])
def test_a_data_line_held_stops_the_drive(image_host: "ImageHost", level: int) -> None:
    image_host.start()
    changes = image_host.line.board.drive_changes
    changes.clear()
    image_host.image.disturb(f"sdata {level}")
    assert image_host.ask(RequestType.SET_PHASE, -700).reason == Refusal.INTERNAL_FAULT
    assert not image_host.line.drives()
    # What the first wrong word did to the chips was not let out for longer than this.
    driven_s = [time_s for time_s, drive in changes if drive.amplitude_b]
    stopped_s = next(time_s for time_s, drive in changes if not drive.amplitude_b)
    assert all(stopped_s - time_s < 50e-6 for time_s in driven_s)
    image_host.image.disturb("sdata free")
    assert_stopped_by(image_host, Faults.DDS_MISMATCH)


def test_a_falling_supply_stops_the_drive(image_host: "ImageHost") -> None:
    image_host.start()
    image_host.disturb(f"register {HLVDCON} {HLVD_STEADY:x}", f"register {PIR2} {HLVDIF:x}")
    assert_stopped_by(image_host, Faults.BROWN_OUT)


def test_a_detector_that_is_not_steady_yet_is_not_believed(image_host: "ImageHost") -> None:
    image_host.start()
    image_host.disturb(f"register {PIR2} {HLVDIF:x}")
    assert image_host.line.drives()


@pytest.mark.parametrize(
    ("register", "value"), [(LATC, 0x0B), (TRISC, 0xD3), (SSPCON1, 0x30)], ids=str
)
def test_pins_that_contradict_the_flags_stop_the_drive(
    image_host: "ImageHost", register: str, value: int
) -> None:
    image_host.start()
    image_host.disturb(f"register {register} {value:x}")
    image_host.line.wait(0.003)
    if register == SSPCON1:
        image_host.image.disturb(f"register {SSPCON1} 31")
    assert_stopped_by(image_host, Faults.STATE)


def test_a_burst_beyond_the_buffer_costs_frames_not_the_drive(image_host: "ImageHost") -> None:
    image_host.start()
    # Each answer is over four times as long as its request.
    burst = b"".join(image_host.frame(RequestType.STATUS) for _ in range(120))
    image_host.image.receive_burst(burst, image_host.line.now_s)
    image_host.line.wait(0.5)
    image_host.line.received()
    image_host.exchange(b"\0")
    status = image_host.status()
    assert status.faults == Faults.UART_OVERRUN
    assert status.flags == Flags.CONFIGURED | Flags.OUTPUTS_ON
    assert image_host.line.drives()


@pytest.mark.parametrize(
    ("variable", "most", "field"), [("bad_frames", 0xFFFF, 7), ("silence_trips", 0xFF, 8)]
)
def test_counters_stop_at_their_end(
    image_host: "ImageHost", variable: str, most: int, field: int
) -> None:
    image_host.start()
    address = address_of(variable)
    value = most - 1
    for offset in range((most.bit_length() + 7) // 8):
        byte = value >> 8 * offset & 0xFF
        image_host.image.disturb(f"register {address + offset:x} {byte:x}")
    for expected in (most - 1, most, most):
        assert image_host.status()[field] == expected
        image_host.exchange(b"\1\0")
        image_host.ask(RequestType.OUTPUTS, 1)
        image_host.line.wait(1.1)


def address_of(variable: str) -> int:
    """Look a variable up in the linker's map."""
    for line in (BUILD / "linked.map").read_text().splitlines():
        words = line.split()
        if words[:1] == [variable]:
            return int(words[1], 16)
    raise AssertionError(f"no variable {variable}")


def test_the_sync_pin_rises_with_every_change_and_always_as_late(image_host: "ImageHost") -> None:
    image_host.start()
    requests = [
        (RequestType.SET_DRIVE, (441_000, 12)),
        (RequestType.SET_PHASE, (-12,)),
        (RequestType.OUTPUTS, (0,)),
        (RequestType.OUTPUTS, (1,)),
        (RequestType.SET_DRIVE, (430_000, -500)),
    ]
    latches = []
    image_host.image.sync_rises_s.clear()
    image_host.image.watch_words(
        lambda time_s, _chips, word: latches.append(time_s) if word >> 14 == 0 else None
    )
    for kind, fields in requests:
        image_host.ask(kind, *fields)
    image_host.line.wait(1.2)
    delays_s = [
        rise - latch for rise, latch in zip(image_host.image.sync_rises_s, latches, strict=True)
    ]
    assert len(delays_s) == len(requests) + 1
    assert max(delays_s) - min(delays_s) < 1e-9
    assert 0.0 < max(delays_s) < 3e-6


def test_times_on_the_bus_and_in_the_processor(image_host: "ImageHost") -> None:
    """AD9833 data sheet, table 2; a received byte must be taken within the next one's time."""
    image_host.start()
    for phase_word in range(-2048, 2049, 256):
        image_host.ask(RequestType.SET_DRIVE, 430_000 + 5 * phase_word % 20_000, phase_word)
        image_host.status()
    measured = image_host.image.disturb("measure")[0]
    least_ns = {
        "data_set_up": 5,
        "data_hold": 3,
        "clock_high": 10,
        "clock_low": 10,
        "fsync_set_up": 5,
        "fsync_hold": 10,
        "clock_to_fsync": 5,
    }
    for name, need_ns in least_ns.items():
        assert measured[name] * NS_PER_CYCLE >= need_ns, name
    byte_cycles = 640
    assert measured["interrupt"] + measured["masked"] < byte_cycles / 4
    assert measured["stack"] <= 31 // 3
