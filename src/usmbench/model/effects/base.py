"""What an effect is: the change that one physical cause makes to the simulation.

The simulation runs phase φ → static curve → linear dynamics → speed ω. An effect acts at one
stage of it:

========== ================================================== ========================
stage      signal it is given                                 what it stands for
========== ================================================== ========================
command    φ, as the board was told                           generator and amplifier
settled    the settled speed v(φ)                             stator, contact, load
dynamics   nothing; it returns another linear part            inertia, loop delays
motion     the speed ω of the shaft                           shaft and coupling
counter    the speed ω that the counter will report           encoder, card
========== ================================================== ========================
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from usmbench.model.driving import ALWAYS, Driving
from usmbench.model.hammerstein import LinearPart

Array = NDArray[np.float64]
Stage = Literal["command", "settled", "dynamics", "motion", "counter"]
Values = Mapping[str, float]

PHYSICS, DEFINITION = 0.1, 0.03
"""Standard deviations of an effect's form, as shares of it.

What a motor's physics leaves open, and what is open where the form is a definition, as that of an
offset is: only the curve beneath it may be off then."""


@dataclass(frozen=True, slots=True)
class Parameter:
    """A number that sizes an effect.

    Parameters
    ----------
    name
        Its name, with the unit in it where it has one.
    unit
        Unit; "1" where it is a plain ratio.
    null
        Value at which the effect vanishes, or, of a parameter that only shapes the effect (a
        threshold, a time constant), any value.
    low, high
        Plausible bounds.
    typical
        A size (distance from null) that is small and yet worth finding; the step of derivatives.
    scanned
        Whether it shapes the effect: it means nothing where the effect has no size, so it is
        searched over a grid; see `Effect.grid`.
    what
        What it says of the motor or the bench, in a few words: which way is positive, of what a
        share is one.
    """

    name: str
    unit: str
    null: float
    low: float
    high: float
    typical: float
    scanned: bool = False
    what: str = ""

    @property
    def one_way(self) -> bool:
        """Whether it sizes an effect that has one sign."""
        return not self.scanned and self.null in (self.low, self.high)


@dataclass(frozen=True, slots=True)
class Wave:
    """Two parameters that are one quantity with an angle: c cos α + s sin α.

    Parameters
    ----------
    name
        What its amplitude is called.
    cosine, sine
        The parameters.
    what
        What the amplitude says of the motor or the bench, in a few words.
    """

    name: str
    cosine: str
    sine: str
    what: str


@dataclass(frozen=True, slots=True)
class Context:
    """What an effect may know of an unbroken stretch of a run; columns have shape (N,).

    Parameters
    ----------
    t_s
        End of each window, from the first sample of the run.
    window_s
        Duration of a window.
    phase_deg
        Commanded phase.
    settled_rad_s
        The model's static curve at this stretch's operating points: phases in, speeds out.
    linear
        The model's linear part.
    angle_rad
        Shaft angle by the counter at the middle of each window; None where only the simulation
        itself can say.
    detuning_rad_s
        How the settled speed changes with the drive frequency, relative to it: f ∂v/∂f, phases in;
        None where the model knows one frequency only.
    count_rad_s
        One count in a window; None where the run does not say how many a revolution has.
    phase_step_deg
        Step of the phases that the generator sets; None where the run does not say.
    driving
        When in the run the motor was driven, and warmed.
    """

    t_s: Array
    window_s: float
    phase_deg: Array
    settled_rad_s: Callable[[Array], Array]
    linear: LinearPart
    angle_rad: Array | None = None
    detuning_rad_s: Callable[[Array], Array] | None = None
    count_rad_s: float | None = None
    phase_step_deg: float | None = None
    driving: Driving = ALWAYS

    @property
    def n(self) -> int:
        """Number of windows."""
        return self.t_s.size

    def warmed(self, constant_s: float) -> Array:
        """Return how warm the run has made the motor, as a share of the most, shape (N,).

        Parameters
        ----------
        constant_s
            Time constant of the warming.
        """
        return self.driving.warmed(self.t_s, constant_s)


class Effect(ABC):
    """One form of one cause; see the class attributes of any file beside this one.

    A cause may take several forms (a load that pulls one way, a load that brakes): classes with
    the same `name` and another `form`.
    """

    name: ClassVar[str]
    form: ClassVar[str] = ""
    meaning: ClassVar[str]
    mend: ClassVar[str]
    stage: ClassVar[Stage]
    parameters: ClassVar[tuple[Parameter, ...]]
    waves: ClassVar[tuple[Wave, ...]] = ()  # pairs of the parameters
    by_chance: ClassVar[bool] = False  # the windows it acts on keep a scatter of its own
    jagged: ClassVar[bool] = False  # values a little apart change other windows; none has a size
    form_off: ClassVar[float] = PHYSICS  # share of itself by which its form may be off
    early: ClassVar[bool] = False  # the other effects of its stage act on what it leaves
    sporadic: ClassVar[bool] = False  # it acts on single windows; see `SporadicEffect`

    @abstractmethod
    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the signal as the cause changes it.

        Parameters
        ----------
        signal
            The stage's signal, shape (N,).
        context
            The stretch.
        values
            A value for each parameter.
        """

    def grid(self, contexts: Sequence[Context]) -> dict[str, Array]:
        """Return the values at which each scanned parameter is tried first, rising.

        Parameters
        ----------
        contexts
            All stretches of the runs under diagnosis.
        """
        return {}

    def untestable(self, contexts: Sequence[Context]) -> str | None:
        """Return why these runs cannot show the cause, or None where they can.

        Parameters
        ----------
        contexts
            All stretches of the runs under diagnosis.
        """
        return None

    @property
    def lookalikes(self) -> "tuple[Effect, ...]":
        """What a model may be off by that looks like it: no causes, and the name yields to them."""
        return ()

    def built_in(self, contexts: Sequence[Context]) -> dict[str, float] | None:
        """Return the values that a bench is known to have it by; None where it has not.

        Parameters
        ----------
        contexts
            All stretches of the runs that a model was identified on.
        """
        return None

    def habitual(self, contexts: Sequence[Context]) -> bool:
        """Return whether healthy runs may show it: a bench's habit, or what a curve cannot be.

        Parameters
        ----------
        contexts
            All stretches of the runs that a model was identified on.
        """
        return False

    def beneath(
        self,
        contexts: Sequence[Context],
        measured_rad_s: Sequence[Array],
        simulated_rad_s: Sequence[Array],
    ) -> bool:
        """Return whether runs and model alike look as if seen through the cause.

        Such a model was identified on what the cause leaves of the speed; to show the cause it has
        to be identified anew with the cause in place.

        Parameters
        ----------
        contexts
            All stretches of the runs under diagnosis.
        measured_rad_s, simulated_rad_s
            Speed on each of them, and the model's free run, shape (N,).
        """
        return False

    @property
    def null(self) -> dict[str, float]:
        """Values at which the effect vanishes."""
        return {p.name: p.null for p in self.parameters}


class DynamicsEffect(Effect):
    """An effect that puts other dynamics in the place of the model's.

    One with another `stage` also changes that stage's signal.
    """

    stage: ClassVar[Stage] = "dynamics"

    @abstractmethod
    def linear_part(self, linear: LinearPart, context: Context, values: Values) -> LinearPart:
        """Return the linear part as the cause changes it.

        Parameters
        ----------
        linear
            The model's linear part.
        context
            The stretch.
        values
            A value for each parameter.
        """

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the signal unchanged: only the linear part differs.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        return signal


def longest_s(contexts: Sequence[Context]) -> float:
    """Return for how long the longest run drives the motor, in seconds.

    Parameters
    ----------
    contexts
        Stretches, at least one.
    """
    return max(float(c.driving.driven_s(c.t_s[-1:])[0]) for c in contexts)


def middle_rad(speed_rad_s: Array, window_s: Array | float) -> Array:
    """Return the angle turned from the start to the middle of each window, shape (N,).

    Parameters
    ----------
    speed_rad_s
        Mean speed of each window, shape (N,).
    window_s
        Duration of a window, or of each, shape (N,).
    """
    turned_rad = speed_rad_s * window_s
    middle: Array = np.cumsum(turned_rad) - 0.5 * turned_rad
    return middle
