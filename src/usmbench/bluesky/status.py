"""What a device hands out for something that takes time: bluesky's Status protocol."""

import threading
from collections.abc import Callable

from usmbench.errors import BenchError


class DeviceStatus:
    """Done once, with or without an error; `bluesky.protocols.Status`."""

    def __init__(self) -> None:
        self._ended = threading.Event()
        self._error: BaseException | None = None
        self._lock = threading.Lock()
        self._callbacks: list[Callable[[DeviceStatus], None]] = []

    def __repr__(self) -> str:
        """Say how it stands; bluesky shows this where a plan fails."""
        state = "under way" if not self.done else "failed" if self._error else "done"
        return f"<status {state}{f': {self._error}' if self._error else ''}>"

    def end(self, error: BaseException | None = None) -> None:
        """Say that it is done; the first time counts.

        Parameters
        ----------
        error
            Why it failed, or None.
        """
        with self._lock:
            if self._ended.is_set():
                return
            self._error = error
            self._ended.set()
            callbacks, self._callbacks = self._callbacks, []
        for callback in callbacks:
            callback(self)

    def add_callback(self, callback: "Callable[[DeviceStatus], None]") -> None:
        """Have a function called with this status when it is done, at once where it is.

        Parameters
        ----------
        callback
            The function.
        """
        with self._lock:
            if not self._ended.is_set():
                self._callbacks.append(callback)
                return
        callback(self)

    def exception(self, timeout: float | None = 0.0) -> BaseException | None:
        """Return why it failed, None where it did not.

        Parameters
        ----------
        timeout
            Longest wait in seconds; None waits until it is done.

        Raises
        ------
        usmbench.errors.BenchError
            It is not done in that time.
        """
        if not self._ended.wait(timeout):
            raise BenchError(f"not done within {timeout} s; look at the bench's loop")
        return self._error

    def wait(self, timeout: float) -> None:
        """Wait until it is done.

        Parameters
        ----------
        timeout
            Longest wait in seconds.

        Raises
        ------
        usmbench.errors.BenchError
            It is not done in that time, or failed.
        """
        error = self.exception(timeout)
        if error is not None:
            raise error

    @property
    def done(self) -> bool:
        """Whether it is done."""
        return self._ended.is_set()

    @property
    def success(self) -> bool:
        """Whether it is done and did not fail."""
        return self.done and self._error is None
