"""What NI-DAQmx and its gRPC layer raise, in the words of the bench."""

import grpc
from nidaqmx import errors as ni

from usmbench.errors import DaqError, InputError, NoDataError
from usmbench.settings.bench import DaqSettings

SAMPLES_OVERWRITTEN = -200279
SAMPLES_NOT_YET_AVAILABLE = -200284
UNKNOWN_DEVICE = -200220
UNKNOWN_CHANNEL = -200170
RESOURCE_RESERVED = -50103

BEGIN_AGAIN = "begin again (a sweep goes on by sweep --resume)"

_MEND = {
    UNKNOWN_DEVICE: "give the name that NI MAX shows for the card",
    UNKNOWN_CHANNEL: "give a counter and channels that the card has",
    RESOURCE_RESERVED: "close the other program that uses the card",
}


def where(settings: DaqSettings) -> str:
    """Return how messages name the card.

    Parameters
    ----------
    settings
        The card's settings.
    """
    return settings.device if settings.address is None else f"{settings.device}@{settings.address}"


def opening_error(error: Exception, settings: DaqSettings) -> InputError:
    """Return what to tell a user whose card cannot be opened.

    Parameters
    ----------
    error
        What the driver raised.
    settings
        The card's settings.
    """
    if isinstance(error, (ni.DaqNotFoundError, ni.DaqNotSupportedError)):
        return InputError(
            "the NI-DAQmx driver is not installed on this computer: install it, or set daq.address "
            "to an NI gRPC device server, or use --bench simulated"
        )
    if isinstance(error, ni.DaqError):
        mend = _MEND.get(error.error_code, "correct the daq section of the bench file")
        return InputError(
            f"{where(settings)}: {_first_line(error)} (NI-DAQmx {error.error_code}); {mend}"
        )
    if isinstance(error, (ni.RpcError, grpc.RpcError, TimeoutError)) and settings.address:
        return InputError(
            f"no NI gRPC device server answers at daq.address {settings.address}: start it, or "
            "correct the address"
        )
    return InputError(
        f"{where(settings)} cannot be opened ({type(error).__name__}: {_first_line(error)}): check "
        "the card in NI MAX, then the daq section of the bench file"
    )


def running_error(error: Exception, settings: DaqSettings) -> DaqError:
    """Return what to tell a user whose acquisition failed.

    Parameters
    ----------
    error
        What the driver raised.
    settings
        The card's settings.
    """
    if isinstance(error, DaqError):
        return error
    if isinstance(error, ni.DaqError):
        return _driver_error(error, settings)
    if isinstance(error, (ni.RpcError, grpc.RpcError, TimeoutError)) and settings.address:
        return DaqError(
            f"the NI gRPC device server at {settings.address} no longer answers: start it again, "
            f"then {BEGIN_AGAIN}"
        )
    return DaqError(
        f"{where(settings)}: the acquisition failed ({type(error).__name__}: "
        f"{_first_line(error)}); {BEGIN_AGAIN}, and report this where it comes again"
    )


def _driver_error(error: ni.DaqError, settings: DaqSettings) -> DaqError:
    code: int = error.error_code
    if code == SAMPLES_OVERWRITTEN:
        return DaqError(
            f"{where(settings)}: buffer overflow, samples were lost before they were read "
            f"(NI-DAQmx {code}); close what keeps the computer busy or lower daq.sample_rate_hz",
            code=code,
        )
    if code == SAMPLES_NOT_YET_AVAILABLE:
        return NoDataError(
            f"{where(settings)}: a read timed out (NI-DAQmx {code}); check that the sample clock "
            f"{settings.sample_clock!r} runs",
            code=code,
        )
    mend = _MEND.get(code, f"check the card in NI MAX, then {BEGIN_AGAIN}")
    return DaqError(f"{where(settings)}: {_first_line(error)} (NI-DAQmx {code}); {mend}", code=code)


def _first_line(error: Exception) -> str:
    lines = str(error).strip().splitlines()
    return lines[0].rstrip(".") if lines else type(error).__name__
