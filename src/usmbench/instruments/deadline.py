"""Calls that must not take longer than they may, whatever the driver underneath does."""

import threading
from collections.abc import Callable
from concurrent.futures import Future
from typing import TypeVar

Result = TypeVar("Result")


def run_within(
    timeout_s: float,
    work: Callable[[], Result],
    *,
    too_late: Callable[[Result], None] | None = None,
) -> Result:
    """Run `work` on a thread of its own and return its result.

    A driver call cannot be interrupted from outside, but it can be left behind.

    Parameters
    ----------
    timeout_s
        Longest wait for the result.
    work
        What to run; what it raises is raised here.
    too_late
        Takes a result that comes after the wait was given up, to release what it holds.

    Raises
    ------
    TimeoutError
        `work` takes longer than `timeout_s`; it goes on by itself.
    """
    future: Future[Result] = Future()
    threading.Thread(target=_fill, args=(future, work), name="bounded call", daemon=True).start()
    try:
        return future.result(timeout_s)
    except BaseException:
        # Left behind: by the deadline, or by Ctrl-C while it was waited for.
        if too_late is not None:
            future.add_done_callback(lambda late: _release(late, too_late))
        raise


def _fill(future: Future[Result], work: Callable[[], Result]) -> None:
    try:
        result = work()
    except BaseException as error:  # noqa: BLE001 - it is raised where the result is awaited
        future.set_exception(error)
    else:
        future.set_result(result)


def _release(future: Future[Result], too_late: Callable[[Result], None]) -> None:
    if future.exception() is None:
        too_late(future.result())
