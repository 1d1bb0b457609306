"""In which order causes are told."""

import pytest

from usmbench.diagnose.evidence import NamedCause, strongest_first


def named(name: str, gain: float) -> NamedCause:
    return NamedCause(name, "", "", "", (), (), 1e-9, gain)


@pytest.mark.parametrize(
    ("gains", "order"),
    [
        ((0.5, 0.4), "ab"),
        ((0.3, 0.5), "ab"),  # no more than chance may make of it
        ((0.1, 0.5), "ba"),
        ((0.0, 0.0), "ab"),
        ((0.1, 0.2, 0.7), "cab"),
        ((0.9,), "a"),
    ],
)
def test_a_cause_that_plainly_gains_most_comes_first(gains: tuple[float, ...], order: str) -> None:
    causes = [named(name, gain) for name, gain in zip("abc", gains, strict=False)]
    assert "".join(cause.name for cause in strongest_first(causes)) == order
