"""It starts later than it stops."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from usmbench.model.effects.base import Array, Context, Effect, Parameter, Values
from usmbench.model.effects.play import last_way, passed_on

_STANDING = 0.01  # share of the highest settled speed of the stretch below which the rotor stands
_MANY_PHASES = 100
_HALVINGS, _DIGITS = 14, 2  # enough for a hundredth of a degree
_AT_START = 1.5  # windows: up to then a run is at its beginning, and its rotor at rest
_MEANING = "The motor starts later than it stops: the dead zone depends on where φ comes from."
_MEND = "Look at preload and friction layer; run in the contact; sweep slowly through 0°."


class _Later(Effect):
    """A rotor that needs h degrees more than the curve says."""

    stage = "settled"
    parameters = (Parameter("start_later_deg", "deg", 0.0, 0.0, 60.0, 1.0, scanned=True),)

    def grid(self, contexts: Sequence[Context]) -> dict[str, Array]:
        """Return a width for every set of starts that it may put off; a few where these are many.

        Parameters
        ----------
        contexts
            All stretches.
        """
        # In a staircase of wide steps all starts may be right between two widths near each other.
        few = np.unique(np.concatenate([c.phase_deg for c in contexts])).size <= _MANY_PHASES
        ends = np.unique(np.concatenate([_into_run_deg(c) if few else [] for c in contexts]))
        ends = ends[ends > 0.0]
        if not ends.size:
            return {"start_later_deg": np.geomspace(0.02, 40.0, 30)}
        return {"start_later_deg": 0.5 * (ends + np.r_[0.0, ends[:-1]])}


class Sticking(_Later):
    """A standing rotor needs h degrees more than the curve says; a running one follows the curve.

    Adhesion in the contact: once broken, the friction is the one that the curve was measured with.
    """

    name = "dead_zone_hysteresis"
    form = "sticking"
    meaning = _MEANING
    mend = _MEND
    sides: ClassVar[tuple[float, ...]] = (-1.0, 1.0)  # ways in which a start takes more
    at_reversals: ClassVar[bool] = True  # a rotor that is reversed passes through standstill

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the settled speed, 0 while the rotor sticks.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        later_deg = values["start_later_deg"]
        if later_deg <= 0.0:
            return signal
        way, least_rad_s = np.sign(signal), standing_rad_s(context)
        starts = _beyond(signal, context, self.sides, later_deg)
        stops = np.abs(signal) <= least_rad_s
        if self.at_reversals:
            stops |= way != np.r_[way[:1], way[:-1]]
        runs = bool(context.t_s[0] > _AT_START * context.window_s)
        return np.where(_latched(starts, stops & ~starts, runs), signal, 0.0)

    @property
    def lookalikes(self) -> tuple[Effect, ...]:
        """Dead zones that are wider whatever φ comes from: the model's edges lie elsewhere."""
        return tuple(_Wider(sides) for sides in ((-1.0, 1.0), (1.0,), (-1.0,)))


@dataclass(frozen=True)
class _Wider(_Later):
    """The rotor stands h degrees farther, outward and inward bound: no cause, the curve is off."""

    sides: tuple[float, ...]
    name = "wider_dead_zone"
    meaning = "The dead zone is wider than the model's."
    mend = "Identify the model on phases close to both edges of the dead zone."

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the settled speed, 0 in the wider zone.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        later_deg = values["start_later_deg"]
        starts = _beyond(signal, context, self.sides, later_deg)
        return np.where(starts | (later_deg <= 0.0), signal, 0.0)


class AtRest(Sticking):
    """Adhesion takes time to form: a rotor that is reversed does not stick on its way."""

    form = "sticking at rest"
    at_reversals = False


class Forwards(Sticking):
    """Only starts forwards take more."""

    form = "sticking forwards"
    sides = (1.0,)


class Backwards(Sticking):
    """Only starts backwards do."""

    form = "sticking backwards"
    sides = (-1.0,)


class DirectedEdges(Effect):
    """Both edges shift by h with the direction of the last move: v′ = v(φ ∓ h/2)."""

    name = "dead_zone_hysteresis"
    form = "directed edges"
    meaning = _MEANING
    mend = _MEND
    stage = "settled"
    parameters = (Parameter("width_deg", "deg", 0.0, -5.0, 60.0, 0.5),)

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the settled speed: the dead zone is wider outward bound and narrower inward.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        outward = last_way(np.diff(np.abs(context.phase_deg), prepend=0.0))
        shift_deg = 0.5 * values["width_deg"] * outward * np.sign(context.phase_deg)
        return (
            signal
            + context.settled_rad_s(context.phase_deg - shift_deg)
            - context.settled_rad_s(context.phase_deg)
        )


class Play(Effect):
    """v′ = v(p), where p follows φ only after it has crossed a gap of h: it lags on either way."""

    name = "dead_zone_hysteresis"
    form = "play"
    meaning = _MEANING
    mend = _MEND
    stage = "settled"
    parameters = (Parameter("width_deg", "deg", 0.0, 0.0, 60.0, 1.0, scanned=True),)

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the settled speed at the phases that have crossed the gap.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        moves_deg, width_deg = np.diff(context.phase_deg), values["width_deg"]
        if width_deg <= 0.0 or not np.any(moves_deg):
            return signal
        # Where it began is not known: at the flank of its first move.
        begin_deg = context.phase_deg[0] - 0.5 * width_deg * np.sign(moves_deg[moves_deg != 0.0][0])
        passed_deg = np.cumsum(passed_on(moves_deg, width_deg))
        behind_deg = begin_deg + np.concatenate(([0.0], passed_deg))
        plain = context.settled_rad_s(context.phase_deg)
        return signal + context.settled_rad_s(behind_deg) - plain

    def grid(self, contexts: Sequence[Context]) -> dict[str, Array]:
        """Return widths from a fiftieth of a degree to that of a wide dead zone.

        Parameters
        ----------
        contexts
            All stretches.
        """
        return {"width_deg": np.geomspace(0.02, 40.0, 30)}


def _beyond(
    signal: Array, context: Context, sides: Sequence[float], later_deg: float
) -> NDArray[np.bool_]:
    """Whether the rotor runs, and ran so many degrees nearer to 0, too, shape (N,)."""
    way, least_rad_s = np.sign(signal), standing_rad_s(context)
    # Of two ways to wire a motor, one runs backwards at a positive phase.
    outward = way * np.copysign(1.0, np.sum(context.phase_deg * signal))
    before_rad_s = context.settled_rad_s(
        context.phase_deg - outward * np.where(np.isin(way, sides), later_deg, 0.0)
    )
    runs: NDArray[np.bool_] = (np.abs(signal) > least_rad_s) & (way * before_rad_s > least_rad_s)
    return runs


def _into_run_deg(context: Context) -> Array:
    """By how many degrees the phases at which the rotor runs lie beyond the dead zone, shape (K,).

    The edge is found by halving: the curve may be of any kind, and dip below 0 before a jump.
    """
    size, way = np.abs(context.phase_deg), np.sign(context.phase_deg)
    least_rad_s, settled_rad_s = standing_rad_s(context), context.settled_rad_s(context.phase_deg)
    forward = way * np.copysign(1.0, np.sum(context.phase_deg * settled_rad_s))
    runs = forward * settled_rad_s > least_rad_s
    inside, outside = np.zeros(context.n), size
    for _ in range(_HALVINGS):
        middle = 0.5 * (inside + outside)
        fast = forward * context.settled_rad_s(way * middle) > least_rad_s
        inside, outside = np.where(fast, inside, middle), np.where(fast, middle, outside)
    found: Array = (size - outside)[runs].round(_DIGITS)
    return found


def standing_rad_s(context: Context) -> float:
    """Return the settled speed below which the rotor counts as standing.

    Parameters
    ----------
    context
        The stretch.
    """
    return _STANDING * float(np.max(np.abs(context.settled_rad_s(context.phase_deg))))


def _latched(
    starts: NDArray[np.bool_], stops: NDArray[np.bool_], before: bool
) -> NDArray[np.bool_]:
    """State of a latch that the one sets and the other resets, as before until then."""
    rows = np.arange(starts.size)
    last = np.maximum.accumulate(np.where(starts | stops, rows, -1))
    state: NDArray[np.bool_] = np.where(last >= 0, starts[np.maximum(last, 0)], before)
    return state


FORMS = (Sticking(), AtRest(), Forwards(), Backwards(), DirectedEdges(), Play())
