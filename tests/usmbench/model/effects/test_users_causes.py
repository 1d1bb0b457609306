"""A user's cause that will not do is told in one line, where it is loaded or where it fails."""

from pathlib import Path

import numpy as np
import pytest

from usmbench.errors import CauseError
from usmbench.model.effects.base import DynamicsEffect, Effect, Values
from usmbench.model.effects.context import Context
from usmbench.model.effects.declared import check_declared
from usmbench.model.effects.lone_windows import LoneWindows, SporadicEffect, Weighed
from usmbench.model.effects.parameter import Parameter
from usmbench.model.effects.registry import find_effect, library
from usmbench.model.effects.trial import made_up_run, try_out
from usmbench.model.hammerstein import LinearPart

SIZE = Parameter("size", "1", 0.0, -1.0, 1.0, 0.01)
DOES = 'return signal * (1.0 - values["slowed_by"] * braked)'
GRID = 'return {"until_s": np.linspace(0.05, 0.95, 19) * end_s}'
MEANS = '    meaning = "The motor is slower until a moment at which it comes free."\n'
MEND = '    mend = "Look whether the brake was on when the run started."\n'
NAME = '    name = "brake_left_on"\n'
ONE = "FORMS = (BrakeLeftOn(),)"

SPOILT = [
    (
        "braked = context",
        'raise KeyError("oops\\n!")\n        braked = context',
        r"brake_left_on, line 22\): apply raised KeyError",
    ),
    (DOES, "raise SystemExit(0)", "apply raised SystemExit"),
    (ONE, "raise SystemExit(0)", "cannot be loaded: SystemExit"),
    (DOES, "return signal[:-1]", r"apply returns an array of shape \(5999,\) where"),
    (DOES, "return 0.0", r"apply returns 0\.0 where one of shape \(6000,\)"),
    (DOES, "pass", "apply returns None where"),
    (DOES, "return signal * np.nan", "apply returns nan in row 0"),
    (DOES, "return signal * 1j", "apply returns complex128 where real numbers"),
    (DOES, "signal *= 0.5\n        return signal", "apply changes in place what it is given"),
    (
        DOES,
        "context.t_s[0] = 1.0\n        return signal",
        "apply changes in place what it is given",
    ),
    (
        DOES,
        "return 0.9 * signal",
        "changes the signal by 0.1 of its size where every parameter is null",
    ),
    (NAME, "", r"cause BrakeLeftOn \(my_bench.brake_left_on\): it has no name"),
    (NAME, '    name = "Brake <b>\\nleft"\n', r"BrakeLeftOn .*its name is 'Brake <b>\\nleft'"),
    (NAME, "    name = 3\n", "its name is 3: give it lower-case words"),
    (
        NAME,
        '    name = "phase_offset"\n',
        r"named phase_offset, as is that of usmbench.*phase_offset:",
    ),
    (MEANS, "", "it has no meaning"),
    (MEANS, '    meaning = "a\\nb"\n', "it has no meaning, one line of text"),
    (MEND, "", "it has no mend"),
    (MEND, MEND + "    form = 3\n", "its form is 3"),
    (MEND, MEND + "    form_off = -1.0\n", r"its form_off is -1\.0"),
    (MEND, MEND + "    sporadic = True\n", "no SporadicEffect"),
    (MEND, MEND + "    waves = (1,)\n", "one of its waves names no two"),
    ('    stage = "settled"\n', "", "it has no stage: choose from command, settled"),
    ('"settled"', '"gearbox"', "its stage is 'gearbox': choose from command, settled"),
    ('"settled"', '"dynamics"', "it is no DynamicsEffect"),
    ("parameters = (", "sizes = (", "it has no tuple of parameters"),
    ('"until_s", "s"', '"slowed_by", "s"', "two parameters of one name"),
    ('"slowed_by", "1"', '"Slowed by", "1"', "'Slowed by' is named by no"),
    ("0.0, 0.0, 0.9, 0.01", "0.0, 0.1, 0.9, 0.01", "slowed_by is 0, outside 0.1 to 0.9"),
    ("0.0, 0.0, 0.9, 0.01", "0.0, 0.9, 0.0, 0.01", "no range from 0.9 to 0"),
    ("0.0, 0.0, 0.9, 0.01", "0.0, 0.0, 0.9, 0.0", "typical of its parameter slowed_by is 0"),
    ("0.0, 0.0, 0.9, 0.01", '0.0, 0.0, "0.9", 0.01', "of its parameter slowed_by is no number"),
    ("0.0, 0.0, 0.9, 0.01", "0.0, 0.0, float('inf'), 0.01", "slowed_by is no number"),
    ("def grid", "def other", "until_s is scanned, and it has no grid"),
    (GRID, "return [1, 2]", r"grid returns \[1, 2\] where a dict of the scanned \(until_s\)"),
    (GRID, "return {}", r"grid returns \{\} where"),
    (GRID, 'return {"until_s": []}', "grid returns no values for until_s"),
    (GRID, 'return {"until_s": [2.0, 1.0]}', "grid returns values for until_s that do not rise"),
    (GRID, 'return {"until_s": ["a"]}', "grid returns could not convert"),
    (ONE, "    def untestable(self, _):\n        return 3\n" + ONE, "untestable returns 3 where"),
    (ONE, "    def habitual(self, _):\n        return 1 / 0\n" + ONE, "habitual raised ZeroDiv"),
    (ONE, "    def built_in(self, _):\n        return {}\n" + ONE, r"built_in returns \{\} where"),
    (ONE, "FORMS = (BrakeLeftOn,)", r"write BrakeLeftOn\(\) for BrakeLeftOn"),
    (ONE, "FORMS = (BrakeLeftOn(), BrakeLeftOn())", "the same form of brake_left_on twice"),
]


def _spoil(file: Path, old: str, new: str) -> None:
    text = file.read_text("utf-8")
    assert text.count(old) == 1
    file.write_text(text.replace(old, new), "utf-8")


@pytest.mark.parametrize(("old", "new", "words"), SPOILT)
def test_what_will_not_do_is_told_by_its_name(
    users_cause: Path, old: str, new: str, words: str
) -> None:
    _spoil(users_cause, old, new)
    with pytest.raises(CauseError, match=words) as caught:
        library()
    said = str(caught.value)
    assert "\n" not in said
    assert "brake_left_on" in said
    assert "my_bench" in said


def test_a_cause_may_take_several_forms(users_cause: Path) -> None:
    other = 'class Late(BrakeLeftOn):\n    form = "late"\n\n\nFORMS = (BrakeLeftOn(), Late())'
    _spoil(users_cause, ONE, other)
    assert find_effect("brake_left_on", "late") is not find_effect("brake_left_on", "")
    names = [effect.name for effect in library()]
    assert names == sorted(names)


def test_what_runs_cannot_show_is_not_tried_on_one(users_cause: Path) -> None:
    why = '    def untestable(self, _):\n        return "no run shows it"\n\n\n' + ONE
    _spoil(users_cause, ONE, why)
    _spoil(users_cause, DOES, "return 0.0")
    assert find_effect("brake_left_on", "").untestable([]) == "no run shows it"


def test_what_fails_later_is_told_too(users_cause: Path) -> None:
    late = "if context.n < 100:\n            raise KeyError('oops')\n        " + DOES
    _spoil(users_cause, DOES, late)
    effect, context = find_effect("brake_left_on", ""), made_up_run()
    short = Context(
        context.t_s[:50], 0.01, context.phase_deg[:50], context.settled_rad_s, context.linear
    )
    with pytest.raises(
        CauseError, match=r"brake_left_on \(my_bench.brake_left_on, line 24\): appl"
    ):
        effect.apply(np.ones(50), short, {"slowed_by": 0.1, "until_s": 1.0})


def test_a_signal_that_comes_back_may_be_changed_by_the_next(users_cause: Path) -> None:
    _spoil(users_cause, DOES, "return signal[:]")
    values, signal = {"slowed_by": 0.0, "until_s": 1.0}, np.ones(6000)
    after = find_effect("brake_left_on", "").apply(signal, made_up_run(), values)
    after *= 2.0
    assert np.all(signal == 1.0)


@pytest.mark.parametrize("effect", library(), ids=lambda e: f"{e.name} {e.form}".strip())
def test_what_ships_is_nothing_that_would_be_refused(effect: Effect) -> None:
    check_declared(effect)
    try_out(effect)


class _Stiff(DynamicsEffect):
    name = "stiff"
    meaning = mend = "None."
    parameters = (SIZE,)

    def linear_part(self, linear: LinearPart, context: Context, values: Values) -> LinearPart:
        return LinearPart(linear.a, linear.b * np.nan, 0, 0.01)


class _NoPart(_Stiff):
    def linear_part(self, linear: LinearPart, context: Context, values: Values) -> LinearPart:
        return None  # type: ignore[return-value]


class _Struck(SporadicEffect):
    name = "struck"
    meaning = mend = "None."
    parameters = (Parameter("rate_hz", "Hz", 0.0, 0.0, 100.0, 0.1),)

    def apply(self, signal: np.ndarray, context: Context, values: Values) -> np.ndarray:
        return signal

    def weigh(self, windows: LoneWindows) -> Weighed:
        return 0.0  # type: ignore[return-value]


@pytest.mark.parametrize(
    ("effect", "words"),
    [
        (_Stiff(), "linear_part returns a linear part whose a or b are no numbers"),
        (_NoPart(), "linear_part returns None where a LinearPart is wanted"),
        (_Struck(), "weigh returns no Weighed"),
    ],
)
def test_other_kinds_of_cause_are_tried_too(effect: Effect, words: str) -> None:
    check_declared(effect)
    with pytest.raises(CauseError, match=words):
        try_out(effect)


def test_a_cause_that_strikes_by_chance_says_how_often() -> None:
    class NoRate(_Struck):
        parameters = (SIZE,)

    with pytest.raises(CauseError, match="has no parameter rate_hz"):
        check_declared(NoRate())
