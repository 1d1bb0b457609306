"""Rows of windows.csv and pairs.csv as text.

Numbers are written with 12 significant digits (a relative error of at most 5e-12): a day of time
stamps to the microsecond, a day of angle at full speed to the microradian.
"""

from usmbench.sweep.rows import PairRow, WindowRow


def window_text(row: WindowRow, *, temperature: bool) -> str:
    """Return a row of windows.csv, without its line end.

    Parameters
    ----------
    row
        The window.
    temperature
        Whether the file has a column for it.
    """
    text = (
        f"{row.t_s:.12g},{row.phase_deg:.12g},{row.speed_rad_s:.12g},{row.frequency_hz:.12g},"
        f"{row.torque_nm:.12g},{row.angle_rad:.12g},{row.window_s:.12g},{row.sweep:d},"
        f"{row.settled:d},{row.average_rad_s:.12g},{row.drive_on:d}"
    )
    if not temperature:
        return text
    return text + (",nan" if row.temperature_c is None else f",{row.temperature_c:.12g}")


def pair_text(row: PairRow) -> str:
    """Return a row of pairs.csv, without its line end.

    Parameters
    ----------
    row
        The pair.
    """
    return (
        f"{row.phase_deg:.12g},{row.frequency_hz:.12g},{row.torque_nm:.12g},"
        f"{row.speed_rad_s:.12g},{row.speed_std_rad_s:.12g},{row.n_windows:d},"
        f"{row.direction:d},{row.t_s:.12g},{row.dwell:d},{row.settled:d}"
    )
