"""Causes of single windows, as a diagnosis tells them."""

from collections.abc import Iterator, Sequence

from usmbench.diagnose.evidence import NamedCause
from usmbench.diagnose.held import Held, counted_alone
from usmbench.diagnose.naming.sporadic import Sporadic
from usmbench.diagnose.naming.unnamed_windows import left_unnamed
from usmbench.diagnose.result import STANDS, LoneView


def news_of(held: Held) -> tuple[Sporadic, ...]:
    """Return the causes of single windows that are named.

    Parameters
    ----------
    held
        What stands.
    """
    return tuple(s for s in held.sporadic if s.is_news) if held.verdict in STANDS else ()


def named_alone(held: Held) -> list[NamedCause]:
    """Return the causes of single windows, each once: a disc may be damaged at two places.

    Parameters
    ----------
    held
        What stands.
    """
    return list({s.named.name: s.named for s in reversed(news_of(held))}.values())[::-1]


def lone_views(held: Held) -> tuple[LoneView, ...]:
    """Return the windows by which single-window causes were told.

    Parameters
    ----------
    held
        What stands.
    """
    return tuple(s.seen for s in news_of(held))


def said_alone(held: Held) -> Iterator[str]:
    """Yield what to say of windows that stand alone, a sentence each.

    Parameters
    ----------
    held
        What stands.
    """
    left_out = [s for s in held.sporadic if s.applied.effect.left_out]
    for name in dict.fromkeys(s.named.name for s in left_out):
        yield f"windows that {name} may have struck are left out of all other figures"
    yield from _further_places(left_out)
    if counted_alone(held.sporadic):
        names = (s.named.name for s in held.sporadic if s not in left_out)
        yield (
            f"no simulation foresees which windows {' and '.join(names)} strikes: they count in "
            "full, before and after"
        )
    else:
        found = held.found
        yield from left_unnamed(found.problem, found.fit.effects, found.spread)


def _further_places(left_out: Sequence[Sporadic]) -> Iterator[str]:
    """Say where the same cause was found more than once."""
    told: set[str] = set()
    for cause in left_out:
        if cause.named.name in told:
            sizes = ", ".join(
                f"{p.name} {p.value:.4g} ({p.low:.4g} … {p.high:.4g})"
                for p in cause.named.parameters
            )
            yield f"{cause.named.name} was found once more: {sizes}"
        told.add(cause.named.name)
