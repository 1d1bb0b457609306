"""How long a diagnosis takes, and how much memory, by the number of windows."""

import argparse
import resource
import sys
import time

import numpy as np

from usmbench.diagnose.pipeline import diagnose
from usmbench.model.effects.base import Context
from usmbench.model.effects.first_order import first_order
from usmbench.model.effects.registry import find_effect
from usmbench.model.extended import Applied, extended_run
from usmbench.model.hammerstein import HammersteinModel, OperatingPoint, StaticCurve
from usmbench.runs.record import Record

_WINDOW_S, _NOISE_RAD_S = 0.01, 0.02
_CURVE = StaticCurve(
    np.array([-90.0, -60, -30, -15, -8, -3, 3, 8, 15, 30, 60, 90]),
    np.array([-10.3, -10.1, -8, 0, 0, 0, 0, 0, 0, 8, 10.2, 10.4]),
)


def motor() -> HammersteinModel:
    point = OperatingPoint(None, None, _CURVE, (-90.0, 90.0), (-10.0, 10.0), _NOISE_RAD_S)
    return HammersteinModel(first_order(0.0035, 0.0015, _WINDOW_S), (point,), "fast")


def run(n_windows: int) -> Record:
    """Return a run in which one direction is faster than the simulation says."""
    rng = np.random.default_rng(n_windows)
    phase_deg = np.repeat(rng.uniform(-88.0, 88.0, n_windows // 5 + 1), 5)[:n_windows]
    t_s = _WINDOW_S * np.arange(1.0, n_windows + 1.0)
    context = Context(t_s, _WINDOW_S, phase_deg, _CURVE.speed_rad_s, motor().linear)
    effect = Applied(find_effect("gain_asymmetry", "balanced"), {"asymmetry": 0.02})
    speed = extended_run([effect], context).speed_rad_s
    noisy = speed + _NOISE_RAD_S * rng.standard_normal(n_windows)
    return Record("run", t_s, phase_deg, noisy, np.full(n_windows, _WINDOW_S))


def main(argv: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--windows", type=int, nargs="+", default=[10_000, 100_000, 1_000_000])
    parser.add_argument("--small", action="store_true", help="2000 windows only")
    arguments = parser.parse_args(argv)
    print("  windows    CPU s   wall s   peak MB  verdict    cause")
    for n_windows in [2000] if arguments.small else arguments.windows:
        record, model = run(n_windows), motor()
        wall_s, cpu_s = time.monotonic(), time.process_time()
        found = diagnose([record], model)
        cpu_s, wall_s = time.process_time() - cpu_s, time.monotonic() - wall_s
        peak_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
        causes = ", ".join(cause.name for cause in found.causes)
        print(f"{n_windows:9} {cpu_s:8.1f} {wall_s:8.1f} {peak_mb:9.0f}  {found.verdict}  {causes}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
