"""How often the 95 % intervals of a named cause's parameters hold the truth.

    python benchmarks/interval_coverage.py [--draws 320] [--small]

Motors of the library's own making: a curve and a lag, with coloured noise. Of each a model is
identified on two runs, so that it is wrong by what two runs leave open. Causes are drawn that
change the speed by half to five times the noise's rms, and the run is searched for the forms of
that cause alone, to save time. A draw counts where just the form that acts is named.
"""

import argparse
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from benchmarks.campaign_tables import share
from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.fitting.intervals import intervals
from usmbench.diagnose.known.model_knowledge import knowledge_of
from usmbench.diagnose.naming.search import search
from usmbench.diagnose.reference import with_knowledge
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.model.applied import Applied
from usmbench.model.effects.base import Effect
from usmbench.model.effects.context import Context
from usmbench.model.effects.first_order import first_order
from usmbench.model.effects.registry import library
from usmbench.model.extended import extended_run
from usmbench.model.hammerstein import StaticCurve
from usmbench.runs.record import Record

Array = NDArray[np.float64]

WINDOW_S, NOISE_RAD_S, COLOUR = 0.01, 0.02, 0.5
STRENGTHS = (0.5, 5.0)
_HOLD = 5
_TRIES = 40


class Motor:
    """A motor drawn by seed, and the model that was identified on two runs of it."""

    def __init__(self, seed: int, n_windows: int):
        self._rng, self._n = np.random.default_rng([seed, 5]), n_windows
        edge_deg, top_rad_s = self._rng.uniform(6.0, 14.0), self._rng.uniform(8.0, 12.0)
        half_deg = np.array([0.4 * edge_deg, edge_deg, 20.0, 35.0, 60.0, 90.0])
        half_rad_s = top_rad_s * np.array([0.0, 0.0, 0.1, 0.7, 0.95, 1.0])
        self._curve = StaticCurve(
            np.r_[-half_deg[::-1], half_deg], np.r_[-half_rad_s[::-1], half_rad_s]
        )
        self._dynamics = first_order(self._rng.uniform(0.003, 0.02), 0.0015, WINDOW_S)
        references = [self.run(()) for _ in range(2)]
        identified = identify_fast(references, FastOptions()).model
        self.model = with_knowledge(identified, references)

    def run(self, effects: tuple[Applied, ...]) -> Record:
        """Return a run of random phases."""
        levels_deg = self._rng.uniform(-88.0, 88.0, -(-self._n // _HOLD))
        context = self._context(np.repeat(levels_deg, _HOLD)[: self._n])
        speed_rad_s = extended_run(effects, context).speed_rad_s + self._noise_rad_s()
        end_rad = np.asarray(context.angle_rad) + 0.5 * WINDOW_S * speed_rad_s
        return Record(
            "run",
            context.t_s,
            context.phase_deg,
            speed_rad_s,
            np.full(self._n, WINDOW_S),
            angle_rad=end_rad,
        )

    def _context(self, phase_deg: Array) -> Context:
        t_s = WINDOW_S * np.arange(1.0, self._n + 1.0)
        settled_rad_s = self._curve.speed_rad_s
        angle_rad = np.cumsum(settled_rad_s(phase_deg)) * WINDOW_S
        return Context(t_s, WINDOW_S, phase_deg, settled_rad_s, self._dynamics, angle_rad)

    def _noise_rad_s(self) -> Array:
        drawn = NOISE_RAD_S * np.sqrt(1.0 - COLOUR**2) * self._rng.standard_normal(self._n)
        return np.asarray(lfilter([1.0], [1.0, -COLOUR], drawn))

    def drawn(self, effect: Effect) -> Applied | None:
        """Return an effect of a size within `STRENGTHS`, or None where there is none."""
        levels_deg = self._rng.uniform(-88.0, 88.0, -(-self._n // _HOLD))
        context = self._context(np.repeat(levels_deg, _HOLD)[: self._n])
        if effect.untestable([context]) is not None:
            return None
        plain = extended_run((), context).speed_rad_s
        grids = effect.grid([context])
        for _ in range(_TRIES):
            values = {}
            for p in effect.parameters:
                if p.scanned:
                    axis = np.clip(grids[p.name], p.low, p.high)
                    values[p.name] = float(self._rng.uniform(axis[0], axis[-1]))
                else:
                    size = p.typical * 10.0 ** self._rng.uniform(-1.0, 1.5)
                    side = self._rng.choice([-1.0, 1.0])
                    values[p.name] = float(np.clip(p.null + side * size, p.low, p.high))
            applied = Applied(effect, values)
            change = extended_run((applied,), context).speed_rad_s - plain
            strength = float(np.sqrt(np.mean(change**2))) / NOISE_RAD_S
            if STRENGTHS[0] <= strength <= STRENGTHS[1]:
                return applied
        return None


def held(motor: Motor, applied: Applied) -> dict[str, bool] | None:
    """Return, by parameter, whether its interval holds the truth; None where it is not named.

    Parameters
    ----------
    motor
        The motor.
    applied
        What acts.
    """
    stretches, _ = cut_runs([motor.run((applied,))], motor.model, ())
    contexts = [stretch.context for stretch in stretches]
    name = applied.effect.name
    forms = [e for e in library() if e.name == name and e.untestable(contexts) is None]
    found = search(stretches, knowledge_of(motor.model), (), forms)
    if [a.effect for a in found.fit.effects] != [applied.effect]:
        return None
    (ranges,) = intervals(found.problem, found.fit, found.spread)
    return {p: low <= applied.values[p] <= high for p, (low, high) in ranges.items()}


def draws(n_draws: int, n_windows: int, each: int) -> Iterator[tuple[str, dict[str, bool]]]:
    """Yield the draws that count: a cause and its form, and what its intervals held.

    Parameters
    ----------
    n_draws
        How many.
    n_windows
        Windows of a run.
    each
        Draws of each motor.
    """
    forms = [e for e in library() if not e.sporadic and e.parameters]
    counted, tried = 0, 0
    while counted < n_draws:
        if tried % each == 0:
            motor = Motor(tried // each, n_windows)
        effect = forms[tried % len(forms)]
        tried += 1
        applied = motor.drawn(effect)
        found = None if applied is None else held(motor, applied)
        if found is not None:
            counted += 1
            yield f"{effect.name} {effect.form}".strip(), found


def main(argv: list[str] | None = None) -> int:
    """Print a line a cause, and the share over all of them.

    Parameters
    ----------
    argv
        The command line; None takes it from the process.
    """
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--draws", type=int, default=320)
    parser.add_argument("--windows", type=int, default=2000)
    parser.add_argument("--small", action="store_true", help="30 draws")
    arguments = parser.parse_args(argv)
    n_draws = 30 if arguments.small else arguments.draws
    table: dict[str, list[bool]] = {}
    for cause, found in draws(n_draws, arguments.windows, 40):
        for parameter, inside in found.items():
            table.setdefault(f"{cause}: {parameter}", []).append(inside)
    for key, held_there in sorted(table.items()):
        print(f"{key:60} {sum(held_there):4} of {len(held_there):4}")
    every = [one for held_there in table.values() for one in held_there]
    mean, low, high = share(sum(every), len(every))
    print(
        f"95 % interval holds the truth: {100 * mean:.1f} % ({100 * low:.1f} to {100 * high:.1f} %)"
        f" of {len(every)} parameters in {n_draws} draws (goal 95 +- 3 %)"
    )
    return 0


if __name__ == "__main__":
    main()
