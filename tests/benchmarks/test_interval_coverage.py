"""The small version: intervals hold the truth, of shapes that trade with a size, too."""

from benchmarks.interval_coverage import draws
from usmbench.model.effects.registry import find_effect


def test_every_draw_says_of_each_parameter_whether_it_was_held() -> None:
    (cause, inside), *_ = draws(1, 1000, 5)
    effect = find_effect(*cause.split(" ", 1))
    assert set(inside) == {p.name for p in effect.parameters}
