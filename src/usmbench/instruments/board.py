"""The board behind its link: identified, and heard when it reports trouble."""

from typing import Final

from usmbench.errors import BoardError, BoardRefusedError, BoardResetError, InputError
from usmbench.instruments.board_link import BoardLink
from usmbench.instruments.protocol._generated import (
    DDS_CLOCK_HZ,
    DDS_FREQUENCY_BITS,
    DDS_PHASE_BITS,
    PROTOCOL_VERSION,
    Flags,
    Refusal,
    RequestType,
)
from usmbench.instruments.protocol.messages import (
    Identity,
    Status,
    unpack_flags,
    unpack_identity,
    unpack_status,
)

_TROUBLE: Final = Flags.HOST_SILENCE | Flags.NOT_IDENTIFIED | Flags.INTERNAL_FAULT
_NOT_IDENTIFIED: Final = Refusal.NOT_IDENTIFIED.name.lower()


class Board:
    """The signal generator board; every command tells whether it is still in the known state.

    Parameters
    ----------
    link
        The way to it.
    """

    def __init__(self, link: BoardLink):
        self._link = link

    def identify(self) -> Identity:
        """Ask the board who it is, which makes it take commands, and switch its outputs off.

        Raises
        ------
        usmbench.errors.InputError
            The board speaks another version of the protocol, or has other DDS chips.
        usmbench.errors.BenchError
            The board does not answer, or has a fault.
        """
        payload = self._link.request(RequestType.IDENTIFY)
        # Only the first two bytes are the same in every version.
        version = payload[1] if len(payload) > 1 else 0
        if version != PROTOCOL_VERSION:
            mend = "update usmbench" if version > PROTOCOL_VERSION else "flash its newest firmware"
            raise InputError(
                f"the board on {self._link.port_name} speaks version {version} of the protocol, "
                f"this usmbench version {PROTOCOL_VERSION}: {mend}"
            )
        identity = unpack_identity(payload)
        chips = (identity.clock_hz, identity.frequency_bits, identity.phase_bits)
        if chips != (DDS_CLOCK_HZ, DDS_FREQUENCY_BITS, DDS_PHASE_BITS):
            raise InputError(
                f"the board on {self._link.port_name} has DDS chips with a {chips[0]} Hz clock, "
                f"{chips[1]} frequency bits and {chips[2]} phase bits; this usmbench knows "
                f"{DDS_CLOCK_HZ} Hz, {DDS_FREQUENCY_BITS} and {DDS_PHASE_BITS}: update usmbench"
            )
        self.off()
        if Flags.INTERNAL_FAULT in identity.flags:
            raise self._trouble(identity.flags)
        return identity

    def command(self, kind: RequestType, *values: int) -> Flags:
        """Send a command that only flags answer.

        Parameters
        ----------
        kind
            Which command.
        *values
            Its fields, in order.

        Returns
        -------
        Flags
            State of the board after it.

        Raises
        ------
        usmbench.errors.BoardResetError
            The board has restarted since it was identified.
        usmbench.errors.BenchError
            The board refused, stopped the drive by itself, or cannot be reached.
        """
        try:
            flags = unpack_flags(kind, self._link.request(kind, *values))
        except BoardRefusedError as refusal:
            if refusal.reason == _NOT_IDENTIFIED:
                raise self._reset_error() from refusal
            raise
        if flags & _TROUBLE:
            raise self._trouble(flags)
        return flags

    def status(self) -> Status:
        """Ask what the board is doing; trouble that it reports is not raised.

        Raises
        ------
        usmbench.errors.BenchError
            The board cannot be reached.
        """
        return unpack_status(self._link.request(RequestType.STATUS))

    def off(self) -> None:
        """Switch the outputs off, whatever state the board is in.

        Raises
        ------
        usmbench.errors.BenchError
            The board cannot be reached, or keeps its outputs on.
        """
        payload = self._link.request(RequestType.OUTPUTS, 0)
        if Flags.OUTPUTS_ON in unpack_flags(RequestType.OUTPUTS, payload):
            raise BoardError(
                f"the board on {self._link.port_name} acknowledged outputs off but they are on: "
                "cut the power of the amplifiers"
            )

    def on(self) -> None:
        """Switch the outputs on.

        Raises
        ------
        usmbench.errors.BenchError
            The board refused, has restarted, or cannot be reached.
        """
        if Flags.OUTPUTS_ON not in self.command(RequestType.OUTPUTS, 1):
            raise BoardError(
                f"the board on {self._link.port_name} acknowledged outputs on but they are off: "
                "read its status"
            )

    def _trouble(self, flags: Flags) -> BoardError:
        """Return what the flags report, the gravest first."""
        place = f"the board on {self._link.port_name}"
        if Flags.NOT_IDENTIFIED in flags:
            return self._reset_error()
        if Flags.INTERNAL_FAULT in flags:
            faults = (self.status().faults.name or "unknown").lower()
            return BoardError(
                f"{place} found an internal fault ({faults}) and switched its outputs off: switch "
                "it off and on; if it comes back, check supply and wiring of the DDS chips"
            )
        return BoardError(
            f"{place} heard nothing from this computer for 1 s and stopped the drive: the computer "
            "was too busy or slept; switch the outputs on to go on"
        )

    def _reset_error(self) -> BoardResetError:
        cause = self.status().reset_cause.name.lower()
        return BoardResetError(
            f"the board on {self._link.port_name} has restarted (cause: {cause}), its outputs are "
            "off: check its supply, then start again"
        )
