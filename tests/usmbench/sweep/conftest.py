"""A bench of a few lines: a motor that follows at once, a counter, a log of what was asked."""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from math import pi, sin

import numpy as np
import pytest
from numpy.typing import NDArray

from usmbench.instruments.samples import SampleBlock
from usmbench.settings.bench import BenchSettings
from usmbench.sweep.controller import Instruments
from usmbench.sweep.observer import Standing
from usmbench.sweep.rows import PairRow, WindowRow

SAMPLE_RATE_HZ = 100_000.0
BLOCK = 1000
COUNTS_PER_RAD = 2000 / (2 * pi)


@dataclass
class FakeBench:
    """Drive, source, operator, sink and observer in one; every call goes through `note`."""

    speed_at: Callable[[float, bool], float] = lambda phase, on: 10 * sin(phase * pi / 180) * on
    hook: Callable[[str], None] = lambda name: None
    fake_counts: Callable[[int], int] | None = None
    temperature_c: float | None = None
    index_counts: NDArray[np.int64] | None = None
    load_after_windows: int = 0
    # Samples that the card has taken beyond those that were read.
    ahead_samples: int = 0
    command_samples: int = 0

    calls: list[str] = field(default_factory=list)
    windows: list[WindowRow] = field(default_factory=list)
    pairs: list[PairRow] = field(default_factory=list)
    left: list[int] = field(default_factory=list)
    waiting: list[bool] = field(default_factory=list)
    seen_pairs: list[PairRow] = field(default_factory=list)
    contact_samples: list[int] = field(default_factory=list)
    loads: list[tuple[float, bool]] = field(default_factory=list)
    on: bool = False
    was_on: bool = False
    frequency_hz: float = 0.0
    phase: float = 0.0
    read_samples: int = 0
    clock_samples: int = 0
    taken_samples: int = 0
    blocks: deque[SampleBlock] = field(default_factory=deque)
    position: float = 0.0
    sample_rate_hz: float = SAMPLE_RATE_HZ
    samples_per_block: int = BLOCK
    counter_bits: int = 32

    def note(self, name: str) -> None:
        self.calls.append(name)
        self.hook(name)

    # The signal generator.
    def set_drive(self, frequency_hz: float, phase_deg: float) -> None:
        self._command(f"set_drive {frequency_hz:g} {phase_deg:g}")
        self.frequency_hz, self.phase = frequency_hz, phase_deg

    @property
    def phase_deg(self) -> float:
        return self.phase

    @phase_deg.setter
    def phase_deg(self, phase_deg: float) -> None:
        self._command(f"phase {phase_deg:g}")
        self.phase = phase_deg

    @property
    def outputs_on(self) -> bool:
        return self.on

    @outputs_on.setter
    def outputs_on(self, on: bool) -> None:
        # On before the interruption: the worst instant for a Ctrl-C is right after the effect.
        self.on = on
        self.was_on = True
        self._command("on")

    def heartbeat(self) -> None:
        self._command("heartbeat")

    def off(self) -> None:
        self.on = False
        self._command("off")

    def _command(self, name: str) -> None:
        self.clock_samples += self.command_samples
        self.contact_samples.append(self.clock_samples)
        self.note(name)

    # The card.
    def start(self) -> None:
        self.note("start")

    def next_block(self) -> SampleBlock:
        self.note("next_block")
        self.read_samples += BLOCK
        self.clock_samples = max(self.clock_samples, self.read_samples + self.ahead_samples)
        while self.taken_samples + BLOCK <= self.clock_samples:
            self.blocks.append(self._take(self.taken_samples))
            self.taken_samples += BLOCK
        return self.blocks.popleft()

    def _take(self, first: int) -> SampleBlock:
        speed = self.speed_at(self.phase, self.on) * COUNTS_PER_RAD / SAMPLE_RATE_HZ
        positions = self.position + speed * np.arange(1, BLOCK + 1)
        self.position = float(positions[-1])
        counts = np.floor(positions).astype(np.int64)
        if self.fake_counts is not None:
            counts = np.array([self.fake_counts(first + i) for i in range(BLOCK)])
        return SampleBlock(first, counts % 2**32, self.index_counts, self.temperature_c)

    def samples_acquired(self) -> int:
        return self.clock_samples

    def close(self) -> None:
        self.note("close")

    # The operator.
    def set_load(self, torque_nm: float, *, ask: bool) -> None:
        assert not (ask and self.on), "nobody may touch the load while the motor is driven"
        self.note(f"load {torque_nm:g}")
        self.loads.append((torque_nm, ask))
        self.wait = self.load_after_windows if ask else 0

    def load_is_set(self) -> bool:
        self.wait -= 1
        return self.wait < 0

    # The sink and the observer.
    def window(self, row: WindowRow, standing: Standing | None = None) -> None:
        if standing is None:
            self.note("window")
            self.windows.append(row)
        else:
            self.note("progress")
            self.left.append(standing.windows_left)
            self.waiting.append(standing.waiting_for_load)

    def settled(self, pair: PairRow) -> None:
        self.note("settled")
        self.seen_pairs.append(pair)

    def pair(self, row: PairRow) -> None:
        self.note("pair")
        self.pairs.append(row)

    def raw(self, block: SampleBlock) -> None:
        self.note("raw")

    @property
    def instruments(self) -> Instruments:
        return Instruments(self, self, self)


@pytest.fixture
def fake() -> FakeBench:
    return FakeBench()


@pytest.fixture
def make_fake() -> type[FakeBench]:
    return FakeBench


@pytest.fixture
def bench_settings() -> BenchSettings:
    return BenchSettings()
