"""A bench that is open for a command."""

import pytest

from usmbench.cli.bench_session import open_bench
from usmbench.errors import LostCountsError
from usmbench.settings.bench import SIMULATED


def test_what_else_failed_where_counts_were_lost_is_told_too() -> None:
    lost = LostCountsError("40 counts off", code=3)
    lost.add_note("switching the outputs off failed: no answer")
    with (
        pytest.raises(
            LostCountsError, match=r"^40 counts off \(the simulated.*it prints\)"
        ) as told,
        open_bench(SIMULATED),
    ):
        raise lost
    assert told.value.__notes__ == ["switching the outputs off failed: no answer"]
    assert told.value.code == 3
