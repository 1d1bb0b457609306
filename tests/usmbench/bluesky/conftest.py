"""A bench in this process under bluesky, and what stays of a run."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any, cast

import pytest
from bluesky import RunEngine
from event_model import DocumentNames, schema_validators, unpack_event_page

from hil_sim.faults import Fault
from hil_sim.in_process import InProcessBench
from usmbench.bluesky import Devices, devices_of
from usmbench.cli.bench_session import Bench
from usmbench.instruments.generator import SignalGenerator
from usmbench.settings.bench import BenchSettings
from usmbench.settings.plan import DwellSettings, Settle

DWELL = DwellSettings(10, 60, Settle(min_windows=3, over_windows=4))


class NoOperator:
    """Nobody changes the load."""

    def set_load(self, torque_nm: float, *, ask: bool) -> None:
        """Have no load to set."""

    def load_is_set(self) -> bool:
        return True


@dataclass
class Opened:
    """The devices, the simulated bench behind them, and what a plan emitted."""

    simulated: InProcessBench
    generator: SignalGenerator
    devices: Devices
    engine: Any
    documents: list[tuple[str, dict[str, Any]]] = field(default_factory=list)

    @property
    def drive_is_on(self) -> bool:
        history = self.simulated.testbed.drive_history
        return bool(history) and history[-1][1].amplitude_a > 0.0

    def keep(self, name: str, document: dict[str, Any]) -> None:
        schema_validators[DocumentNames[name]].validate(document)
        self.documents.append((name, document))

    def events(self, stream: str = "primary") -> list[dict[str, Any]]:
        """Return their data; what is taken again after a suspension keeps its number."""
        uids = {d["uid"] for n, d in self.documents if n == "descriptor" and d["name"] == stream}
        found: list[Any] = []
        for name, document in self.documents:
            if name.startswith("event") and document["descriptor"] in uids:
                found += [document] if name == "event" else unpack_event_page(cast(Any, document))
        return list({event["seq_num"]: event["data"] for event in found}.values())

    def last(self, name: str) -> dict[str, Any]:
        return [document for kind, document in self.documents if kind == name][-1]


OpenBench = Callable[..., Any]


@pytest.fixture
def open_bench() -> OpenBench:
    @contextmanager
    def open_it(faults: tuple[Fault, ...] = (), **interlocks: Any) -> Iterator[Opened]:
        limits = replace(BenchSettings().interlocks, drive_time_max_s=1e6, **interlocks)
        settings = replace(BenchSettings(), interlocks=limits)
        simulated = InProcessBench(3, faults=faults)
        with (
            SignalGenerator(
                simulated.port,
                clock=simulated.clock,
                frequency_limits_hz=settings.generator.frequency_limits_hz,
                phase_limits_deg=settings.generator.phase_limits_deg,
            ) as generator,
            simulated.source,
        ):
            bench = Bench(settings, generator, simulated.source, NoOperator(), simulated.clock)
            engine: Any = RunEngine({}, context_managers=[])
            with devices_of(bench, dwell=DWELL) as devices:
                opened = Opened(simulated, generator, devices, engine)
                engine.subscribe(opened.keep)
                yield opened
            # With a port that has gone only the board's own watchdog can see to that.
            assert faults or not opened.drive_is_on

    return open_it
