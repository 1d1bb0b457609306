from itertools import pairwise
from pathlib import Path

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from usmbench.errors import InputError
from usmbench.settings.plan import Plan, Settle, WarmUp
from usmbench.settings.plan_file import load_plan, parse_plan, shipped_plans
from usmbench.settings.yaml_source import Source, parse_source

HEAD = "format: usmbench-plan/1\nfrequency_hz: 41000\n"


def plan_of(text: str) -> Plan:
    return parse_plan(parse_source(HEAD + text, "plan.yaml"))


def test_a_plan_is_read_with_everything_it_says() -> None:
    plan = plan_of(
        """
name: all of it
torque_nm: [0, 0.1]
load: operator
outer: frequency_hz
warm_up: {phase_deg: 90, duration_s: 10, frequency_hz: 40500}
passes:
  - {phase_deg: [10, 0, 20], direction: as_listed, repeats: 3}
  - {phase_deg: {from: 90, to: -90, step: 45}, direction: both}
dwell: {windows: 30, extend_to_windows: 60, settle: {min_windows: 4, over_windows: 6}}
limits: {overspeed_rad_s: 12}
"""
    )
    assert plan.name == "all of it"
    assert (plan.frequency_hz, plan.torque_nm) == ((41000.0,), (0.0, 0.1))
    assert plan.ask_operator
    assert plan.outer == "frequency_hz"
    assert plan.warm_up == WarmUp(90.0, 10.0, 40500.0)
    assert plan.passes[0].phase_deg == (10.0, 0.0, 20.0)
    assert plan.passes[0].repeats == 3
    assert plan.passes[1].phase_deg == (90.0, 45.0, 0.0, -45.0, -90.0)
    assert plan.dwell.settle == Settle(4, 6)
    assert (plan.dwell.windows, plan.dwell.extend_to_windows) == (30, 60)
    assert plan.limits.overspeed_rad_s == 12


PASS = "passes: [{phase_deg: [0, 10]}]\n"


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("passes:\n  - phase_deg: [0, 300]\n", 4, "passes[0].phase_deg[1]: 300 is above 180"),
        ("passes:\n  - phase_deg: {from: 0, to: 10, step: 3}\n", 4, "choose 3.33333"),
        ("passes:\n  - phase_deg: {from: 0, to: 180, step: 0.001}\n", 4, "larger step"),
        ("passes:\n  - phase_dge: [0]\n", 4, "unknown key; did you mean phase_deg?"),
        ("passes:\n  - direction: both\n", 4, "has no key phase_deg; add it"),
        ("passes:\n  - phase_deg: 3\n", 4, "list of phases in degrees, or a range"),
        ("passes: []\n", 3, "has 0 entries; give at least 1"),
        ("passes:\n  - {phase_deg: [0], direction: up}\n", 4, "choose from: rising, falling"),
        ("passes:\n  - {phase_deg: [0], repeats: 2.5}\n", 4, "2.5 is not a whole number"),
        (PASS + "torque_nm: [0, 1]\n", 4, "add load: operator"),
        (PASS + "dwell: {windows: 15}\n", 4, "choose at least 16"),
        (PASS + "dwell: {windows: 50, extend_to_windows: 40}\n", 4, "choose at least 50"),
        (PASS + "dwell:\n  settle:\n    relative: 41e3\n", 6, "write 41000.0"),
        (PASS + "dwell:\n  settle:\n    relative: 1e-300\n", 6, "write 1.0e-300"),
        (PASS + "excitation: {kind: telegraph, amplitude_deg: 9, duration_s: 1}\n", 1, "both"),
        ("name: nothing\n", 1, "neither passes nor excitation"),
        (PASS + "limits: {overspeed_rad_s: 0}\n", 4, "0 is not above 0; choose more than 0"),
        (PASS + "name: ''\n", 4, "has 0 characters; give at least 1"),
        (PASS + f"name: {'x' * 101}\n", 4, "has 101 characters; give at most 100"),
    ],
)
def test_what_is_wrong_is_named_with_its_line_and_the_mend(
    text: str, line: int, words: str
) -> None:
    with pytest.raises(InputError) as caught:
        plan_of(text)
    assert caught.value.line == line
    assert words in str(caught.value)


EXCITATION = "excitation:\n  kind: {kind}\n  amplitude_deg: 90\n  duration_s: 10\n  "


@pytest.mark.parametrize(
    ("kind", "line", "words"),
    [
        ("telegraph", "centre_deg: 100", "choose at most 80"),
        ("telegraph", "band_hz: [1, 2]", "means nothing for telegraph"),
        ("multisine", "levels: 3", "means nothing for multisine"),
        ("multisine", "band_hz: [2, 1]", "lower frequency first"),
        ("square", "seed: 1", "choose from: telegraph, multisine"),
    ],
)
def test_an_excitation_that_cannot_be(kind: str, line: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        plan_of(EXCITATION.format(kind=kind) + line)


def test_another_format_is_named_before_its_consequences() -> None:
    with pytest.raises(InputError, match=r"plan.yaml:2: format: .* write usmbench-plan/1"):
        parse_plan(parse_source("alien: 1\nformat: usmbench-plan/9\n", "plan.yaml"))
    with pytest.raises(InputError, match="add format: usmbench-plan/1"):
        parse_plan(parse_source("frequency_hz: 41000\n", "plan.yaml"))


@given(
    start=st.integers(-180, 180),
    steps=st.integers(1, 400),
    step=st.sampled_from([0.1, 0.25, 0.5, 1.0, 5.0]),
    falling=st.booleans(),
)
@settings(deadline=None)
def test_a_range_has_both_ends_and_even_steps(
    start: int, steps: int, step: float, falling: bool
) -> None:
    end = round(start + (-1 if falling else 1) * steps * step, 6)
    if not -180 <= end <= 180:
        return
    phases = plan_of(f"passes: [{{phase_deg: {{from: {start}, to: {end}, step: {step}}}}}]\n")
    driven = phases.passes[0].phase_deg
    assert (driven[0], driven[-1], len(driven)) == (start, end, steps + 1)
    assert all(abs(abs(b - a) - step) < 1e-9 for a, b in pairwise(driven))


WORDS = st.sampled_from(
    [
        "passes",
        "phase_deg",
        "from",
        "to",
        "step",
        "dwell",
        "windows",
        "settle",
        "excitation",
        "kind",
        "telegraph",
        "multisine",
        "amplitude_deg",
        "duration_s",
        "band_hz",
        "limits",
        "warm_up",
        "frequency_hz",
        "torque_nm",
        "load",
        "operator",
        "usmbench-plan/1",
        "both",
    ]
)
TREES = st.recursive(
    st.none() | st.integers() | st.floats() | WORDS | st.booleans(),
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(WORDS | st.just("format"), inner, max_size=5)
    ),
    max_leaves=15,
)


@given(TREES)
@settings(deadline=None, max_examples=150)
def test_any_document_is_a_plan_or_bad_input(document: object) -> None:
    given_plan = {"format": "usmbench-plan/1", "frequency_hz": 41000, "passes": PASS}
    if isinstance(document, dict):
        document = given_plan | document
    try:
        parse_plan(parse_source(yaml.safe_dump(document), "plan.yaml"))
    except InputError as error:
        message = str(error)
    else:
        message = ""
    assert "\n" not in message


def test_the_plans_that_ship_are_plans() -> None:
    assert "phase-sweep" in shipped_plans()
    for name in shipped_plans():
        assert load_plan(name).name == name


def test_a_file_goes_before_a_plan_that_ships(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("phase-sweep").write_text(HEAD + PASS + "name: mine\n")
    assert load_plan("phase-sweep").name == "mine"


def test_an_unknown_plan_is_met_with_the_nearest() -> None:
    with pytest.raises(InputError, match="did you mean phase-sweep"):
        load_plan("phase-swep")
    with pytest.raises(InputError, match="choose from: multisine"):
        load_plan("xyz.yaml")


def test_a_plan_survives_the_run_folder() -> None:
    plan = load_plan("operating-points")
    again = parse_plan(Source("run.yaml", yaml.safe_load(yaml.safe_dump(plan.source.document))))
    assert again.passes == plan.passes
    assert again.warm_up == plan.warm_up
