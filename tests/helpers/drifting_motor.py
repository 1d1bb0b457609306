"""A motor that loses a fifth of its speed as it warms, and runs of it that were paused."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from usmbench.model.hammerstein import HammersteinModel, LinearPart, OperatingPoint, StaticCurve
from usmbench.runs.record import Record

Array = NDArray[np.float64]

WINDOW_S, WARM_UP_S, LOSES = 0.01, 7.0, 0.2
DRIFT = {
    "name": "thermal_drift",
    "form": "speed",
    "stage": "settled",
    "parameters": {"final_drift": -LOSES, "warm_up_s": WARM_UP_S},
}


def drifting_motor() -> HammersteinModel:
    """Return its model: a tenth of the phase, through a lag of some windows."""
    curve = StaticCurve(np.array([-90.0, 0.0, 90.0]), np.array([-9.0, 0.0, 9.0]))
    point = OperatingPoint(None, None, curve, (-90.0, 90.0), (0.0, 0.0), 0.01)
    linear = LinearPart(np.array([-0.9]), np.array([0.1]), 0, WINDOW_S)
    return HammersteinModel(linear, (point,), "fast", effects=(DRIFT,))


def paused_run(seed: int, pauses_s: tuple[float, ...], part: int = 800) -> Record:
    """Return a run at 90°, as far as it was seen: at rest before and after each pause."""
    rng = np.random.default_rng(seed)
    on: list[Array] = []
    gaps_s: list[Array] = []
    for pause_s in (0.0, *pauses_s):
        n = part + int(rng.integers(0, part))
        on.append(np.r_[np.zeros(5), np.ones(n)])
        gaps_s.append(np.r_[pause_s, np.zeros(n + 4)])
    drive_on = np.concatenate(on)
    t_s = np.cumsum(WINDOW_S + np.concatenate(gaps_s))
    speed, warmth, rotor = [], 0.0, 0.0
    for gap_s, driven in zip(np.concatenate(gaps_s).tolist(), drive_on.tolist(), strict=True):
        kept = np.exp(-WINDOW_S / WARM_UP_S)
        warmth = warmth * np.exp(-gap_s / WARM_UP_S) * kept + (1.0 - kept) * driven
        rotor = (0.9 * rotor if gap_s == 0.0 else 0.0) + 0.1 * 9.0 * driven * (1.0 - LOSES * warmth)
        speed.append(rotor)
    window_s = np.full(t_s.size, WINDOW_S)
    record = Record(f"run {seed}", t_s, 90.0 * drive_on, np.array(speed), window_s)
    return replace(record, extra={"drive_on": drive_on})
