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
