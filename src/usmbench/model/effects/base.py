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
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from usmbench.model.effects.context import Context
from usmbench.model.effects.guarded import guard
from usmbench.model.effects.parameter import Parameter, Wave
from usmbench.model.hammerstein import LinearPart

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Stage = Literal["command", "settled", "dynamics", "motion", "counter"]
Values = Mapping[str, float]

PHYSICS, DEFINITION = 0.1, 0.03
"""Standard deviations of an effect's form, as shares of it.

What a motor's physics leaves open, and what is open where the form is a definition, as that of an
offset is: only the curve beneath it may be off then."""


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
    apart: ClassVar[bool] = False  # each scanned parameter acts on windows of its own
    form_off: ClassVar[float] = PHYSICS  # share of itself by which its form may be off
    early: ClassVar[bool] = False  # the other effects of its stage act on what it leaves
    sporadic: ClassVar[bool] = False  # it acts on single windows; see `SporadicEffect`
    left_out: ClassVar[bool] = False  # the windows that a sporadic one may move count in nothing

    def __init_subclass__(cls, **options: Any) -> None:
        """See that a cause of the user's own tells in one line what it does wrong."""
        super().__init_subclass__(**options)
        guard(cls)

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

    def alike(self, values: Values, contexts: Sequence[Context]) -> tuple[Array, Mask]:
        """Return other values of a jagged effect's only parameter that may do about the same.

        Parameters
        ----------
        values
            Its value.
        contexts
            All stretches of the runs under diagnosis.

        Returns
        -------
        tuple of Array and Mask
            The values, rising, and which of them no smooth effect does as well, shape (V,) each.
        """
        return np.empty(0), np.empty(0, dtype=np.bool_)

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
