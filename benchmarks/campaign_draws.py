"""Draws of the naming campaign: what is hidden in which motor, and how it is driven."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from benchmarks.campaign_runs import (
    COUNT_RAD_S,
    FREQUENCIES_HZ,
    FREQUENCY_HZ,
    PLANS,
    Excited,
    Motor,
)
from hil_sim.defects import CATALOGUE, Defect, parse_defect
from usmbench.model.effects.registry import library

STRENGTHS = (0.3, 1.0, 3.0, 10.0)
COLOURS_S = (0.003, 0.01, 0.03)
# About as long as the plan that comes with usmbench, and half as long again.
LENGTHS_S = (40.0, 60.0)
SMALL_LENGTHS_S = (12.0, 30.0)
WANDERS = (0.0, 0.003, 0.01)
GROUPS = (
    *("single", "nothing", "single", "outside", "single", "two"),
    *("single", "single", "nothing", "single", "outside", "two"),
)
_KNOWN: Final = tuple(m for m, kind in CATALOGUE.items() if kind.cause)
_NAMELESS: Final = tuple(m for m in CATALOGUE if m not in _KNOWN)
# Mechanisms of which any two can be told apart in principle, each of a size that can be drawn.
_PAIRED: Final = _KNOWN[: _KNOWN.index("dead_direction")]

TRUTHS: Final[dict[str, Callable[[float, float], dict[str, float]]]] = {
    "amplifier_delay": lambda ns, hz: {"offset_deg": -360.0 * hz * 1e-9 * ns},
    "command_queue": lambda ms, _: {"delay_s": 1e-3 * ms},
    "other_code_wheel": lambda lines, _: {"scale_error": lines / 500.0},
    "off_crystal": lambda ppm, _: {"frequency_error_ppm": ppm},
    "missing_phase_bits": lambda bits, _: {"step_deg": 360.0 / 4096.0 * 2.0**bits},
    "spikes": lambda per_s, _: {"rate_hz": per_s, "size_rad_s": COUNT_RAD_S},
}
"""Mechanisms whose size, converted at a drive frequency, is a parameter of the library's cause."""


@dataclass(frozen=True, slots=True)
class Hidden:
    """What is hidden in one measured run.

    Parameters
    ----------
    group
        "single", "outside", "two" or "nothing".
    defects
        The mechanisms, as mechanism=size.
    causes
        The names that ought to come out.
    strength
        The strength aimed at, in noise of a window.
    """

    group: str
    defects: tuple[str, ...] = ()
    causes: tuple[str, ...] = ()
    strength: float = 0.0

    @property
    def made(self) -> tuple[Defect, ...]:
        """The mechanisms."""
        return tuple(parse_defect(text) for text in self.defects)

    def truth(self, frequencies_hz: Sequence[float]) -> dict[str, float]:
        """Return the cause's true parameters, where the mechanism has them in the library's units.

        What is another at each drive frequency, as the angle of a late amplifier, has no true value
        in a run at several.

        Parameters
        ----------
        frequencies_hz
            Drive frequencies of the run.
        """
        if self.group != "single":
            return {}
        (defect,) = self.made
        known = TRUTHS.get(defect.mechanism)
        if known is None:
            return {}
        first, *others = (known(defect.size, f) for f in frequencies_hz)
        return {name: at for name, at in first.items() if all(o[name] == at for o in others)}


@dataclass(frozen=True, slots=True)
class Choice:
    """What a campaign draws from.

    Parameters
    ----------
    strengths
        Sizes, in noise of a window.
    mechanisms
        Mechanisms to hide in turn, each alone, "nothing" among them; empty for all groups.
    two_frequencies
        Share of the draws that drive two frequencies, one after the other.
    lengths_s
        Durations of the runs.
    """

    strengths: tuple[float, ...] = STRENGTHS
    mechanisms: tuple[str, ...] = ()
    two_frequencies: float = 0.5
    lengths_s: tuple[float, ...] = LENGTHS_S

    def hidden(self, turn: int, rng: np.random.Generator) -> Hidden:
        """Return what is hidden in the campaign's draw of a number."""
        strength = float(rng.choice(self.strengths))
        if not self.mechanisms:
            return hide(GROUPS[turn % len(GROUPS)], turn, strength, rng)
        name = self.mechanisms[turn % len(self.mechanisms)]
        return Hidden("nothing") if name == "nothing" else alone(name, strength, rng)


@dataclass(frozen=True, slots=True)
class Draw:
    """One measured run of a campaign."""

    number: int
    hidden: Hidden
    excited: Excited
    wire: bool


def motor_of(seed: int, number: int, wanders: Sequence[float]) -> Motor:
    """Return a motor of a campaign.

    Parameters
    ----------
    seed
        The campaign's.
    number
        The motor's number in it.
    wanders
        Run-to-run wanders that the motors take in turn.
    """
    rng = np.random.default_rng([seed, number, 7])
    colour_s = float(rng.choice(COLOURS_S))
    return Motor(1000 * seed + number, colour_s, wanders[number % len(wanders)])


def draws(seed: int, motor: int, n_draws: int, n_wire: int, choice: Choice) -> Iterator[Draw]:
    """Yield the draws of one motor; over the motors every mechanism comes equally often.

    Parameters
    ----------
    seed
        The campaign's.
    motor
        The motor's number in it.
    n_draws
        How many.
    n_wire
        How many of them go over the wire.
    choice
        What to draw from.
    """
    rng, places = np.random.default_rng([seed, motor]), np.random.default_rng([seed, motor, 8])
    for k in range(n_draws):
        hidden = choice.hidden(motor * n_draws + k, rng)
        plan = int(rng.integers(len(PLANS)))
        # One length a plan and motor: half the healthy runs to compare with.
        duration_s = choice.lengths_s[(motor + plan) % len(choice.lengths_s)]
        two = places.random() < choice.two_frequencies
        driven_hz = FREQUENCIES_HZ if two else (FREQUENCY_HZ,)
        yield Draw(k, hidden, Excited(PLANS[plan], duration_s, 1000 + motor, driven_hz), k < n_wire)


def hide(group: str, turn: int, strength: float, rng: np.random.Generator) -> Hidden:
    """Draw what is hidden.

    Parameters
    ----------
    group
        "single", "outside", "two" or "nothing".
    turn
        Number of the draw in the campaign; successive ones go through the mechanisms.
    strength
        Size, in noise of a window.
    rng
        Where the rest comes from.
    """
    if group == "nothing":
        return Hidden(group)
    if group == "two":
        first = str(rng.choice(_PAIRED))
        others = [m for m in _PAIRED if CATALOGUE[m].cause != CATALOGUE[first].cause]
        return _made(group, (first, str(rng.choice(others))), max(strength, 1.0), rng)
    mechanisms = _KNOWN if group == "single" else _NAMELESS
    return alone(mechanisms[_turn_in_group(group, turn) % len(mechanisms)], strength, rng)


def alone(mechanism: str, strength: float, rng: np.random.Generator) -> Hidden:
    """Hide one mechanism.

    Parameters
    ----------
    mechanism
        Its name.
    strength
        Size, in noise of a window.
    rng
        Where the rest comes from.
    """
    return _made("single" if CATALOGUE[mechanism].cause else "outside", (mechanism,), strength, rng)


def _made(
    group: str, mechanisms: Sequence[str], strength: float, rng: np.random.Generator
) -> Hidden:
    """Draw the mechanisms' sizes; a cause that is not installed is one outside the library."""
    made = [CATALOGUE[name].of_strength(strength, rng) for name in mechanisms]
    causes = tuple(d.cause for d in made if d.cause)
    if not {effect.name for effect in library()} >= set(causes):
        group, causes = "outside", ()
    return Hidden(group, tuple(f"{d.mechanism}={float(d.size)!r}" for d in made), causes, strength)


def _turn_in_group(group: str, turn: int) -> int:
    """How many draws of the group came before."""
    cycles, place = divmod(turn, len(GROUPS))
    return cycles * GROUPS.count(group) + GROUPS[:place].count(group)
