"""What the generator driver asks of a serial port: the part of pyserial's Serial it uses."""

from typing import Protocol


class SerialPort(Protocol):
    """A byte stream with a read time-out; `serial.Serial` is one, the simulated port another."""

    timeout: float | None

    @property
    def name(self) -> str | None:
        """The port's name, for messages."""

    @property
    def in_waiting(self) -> int:
        """Bytes that a read returns at once."""

    def read(self, size: int = 1, /) -> bytes:
        """Return up to `size` bytes, fewer when `timeout` seconds pass first."""

    def write(self, data: bytes, /) -> int | None:
        """Send bytes; `OSError` (pyserial's SerialException is one) where the port is gone."""

    def close(self) -> None:
        """Release the port."""
