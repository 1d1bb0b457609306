"""The firmware in figures: memory, stack, interrupt, bus times, round trip, resolution.

``python benchmarks/firmware_figures.py`` prints them as tables; exits 1 where a limit is not kept.
Build the image with `make -C firmware`. Frequency and phase are asked of the host's own driver over
the whole range and read from the registers of the AD9833 models. ``--small`` asks fewer.
"""

import argparse
import re
import statistics
import struct
import sys
from collections import deque
from typing import Final

from hil_sim.gpsim_board import GpsimBoard
from hil_sim.gpsim_bridge import BUILD, CYCLES_PER_SECOND, GpsimBridge
from hil_sim.line import BYTE_S
from usmbench.instruments.generator import SignalGenerator
from usmbench.instruments.protocol._generated import (
    DDS_CLOCK_HZ,
    DDS_FREQUENCY_BITS,
    DDS_PHASE_BITS,
    RequestType,
)
from usmbench.instruments.protocol.frames import encode_frame

FREQUENCY_STEP_HZ: Final = DDS_CLOCK_HZ / 2**DDS_FREQUENCY_BITS
PHASE_STEP_DEG: Final = 360.0 / 2**DDS_PHASE_BITS
FREQUENCIES_HZ: Final = (40_000.0, 42_000.0)
PHASES_DEG: Final = (-180.0, 180.0)
NS_PER_CYCLE: Final = 1e9 / CYCLES_PER_SECOND
FLASH_BYTES, ACCESS_RAM_BYTES, STACK_LEVELS = 32_768, 128, 31
BUFFERS_BYTES = {"receive ring": 256, "reply": 36, "reply on the line": 38, "stored reply": 38}
BYTE_CYCLES, TICK_CYCLES = 640, 7200
DELAYS_ASKED: Final = 40
ASKED: Final = {
    RequestType.SET_DRIVE: (struct.pack("<Ih", 430_000, 1), struct.pack("<Ih", 450_000, -1)),
    RequestType.SET_PHASE: (struct.pack("<h", 2), struct.pack("<h", -1500)),
    RequestType.OUTPUTS: (b"\0", b"\1"),
    RequestType.STATUS: (b"", b""),
}

# AD9833 data sheet, table 2: shortest time in ns.
BUS_TIMES: Final = {
    "data_set_up": ("data set-up, t9", 5),
    "data_hold": ("data hold, t10", 3),
    "clock_high": ("SCLK high, t5", 10),
    "clock_low": ("SCLK low, t6", 10),
    "fsync_set_up": ("FSYNC to SCLK falling, t7", 5),
    "fsync_hold": ("SCLK falling to FSYNC rising, t8", 10),
    "clock_to_fsync": ("SCLK high to FSYNC falling, t11", 5),
}


class BoardPort:
    """The board's line as the driver's serial port; time passes as bytes do."""

    name = "the firmware in gpsim"

    def __init__(self, board: GpsimBoard):
        self.timeout: float | None = None
        self.now_s = 0.001
        self.board = board
        self._input: deque[int] = deque()

    def clock(self) -> float:
        """Return the simulated time."""
        return self.now_s

    @property
    def in_waiting(self) -> int:
        """Bytes that a read returns at once."""
        return len(self._input)

    def read(self, size: int = 1, /) -> bytes:
        """Return what has come; without it, let the time-out pass."""
        if not self._input:
            self.now_s += self.timeout or 0.0
        return bytes(self._input.popleft() for _ in range(min(size, len(self._input))))

    def write(self, data: bytes, /) -> int:
        """Send bytes and wait for the reply."""
        self.board.advance(self.now_s)
        self.board.receive_burst(data, self.now_s)
        self.now_s += BYTE_S * len(data)
        for start_s, frame in self.board.replies:
            self._input.extend(frame)
            self.now_s = max(self.now_s, start_s + BYTE_S * len(frame))
        self.board.replies.clear()
        return len(data)

    def close(self) -> None:
        """Forget what was not read."""
        self._input.clear()


def section_bytes(kind: str) -> int:
    """Add up the linker's sections of a kind."""
    sections = re.findall(
        rf"^\s*\S+\s+{kind}\s+0x\w+\s+\w+\s+(0x\w+)",
        (BUILD / "linked.map").read_text(),
        re.MULTILINE,
    )
    return sum(int(size, 16) for size in sections)


def resolution(generator: SignalGenerator, board: GpsimBoard, asks: int) -> tuple[float, float]:
    """Ask for frequencies and phases over the range; return the largest errors, in steps."""
    worst_frequency = worst_phase = 0.0
    for index in range(asks + 1):
        # Both run over their whole range, at different rates, ends included.
        frequency_hz = FREQUENCIES_HZ[0] + (FREQUENCIES_HZ[1] - FREQUENCIES_HZ[0]) * index / asks
        part = (index * 617) % asks / asks if index < asks else 1.0
        phase_deg = PHASES_DEG[0] + (PHASES_DEG[1] - PHASES_DEG[0]) * part
        generator.set_drive(frequency_hz, phase_deg)
        drive = board.drive_changes[-1][1]
        worst_frequency = max(worst_frequency, abs(drive.frequency_hz - frequency_hz))
        worst_phase = max(worst_phase, abs((drive.phase_deg - phase_deg + 180) % 360 - 180))
        del board.drive_changes[:-1]
    return worst_frequency / FREQUENCY_STEP_HZ, worst_phase / PHASE_STEP_DEG


def delays_us(port: BoardPort, kind: RequestType, payloads: tuple[bytes, bytes]) -> list[float]:
    """Mean times from a request's end to its effect, where it has one, and to the reply.

    The payloads take turns, so that each request has an effect; the instants spread over a tick.
    """
    effects_us, replies_us = [], []
    for index in range(DELAYS_ASKED):
        port.now_s += (TICK_CYCLES * (10 + index / DELAYS_ASKED)) / CYCLES_PER_SECOND
        payload = payloads[index % 2]
        port.board.advance(port.now_s)
        port.board.drive_changes.clear()
        frame = encode_frame(index % 256, kind, payload)
        end_s = port.now_s + BYTE_S * len(frame)
        port.board.receive_burst(frame, port.now_s)
        ((start_s, _),) = port.board.replies
        port.board.replies.clear()
        effects_us += [1e6 * (time_s - end_s) for time_s, _ in port.board.drive_changes]
        replies_us.append(1e6 * (start_s - end_s))
        port.now_s = max(port.now_s, port.board.time_s)
    return [statistics.fmean(times_us) for times_us in (effects_us, replies_us) if times_us]


def meet_the_tick(port: BoardPort) -> None:
    """Send a byte at every instant of a tick's period, so that one interrupt has both to do."""
    for _ in range(0, TICK_CYCLES, 2):
        port.now_s += (TICK_CYCLES + 2) / CYCLES_PER_SECOND
        port.write(b"\0")


def print_table(rows: list[tuple[str, str, str, bool]]) -> bool:
    """Print what, measured, limit; return whether every limit is kept."""
    print("| | measured | limit |\n|---|---|---|")
    for what, measured, limit, _ in rows:
        print(f"| {what} | {measured} | {limit} |")
    return all(kept for *_, kept in rows)


def memory_rows() -> list[tuple[str, str, str, bool]]:
    code, variables = section_bytes("code"), section_bytes("udata")
    buffers = sum(BUFFERS_BYTES.values())
    return [
        ("flash", f"{code} bytes", f"{FLASH_BYTES}", code < FLASH_BYTES),
        ("variables", f"{variables} bytes", f"{ACCESS_RAM_BYTES}", variables <= ACCESS_RAM_BYTES),
        ("buffers, a bank each", f"{buffers} bytes in 4 banks", "5 banks", True),
    ]


def time_rows(measured: dict[str, int]) -> list[tuple[str, str, str, bool]]:
    def us(cycles: int) -> str:
        return f"{cycles} cycles, {cycles * NS_PER_CYCLE / 1000:.1f} µs"

    stack, blocked = measured["stack"], measured["interrupt"] + measured["masked"]
    rows = [
        ("return stack", f"{stack} levels", f"{STACK_LEVELS}", stack < STACK_LEVELS),
        ("interrupt, longest", us(measured["interrupt"]), "", True),
        ("interrupts masked, longest", us(measured["masked"]), "", True),
        ("both, against a byte's time", us(blocked), us(BYTE_CYCLES), blocked < BYTE_CYCLES),
    ]
    for name, (what, least_ns) in BUS_TIMES.items():
        time_ns = measured[name] * NS_PER_CYCLE
        rows.append((what, f"{time_ns:.0f} ns", f"≥ {least_ns} ns", time_ns >= least_ns))
    return rows


def delay_rows(delays: list[tuple[RequestType, list[float]]]) -> list[tuple[str, str, str, bool]]:
    rows = []
    for kind, times_us in delays:
        what = "to effect, to reply" if len(times_us) > 1 else "to reply"
        times = ", ".join(f"{time_us:.0f}" for time_us in times_us)
        rows.append((f"{kind.name.lower()}: {what}", f"{times} µs", "", True))
    return rows


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--small", action="store_true", help="ask fewer frequencies and phases")
    asks = 500 if parser.parse_args().small else 40_000
    with GpsimBridge() as bridge:
        port = BoardPort(GpsimBoard(bridge))
        generator = SignalGenerator(
            port, clock=port.clock, frequency_limits_hz=FREQUENCIES_HZ, phase_limits_deg=PHASES_DEG
        )
        frequency, phase = resolution(generator, port.board, asks)
        delays = [(kind, delays_us(port, kind, payloads)) for kind, payloads in ASKED.items()]
        generator.off()
        meet_the_tick(port)
        (measured,) = port.board.disturb("measure")
        errors = port.board.errors
    # Half a step, but for the rounding of the comparison itself.
    half = 0.5 + 1e-6
    kept = print_table(
        [
            *memory_rows(),
            *time_rows(measured),
            *delay_rows(delays),
            ("frequency error", f"{frequency:.3f} steps", "0.5 steps", frequency <= half),
            ("phase error", f"{phase:.3f} steps", "0.5 steps", phase <= half),
        ]
    )
    print(f"{asks + 1} settings asked for; errors on bus and line: {errors or 'none'}")
    return 0 if kept and not errors else 1


if __name__ == "__main__":
    sys.exit(main())
