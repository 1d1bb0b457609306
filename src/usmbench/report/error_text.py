"""What the errors and the noise of a diagnosis say, and what of them is news."""

from usmbench.diagnose.naming.remainder import LOUD
from usmbench.diagnose.result import Diagnosis
from usmbench.report.numbers_text import number, spelled, times

_NO_NEWS = "the simulation misses as much on its own runs, or healthy runs differ by as much"


def noise_note(diagnosis: Diagnosis) -> str:
    """Return what the noise is beside an error that is larger without being news.

    Parameters
    ----------
    diagnosis
        The diagnosis.
    """
    if diagnosis.rmse_extended_rad_s > diagnosis.noise_floor_rad_s:
        return "what a simulation without any error would leave far from steps"
    return "all that is left"


def what_is_left(diagnosis: Diagnosis) -> str:
    """Return what the simulation, with the named causes in it, leaves.

    Parameters
    ----------
    diagnosis
        The diagnosis.
    """
    if diagnosis.remainder is not None:
        return f"Something is left: {diagnosis.remainder.says}."
    left = f"{number(diagnosis.rmse_extended_rad_s)} rad/s"
    noise = f"{number(diagnosis.noise_floor_rad_s)} rad/s"
    if left == noise:
        return f"The {left} that are left are the bench's noise."
    beyond = max((view.excess_after for view in diagnosis.views), default=0.0)
    news = "and no figure above leaves its grey band"
    if beyond > 1.0:
        news = (
            f"and what a figure above shows beyond its grey band ({times(beyond)} at the most) is "
            "little beside what was there, or chance"
        )
    where = f"{left} are left, where the bench's noise far from steps is {noise}."
    if diagnosis.left_over <= LOUD:
        return f"{where} The difference is no news: {_NO_NEWS}, {news}."
    usual = f"That is {times(diagnosis.left_over)} what the simulation misses on its own runs."
    struck = [spelled(cause.name) for cause in diagnosis.causes if cause.by_chance]
    if struck:
        return (
            f"{where} {usual} No simulation foresees which windows {' and '.join(struck)} "
            "strikes: they count in full."
        )
    return (
        f"{where} {usual} No test tells it from what may differ between days, {news}: of these "
        "runs the simulation is no better than that."
    )
