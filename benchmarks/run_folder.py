"""What the run folder costs: to append a window, to end a dwell, to read a long run.

    python benchmarks/run_folder.py [--small]

The folder is made in the system's folder for temporary files, or in --folder.
"""

import argparse
import tempfile
import time
from pathlib import Path

from usmbench.runs.reader import read_run
from usmbench.runs.writer import RunWriter
from usmbench.sweep.rows import PairRow, WindowRow

WINDOWS_PER_DWELL = 1000


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


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--small", action="store_true", help="20 000 windows, not a million")
    parser.add_argument("--folder", type=Path, help="where to make the run folder")
    arguments = parser.parse_args()
    n_windows = 20_000 if arguments.small else 1_000_000
    with tempfile.TemporaryDirectory(dir=arguments.folder) as parent:
        folder = Path(parent) / "run"
        window_s, pair_s = write(folder, n_windows)
        size_mb = (folder / "windows.csv").stat().st_size / 1e6
        wall_s, cpu_s = time.perf_counter(), time.process_time()
        run = read_run(folder)
        wall_s, cpu_s = time.perf_counter() - wall_s, time.process_time() - cpu_s
    print(f"append a window:            {window_s * 1e6:.1f} µs of CPU")
    print(f"end a dwell, two files forced to disk: {pair_s * 1e3:.2f} ms")
    print(f"read {len(run.t_s)} windows, {size_mb:.0f} MB: {cpu_s:.2f} s of CPU, {wall_s:.2f} s")


if __name__ == "__main__":
    main()
