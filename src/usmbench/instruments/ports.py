"""Serial ports: opening one, and finding the one the board is on."""

import errno
import sys
import time
from collections.abc import Iterable
from contextlib import suppress
from typing import Final

import serial
from serial.tools import list_ports

from usmbench.errors import BoardError, InputError, PortError
from usmbench.instruments.board_link import REPLY_TIMEOUT_S, BoardLink
from usmbench.instruments.protocol._generated import BAUD, RequestType

# Other instruments are on the other ports: ask briefly, and once more for a frame lost to noise.
_SEARCH_TRIES: Final = 2
_WRITE_TIMEOUT_S: Final = 0.2

_MENDS: Final = {
    errno.ENOENT: "plug the board in, or correct the port",
    errno.EACCES: "you may not use this port; on Linux join the group dialout",
    errno.EAGAIN: "another program has this port open; close it",
    errno.EBUSY: "another program has this port open; close it",
}


def port_names() -> list[str]:
    """Return the names of this computer's serial ports, sorted."""
    return sorted(str(port.device) for port in list_ports.comports())


def open_port(name: str) -> serial.Serial:
    """Open a serial port for the board alone, in low-latency mode where the adapter has it.

    Parameters
    ----------
    name
        Such as /dev/ttyUSB0 or COM3.

    Returns
    -------
    serial.Serial
        The open port.

    Raises
    ------
    usmbench.errors.InputError
        It cannot be opened; the message lists the ports there are.
    """
    port = serial.Serial(
        baudrate=BAUD, timeout=REPLY_TIMEOUT_S, write_timeout=_WRITE_TIMEOUT_S, exclusive=True
    )
    # An edge on DTR or RTS restarts many other instruments, and a search opens their ports too.
    port.dtr = False
    port.rts = False
    port.port = name
    try:
        port.open()
    except OSError as error:
        mend = _MENDS.get(error.errno or 0, "check generator.port in the bench file")
        there = ", ".join(port_names()) or "none"
        raise InputError(
            f"serial port {name} cannot be opened ({error}): {mend}. Serial ports here: {there}"
        ) from error
    if sys.platform == "linux":  # pyserial knows the mode nowhere else
        with suppress(ValueError):  # nor has every adapter one
            port.set_low_latency_mode(True)
    return port


def find_board(extra_names: Iterable[str] = ()) -> str:
    """Ask every serial port who it is; only identify is sent.

    Parameters
    ----------
    extra_names
        Ports to ask beside those the system lists, such as pseudo-terminals.

    Returns
    -------
    str
        The port a board answered on.

    Raises
    ------
    usmbench.errors.InputError
        No board answered, or several did.
    """
    answers = {name: _why_no_board(name) for name in [*port_names(), *extra_names]}
    boards = [name for name, reason in answers.items() if reason is None]
    if len(boards) == 1:
        return boards[0]
    if boards:
        raise InputError(
            f"signal generator boards answer on {' and '.join(boards)}: "
            "say which one in the bench file (generator.port)"
        )
    asked = "; ".join(f"{name}: {reason}" for name, reason in answers.items())
    raise InputError(
        "no signal generator board answers: connect it and switch it on, or name its port in the "
        f"bench file (generator.port). {asked or 'This computer has no serial port'}"
    )


def _why_no_board(name: str) -> str | None:
    """Ask one port; None where a board answers."""
    try:
        link = BoardLink(open_port(name), clock=time.monotonic, tries=_SEARCH_TRIES)
    except InputError:
        return "cannot be opened"
    try:
        link.request(RequestType.IDENTIFY)
    except PortError:
        return "has gone"
    except BoardError:
        return "no board answers"
    finally:
        link.close()
    return None
