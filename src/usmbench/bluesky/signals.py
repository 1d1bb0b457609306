"""Values that a run may be monitored by, or suspended on: subscribed to as ophyd's are."""

import threading
import time
from collections.abc import Callable
from typing import Any, cast

from bluesky.protocols import Reading
from event_model import DataKey

Callback = Callable[..., None]
Readings = dict[str, Reading[Any]]
Keys = dict[str, DataKey]


def data_key(
    source: str,
    units: str | None = None,
    dtype: str = "number",
    limits: tuple[float, float] | None = None,
) -> DataKey:
    """Return how an event descriptor describes a single value.

    Parameters
    ----------
    source
        Where on the bench it comes from.
    units
        Its unit, where it has one.
    dtype
        Kind of the value, by event-model's names.
    limits
        Lowest and highest value that may be set, where it may.
    """
    kind = {"number": "<f8", "integer": "<i8", "boolean": "|b1"}[dtype]
    key: dict[str, Any] = {"source": f"usmbench:{source}", "dtype": dtype, "shape": []}
    key["dtype_numpy"] = kind
    if units is not None:
        key["units"] = units
    if limits is not None:
        key["limits"] = {"control": {"low": limits[0], "high": limits[1]}}
    return cast(DataKey, key)


class Signal:
    """One value that changes by itself; `bluesky.protocols.Readable` and `Subscribable`.

    Parameters
    ----------
    name
        Its name, and that of its data key.
    key
        The data key.
    value
        What it is at first.
    """

    parent = None

    def __init__(self, name: str, key: DataKey, value: float | bool):
        self.name = name
        self._key = key
        self._value = value
        self._at_s = time.time()
        self._lock = threading.Lock()
        self._callbacks: list[Callback] = []
        self._untold: list[Callback] = []

    def put(self, value: float | bool, at_s: float) -> None:
        """Take a new value and tell everybody who subscribed.

        bluesky's suspenders raise RuntimeError where the RunEngine is busy, for example waiting
        for a device to stop; `tell_again` then has to follow.

        Parameters
        ----------
        value
            The value.
        at_s
            When it was measured, in seconds since the epoch.
        """
        with self._lock:
            self._value, self._at_s = value, at_s
            callbacks = list(self._callbacks)
        self._tell(callbacks)

    def tell_again(self) -> None:
        """Tell those of the value who could not take it before."""
        if self._untold:
            self._tell(self._untold)

    def _tell(self, callbacks: list[Callback]) -> None:
        untold = []
        for callback in callbacks:
            try:
                callback(value=self._value, timestamp=self._at_s)
            except RuntimeError:
                untold.append(callback)
        with self._lock:
            # Who left meanwhile is not told again.
            self._untold = [callback for callback in untold if callback in self._callbacks]

    def get(self) -> float | bool:
        """Return the value."""
        return self._value

    def read(self) -> Readings:
        """Return the value with its time."""
        with self._lock:
            return {self.name: {"value": self._value, "timestamp": self._at_s}}

    def describe(self) -> Keys:
        """Return the data key."""
        return {self.name: self._key}

    def subscribe(
        self, function: Callback, event_type: str | None = None, run: bool = True
    ) -> None:
        """Have a function called with every new value, as ``function(value=…, timestamp=…)``.

        Parameters
        ----------
        function
            The function; it is called by the bench's loop and must return at once.
        event_type
            ophyd's name of a kind of event; there is only one here.
        run
            Whether it is called with the present value at once.
        """
        with self._lock:
            self._callbacks.append(function)
            value, at_s = self._value, self._at_s
        if run:
            function(value=value, timestamp=at_s)

    def clear_sub(self, function: Callback) -> None:
        """Forget a function that was subscribed.

        Parameters
        ----------
        function
            The function.
        """
        with self._lock:
            self._callbacks = [kept for kept in self._callbacks if kept != function]
            self._untold = [kept for kept in self._untold if kept != function]
