"""Why no experiment is proposed, and what one is worth."""

from collections.abc import Callable
from dataclasses import replace

from usmbench.diagnose.result import Diagnosis
from usmbench.report.experiment_text import odds_of, why_no_experiment

Make = Callable[..., Diagnosis]


def test_causes_that_stay_open_are_not_said_to_be_decided(make_diagnosis: Make) -> None:
    open_, alone = make_diagnosis(), replace(make_diagnosis().causes[0], alternatives=())
    assert "within what this model knows" in why_no_experiment(open_)
    assert "second drive frequency" in why_no_experiment(open_)
    assert "no causes are left" in why_no_experiment(make_diagnosis(causes=(alone,)))


def test_a_model_of_no_known_frequency_is_what_stands_in_the_way(make_diagnosis: Make) -> None:
    found = make_diagnosis()
    (point,) = found.extended.points
    anywhere = replace(found.extended, points=(replace(point, frequency_hz=None),))
    assert "a column frequency_hz" in why_no_experiment(replace(found, extended=anywhere))


def test_odds_are_never_certain() -> None:
    odds = odds_of({"odds_before": 0.001, "odds_after": 0.9999})
    assert odds is not None
    assert [o.replace("\N{NO-BREAK SPACE}", " ") for o in odds] == [
        "less than 1 %",
        "more than 99 %",
    ]
    assert odds_of({"says": "x"}) is None
