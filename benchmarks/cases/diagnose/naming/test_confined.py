"""What is off in a part of the runs only."""

from known_motor import applied, measured
from usmbench.diagnose.pipeline import diagnose
from usmbench.model.hammerstein import HammersteinModel


def test_a_diagnosis_tells_it_rather_than_the_views(model: HammersteinModel) -> None:
    record, plain = measured(51, applied("phase_offset", "", offset_deg=1.5)), measured(51)
    share = record.t_s / record.t_s[-1]
    away = (share <= 0.3) | (share > 0.7)
    record.speed_rad_s[away] = plain.speed_rad_s[away]
    found = diagnose([record], model)
    assert (found.verdict, found.causes) == ("unexplained", ())
    assert found.remainder is not None
    assert found.remainder.versus == "time"
