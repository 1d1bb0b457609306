"""What the run folder costs, beside pandas: to append a window, to end a dwell, to read a long run.

    python benchmarks/run_folder.py [--small]

pandas appends with ``DataFrame.to_csv(mode="a")``, row by row as they are measured (a sample of
them) and all at once, which a power cut would lose; it reads with ``read_csv``. The folder is made
in the system's folder for temporary files, or in --folder.
"""

import argparse
import tempfile
import time
from pathlib import Path

import pandas as pd

from usmbench.runs.reader import read_run
from usmbench.runs.writer import RunWriter
from usmbench.sweep.rows import PairRow, WindowRow

WINDOWS_PER_DWELL = 1000
PANDAS_ROWS = 2000


def write(folder: Path, n_windows: int) -> tuple[float, float]:
    """Write a run; return CPU seconds of a window and wall seconds of a pair, forced to disk.

    Parameters
    ----------
    folder
        The run folder to make.
    n_windows
        Windows to write.
    """
    encoder = {"counts_per_rev": 2000, "sample_rate_hz": 100e3, "samples_per_average": 1000}
    meta = {"motor": "none", "encoder": encoder}
    writer = RunWriter.create(folder, meta, temperature=True, raw=False)
    windows_s = pairs_s = 0.0
    for dwell in range(n_windows // WINDOWS_PER_DWELL):
        first = dwell * WINDOWS_PER_DWELL
        rows = [
            WindowRow(
                t_s=k * 0.01,
                phase_deg=dwell % 181 - 90.0,
                speed_rad_s=10.0 / (1.0 + k % 97),
                frequency_hz=41_000.0,
                torque_nm=0.1,
                angle_rad=k / 30.0,
                window_s=0.01,
                sweep=dwell // 181,
                settled=1,
                average_rad_s=10.0 / (1.0 + k % 89),
                drive_on=1,
                temperature_c=25.0 + k * 1e-6,
            )
            for k in range(first + 1, first + WINDOWS_PER_DWELL + 1)
        ]
        started_s = time.process_time()
        for row in rows:
            writer.window(row)
        windows_s += time.process_time() - started_s
        started_s = time.perf_counter()
        writer.pair(
            PairRow(
                phase_deg=rows[-1].phase_deg,
                frequency_hz=41_000.0,
                torque_nm=0.1,
                speed_rad_s=5.0,
                speed_std_rad_s=0.1,
                n_windows=WINDOWS_PER_DWELL,
                direction=1,
                t_s=rows[-1].t_s,
                dwell=dwell,
                settled=1,
            )
        )
        pairs_s += time.perf_counter() - started_s
    writer.close("completed")
    return windows_s / n_windows, pairs_s / (n_windows // WINDOWS_PER_DWELL)


def pandas_append(table: pd.DataFrame, file: Path) -> tuple[float, float]:
    """Return CPU seconds of a window that pandas appends by itself, and among all others.

    Parameters
    ----------
    table
        The windows.
    file
        The CSV file to write.
    """
    sample = [table.iloc[[k]] for k in range(min(len(table), PANDAS_ROWS))]
    started_s = time.process_time()
    for row in sample:
        row.to_csv(file, mode="a", header=False, index=False, float_format="%.12g")
    one_s = (time.process_time() - started_s) / len(sample)
    file.unlink()
    started_s = time.process_time()
    table.to_csv(file, index=False, float_format="%.12g")
    return one_s, (time.process_time() - started_s) / len(table)


def reading(file: Path) -> tuple[float, float]:
    """Return CPU seconds to read a run folder, and its windows alone with pandas.

    Parameters
    ----------
    file
        The run's windows.csv.
    """
    started_s = time.process_time()
    run = read_run(file.parent)
    ours_s = time.process_time() - started_s
    started_s = time.process_time()
    table = pd.read_csv(file)
    theirs_s = time.process_time() - started_s
    assert table["speed_rad_s"].to_numpy().tolist() == run.speed_rad_s.tolist()
    return ours_s, theirs_s


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--small", action="store_true", help="20 000 windows, not a million")
    parser.add_argument("--folder", type=Path, help="where to make the run folder")
    options = parser.parse_args(arguments)
    n_windows = 20_000 if options.small else 1_000_000
    with tempfile.TemporaryDirectory(dir=options.folder) as parent:
        folder = Path(parent) / "run"
        window_s, pair_s = write(folder, n_windows)
        windows = folder / "windows.csv"
        size_mb = windows.stat().st_size / 1e6
        ours_s, theirs_s = (
            min(times) for times in zip(*(reading(windows) for _ in range(3)), strict=True)
        )
        one_s, all_s = pandas_append(pd.read_csv(windows), Path(parent) / "pandas.csv")
    print(f"append a window: {window_s * 1e6:.1f} µs of CPU, flushed to the system at once")
    print(f"  pandas, row by row: {one_s * 1e6:.0f} µs; all at once: {all_s * 1e6:.1f} µs")
    print(f"end a dwell, two files forced to disk: {pair_s * 1e3:.2f} ms")
    print(f"read {n_windows} windows, {size_mb:.0f} MB: {ours_s:.2f} s of CPU, checked")
    print(f"  pandas, read_csv: {theirs_s:.2f} s")


if __name__ == "__main__":
    main()
