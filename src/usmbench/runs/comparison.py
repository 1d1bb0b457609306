"""Two runs held against each other, setting by setting."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from usmbench.errors import InputError
from usmbench.runs.record import Column, Pairs
from usmbench.settings.bench import SIMULATED

# Settings that round to the same multiples are the same: the finest step of a plan, above rounding.
_GRID: Final = {"phase_deg": 0.001, "frequency_hz": 0.1, "torque_nm": 1e-6, "direction": 1.0}
# What is another one in every run.
_ALWAYS_DIFFERENT: Final = frozenset({"id", "started", "stopped", "resumed", "sha256", "imported"})
_BY_CHANCE: Final = frozenset({"bench.daq.address", "bench.generator.port"})


@dataclass(frozen=True, slots=True)
class Comparison:
    """What two runs measured at the settings both have; every column has shape (S,).

    Parameters
    ----------
    phase_deg, frequency_hz, torque_nm
        The setting; frequency and torque are NaN where one of the runs does not say.
    direction
        +1 where φ was rising, -1 where it was falling.
    first_rad_s, second_rad_s
        Settled speed of each run, the mean where a setting was repeated.
    std_rad_s
        Standard error of the difference, from the windows' scatter within the dwells.
    """

    phase_deg: Column
    frequency_hz: Column
    torque_nm: Column
    direction: Column
    first_rad_s: Column
    second_rad_s: Column
    std_rad_s: Column

    @property
    def difference_rad_s(self) -> Column:
        """Second run less the first, shape (S,)."""
        return self.second_rad_s - self.first_rad_s


@dataclass(slots=True)
class _Dwells:
    """The dwells of one run at one setting."""

    speed_rad_s: list[float]
    variance: list[float]

    def mean(self) -> tuple[float, float]:
        """Return the mean speed and the variance of that mean."""
        n = len(self.speed_rad_s)
        return sum(self.speed_rad_s) / n, sum(self.variance) / n**2


def compare_pairs(first: Pairs, second: Pairs) -> Comparison:
    """Match the settled pairs of two runs.

    Parameters
    ----------
    first, second
        The pairs. An operating point that one run does not say matches any.

    Raises
    ------
    usmbench.errors.InputError
        No setting is in both.
    """
    names = [
        name
        for name in _GRID
        if not (np.isnan(getattr(first, name)).any() or np.isnan(getattr(second, name)).any())
    ]
    one, other = _by_setting(first, names), _by_setting(second, names)
    both = [setting for setting in one if setting in other]
    if not both:
        raise InputError(
            "no phase, frequency, torque and direction was settled in both runs; compare runs of "
            "one plan, or replay one through a model of the other"
        )
    means = [one[setting].mean() for setting in both]
    others = [other[setting].mean() for setting in both]
    columns = {name: np.full(len(both), np.nan) for name in _GRID}
    for place, name in enumerate(names):
        columns[name] = np.array([setting[place] * _GRID[name] for setting in both])
    return Comparison(
        **columns,
        first_rad_s=np.array([mean for mean, _ in means]),
        second_rad_s=np.array([mean for mean, _ in others]),
        std_rad_s=np.sqrt([a + b for (_, a), (_, b) in zip(means, others, strict=True)]),
    )


def _by_setting(pairs: Pairs, names: list[str]) -> dict[tuple[int, ...], _Dwells]:
    found: dict[tuple[int, ...], _Dwells] = {}
    columns = [np.round(getattr(pairs, name) / _GRID[name]).astype(int) for name in names]
    keys = [tuple(key) for key in np.column_stack(columns).tolist()]
    variance = pairs.speed_std_rad_s**2 / np.maximum(pairs.n_windows, 1.0)
    for key, speed, scatter in zip(
        keys, pairs.speed_rad_s.tolist(), variance.tolist(), strict=True
    ):
        dwells = found.setdefault(key, _Dwells([], []))
        dwells.speed_rad_s.append(speed)
        dwells.variance.append(scatter)
    return found


def differing_keys(
    first: Mapping[str, Any], second: Mapping[str, Any]
) -> Iterator[tuple[str, Any, Any]]:
    """Yield the keys of run.yaml in which two runs differ, and what each says.

    Parameters
    ----------
    first, second
        What the two run.yaml say. Times, ids and check sums are passed over, and where the
        simulated bench happened to listen.
    """
    benches = [said.get("bench") for said in (first, second)]
    simulated = all(isinstance(b, dict) and b.get("name") == SIMULATED for b in benches)
    passed_over = _BY_CHANCE if simulated else ()
    for key in sorted((first.keys() | second.keys()) - _ALWAYS_DIFFERENT, key=str):
        for found in _differing(str(key), first.get(key), second.get(key)):
            if found[0] not in passed_over:
                yield found


def _differing(key: str, first: Any, second: Any) -> Iterator[tuple[str, Any, Any]]:
    if isinstance(first, dict) and isinstance(second, dict):
        for name in sorted(first.keys() | second.keys(), key=str):
            yield from _differing(f"{key}.{name}", first.get(name), second.get(name))
    elif first != second:
        yield key, first, second
