"""The effects of the extended model: the model's own, less what is gone, and what was named."""

from collections.abc import Iterator
from typing import Any

from usmbench.diagnose.described_alone import news_of
from usmbench.diagnose.held import Held
from usmbench.diagnose.naming.sporadic import Sporadic
from usmbench.diagnose.residual.own_gone import OwnGone
from usmbench.model.applied import applied_effects
from usmbench.model.hammerstein import HammersteinModel


def extended_effects(held: Held, model: HammersteinModel) -> tuple[dict[str, Any], ...]:
    """Return the effects of a model file with what was found.

    What the model has already of a cause of single windows gives way to all that was found of it.

    Parameters
    ----------
    held
        What stands.
    model
        The model.
    """
    news = {(s.named.name, s.named.form) for s in news_of(held)}
    named = held.found.fit.effects
    return (
        *(
            entry
            for entry in _own(held, model)
            if (entry["name"], entry.get("form", "")) not in news
        ),
        *(s.applied.to_mapping() for s in held.sporadic if _of(s) in news),
        *(applied.to_mapping() for applied in named if not isinstance(applied.effect, OwnGone)),
    )


def _own(held: Held, model: HammersteinModel) -> Iterator[dict[str, Any]]:
    """Yield the model's own effects, as far as they are still there."""
    gone = [a for a in held.found.fit.effects if isinstance(a.effect, OwnGone)]
    for entry, own in zip(model.effects, applied_effects(model.effects), strict=True):
        left: dict[str, Any] | None = dict(entry)
        for applied in gone:
            if isinstance(applied.effect, OwnGone) and applied.effect.own == own:
                left = applied.effect.entry_left(applied.values)
        if left is not None:
            yield left


def _of(cause: Sporadic) -> tuple[str, str]:
    return cause.named.name, cause.named.form
