"""What other tools get is the same run and the same dynamics."""

import importlib
from pathlib import Path

import control
import numpy as np
import pytest
from scipy.io import loadmat
from scipy.signal import dlsim

from usmbench.errors import InputError
from usmbench.model.hammerstein import (
    HammersteinModel,
    LinearPart,
    OperatingPoint,
    StaticCurve,
)
from usmbench.model.interop import to_control, to_pandas, to_scipy, to_xarray, write_mat
from usmbench.model.linear import from_rest
from usmbench.runs.record import Record

LINEAR = LinearPart(np.array([-0.3]), np.array([0.4, 0.2, 0.1]), 2, 0.01)
INPUT = np.random.default_rng(0).standard_normal(40)


@pytest.fixture
def record() -> Record:
    t_s = 0.01 * np.arange(1.0, 6.0)
    return Record("run", t_s, 10.0 * t_s, t_s**2, np.full(5, 0.01), torque_nm=np.full(5, 0.1))


def test_scipy_runs_the_same_dynamics() -> None:
    system = to_scipy(LINEAR)
    output = np.ravel(dlsim((system.num, system.den, system.dt), INPUT)[1])
    assert system.dt == 0.01
    assert np.allclose(output, from_rest(LINEAR.b, LINEAR.a, 2, INPUT), atol=1e-12)


def test_control_runs_the_same_dynamics() -> None:
    system = to_control(LINEAR)
    assert system.dt == 0.01
    response = control.forced_response(system, inputs=INPUT)
    assert np.allclose(response.outputs, from_rest(LINEAR.b, LINEAR.a, 2, INPUT), atol=1e-12)


def test_the_paper_s_first_order_is_the_textbook_s() -> None:
    system = to_control(LinearPart(np.array([-0.5]), np.array([0.5]), 0, 0.01))
    assert system.poles() == pytest.approx([0.5])
    assert system.dcgain() == pytest.approx(1.0)


def test_pandas_has_the_run_s_columns_and_no_others(record: Record) -> None:
    table = to_pandas(record)
    assert list(table.columns) == ["phase_deg", "speed_rad_s", "window_s", "torque_nm"]
    assert table.index.name == "t_s"
    assert table["speed_rad_s"].to_numpy().tolist() == record.speed_rad_s.tolist()


def test_xarray_carries_the_units(record: Record) -> None:
    data = to_xarray(record)
    assert data["torque_nm"].attrs["units"] == "N·m"
    assert data["phase_deg"].dims == ("t_s",)
    assert data.attrs["name"] == "run"


def test_matlab_reads_back_run_and_model(record: Record, tmp_path: Path) -> None:
    curve = StaticCurve(np.array([-90.0, 0.0, 90.0]), np.array([-1.0, 0.0, 1.0]))
    point = OperatingPoint(41e3, None, curve, (-90.0, 90.0), (None, None), 0.1)
    path = tmp_path / "both.mat"
    write_mat(path, record, HammersteinModel(LINEAR, (point, point), "fast"))
    content = loadmat(path, simplify_cells=True)
    assert content["run"]["phase_deg"].tolist() == record.phase_deg.tolist()
    assert content["model"]["b"].tolist() == LINEAR.b.tolist()
    assert content["model"]["points"][1]["knots_deg"].tolist() == [-90.0, 0.0, 90.0]
    assert np.isnan(content["model"]["points"][0]["torque_nm"])


def test_a_folder_that_is_none_is_refused(record: Record, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be written"):
        write_mat(tmp_path / "none" / "run.mat", record)


def test_a_missing_package_is_named(record: Record, monkeypatch: pytest.MonkeyPatch) -> None:
    def without(name: str) -> object:
        raise ImportError(name)

    monkeypatch.setattr(importlib, "import_module", without)
    with pytest.raises(InputError, match=r"pandas is not installed; .* usmbench\[interop\]"):
        to_pandas(record)
