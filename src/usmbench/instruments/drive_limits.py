"""How far the drive may go: this lab's limits and the board's, checked before a byte is sent."""

from dataclasses import dataclass

from usmbench.errors import InputError
from usmbench.instruments import dds
from usmbench.instruments.protocol.messages import Identity

Limits = tuple[float, float]


@dataclass(frozen=True, slots=True)
class DriveLimits:
    """The limits of this lab.

    Parameters
    ----------
    frequency_limits_hz
        Lowest and highest frequency.
    phase_limits_deg
        Lowest and highest phase shift.
    """

    frequency_limits_hz: Limits
    phase_limits_deg: Limits

    def frequency_word(self, frequency_hz: float, board: Identity) -> int:
        """Return the word for a frequency that lab and board allow.

        Parameters
        ----------
        frequency_hz
            Frequency.
        board
            The board, with its own limits.

        Raises
        ------
        usmbench.errors.InputError
            The frequency is out of range, or is no number.
        """
        what = f"frequency {frequency_hz} Hz"
        _check_lab(what, frequency_hz, self.frequency_limits_hz, "Hz", "frequency_limits_hz")
        word = dds.frequency_to_word(frequency_hz)
        lowest, highest = board.frequency_word_min, board.frequency_word_max
        if not lowest <= word <= highest:
            limits_hz = (dds.word_to_frequency_hz(lowest), dds.word_to_frequency_hz(highest))
            raise InputError(_beyond_board(what, limits_hz, "Hz"))
        return word

    def phase_word(self, phase_deg: float, board: Identity) -> int:
        """Return the signed word for a phase shift that lab and board allow.

        Parameters
        ----------
        phase_deg
            Phase shift.
        board
            The board, with its own limits.

        Raises
        ------
        usmbench.errors.InputError
            The phase shift is out of range, or is no number.
        """
        what = f"phase {phase_deg}°"
        _check_lab(what, phase_deg, self.phase_limits_deg, "°", "phase_limits_deg")
        word = dds.phase_to_word(phase_deg)
        lowest, highest = board.phase_word_min, board.phase_word_max
        if not lowest <= word <= highest:
            limits_deg = (dds.word_to_phase_deg(lowest), dds.word_to_phase_deg(highest))
            raise InputError(_beyond_board(what, limits_deg, "°"))
        return word


def _check_lab(what: str, value: float, limits: Limits, unit: str, setting: str) -> None:
    if not limits[0] <= value <= limits[1]:
        raise InputError(
            f"{what} is outside this lab's {limits[0]} to {limits[1]} {unit}: choose another, or "
            f"widen generator.{setting} in the bench file"
        )


def _beyond_board(what: str, limits: Limits, unit: str) -> str:
    return (
        f"{what} is outside what the board takes, {limits[0]:.1f} to {limits[1]:.1f} {unit}: "
        "choose another"
    )
