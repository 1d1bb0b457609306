"""The widths at which a sticking rotor is looked for."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from usmbench.model.effects.base import Context
from usmbench.model.effects.dead_zone_hysteresis import AtRest, Sticking
from usmbench.model.hammerstein import LinearPart, StaticCurve

WINDOW_S = 0.01
KNOTS_DEG = np.linspace(-90.0, 90.0, 91)
# Edges of the dead zone that differ, as those of a real motor do.
BEYOND_DEG = np.maximum(KNOTS_DEG - 13.0, 0.0) + np.minimum(KNOTS_DEG + 14.0, 0.0)
CURVE = StaticCurve(KNOTS_DEG, 9.0 * np.tanh(BEYOND_DEG / 40.0))
LINEAR = LinearPart(np.array([-0.05]), np.array([0.6, 0.35]), 0, WINDOW_S)


def context_of(levels_deg: list[float]) -> Context:
    """Return a staircase up, down and up again."""
    stairs = sorted(levels_deg)
    phase_deg = np.repeat([0.0, *stairs, *stairs[::-1], *stairs], 5)
    t_s = WINDOW_S * np.arange(1.0, phase_deg.size + 1.0)
    return Context(t_s, WINDOW_S, phase_deg, CURVE.speed_rad_s, LINEAR)


@settings(deadline=None, max_examples=50)
@given(
    st.lists(st.integers(-90, 90), min_size=4, max_size=19, unique=True).filter(
        lambda levels: max(map(abs, levels)) > 30
    ),
    st.floats(0.05, 60.0),
    st.sampled_from([Sticking(), AtRest()]),
)
def test_of_a_staircase_every_set_of_starts_is_tried(
    levels_deg: list[int], later_deg: float, effect: Sticking
) -> None:
    context = context_of([float(level) for level in levels_deg])
    settled = context.settled_rad_s(context.phase_deg)
    (tried,) = effect.grid([context]).values()
    wanted = effect.apply(settled, context, {"start_later_deg": later_deg})
    found = [effect.apply(settled, context, {"start_later_deg": float(x)}) for x in tried]
    ends = np.min(np.abs(later_deg - _ends(context))) < 0.02  # where a rounded width may differ
    assert ends or later_deg > tried[-1] or any(np.array_equal(f, wanted) for f in found)


def _ends(context: Context) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """Widths at which a level starts no more, by a search along the curve."""
    fine = np.linspace(0.0, 90.0, 90001)
    least = 0.01 * np.max(np.abs(context.settled_rad_s(context.phase_deg)))
    edges = {
        way: fine[np.argmax(np.abs(CURVE.speed_rad_s(way * fine)) > least)] for way in (-1.0, 1.0)
    }
    return np.array([abs(p) - edges[1.0 if p > 0 else -1.0] for p in context.phase_deg])


def test_where_the_phases_are_many_or_nothing_runs_a_few_widths_are_tried() -> None:
    many = Context(
        WINDOW_S * np.arange(1.0, 501.0),
        WINDOW_S,
        np.linspace(-90, 90, 500),
        CURVE.speed_rad_s,
        LINEAR,
    )
    for context in (many, context_of([0.0])):
        (tried,) = Sticking().grid([context]).values()
        assert tried.size == 30
        assert np.all(np.diff(tried) > 0.0)
