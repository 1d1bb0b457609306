"""The frame log: every exchange on the line as text, with its time and its meaning."""

from collections.abc import Callable, Sequence
from typing import TextIO

from usmbench.errors import BenchError
from usmbench.instruments.protocol.frames import Frame
from usmbench.instruments.protocol.messages import describe


def log_error(stream: TextIO, error: OSError) -> BenchError:
    """Return what the user is told when the log cannot be written.

    Parameters
    ----------
    stream
        The log.
    error
        What the system said.
    """
    # A stream in memory has no name.
    return BenchError(
        f"{getattr(stream, 'name', '-')}: the frame log cannot be written "
        f"({error.strerror or error}); free some space, or leave the log out"
    )


class FrameLog:
    """Writes one line for each write to and each read from the port, until the stream fails.

    A line has the seconds since the first one, ``>`` to the board or ``<`` from it, the bytes in
    hexadecimal, and the frames that end in them.

    Parameters
    ----------
    stream
        Where the lines go.
    clock
        Seconds, on the port's own time.
    """

    def __init__(self, stream: TextIO, clock: Callable[[], float]):
        self._stream = stream
        self._clock = clock
        self._start_s = clock()
        self._failed = False

    def sent(self, data: bytes, frame: Frame) -> None:
        """Log what was written.

        Parameters
        ----------
        data
            The bytes, as on the line.
        frame
            The frame they carry.
        """
        self._line(">", data, [describe(frame)])

    def received(self, data: bytes, frames: Sequence[Frame], n_bad: int) -> None:
        """Log what was read.

        Parameters
        ----------
        data
            The bytes, as they came; a frame may take several reads.
        frames
            The frames they completed.
        n_bad
            How many bad frames they completed.
        """
        meanings = [describe(frame) for frame in frames]
        if n_bad:
            meanings.append(f"bad frames: {n_bad}")
        self._line("<", data, meanings)

    def _line(self, direction: str, data: bytes, meanings: Sequence[str]) -> None:
        # A full disk is told of once: what is sent after it, to switch off, needs no log.
        if self._failed:
            return
        time_s = self._clock() - self._start_s
        line = f"{time_s:12.6f} {direction} {data.hex(' ')}  {'; '.join(meanings)}"
        try:
            self._stream.write(line.rstrip() + "\n")
        except OSError as error:
            self._failed = True
            raise log_error(self._stream, error) from error
