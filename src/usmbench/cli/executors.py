"""Where much work of one kind is done: all cores of this machine, or a Dask cluster."""

import asyncio
import signal
from collections.abc import Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context
from typing import Any

from usmbench.errors import InputError

_DEADLINE_S = 10.0


@contextmanager
def all_cores() -> Iterator[Executor]:
    """Give a pool of processes, one a core.

    Yields
    ------
    concurrent.futures.Executor
        The pool. What is not done when the context is left, is dropped, and its worker ended.
    """
    # Ctrl-C reaches the whole group: a worker then ends at once, and says nothing.
    pool = ProcessPoolExecutor(
        mp_context=get_context("spawn"),
        initializer=signal.signal,
        initargs=(signal.SIGINT, signal.SIG_DFL),
    )
    try:
        yield pool
    finally:
        # One that is stuck would be waited for, for ever, and as Python ends once more.
        workers = list((pool._processes or {}).values())
        pool.shutdown(wait=False, cancel_futures=True)
        for worker in workers:
            worker.kill()


@contextmanager
def cluster(address: str) -> Iterator[Executor]:
    """Give the workers of a Dask cluster.

    Parameters
    ----------
    address
        Address of the scheduler, such as ``tcp://10.0.0.5:8786``.

    Yields
    ------
    concurrent.futures.Executor
        The cluster. What is not done when the context is left, is dropped.

    Raises
    ------
    usmbench.errors.InputError
        dask.distributed is not installed, no scheduler answers within 10 s, or it has no workers.
    """
    try:
        from distributed import Client
    except ImportError:
        raise InputError(
            "--scheduler needs dask.distributed; pip install 'usmbench[cluster]'"
        ) from None
    if not _workers(address):
        raise InputError(
            f"the Dask scheduler at {address} has no workers; start some: dask worker {address}"
        )
    with Client(address, timeout=_DEADLINE_S, set_as_default=False) as client:
        yield client.get_executor()


def _workers(address: str) -> dict[str, Any]:
    """Return the workers that a scheduler says it has."""
    # A Client would wait for ever on a server that is no scheduler.
    try:
        return asyncio.run(asyncio.wait_for(_asked(address), _DEADLINE_S))
    except (OSError, ValueError, MemoryError) as error:
        raise InputError(
            f"no Dask scheduler answers at {address} within {_DEADLINE_S:g} s "
            f"({str(error) or 'silent'}); give the address that `dask scheduler` prints"
        ) from None


async def _asked(address: str) -> dict[str, Any]:
    """Ask a scheduler for its workers."""
    from distributed.core import rpc

    async with rpc(address, timeout=_DEADLINE_S) as scheduler:
        identity = await scheduler.identity()
    return dict(identity["workers"])
