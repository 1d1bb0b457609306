"""How long a diagnosis takes, and how much memory, by the number of windows.

    python benchmarks/diagnosis_time.py [--identified] [--limited] [--unnamed]

The model is one of which nothing but its noise is known, or one that was identified on two runs and
carries what they taught of its errors; the motor a plain lag, or one whose torque has a limit. What
is wrong is an asymmetry, or something that the library has no name for, so that all is tried.
"""

import argparse
import resource
import sys
import time
from dataclasses import replace

import numpy as np

from usmbench.diagnose.pipeline import diagnose
from usmbench.diagnose.reference import with_knowledge
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.model.applied import Applied
from usmbench.model.effects.context import Context
from usmbench.model.effects.first_order import first_order
from usmbench.model.effects.registry import find_effect
from usmbench.model.extended import extended_run
from usmbench.model.hammerstein import HammersteinModel, OperatingPoint, StaticCurve
from usmbench.runs.record import Record

_WINDOW_S, _NOISE_RAD_S, _SLIP_RAD_S = 0.01, 0.02, 8.0
_CURVE = StaticCurve(
    np.array([-90.0, -60, -30, -15, -8, -3, 3, 8, 15, 30, 60, 90]),
    np.array([-10.3, -10.1, -8, 0, 0, 0, 0, 0, 0, 8, 10.2, 10.4]),
)


def motor(*, limited: bool = False) -> HammersteinModel:
    point = OperatingPoint(None, None, _CURVE, (-90.0, 90.0), (-10.0, 10.0), _NOISE_RAD_S)
    lag = first_order(0.0035, 0.0015, _WINDOW_S)
    linear = replace(lag, slip_limit_rad_s=_SLIP_RAD_S if limited else None)
    return HammersteinModel(linear, (point,), "fast")


def identified(of: HammersteinModel) -> HammersteinModel:
    """Return the model of two runs of a motor with nothing wrong."""
    references = [run(n_windows, of, 0.0) for n_windows in (3000, 3001)]
    return with_knowledge(identify_fast(references, FastOptions()).model, references)


def run(n_windows: int, of: HammersteinModel, asymmetry: float = 0.02) -> Record:
    """Return a run in which one direction is faster than the simulation says."""
    rng = np.random.default_rng(n_windows)
    phase_deg = np.repeat(rng.uniform(-88.0, 88.0, n_windows // 5 + 1), 5)[:n_windows]
    t_s = _WINDOW_S * np.arange(1.0, n_windows + 1.0)
    context = Context(t_s, _WINDOW_S, phase_deg, _CURVE.speed_rad_s, of.linear)
    effect = Applied(find_effect("gain_asymmetry", "balanced"), {"asymmetry": asymmetry})
    speed = extended_run([effect], context).speed_rad_s
    noisy = speed + _NOISE_RAD_S * rng.standard_normal(n_windows)
    return Record("run", t_s, phase_deg, noisy, np.full(n_windows, _WINDOW_S))


def humming(record: Record) -> Record:
    """Return a run whose speed hums, more the faster it is, and waves along the speed."""
    speed = record.speed_rad_s
    hum = 0.006 * speed * np.sin(2.0 * np.pi * 3.7 * record.t_s) + 0.05 * np.sin(5.0 * speed)
    return replace(record, speed_rad_s=speed + hum)


def main(argv: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--windows", type=int, nargs="+", default=[10_000, 100_000, 1_000_000])
    parser.add_argument("--identified", action="store_true", help="with an identified model")
    parser.add_argument("--limited", action="store_true", help="of a motor with a torque limit")
    parser.add_argument("--unnamed", action="store_true", help="what has no name is wrong")
    parser.add_argument("--small", action="store_true", help="2000 windows only")
    arguments = parser.parse_args(argv)
    print("  windows    CPU s   wall s   peak MB  verdict    cause")
    for n_windows in [2000] if arguments.small else arguments.windows:
        plain = motor(limited=arguments.limited)
        model = identified(plain) if arguments.identified else plain
        record = run(n_windows, plain)
        if arguments.unnamed:
            record = humming(run(n_windows, plain, asymmetry=0.0))
        wall_s, cpu_s = time.monotonic(), time.process_time()
        found = diagnose([record], model)
        cpu_s, wall_s = time.process_time() - cpu_s, time.monotonic() - wall_s
        peak_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
        causes = ", ".join(cause.name for cause in found.causes)
        print(f"{n_windows:9} {cpu_s:8.1f} {wall_s:8.1f} {peak_mb:9.0f}  {found.verdict}  {causes}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
