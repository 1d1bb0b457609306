"""The plot of ``replay --plot``: measurement, free run, and what lies between them."""

from pathlib import Path

from matplotlib.figure import Figure

from usmbench.model.replay import Replay
from usmbench.report.drawing import save_figure, shown_time
from usmbench.report.plain_text import short_name
from usmbench.runs.record import Record


def write_replay_plot(path: Path, record: Record, replay: Replay) -> None:
    """Write the plot in the format that the file's name asks for.

    Parameters
    ----------
    path
        The file: .png, .svg, .pdf.
    record
        The run.
    replay
        Its replay.

    Raises
    ------
    InputError
        The file cannot be written, or its format is unknown.
    """
    figure = Figure(figsize=(9.0, 6.0), layout="constrained")
    top, bottom = figure.subplots(2, 1, sharex=True, height_ratios=(3.0, 1.0))
    inside = replay.simulation.inside
    speed_rad_s, error_rad_s = (
        record.speed_rad_s,
        record.speed_rad_s - replay.simulation.speed_rad_s,
    )
    t_s, label = shown_time(record)
    # Apart in grey too: pale points under a thin dark line.
    top.plot(t_s, speed_rad_s, "o", ms=4, mec="none", color="0.65", label="measured")
    top.plot(t_s, replay.simulation.speed_rad_s, lw=0.8, color="#0b3070", label="free run")
    outside_s = t_s[~inside]
    if outside_s.size:
        top.plot(
            outside_s,
            replay.simulation.speed_rad_s[~inside],
            "x",
            ms=4,
            color="C3",
            label="outside the model's range",
        )
    top.set_ylabel("speed ω (rad/s)")
    top.legend(loc="best", frameon=False)
    fit = "" if replay.fit_percent is None else f", fit {replay.fit_percent:.1f} %"
    name = short_name(record.name)
    top.set_title(f"{name}: RMSE {replay.rmse_rad_s:.3g} rad/s{fit}", parse_math=False)
    bottom.plot(t_s[inside], error_rad_s[inside], ".", ms=2, color="0.3")
    bottom.axhline(0.0, lw=0.6, color="0.3")
    bottom.set_ylabel("residual (rad/s)")
    bottom.set_xlabel(label)
    save_figure(figure, path)
