import pytest

from benchmarks.fault_campaign import Outcome, campaign, judge, run_draw
from hil_sim.faults import Fault, FaultKind


def test_every_drawn_fault_ends_as_it_must() -> None:
    outcomes = campaign(draws=40, seed=20, jobs=1, through_wire=0)
    assert [o.complaints for o in outcomes if o.complaints] == []
    assert len({o.fault.kind for o in outcomes}) >= 8


@pytest.mark.parametrize("number", range(4))
def test_faults_over_the_wire_end_as_they_must(number: int) -> None:
    outcome = run_draw(number, seed=21, through_wire=4)
    assert outcome.complaints == []


def test_a_drive_left_on_is_complained_of(tmp_path_factory: pytest.TempPathFactory) -> None:
    class StuckOn:
        """A testbed whose drive never goes off."""

        class Drive:
            amplitude_a = amplitude_b = 1.0

        drive_history = ((0.1, Drive()),)
        time_s = 9.0

        def idle(self, duration_s: float) -> None:
            pass

    class Nothing:
        rows: tuple[()] = ()

    outcome = Outcome(Fault(FaultKind.PORT_GONE, 1.0), status=3, message="the port has gone")
    judge(outcome, StuckOn(), Nothing(), tmp_path_factory.mktemp("run"))  # type: ignore[arg-type]
    assert any("drive off only after inf" in complaint for complaint in outcome.complaints)
