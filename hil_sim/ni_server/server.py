"""Start and stop the stand-in NI device server."""

from concurrent.futures import ThreadPoolExecutor
from typing import Final

import grpc

from hil_sim.faults import FaultSchedule
from hil_sim.ni_server.card import Card
from hil_sim.ni_server.channels import Wiring
from hil_sim.ni_server.clock import SampleFeed
from hil_sim.ni_server.service import NiDaqService

_DEVICE: Final = "Dev1"  # name of the card
_WORKERS: Final = 8  # an event stream holds one for as long as it is open
_STOP_TIMEOUT_S: Final = 5.0


class NiServer:
    """A running server, on this machine only.

    Parameters
    ----------
    feed
        Where the samples come from.
    lock_step
        Whether simulated time stands still until samples are read, instead of following the clock.
    faults
        What goes wrong, and when.

    Attributes
    ----------
    address
        Where clients connect.

    Raises
    ------
    OSError
        No port of this machine can be opened.
    """

    def __init__(self, feed: SampleFeed, *, lock_step: bool, faults: FaultSchedule):
        self._card = Card(feed, lock_step=lock_step, faults=faults)
        self._workers = ThreadPoolExecutor(_WORKERS, thread_name_prefix="ni_server")
        self._server = grpc.server(self._workers)
        service = NiDaqService(self._card, Wiring(_DEVICE, faults), die=self._die)
        self._server.add_generic_rpc_handlers((service.handlers(),))
        try:
            port = self._server.add_insecure_port("127.0.0.1:0")
        except RuntimeError as error:
            raise OSError(f"no port for the NI device server on 127.0.0.1: {error}") from error
        self.address = f"127.0.0.1:{port}"
        self._server.start()

    def _die(self) -> None:
        # In this order: who notices that the server has gone finds the testbed going on without it.
        self._card.close()
        self._server.stop(None)

    def stop(self) -> None:
        """Stop answering and end all threads; safe to call twice."""
        self._card.close()
        self._server.stop(None).wait(_STOP_TIMEOUT_S)
        self._workers.shutdown(wait=True)
