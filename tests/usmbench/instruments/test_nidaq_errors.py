import grpc
import pytest
from nidaqmx import errors as ni

from usmbench.errors import DaqError, NoDataError
from usmbench.instruments.nidaq_errors import opening_error, running_error
from usmbench.settings.bench import DaqSettings

LOCAL = DaqSettings(device="Dev3")
REMOTE = DaqSettings(device="Dev3", address="127.0.0.1:31763")
UNAVAILABLE = ni.RpcError(grpc.StatusCode.UNAVAILABLE.value[0], "Failed to connect to server")


@pytest.mark.parametrize(
    ("error", "settings", "says"),
    [
        (ni.DaqNotFoundError("Could not find an installation"), LOCAL, "not installed"),
        (ni.DaqNotSupportedError("NI-DAQmx Python is not supported"), LOCAL, "not installed"),
        (ni.DaqError("Device identifier is invalid.", -200220), LOCAL, "Dev3.*-200220.*NI MAX"),
        (ni.DaqError("Physical channel does not exist.", -200170), LOCAL, "counter and channels"),
        (ni.DaqError("Resource is reserved.", -50103), LOCAL, "close the other program"),
        (ni.DaqError("Something else.", -201000), LOCAL, "correct the daq section"),
        (UNAVAILABLE, REMOTE, "no NI gRPC device server answers at daq.address 127.0.0.1:31763"),
        (TimeoutError(), REMOTE, "no NI gRPC device server"),
        (TimeoutError(), LOCAL, "Dev3 cannot be opened"),
    ],
)
def test_opening(error: Exception, settings: DaqSettings, says: str) -> None:
    told = opening_error(error, settings)
    assert told.exit_status == 2
    assert "\n" not in str(told)
    with pytest.raises(type(told), match=says):
        raise told


@pytest.mark.parametrize(
    ("error", "settings", "says", "code"),
    [
        (ni.DaqReadError("Overwritten.", -200279, 0), LOCAL, "buffer overflow", -200279),
        (ni.DaqReadError("Not yet.", -200284, 0), LOCAL, "sample clock 'ai' runs", -200284),
        (
            ni.DaqError("Reset.\n\nTask Name: x", -200557),
            LOCAL,
            "Reset .*-200557.*then begin again",
            -200557,
        ),
        (UNAVAILABLE, REMOTE, "127.0.0.1:31763 no longer .*then begin again", None),
        (TimeoutError(), REMOTE, "no longer answers", None),
        (ZeroDivisionError("by zero"), LOCAL, "ZeroDivisionError: by zero.*; begin again", None),
        (ZeroDivisionError(), LOCAL, "ZeroDivisionError: ZeroDivisionError", None),
    ],
)
def test_running(error: Exception, settings: DaqSettings, says: str, code: int | None) -> None:
    told = running_error(error, settings)
    assert told.exit_status == 3
    assert told.code == code
    assert "\n" not in str(told)
    with pytest.raises(DaqError, match=says):
        raise told


def test_a_read_that_timed_out_is_missing_data() -> None:
    told = running_error(ni.DaqReadError("Not yet.", -200284, 0), LOCAL)
    assert isinstance(told, NoDataError)


def test_our_own_errors_pass() -> None:
    told = NoDataError("no data")
    assert running_error(told, LOCAL) is told
