"""The devices over a pseudo-terminal and gRPC, as a user opens them."""

from typing import Any

import pytest
from bluesky import RunEngine
from bluesky.plans import scan

from usmbench.bluesky import open_devices
from usmbench.settings.plan import DwellSettings, Settle


def test_a_scan_on_the_simulated_testbed() -> None:
    documents: list[tuple[str, Any]] = []
    dwell = DwellSettings(10, 40, Settle(min_windows=3, over_windows=4))
    with open_devices("simulated", dwell=dwell, testbed_arguments=["--seed", "4"]) as devices:
        engine: Any = RunEngine({}, context_managers=[])
        engine.subscribe(lambda name, document: documents.append((name, document)))
        engine(scan([devices.encoder], devices.phase, -90, 90, 5))
        assert devices.loop.setting.drive_on == 0
    speeds = [d["data"]["speed_rad_s"] for name, d in documents if name == "event"]
    assert speeds == pytest.approx([-10.3, -6.8, 0.0, 6.8, 10.3], abs=0.3)
    assert documents[-1][1]["exit_status"] == "success"
