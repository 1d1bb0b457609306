"""Whether a run that is to be taken up was measured by the plan that its run.yaml has now."""

from itertools import dropwhile
from pathlib import Path
from typing import Final

import numpy as np

from usmbench.errors import InputError
from usmbench.runs.columns import PAIRS_FILE, RUN_FILE
from usmbench.runs.csv_table import has_names, read_table
from usmbench.settings.plan import Plan
from usmbench.sweep.schedule import WARM_UP, Dwell, schedule

_SETTING: Final = ("phase_deg", "frequency_hz", "torque_nm")


def check_same_plan(folder: Path, plan: Plan, window_s: float) -> None:
    """Refuse a plan whose dwells are not those that a run has measured.

    Parameters
    ----------
    folder
        The run folder.
    plan
        The plan by which it is to go on.
    window_s
        Duration of a window.

    Raises
    ------
    usmbench.errors.InputError
        A pair belongs to no dwell of the plan, or pairs.csv cannot be read.
    """
    path, columns = folder / PAIRS_FILE, (*_SETTING, "dwell")
    if not has_names(path):
        return
    table = read_table(path, needed=columns, numbers=columns, whole_rows=True, may_be_empty=True)
    measured = np.column_stack([table.columns[name].astype(np.float64) for name in columns])
    planned = dropwhile(lambda dwell: dwell.number == WARM_UP, schedule(plan, window_s))
    dwell: Dwell | None = next(planned, None)
    for *setting, number in measured.tolist():
        while dwell is not None and dwell.number < number:
            dwell = next(planned, None)
        own = () if dwell is None else (dwell.phase_deg, dwell.frequency_hz, dwell.torque_nm)
        if len(own) != len(setting) or not np.allclose(own, setting, rtol=1e-9, atol=1e-9):
            raise InputError(
                f"the plan in it is not the one that was measured: dwell {number:.0f} of "
                f"{PAIRS_FILE} is at φ = {setting[0]:g}°, {setting[1]:g} Hz, {setting[2]:g} N·m; "
                "put the plan back as it was, or sweep the new one into a folder of its own",
                file=folder / RUN_FILE,
            )
