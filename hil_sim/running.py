"""The testbed behind a pseudo-terminal and an NI device server, for any client."""

from typing import Self

from hil_sim.clock import Clock, LockStep, RealTime
from hil_sim.faults import FaultSchedule
from hil_sim.ni_server import NiServer
from hil_sim.pty_edge import PtyEdge
from hil_sim.sample_feed import SampleFeed
from hil_sim.testbed import BoardMachine, FaultablePlant, Testbed


class RunningTestbed:
    """A testbed with both its edges; used as a context manager that stops them.

    Parameters
    ----------
    plant
        Motor, disc and sensor.
    faults
        What goes wrong, and when.
    lock_step
        Whether time moves only with the samples read, instead of with the wall clock.
    board
        The signal generator board, where it is not the emulated one.

    Attributes
    ----------
    testbed
        The machines.
    port
        Path of the board's serial port.
    daq_address
        host:port of the NI device server.
    """

    def __init__(
        self,
        plant: FaultablePlant,
        faults: FaultSchedule | None = None,
        *,
        lock_step: bool = False,
        board: BoardMachine | None = None,
    ):
        self.testbed = Testbed(plant, faults, board=board)
        clock: Clock = LockStep(self.testbed) if lock_step else RealTime()
        self._feed = SampleFeed(self.testbed, clock)
        self._server = NiServer(self._feed, lock_step=lock_step, faults=self.testbed.faults)
        self._edge = PtyEdge(self.testbed, clock)
        self.port = self._edge.path
        self.daq_address = self._server.address

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def stop(self) -> None:
        """Close the port and end the server; safe to call twice."""
        self._edge.stop()
        self._server.stop()
        self._feed.close()
