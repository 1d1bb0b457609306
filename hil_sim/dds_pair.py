"""The two generators as the board's firmware drives them: both change at one instant."""

from collections.abc import Callable
from typing import Final, Literal

from hil_sim import ad9833
from hil_sim.ad9833 import Ad9833
from hil_sim.signals import Drive
from usmbench.instruments.protocol._generated import DDS_CLOCK_HZ, DDS_PHASE_BITS

Chips = Literal["a", "b", "ab"]
SpiLog = Callable[[float, Chips, int], None]
"""Called with the time in seconds, the chips whose FSYNC is low, and the 16-bit word."""

_BASE_CONTROL: Final = ad9833.B28 | ad9833.OPBITEN | ad9833.DIV2
# Whole frequency words, and the square wave at the full frequency.
_PHASE_STEPS: Final = 1 << DDS_PHASE_BITS


class DdsPair:
    """Generators A and B on one SPI bus; new values go to the idle registers, then both flip.

    Parameters
    ----------
    log
        Told of every word written, where given.
    """

    def __init__(self, log: SpiLog | None = None):
        self.a = Ad9833()
        self.b = Ad9833()
        self._log = log
        self._control = _BASE_CONTROL | ad9833.RESET

    def _write(self, time_s: float, chips: Chips, word: int) -> None:
        if self._log is not None:
            self._log(time_s, chips, word)
        if chips != "b":
            self.a.write_word(word)
        if chips != "a":
            self.b.write_word(word)

    def _write_control(self, time_s: float, control: int) -> None:
        self._control = control
        self._write(time_s, "ab", control)

    def start_up(self, time_s: float) -> None:
        """Hold both chips in RESET and clear their registers, as after a reset of the board.

        Parameters
        ----------
        time_s
            Simulated time.
        """
        self._write_control(time_s, _BASE_CONTROL | ad9833.RESET)
        for address in ad9833.FREQUENCY_ADDRESSES:
            self._write(time_s, "ab", address)
            self._write(time_s, "ab", address)
        for address in ad9833.PHASE_ADDRESSES:
            self._write(time_s, "ab", address)

    def set_drive(self, time_s: float, frequency_word: int, phase_word: int) -> None:
        """Change frequency and phase of both chips at one instant.

        Parameters
        ----------
        time_s
            Simulated time.
        frequency_word
            28-bit frequency word of both.
        phase_word
            Phase of B against A, signed; the chip takes the low 12 bits.
        """
        address = ad9833.FREQUENCY_ADDRESSES[1 - self.a.frequency_select]
        self._write(time_s, "ab", address | frequency_word & ad9833.HALF_MASK)
        self._write(time_s, "ab", address | frequency_word >> ad9833.HALF_BITS)
        self._load_phase(time_s, phase_word)
        self._write_control(time_s, self._control ^ (ad9833.FSELECT | ad9833.PSELECT))

    def set_phase(self, time_s: float, phase_word: int) -> None:
        """Change the phase of B against A; frequency and A stay.

        Parameters
        ----------
        time_s
            Simulated time.
        phase_word
            Phase of B against A, signed; the chip takes the low 12 bits.
        """
        self._load_phase(time_s, phase_word)
        self._write_control(time_s, self._control ^ ad9833.PSELECT)

    def _load_phase(self, time_s: float, phase_word: int) -> None:
        # A's registers stay at zero: both hold it since start-up.
        address = ad9833.PHASE_ADDRESSES[1 - self.b.phase_select]
        self._write(time_s, "b", address | phase_word & ad9833.PHASE_MASK)

    def set_outputs(self, time_s: float, on: bool) -> None:
        """Release both chips from RESET together, so that they start in step, or hold them.

        Parameters
        ----------
        time_s
            Simulated time.
        on
            Whether the outputs run.
        """
        control = self._control & ~ad9833.RESET if on else self._control | ad9833.RESET
        self._write_control(time_s, control)

    @property
    def drive(self) -> Drive:
        """The drive voltages that the chips' registers make."""
        steps = self.b.phase_word - self.a.phase_word
        half = _PHASE_STEPS // 2
        return Drive(
            frequency_hz=self.a.output_hz(DDS_CLOCK_HZ),
            phase_deg=((steps + half) % _PHASE_STEPS - half) * 360.0 / _PHASE_STEPS,
            amplitude_a=float(self.a.running),
            amplitude_b=float(self.b.running),
        )
