"""Which cause struck the windows that stand alone, and whether the model has it already."""

from collections.abc import Sequence
from dataclasses import dataclass

from usmbench.diagnose.evidence import Estimate, NamedCause
from usmbench.diagnose.naming.ranking import TELLING
from usmbench.diagnose.result import LoneView
from usmbench.model.applied import Applied
from usmbench.model.effects.lone_windows import LoneWindows, SporadicEffect, Weighed
from usmbench.model.effects.registry import library


@dataclass(frozen=True, slots=True)
class LoneKind:
    """A cause of single windows, weighed.

    Parameters
    ----------
    effect
        The cause.
    weighed
        How well it fits.
    behind
        Twice by how much its log-likelihood is below that of the likeliest.
    """

    effect: SporadicEffect
    weighed: Weighed
    behind: float

    @property
    def is_near(self) -> bool:
        """Whether these windows cannot tell it from the likeliest."""
        return self.behind < TELLING

    @property
    def estimates(self) -> tuple[Estimate, ...]:
        """Its parameters."""
        return tuple(
            Estimate(p.name, value, low, high, p.unit, p.what)
            for p in self.effect.parameters
            for low, value, high in (self.weighed.values[p.name],)
        )

    @property
    def applied(self) -> Applied:
        """The effect with its parameters."""
        return Applied(self.effect, {e.name: e.value for e in self.estimates})

    def is_in(self, known: Sequence[Applied]) -> bool:
        """Return whether one of some effects is the same cause, as large.

        Parameters
        ----------
        known
            The effects.
        """
        return any(
            own.effect == self.effect and self.effect.is_known(self.weighed, own.values)
            for own in known
        )

    def named(self, rivals: Sequence["LoneKind"], p_value: float) -> NamedCause:
        """Return it as the result has it.

        Parameters
        ----------
        rivals
            The other causes.
        p_value
            Probability of as many such windows where nothing is wrong.
        """
        effect = self.effect
        return NamedCause(
            effect.name,
            effect.form,
            effect.meaning,
            effect.mend,
            tuple(other.effect.name for other in rivals if other.is_near),
            self.estimates,
            p_value,
            gain=0.0,
            single=True,
            by_chance=not effect.left_out,
        )

    def seen(self, rivals: Sequence["LoneKind"], windows: LoneWindows) -> LoneView:
        """Return the windows that stand alone as a figure shows them.

        Parameters
        ----------
        rivals
            The other causes.
        windows
            The windows that they were weighed by.
        """
        label, at = self.effect.shown_against(windows)
        off_rad_s = windows.deviation_rad_s[windows.alone]
        behind = tuple((other.effect.name, other.behind) for other in rivals)
        return LoneView(self.effect.name, label, at[windows.alone], off_rad_s, behind)


def lone_kinds(windows: LoneWindows) -> list[LoneKind]:
    """Return the causes of single windows, the likeliest first.

    Parameters
    ----------
    windows
        The windows, of which some stand alone.
    """
    kinds = [effect for effect in library() if isinstance(effect, SporadicEffect)]
    weighed = [(effect, effect.weigh(windows)) for effect in kinds]
    best = max(found.log_likelihood for _, found in weighed)
    found = [LoneKind(e, w, 2.0 * (best - w.log_likelihood)) for e, w in weighed]
    return sorted(found, key=lambda kind: kind.behind)
