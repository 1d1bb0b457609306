"""A small run of the diagnosis' time benchmark."""

import pytest

from benchmarks import diagnosis_time


@pytest.mark.parametrize("options", [[], ["--identified", "--limited"]])
def test_a_short_run_is_diagnosed_in_time(
    options: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert diagnosis_time.main(["--small", *options]) == 0
    n_windows, cpu_s, *_, verdict, cause = capsys.readouterr().out.splitlines()[-1].split()
    assert (n_windows, verdict, cause) == ("2000", "explained", "gain_asymmetry")
    assert float(cpu_s) < 5.0


def test_what_has_no_name_takes_the_longest_and_gets_none(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert diagnosis_time.main(["--small", "--identified", "--unnamed"]) == 0
    n_windows, cpu_s, *_, verdict = capsys.readouterr().out.splitlines()[-1].split()
    assert (n_windows, verdict) == ("2000", "unexplained")
    assert float(cpu_s) < 5.0
