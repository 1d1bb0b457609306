"""The signal generator board: frequency, phase and outputs of the two drive voltages."""

import time
from collections.abc import Callable
from functools import partial
from types import TracebackType
from typing import Final, Self, TextIO

from usmbench.errors import InputError, PortError, UsmbenchError
from usmbench.instruments import dds
from usmbench.instruments.board import Board
from usmbench.instruments.board_link import DRIVE_STOPS, REPLY_TIMEOUT_S, BoardLink
from usmbench.instruments.drive_limits import DriveLimits
from usmbench.instruments.leaving_off import leave_off
from usmbench.instruments.ports import find_board, open_port
from usmbench.instruments.protocol._generated import Flags, RequestType
from usmbench.instruments.protocol.messages import Identity, Status
from usmbench.instruments.serial_port import SerialPort
from usmbench.settings.bench import GeneratorSettings

AUTO: Final = "auto"


class SignalGenerator:
    """The signal generator board on an open port, identified and with its drive off.

    Used as a context manager it leaves the drive off whatever happens. A value out of range is
    refused with `InputError` before a byte is sent. Any command raises `BoardResetError` where the
    board has restarted, another `BoardError` where it has stopped the drive by itself, does not
    answer or refuses, and `PortError` where the port has gone.

    Parameters
    ----------
    port
        The open serial port, or a simulated one.
    clock
        Seconds, on the port's own time.
    frequency_limits_hz
        Lowest and highest frequency of this lab; the board's own limits hold as well.
    phase_limits_deg
        Lowest and highest phase shift of this lab; the board's own limits hold as well.
    frame_log
        Text stream that takes every frame on the line, or None.
    reopen
        Opens the port again for `reconnect`, or None where it stays open.
    reply_timeout_s
        Time a reply may take before the request is sent again.

    Raises
    ------
    usmbench.errors.InputError
        The board speaks another version of the protocol, or has other DDS chips.
    usmbench.errors.BoardError
        The board does not answer, or has a fault.
    """

    def __init__(
        self,
        port: SerialPort,
        *,
        clock: Callable[[], float] = time.monotonic,
        frequency_limits_hz: tuple[float, float],
        phase_limits_deg: tuple[float, float],
        frame_log: TextIO | None = None,
        reopen: Callable[[], SerialPort] | None = None,
        reply_timeout_s: float = REPLY_TIMEOUT_S,
    ):
        self._link = BoardLink(
            port, clock=clock, frame_log=frame_log, reply_timeout_s=reply_timeout_s
        )
        self._board = Board(self._link)
        self._limits = DriveLimits(frequency_limits_hz, phase_limits_deg)
        self._reopen = reopen
        # Frequency and phase word in force; None where only the board knows.
        self._words: tuple[int, int] | None = None
        self._identity = self._board.identify()

    @classmethod
    def open(cls, settings: GeneratorSettings, *, frame_log: TextIO | None = None) -> Self:
        """Open the board's serial port, found by asking where the settings say "auto".

        Parameters
        ----------
        settings
            Port and limits, from the bench file.
        frame_log
            Text stream that takes every frame on the line, or None.

        Returns
        -------
        SignalGenerator
            The board, identified, its drive off.

        Raises
        ------
        usmbench.errors.InputError
            The port cannot be opened, no or several boards answer, or the board is another one.
        usmbench.errors.BoardError
            The board does not answer, or has a fault.
        """
        name = find_board() if settings.port == AUTO else settings.port
        port = open_port(name)
        try:
            return cls(
                port,
                frequency_limits_hz=settings.frequency_limits_hz,
                phase_limits_deg=settings.phase_limits_deg,
                frame_log=frame_log,
                reopen=partial(open_port, name),
                reply_timeout_s=settings.reply_timeout_s,
            )
        except BaseException:
            port.close()
            raise

    @property
    def identity(self) -> Identity:
        """Get what the board said of itself when it was last identified."""
        return self._identity

    @property
    def frequency_hz(self) -> float:
        """Control the frequency of both drive voltages in hertz, float from 40000 to 42000.

        The limits of the lab may be narrower. Reading gives the frequency really applied, which is
        the nearest the chip can produce, within 0.047 Hz.
        """
        return dds.word_to_frequency_hz(self._words_in_force()[0])

    @frequency_hz.setter
    def frequency_hz(self, frequency_hz: float) -> None:
        word = self._limits.frequency_word(frequency_hz, self._identity)
        self._set_words(word, self._words_in_force()[1])

    @property
    def phase_deg(self) -> float:
        """Control the phase shift of generator B against A in degrees, float from -180 to 180.

        The limits of the lab may be narrower. Reading gives the phase shift really applied, which
        is the nearest the chip can produce, within 0.044°.
        """
        return dds.word_to_phase_deg(self._words_in_force()[1])

    @phase_deg.setter
    def phase_deg(self, phase_deg: float) -> None:
        word = self._limits.phase_word(phase_deg, self._identity)
        known, self._words = self._words, None
        self._board.command(RequestType.SET_PHASE, word)
        self._words = None if known is None else (known[0], word)

    @property
    def outputs_on(self) -> bool:
        """Control whether the drive voltages are on, bool; needs a `set_drive` before."""
        return Flags.OUTPUTS_ON in self.status().flags

    @outputs_on.setter
    def outputs_on(self, outputs_on: bool) -> None:
        if outputs_on:
            self._board.on()
        else:
            self._board.off()

    def set_drive(self, frequency_hz: float, phase_deg: float) -> None:
        """Set frequency and phase shift so that both take effect at one instant.

        Parameters
        ----------
        frequency_hz
            Frequency of both drive voltages, float from 40000 to 42000.
        phase_deg
            Phase shift of generator B against A, float from -180 to 180.

        Raises
        ------
        usmbench.errors.InputError
            One of them is outside the limits of the lab or the board; nothing was sent.
        usmbench.errors.BenchError
            The board refused, has restarted, stopped the drive, or cannot be reached.
        """
        self._set_words(
            self._limits.frequency_word(frequency_hz, self._identity),
            self._limits.phase_word(phase_deg, self._identity),
        )

    def status(self) -> Status:
        """Measure what the board is doing: words in force, faults, cause of its last reset.

        Raises
        ------
        usmbench.errors.BenchError
            The board cannot be reached.
        """
        return self._board.status()

    def heartbeat(self) -> None:
        """Tell the board that the host is alive; due at least once a second while driving.

        Raises
        ------
        usmbench.errors.BenchError
            The board has restarted, stopped the drive, or cannot be reached.
        """
        self._board.command(RequestType.HEARTBEAT)

    def off(self) -> None:
        """Set the outputs off, whatever state the board is in.

        Raises
        ------
        usmbench.errors.BenchError
            The board cannot be reached, or keeps its outputs on.
        """
        self._board.off()

    def reconnect(self) -> None:
        """Open the port again, identify the board anew, and leave its drive off.

        Raises
        ------
        usmbench.errors.PortError
            The port is not there.
        usmbench.errors.InputError
            Another board is there now.
        usmbench.errors.BoardError
            The board does not answer, or has a fault.
        """
        if self._reopen is not None:
            self._link.close()
            try:
                self._link.replace_port(self._reopen())
            except InputError as error:
                raise PortError(f"{error}; {DRIVE_STOPS}") from error
        self._words = None
        self._identity = self._board.identify()

    def close(self) -> None:
        """Release the port; the outputs stay as they are."""
        self._link.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        try:
            leave_off(self._switch_off, error)
        except KeyboardInterrupt:
            # An impatient second Ctrl-C must not leave the drive on.
            leave_off(self._switch_off, error)
            raise
        finally:
            self.close()

    def _switch_off(self, failure: UsmbenchError | None) -> None:
        """Switch off, over a port opened anew where it had gone."""
        if isinstance(failure, PortError):
            self.reconnect()
        else:
            self._board.off()

    def _set_words(self, frequency_word: int, phase_word: int) -> None:
        # Broken off in the middle, only the board knows which words are in force.
        self._words = None
        self._board.command(RequestType.SET_DRIVE, frequency_word, phase_word)
        self._words = (frequency_word, phase_word)

    def _words_in_force(self) -> tuple[int, int]:
        if self._words is None:
            status = self._board.status()
            phase_word = dds.signed_phase_word(status.phase_word_b - status.phase_word_a)
            self._words = (status.frequency_word_a, phase_word)
        return self._words
