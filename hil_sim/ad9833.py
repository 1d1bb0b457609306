"""The AD9833 waveform generator, register by register (Analog Devices data sheet, rev. G)."""

from typing import Final

B28: Final = 1 << 13
HLB: Final = 1 << 12
FSELECT: Final = 1 << 11
PSELECT: Final = 1 << 10
RESET: Final = 1 << 8
SLEEP1: Final = 1 << 7
SLEEP12: Final = 1 << 6
OPBITEN: Final = 1 << 5
DIV2: Final = 1 << 3

FREQUENCY_ADDRESSES: Final = (0x4000, 0x8000)
"""Upper bits of a word for the frequency registers 0 and 1; 14 bits of data follow."""
PHASE_ADDRESSES: Final = (0xC000, 0xE000)
"""Upper bits of a word for the phase registers 0 and 1; 12 bits of data follow."""
HALF_BITS: Final = 14
HALF_MASK: Final = (1 << HALF_BITS) - 1
PHASE_MASK: Final = 0xFFF


class Ad9833:
    """One chip, seen from its serial port.

    The registers are undefined after power-on; here they start at zero, with the output held by
    RESET as the board's start-up code leaves it.
    """

    def __init__(self) -> None:
        self.control = RESET
        self.frequency_registers = [0, 0]
        self.phase_registers = [0, 0]
        self._low_half: tuple[int, int] | None = None

    def write_word(self, word: int) -> None:
        """Take 16 bits, the most significant first on the wire.

        Parameters
        ----------
        word
            What was shifted in while FSYNC was low.
        """
        address = word >> HALF_BITS
        if address == 0:
            self.control = word & HALF_MASK
            self._low_half = None
        elif address == 3:
            self.phase_registers[word >> 13 & 1] = word & PHASE_MASK
        else:
            self._load_frequency(address - 1, word & HALF_MASK)

    def _load_frequency(self, register: int, half: int) -> None:
        if not self.control & B28:
            shift = HALF_BITS if self.control & HLB else 0
            kept = self.frequency_registers[register] & ~(HALF_MASK << shift)
            self.frequency_registers[register] = kept | half << shift
        elif self._low_half is not None and self._low_half[0] == register:
            # Both halves reach the register together: it never holds half a frequency.
            self.frequency_registers[register] = half << HALF_BITS | self._low_half[1]
            self._low_half = None
        else:
            self._low_half = (register, half)

    @property
    def frequency_select(self) -> int:
        """Number of the frequency register in force."""
        return 1 if self.control & FSELECT else 0

    @property
    def phase_select(self) -> int:
        """Number of the phase register in force."""
        return 1 if self.control & PSELECT else 0

    @property
    def frequency_word(self) -> int:
        """The 28-bit frequency word in force."""
        return self.frequency_registers[self.frequency_select]

    @property
    def phase_word(self) -> int:
        """The 12-bit phase word in force."""
        return self.phase_registers[self.phase_select]

    def output_hz(self, clock_hz: float) -> float:
        """Return the frequency of what comes out while the chip runs.

        Parameters
        ----------
        clock_hz
            Frequency of the master clock.
        """
        divided = self.control & OPBITEN and not self.control & DIV2
        return self.frequency_word * clock_hz / (1 << 2 * HALF_BITS) / (2.0 if divided else 1.0)

    @property
    def running(self) -> bool:
        """Whether a signal comes out: clocked, not held by RESET, and its output powered."""
        if self.control & (RESET | SLEEP1):
            return False
        return not self.control & SLEEP12 or bool(self.control & OPBITEN)
