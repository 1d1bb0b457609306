"""Records that others have measured, diagnosed by the commands that a user runs.

    python benchmarks/diagnosis_real.py --data DIR

DIR is that of `benchmarks/identification_real.py`. The tachometer of the coupled drives is blind to
the sign of the speed, and so is a model that is identified on what it shows. The first 400 rows are
identified (of third order: the drives' belt rings) and diagnosed, the last 100 replayed with both
models; published for them is a polynomial NARX model with 0.10 and 0.141 ticks/s. The DC motor is
faster backwards: its forward dwells, and their mirror image, make a simulation that is symmetric.
"""

import argparse
import contextlib
import io
import json
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.identification_real import Split, error, splits
from usmbench.cli.main import main as usmbench
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.model.model_file import read_model, write_model
from usmbench.runs.record import Record

PUBLISHED = (0.10, 0.141)
_AVERAGED = 5  # rows of the DC motor's record


def blind(split: Split, folder: Path) -> tuple[list[dict[str, Any]], float, float]:
    """Identify and diagnose the rows of the coupled drives that are not held out.

    Parameters
    ----------
    split
        The record.
    folder
        Where files go.

    Returns
    -------
    causes, before, after
        What is named, and the errors of the free run of the identified and of the extended model
        over the held-out rows.
    """
    run, model, extended = (folder / name for name in ("run.csv", "model.yaml", "extended.yaml"))
    _write(run, split.record, ~split.held)
    _command("identify", run, "--na", "3", "--nb", "2", "--out", model)
    causes = _diagnosed(run, model, "--out", extended)
    before, after = (error(split, read_model(file), split.held) for file in (model, extended))
    return causes, before, after


def lopsided(split: Split, folder: Path) -> list[dict[str, Any]]:
    """Return what is named of the DC motor's run against a simulation of its forward half.

    Parameters
    ----------
    split
        The record.
    folder
        Where files go.
    """
    run, model = folder / "run.csv", folder / "model.yaml"
    record = _averaged(split.record)
    _write(run, record, np.ones(record.t_s.size, dtype=np.bool_))
    # A voltage makes a current, and that a speed: two lags.
    found = identify_fast(_both_ways(record), FastOptions(degree=18, na=2, nb=2))
    write_model(model, found.model)
    return _diagnosed(run, model)


def _averaged(record: Record) -> Record:
    """Average over windows of a few rows: neighbours say the same."""
    whole = record.t_s.size // _AVERAGED * _AVERAGED
    t_s, phase_deg, speed_rad_s, window_s = (
        column[:whole].reshape(-1, _AVERAGED)
        for column in (record.t_s, record.phase_deg, record.speed_rad_s, record.window_s)
    )
    volts, speeds = phase_deg.mean(axis=1), speed_rad_s.mean(axis=1)
    return Record(record.name, t_s[:, -1], volts, speeds, window_s.sum(axis=1))


def _both_ways(record: Record) -> list[Record]:
    """Return the stretches without a negative voltage, and their mirror images."""
    dwell = np.cumsum(np.diff(record.phase_deg, prepend=0.0) != 0.0)
    forward = ~np.isin(dwell, dwell[record.phase_deg < 0.0])
    return [
        Record(
            name,
            record.t_s[forward],
            sign * record.phase_deg[forward],
            sign * record.speed_rad_s[forward],
            record.window_s[forward],
        )
        for name, sign in (("forward", 1.0), ("mirrored", -1.0))
    ]


def _write(file: Path, record: Record, rows: NDArray[np.bool_]) -> None:
    """Write rows of a record as a bare CSV."""
    table = np.column_stack([record.t_s, record.phase_deg, record.speed_rad_s])[rows]
    head = "t_s,phase_deg,speed_rad_s"
    np.savetxt(file, table, fmt="%.9g", delimiter=",", header=head, comments="")


def _diagnosed(run: Path, model: Path, *more: str | Path) -> list[dict[str, Any]]:
    """Return the causes that the command names."""
    said = run.with_name("diagnosis.json")
    _command("diagnose", run, "--model", model, "--json", said, *more)
    causes: list[dict[str, Any]] = json.loads(said.read_text())["causes"]
    return causes


def _command(*words: str | Path) -> None:
    """Run a usmbench command in this process, silently."""
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        status = usmbench([str(word) for word in words])
    if status:
        raise RuntimeError(f"usmbench {words[0]} left with {status}")


def _named(causes: Sequence[dict[str, Any]]) -> str:
    """Say what is named."""
    return "; ".join(" or ".join([c["name"], *c["alternatives"]]) for c in causes) or "nothing"


def main() -> None:
    """Print what is named, and the errors."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, required=True, metavar="DIR")
    args = parser.parse_args()
    motor, *drives = splits(args.data)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        print(f"{motor.name}: {_named(lopsided(motor, folder))}")
        for split, published in zip(drives, PUBLISHED, strict=True):
            causes, before, after = blind(split, folder)
            print(
                f"{split.name}: {_named(causes)}; last 100 rows {before:.3f}, extended "
                f"{after:.3f} {split.unit} (published {published:g})",
                flush=True,
            )


if __name__ == "__main__":
    main()
