"""Reading runs: what was written comes back, what is missing is derived, what is wrong is named."""

from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from usmbench.errors import InputError
from usmbench.runs.reader import read_run
from usmbench.runs.writer import RunWriter
from usmbench.sweep.rows import WindowRow

SETTINGS = settings(
    deadline=None,
    max_examples=60,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
PHASES_DEG = (0.0, 180.0, 180.5, 270.0, 360.0, -180.0, -270.0, -360.0)
finite = st.floats(-1e6, 1e6)


def csv_file(folder: Path, text: str) -> Path:
    path = folder / "bare.csv"
    path.write_text(text)
    return path


def run_folder(folder: Path, windows: str, run_yaml: str = "format: usmbench-run/1\n") -> Path:
    (folder / "windows.csv").write_text(windows)
    (folder / "run.yaml").write_text(run_yaml)
    return folder


rows = st.lists(
    st.builds(
        WindowRow,
        t_s=st.just(0.0),
        phase_deg=st.floats(-180.0, 180.0),
        speed_rad_s=finite,
        frequency_hz=st.floats(1.0, 1e5),
        torque_nm=finite,
        angle_rad=finite,
        window_s=st.floats(1e-4, 10.0),
        sweep=st.integers(-1, 999),
        settled=st.integers(0, 1),
        average_rad_s=finite,
        drive_on=st.integers(0, 1),
        temperature_c=st.none() | st.floats(-50.0, 150.0),
    ),
    min_size=1,
    max_size=8,
)


@given(rows)
@SETTINGS
def test_what_was_written_is_read_to_twelve_digits(
    tmp_path_factory: pytest.TempPathFactory, rows: list[WindowRow]
) -> None:
    folder = tmp_path_factory.mktemp("round") / "run"
    writer = RunWriter.create(
        folder, {"motor": "m", "encoder": {"lines": (500,)}}, temperature=True, raw=False
    )
    t_s = 86_400.0 + 0.01 * np.arange(len(rows))
    for row, time_s in zip(rows, t_s.tolist(), strict=True):
        values = {name: getattr(row, name) for name in WindowRow.__slots__}
        writer.window(WindowRow(**values | {"t_s": time_s}))
    writer.close("completed")
    run = read_run(folder)
    assert run.t_s == pytest.approx(t_s, rel=5e-12)
    for name in ("phase_deg", "speed_rad_s", "frequency_hz", "torque_nm", "angle_rad", "window_s"):
        written = np.array([getattr(row, name) for row in rows])
        assert getattr(run, name) == pytest.approx(written, rel=5e-12, abs=0.0)
    assert run.sweep is not None
    assert run.sweep.tolist() == [row.sweep for row in rows]
    assert run.temperature_c is not None
    warm = [np.nan if row.temperature_c is None else row.temperature_c for row in rows]
    assert run.temperature_c == pytest.approx(np.array(warm), rel=5e-12, nan_ok=True)
    assert run.extra["drive_on"].tolist() == [row.drive_on for row in rows]
    assert run.meta["encoder"] == {"lines": [500]}


ALPHABET = st.sampled_from(list("0123456789.,-+e\n\r\"' naif_\t\0é:{}[]&*!|>%@`#xt_sphase"))


@given(st.text(ALPHABET, max_size=60), st.text(ALPHABET, max_size=40))
@SETTINGS
def test_garbage_is_never_worse_than_an_input_error(
    tmp_path_factory: pytest.TempPathFactory, garbage: str, more: str
) -> None:
    folder = tmp_path_factory.mktemp("garbage")
    heads = "", "t_s,phase_deg,speed_rad_s\n", "phase_deg,speed_rad_s,note\n1,2,3\n"
    bare = folder / "bare.csv"
    for head in heads:
        for text in (head + garbage, head + garbage + more):
            bare.write_bytes(text.encode())
            run_folder(folder, head + garbage, "format: usmbench-run/1\n" + more)
            (folder / "pairs.csv").write_text(garbage)
            for path in (bare, folder):
                with suppress(InputError):
                    assert np.all(np.isfinite(read_run(path).speed_rad_s))


@given(st.binary(max_size=80))
@SETTINGS
def test_random_bytes_are_never_worse_than_an_input_error(
    tmp_path_factory: pytest.TempPathFactory, content: bytes
) -> None:
    folder = tmp_path_factory.mktemp("bytes")
    run_folder(folder, "t_s,phase_deg,speed_rad_s\n0.01,0,0\n")
    for name in ("windows.csv", "run.yaml"):
        whole = (folder / name).read_bytes()
        (folder / name).write_bytes(content)
        with pytest.raises(InputError):
            read_run(folder)
        (folder / name).write_bytes(whole)
    read_run(folder)


@given(st.integers(0, 10_000))
@SETTINGS
def test_a_run_cut_anywhere_is_read_to_its_last_whole_row(
    tmp_path_factory: pytest.TempPathFactory, cut: int
) -> None:
    head = "t_s,phase_deg,speed_rad_s\n"
    text = head + "".join(f"{0.01 * k:.2f},{k % 7},{0.125 * k}\n" for k in range(1, 200))
    kept = text[: len(head) + 10 + cut % (len(text) - len(head))]
    folder = run_folder(tmp_path_factory.mktemp("cut"), kept + "\0" * (cut % 3))
    whole = kept.count("\n") - 1
    if whole:
        assert read_run(folder).speed_rad_s.tolist() == [0.125 * k for k in range(1, whole + 1)]
    else:
        with pytest.raises(InputError, match="no rows"):
            read_run(folder)


@pytest.mark.parametrize("torn", ["", "2", "20", "20,", "20,-", "20,+", "20,.", "20,1e", "20,1e-"])
def test_a_bare_csv_that_breaks_off_is_read_to_its_last_whole_row(
    tmp_path: Path, torn: str
) -> None:
    run = read_run(csv_file(tmp_path, f"phase_deg,speed_rad_s\n10,1\n10,2\n{torn}"))
    assert run.speed_rad_s.tolist() == [1.0, 2.0]


@given(st.integers(0, 30))
@SETTINGS
def test_a_bare_csv_cut_in_a_number_of_fixed_decimals_ends_before_it(
    tmp_path_factory: pytest.TempPathFactory, cut: int
) -> None:
    whole = "phase_deg,speed_rad_s\n" + "".join(f"{k % 7}.00,{0.125 * k:.4f}\n" for k in range(90))
    kept = whole[: len(whole) - 1 - cut]
    run = read_run(csv_file(tmp_path_factory.mktemp("cut"), kept))
    rows = kept.splitlines()[1:]
    n = len(rows) if len(rows[-1].partition(".00,")[2].partition(".")[2]) == 4 else len(rows) - 1
    assert run.speed_rad_s.tolist() == [0.125 * k for k in range(n)]


@pytest.mark.parametrize("last", ["0.5", "2", "-1.25"])
def test_a_bare_csv_whose_decimals_vary_keeps_its_last_row(tmp_path: Path, last: str) -> None:
    rows = "".join(f"{k},{k / 4:g}\n" for k in range(20))
    run = read_run(csv_file(tmp_path, f"phase_deg,speed_rad_s\n{rows}3,{last}"))
    assert run.speed_rad_s[-1] == float(last)


def test_a_last_row_without_a_number_is_named_where_the_line_ends(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r":3: speed_rad_s is '-'"):
        read_run(csv_file(tmp_path, "phase_deg,speed_rad_s\n10,1\n20,-\n"))


def test_a_bare_csv_gets_time_windows_and_pairs(tmp_path: Path) -> None:
    run = read_run(csv_file(tmp_path, "phase_deg,speed_rad_s\n10,1\n10,2\n10,3\n20,5\n20,6\n20,7"))
    assert run.t_s == pytest.approx(0.01 * np.arange(1, 7))
    assert run.window_s == pytest.approx(np.full(6, 0.01))
    assert run.meta == {}
    assert run.frequency_hz is None
    assert run.pairs is not None
    assert run.pairs.speed_rad_s.tolist() == [2.5, 6.5]
    assert run.pairs.n_windows.tolist() == [2.0, 2.0]
    assert run.pairs.t_s == pytest.approx(np.array([0.03, 0.06]))


def test_the_window_comes_from_the_best_source(tmp_path: Path) -> None:
    timed = "t_s,phase_deg,speed_rad_s\n0.02,0,0\n0.04,0,0\n0.5,0,0\n0.52,0,0\n"
    assert read_run(csv_file(tmp_path, timed)).window_s[0] == pytest.approx(0.02)
    encoder = (
        "format: usmbench-run/1\nencoder: {samples_per_average: 1000, sample_rate_hz: 200000}\n"
    )
    assert read_run(run_folder(tmp_path, timed, encoder)).window_s[0] == pytest.approx(0.005)
    column = "t_s,phase_deg,speed_rad_s,window_s\n0.02,0,0,0.003\n"
    assert read_run(run_folder(tmp_path, column, encoder)).window_s[0] == pytest.approx(0.003)


def test_columns_of_the_users_own_are_kept(tmp_path: Path) -> None:
    text = 'phase_deg,"note, mine",speed_rad_s,volts\r\n1,"cold, wet",0.5,3\r\n2,,0.6,4\r\n'
    run = read_run(csv_file(tmp_path, text))
    assert run.speed_rad_s.tolist() == [0.5, 0.6]
    assert run.extra["note, mine"].tolist() == ["cold, wet", ""]
    assert run.extra["volts"].tolist() == [3.0, 4.0]


@pytest.mark.parametrize(
    ("text", "line", "says"),
    [
        ("phase,speed\n1,2\n", 1, "no column 'phase_deg'"),
        ("phase,speed\n1,2\n", 1, "among them; it is 'phase,speed'"),
        ("phase," + "x" * 90 + "\n1,2\n", 1, f"'phase,{'x' * 54}…'"),
        ("\x1b[31m\n1,2\n", 1, r"it is '\x1b[31m'"),
        ("# my bench\nphase_deg,speed_rad_s\n1,2\n", 1, "usmbench import` and its skip_lines"),
        ("Phase_deg,speed_rad_s\n1,2\n", 1, "write 'Phase_deg' in small letters"),
        ("phase_deg;speed_rad_s\n1,5;2\n", 1, "between semicolons: bring the file in with `usm"),
        ("phase_deg\tspeed_rad_s\n1\t2\n", 1, "between tabs: bring the file in with `usmbench"),
        ("phase_deg,speed_rad_s,phase_deg\n1,2,3\n", 1, "stands twice"),
        ("phase_deg,speed_rad_s\n1,2\n1,fast\n", 3, "speed_rad_s is 'fast'"),
        ("phase_deg,speed_rad_s\n1,2\n\n1,nan\n", 4, "speed_rad_s is nan"),
        ("phase_deg,speed_rad_s\n1,2\n1,1e999\n", 3, "speed_rad_s is inf"),
        ("phase_deg,speed_rad_s\n1,2\n1,2_0\n", 3, "'2_0', not a number"),
        ("phase_deg,speed_rad_s\n1,2\n1\n1,2\n", 3, "1 fields"),
        ("phase_deg,speed_rad_s,t_s\n1,2,0.1\n1,2,0.2\n1,2,0.2\n", 4, "t_s does not rise"),
        ("phase_deg,speed_rad_s,t_s,a\n1,2,0.1,x\n1,2,0.3,y\n1,2,0.2,z\n", 4, "t_s does not rise"),
        ("phase_deg,speed_rad_s,window_s\n1,2,0.1\n1,2,0\n", 3, "window_s is 0"),
        ("phase_deg,speed_rad_s\n1,2\n1e9,2\n", 3, "phase_deg is 1000000000, not -360 to 360"),
        ("phase_deg,speed_rad_s,frequency_hz\n1,2,-5\n", 2, "frequency_hz is -5, not 0 to 1e+12"),
        ("phase_deg,speed_rad_s\n1,2\n1,1e200\n", 3, "speed_rad_s is 1e+200, not -1e+12 to 1e+12"),
        ("phase_deg,speed_rad_s,settled\n1,2,1\n1,2,7\n", 3, "settled is 7, not 0 to 1"),
        ("phase_deg,speed_rad_s,drive_on\n1,2,1\n1,2,-1\n", 3, "drive_on is -1, not 0 to 1"),
        ("phase_deg,speed_rad_s,drive_on\n1,2,yes\n", 2, "drive_on is 'yes', not a number"),
    ],
)
def test_what_is_wrong_is_named_with_its_line(
    tmp_path: Path, text: str, line: int, says: str
) -> None:
    path = csv_file(tmp_path, text)
    with pytest.raises(InputError) as caught:
        read_run(path)
    assert str(caught.value).startswith(f"{path}:{line}: ")
    assert says in str(caught.value)


def test_phases_counted_from_0_to_360_are_wrapped(tmp_path: Path) -> None:
    rows = "".join(f"{k / 100},{phase},0\n" for k, phase in enumerate(PHASES_DEG, start=1))
    text = f"t_s,phase_deg,speed_rad_s\n{rows}"
    expected = [0.0, 180.0, -179.5, -90.0, 0.0, -180.0, 90.0, 0.0]
    folder = run_folder(tmp_path, text)
    head = "phase_deg,frequency_hz,torque_nm,speed_rad_s,speed_std_rad_s,n_windows,direction,t_s\n"
    (folder / "pairs.csv").write_text(f"{head}270,41000,0,-9,0.01,50,1,0.5\n")
    assert read_run(csv_file(tmp_path, text)).phase_deg.tolist() == expected
    run = read_run(folder)
    assert run.phase_deg.tolist() == expected
    assert run.pairs is not None
    assert run.pairs.phase_deg.tolist() == [-90.0]


def test_a_run_folder_needs_its_two_files(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"run\.yaml: cannot be read"):
        read_run(tmp_path)
    (tmp_path / "run.yaml").write_text("format: usmbench-run/1\n")
    with pytest.raises(InputError, match=r"windows\.csv: cannot be read"):
        read_run(tmp_path)
    with pytest.raises(InputError, match="cannot be read"):
        read_run(tmp_path / "absent")


def test_a_long_run_is_read_whole(tmp_path: Path) -> None:
    t_s = 0.01 * np.arange(1, 100_001)
    table = np.column_stack([t_s, np.floor(t_s) % 90, np.sin(t_s)])
    np.savetxt(
        tmp_path / "windows.csv",
        table,
        "%.9g",
        ",",
        header="t_s,phase_deg,speed_rad_s",
        comments="",
    )
    (tmp_path / "run.yaml").write_text("format: usmbench-run/1\n")
    run = read_run(tmp_path)
    assert len(run.t_s) == 100_000
    assert run.pairs is not None
    assert len(run.pairs.t_s) == pytest.approx(1001, abs=1)


@pytest.mark.parametrize(("begins_s", "first_s"), [(1.7e9, 0.01), (-1e6, 0.01), (120.0, 120.0)])
def test_a_clocks_time_is_counted_from_the_first_row(
    tmp_path: Path, begins_s: float, first_s: float
) -> None:
    rows = "".join(f"{begins_s + 0.01 * k:.2f},{k},{k}\n" for k in range(20))
    (tmp_path / "clock.csv").write_text("t_s,phase_deg,speed_rad_s\n" + rows)
    record = read_run(tmp_path / "clock.csv")
    assert record.t_s[0] == pytest.approx(first_s, abs=1e-5)
    assert record.t_s[-1] - record.t_s[0] == pytest.approx(0.19, abs=1e-5)


def test_files_that_are_not_what_they_were_are_known(
    tmp_path: Path, fill: Callable[[RunWriter, int, int], None]
) -> None:
    folder = tmp_path / "run"
    writer = RunWriter.create(folder, {}, temperature=False, raw=False)
    fill(writer, 0, 3)
    assert read_run(folder).changed == ()
    writer.close("completed")
    assert read_run(folder).changed == ()
    windows, pairs = folder / "windows.csv", folder / "pairs.csv"
    windows.write_bytes(windows.read_bytes()[:-200])
    assert read_run(folder).changed == ("windows.csv",)
    pairs.unlink()
    assert read_run(folder).changed == ("windows.csv", "pairs.csv")


def test_sums_that_are_none_are_no_reason_not_to_read(tmp_path: Path) -> None:
    said = "format: usmbench-run/1\nsha256: unknown\n"
    folder = run_folder(tmp_path, "t_s,phase_deg,speed_rad_s\n0.01,1,2\n", said)
    assert read_run(folder).changed == ()
