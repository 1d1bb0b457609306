"""Runs that say nothing about a model, or do not belong together, are refused."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from usmbench.errors import InputError
from usmbench.model.hammerstein import HammersteinModel
from usmbench.model.same_windows import check_windows
from usmbench.runs.check_record import check_numbers
from usmbench.runs.doubtful_units import doubtful_units
from usmbench.runs.record import Record

FEWEST_WINDOWS = 60
_MOVES, _SELDOM = 0.01, 0.01  # of the model's highest speed; of the rows
_STANDS = 0.02  # of the model's root mean square: a count now and then, or a channel that is dead
_TURNS_RAD_S = 1.0  # an encoder of 500 lines then counts three times in a window of 10 ms


def check_run(record: Record, model: HammersteinModel) -> None:
    """Refuse numbers that are none, and windows of another length.

    Parameters
    ----------
    record
        The run.
    model
        The model that it is held against.

    Raises
    ------
    usmbench.errors.InputError
        The run is one of these, or too short.
    """
    check_numbers(record)
    if record.t_s.size < FEWEST_WINDOWS:
        raise InputError(
            f"{record.name}: {record.t_s.size} windows say nothing about causes; measure at least "
            f"{FEWEST_WINDOWS}"
        )
    check_windows(record.name, record.usual_window_s, model.linear)


def check_driven(record: Record) -> None:
    """Refuse a run whose motor was not driven.

    Parameters
    ----------
    record
        The run.

    Raises
    ------
    usmbench.errors.InputError
        It says so of every window.
    """
    if record.driven is not None and not np.any(record.driven):
        raise InputError(
            f"{record.name}: its drive_on says that the drive was off in every window; diagnose a "
            "run that was driven"
        )


def check_outside(record: Record, outside: NDArray[np.bool_], warnings: list[str]) -> None:
    """Refuse a run mostly outside the model's range; warn of a few rows.

    Parameters
    ----------
    record
        The run.
    outside
        Rows beyond the phases, frequencies or torques that the model knows, shape (N,).
    warnings
        What the user ought to know, to be added to.

    Raises
    ------
    usmbench.errors.InputError
        More than half of the rows are.
    """
    share = float(np.mean(outside))
    if share > 0.5:
        raise InputError(
            f"{record.name}: {100.0 * share:.0f} % of the rows lie outside the phases, frequencies "
            "or torques that the model was identified on; diagnose a run within them, or identify "
            "a model on a run like this one"
        )
    if share > 0.0:
        warnings.append(
            f"{record.name}: {np.count_nonzero(outside)} rows lie outside the model's range and "
            "are not judged"
        )


def check_moves(record: Record, simulated_rad_s: Sequence[NDArray[np.float64]]) -> None:
    """Refuse a run in which nothing moves, or nothing changes, though the motor should turn.

    Parameters
    ----------
    record
        The run.
    simulated_rad_s
        The model's speed on its stretches, shape (N,) each.

    Raises
    ------
    usmbench.errors.InputError
        As good as every speed is 0, or all are the same.
    """
    simulated = np.concatenate([*simulated_rad_s, np.empty(0)])
    fastest_rad_s = float(np.max(np.abs(simulated), initial=0.0))
    if fastest_rad_s <= _TURNS_RAD_S:
        return
    measured = record.speed_rad_s
    least_rad_s, changes_rad_s = _MOVES * fastest_rad_s, float(np.std(simulated))
    moves = float(np.mean(np.abs(measured) > least_rad_s))
    stands = changes_rad_s > least_rad_s and float(np.std(measured)) < _STANDS * changes_rad_s
    if stands and np.abs(np.mean(measured)) > least_rad_s:
        raise InputError(
            f"{record.name}: the speed is {np.mean(measured):.3g} rad/s throughout whatever the "
            "phase; is the counter still read?"
        )
    if stands or moves < _SELDOM:
        raise InputError(
            f"{record.name}: the speed is 0 throughout where the model turns; is the encoder "
            "connected, and was the drive on?"
        )


def check_enough(records: Sequence[Record], n_usable: int) -> None:
    """Refuse runs of which too little can be judged.

    Parameters
    ----------
    records
        The runs.
    n_usable
        Windows that can be.

    Raises
    ------
    usmbench.errors.InputError
        They are too few.
    """
    if n_usable < FEWEST_WINDOWS:
        todo = "; ".join(doubtful_units(records)) or "measure for longer"
        raise InputError(
            f"{records[0].name}: fewer than {FEWEST_WINDOWS} usable windows say nothing about "
            f"causes; {todo}"
        )
