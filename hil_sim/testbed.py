"""Board, motor and faults joined on one simulated time, which moves when samples are taken."""

import heapq
import itertools
import math
import threading
from collections import deque
from collections.abc import Callable
from typing import Final, Literal, Protocol

from hil_sim.board import Board
from hil_sim.faults import FaultKind, FaultSchedule
from hil_sim.line import Arrival, Line
from hil_sim.signals import Drive, Plant, Samples
from usmbench.errors import InputError
from usmbench.instruments.protocol._generated import ResetCause

HISTORY_LENGTH: Final = 10_000
"""Drive changes kept: a day of them would not stay in memory."""
_IDLE_RATE_HZ: Final = 10_000.0
_IDLE_BLOCK: Final = 10_000


class FaultablePlant(Plant, Protocol):
    """A plant that can also break."""

    def set_coupling(self, time_s: float, coupled: bool) -> None:
        """Join the encoder to the shaft, or let it slip, from `time_s` on."""

    def set_dead_channel(self, time_s: float, channel: Literal["a", "b"] | None) -> None:
        """Hold one encoder channel at its level from `time_s` on, or neither."""


class BoardMachine(Protocol):
    """The signal generator board, emulated or its firmware in gpsim.

    Attributes
    ----------
    replies
        What it has said since the list was last emptied: start of the first byte, and the bytes.
    drive_changes
        Drive voltages since the list was last emptied: the instant, and what holds from then on.
    """

    replies: list[tuple[float, bytes]]
    drive_changes: list[tuple[float, Drive]]

    def advance(self, time_s: float) -> None:
        """Let time pass until `time_s`."""

    def receive(self, byte: int, time_s: float) -> None:
        """Take a byte that ends at `time_s`."""

    def reset(self, time_s: float, cause: ResetCause) -> None:
        """Restart at `time_s`, as by `cause`."""


class Testbed:
    """The simulated testbed. Every method may be called from any thread.

    Parameters
    ----------
    plant
        Motor, disc and sensor.
    faults
        What goes wrong, and when.
    board
        The signal generator board, where it is not the emulated one.

    Attributes
    ----------
    drive_history
        The last changes of the drive voltages: instant and what holds from then on. A change that
        a byte still on the line will make is already in it.
    faults
        What goes wrong, and when.
    answered_s
        When the host has, or would have, the last reply that no fault held up.
    """

    __test__ = False  # pytest takes the name for a test's

    def __init__(
        self,
        plant: FaultablePlant,
        faults: FaultSchedule | None = None,
        *,
        board: BoardMachine | None = None,
    ):
        self.faults = FaultSchedule() if faults is None else faults
        self.drive_history: deque[tuple[float, Drive]] = deque(maxlen=HISTORY_LENGTH)
        self._plant = plant
        self._board: BoardMachine = Board() if board is None else board
        self._to_board = Line("to_board", self.faults)
        self._to_host = Line("to_host", self.faults)
        self._resets = deque(self.faults.of(FaultKind.BOARD_RESET))
        gone = self.faults.of(FaultKind.PORT_GONE)
        self.answered_s = 0.0
        self.port_gone_s = gone[0].time_s if gone else math.inf
        self._lock = threading.RLock()
        self._epoch_s = 0.0
        self._ticks = 0
        self._rate_hz = _IDLE_RATE_HZ
        self._events: list[tuple[float, int, Callable[..., None], object]] = []
        self._order = itertools.count()
        self._schedule_plant_faults()

    def _schedule_plant_faults(self) -> None:
        plant = self._plant
        for fault in self.faults.of(FaultKind.SLIPPED_COUPLING):
            self._at(fault.time_s, plant.set_coupling, False)
            self._at(fault.end_s, plant.set_coupling, True)
        for fault in self.faults.of(FaultKind.DEAD_CHANNEL):
            self._at(fault.time_s, plant.set_dead_channel, fault.channel)
            self._at(fault.end_s, plant.set_dead_channel, None)

    def _at(self, time_s: float, act: Callable[..., None], value: object) -> None:
        """Have the plant told of a new value when its time comes."""
        heapq.heappush(self._events, (time_s, next(self._order), act, value))

    @property
    def time_s(self) -> float:
        """Simulated time: that of the end of the samples taken."""
        return self._epoch_s + self._ticks / self._rate_hz

    def host_bytes(self, data: bytes, at_s: float) -> list[Arrival]:
        """Take what the host wrote, and return the reply with the times it takes.

        Parameters
        ----------
        data
            The bytes.
        at_s
            When they were written; taken as now where that time has passed.

        Returns
        -------
        list of Arrival
            The reply's bytes as they will end at the host.
        """
        with self._lock:
            replies: list[Arrival] = []
            for time_s, byte, late in self._to_board.send(data, max(at_s, self.time_s)):
                self._advance_board(time_s)
                self._board.receive(byte, time_s)
                for start_s, frame in self._board.replies:
                    sent = self._to_host.send(frame, start_s)
                    replies += [a._replace(late=a.late or late) for a in sent]
                self._board.replies.clear()
            self._collect_drive()
            ends_s = [arrival.time_s for arrival in replies if not arrival.late]
            self.answered_s = max([self.answered_s, *ends_s])
            return replies

    def _advance_board(self, time_s: float) -> None:
        while self._resets and self._resets[0].time_s <= time_s:
            fault = self._resets.popleft()
            self._board.reset(fault.time_s, fault.reset_cause)
        self._board.advance(time_s)

    def _collect_drive(self) -> None:
        for time_s, drive in self._board.drive_changes:
            self.drive_history.append((time_s, drive))
            self._at(time_s, self._plant.drive, drive)
        self._board.drive_changes.clear()

    def sample(self, n_samples: int, sample_rate_hz: float) -> Samples:
        """Take samples: simulated time moves on by as much.

        Parameters
        ----------
        n_samples
            How many.
        sample_rate_hz
            Rate of the sample clock.
        """
        with self._lock:
            if sample_rate_hz != self._rate_hz:
                self._epoch_s, self._ticks, self._rate_hz = self.time_s, 0, sample_rate_hz
            end_s = self._epoch_s + (self._ticks + n_samples) / sample_rate_hz
            self._advance_board(end_s)
            self._collect_drive()
            while self._events and self._events[0][0] < end_s:
                time_s, _, act, value = heapq.heappop(self._events)
                act(time_s, value)
            samples = self._plant.sample(n_samples, sample_rate_hz)
            self._ticks += n_samples
            return samples

    def idle(self, duration_s: float) -> None:
        """Let time pass without a reader, to the next 0.1 ms.

        Parameters
        ----------
        duration_s
            How long.
        """
        left = math.ceil(duration_s * _IDLE_RATE_HZ - 1e-6)
        while left > 0:
            block = min(left, _IDLE_BLOCK)
            self.sample(block, _IDLE_RATE_HZ)
            left -= block

    def set_load(self, torque_nm: float) -> None:
        """Change the load torque now.

        Parameters
        ----------
        torque_nm
            Load torque, which acts against the motion.

        Raises
        ------
        usmbench.errors.InputError
            The torque is negative or not a number.
        """
        if not 0.0 <= torque_nm < math.inf:
            raise InputError(f"the load torque must be 0 N·m or more, not {torque_nm:g}")
        with self._lock:
            self._at(self.time_s, self._plant.set_load, torque_nm)
