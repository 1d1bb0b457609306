"""The NI-DAQmx driver that a card is reached by."""

from typing import Final

import nidaqmx
from nidaqmx.system import System

from usmbench.instruments.deadline import run_within
from usmbench.instruments.nidaq_channel import DeadlineChannel
from usmbench.instruments.nidaq_errors import opening_error
from usmbench.settings.bench import DaqSettings

_TIMEOUT_S: Final = 20.0


def driver_version(settings: DaqSettings) -> str:
    """Return the version of the driver, on this computer or behind the device server.

    Parameters
    ----------
    settings
        The card.

    Raises
    ------
    usmbench.errors.InputError
        There is no driver, or no server answers at the address.
    """
    try:
        return run_within(_TIMEOUT_S, lambda: _ask(settings.address))
    except Exception as error:
        raise opening_error(error, settings) from error


def _ask(address: str | None) -> str:
    if address is None:
        version = System.local().driver_version
    else:
        channel = DeadlineChannel(address, 0.0)
        try:
            version = System.remote(nidaqmx.GrpcSessionOptions(channel, "")).driver_version
        finally:
            channel.close()
    return ".".join(str(part) for part in version)
