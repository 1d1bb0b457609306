"""A simulated bench in process, for the commands that sweep, and what they asked of it."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

from hil_sim.in_process import InProcessBench
from usmbench.cli.bench_session import Bench
from usmbench.instruments.generator import SignalGenerator
from usmbench.settings.bench import BenchSettings

PLAN: dict[str, Any] = {
    "format": "usmbench-plan/1",
    "name": "short",
    "frequency_hz": 41000,
    "passes": [{"phase_deg": [-90, 0, 90]}],
    "dwell": {"windows": 20, "settle": {"min_windows": 3, "over_windows": 6}},
}


class SimulatedLoad:
    """The operator of a simulated bench."""

    def set_load(self, torque_nm: float, *, ask: bool) -> None:
        """Have no load to set."""

    def load_is_set(self) -> bool:
        return True


class Opened:
    """What was asked of `open_bench`, and what was left behind."""

    def __init__(self) -> None:
        self.arguments: list[tuple[Any, list[str]]] = []
        self.generators: list[SignalGenerator] = []
        self.interrupt_at_block = 0

    @contextmanager
    def open_bench(
        self, bench: Any, *, testbed_arguments: list[str], frame_log: Any
    ) -> Iterator[Bench]:
        self.arguments.append((bench, testbed_arguments))
        settings = replace(BenchSettings(), name="simulated")
        simulated = InProcessBench(3)
        limits = settings.generator
        generator = SignalGenerator(
            simulated.port,
            clock=simulated.clock,
            frequency_limits_hz=limits.frequency_limits_hz,
            phase_limits_deg=limits.phase_limits_deg,
            frame_log=frame_log,
        )
        self.generators.append(generator)
        next_block, blocks = simulated.source.next_block, 0

        def interrupted() -> Any:
            nonlocal blocks
            blocks += 1
            if blocks == self.interrupt_at_block:
                signal.raise_signal(signal.SIGINT)
            return next_block()

        simulated.source.next_block = interrupted  # type: ignore[method-assign]
        yield Bench(settings, generator, simulated.source, SimulatedLoad(), simulated.clock)
        assert not generator.outputs_on
