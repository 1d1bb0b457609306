"""Messages: what the payloads of the frames mean, field by field."""

import struct
from dataclasses import dataclass
from typing import Any, Final

from usmbench.errors import BoardError
from usmbench.instruments.protocol._generated import (
    ACK_BIT,
    REFUSAL_BITS,
    REPLY_LAYOUTS,
    REQUEST_LAYOUTS,
    Faults,
    Flags,
    Layout,
    Refusal,
    RequestType,
    ResetCause,
)
from usmbench.instruments.protocol.frames import Frame

_REFUSAL_LAYOUT: Final[Layout] = (("reason", "B"), ("flags", "B"))


@dataclass(frozen=True, slots=True)
class Identity:
    """What the board says of itself.

    Parameters
    ----------
    flags
        State after the command.
    protocol_version
        Version of the protocol it speaks.
    firmware_major, firmware_minor
        Version of its firmware.
    clock_hz
        Clock of the two DDS chips.
    frequency_word_min, frequency_word_max
        Range of frequency words it takes.
    phase_word_min, phase_word_max
        Range of signed phase words it takes.
    frequency_bits, phase_bits
        Resolution of the chips.
    host_silence_ms
        Silence after which it stops the drive.
    """

    flags: Flags
    protocol_version: int
    firmware_major: int
    firmware_minor: int
    clock_hz: int
    frequency_word_min: int
    frequency_word_max: int
    phase_word_min: int
    phase_word_max: int
    frequency_bits: int
    phase_bits: int
    host_silence_ms: int


@dataclass(frozen=True, slots=True)
class Status:
    """What the board is doing.

    Parameters
    ----------
    flags
        State after the command.
    reset_cause
        Why it last started.
    faults
        What went wrong since.
    frequency_word_a, frequency_word_b
        Frequency words in force.
    phase_word_a, phase_word_b
        Phase words in force, as the chips hold them: unsigned.
    bad_frames
        Frames with a wrong CRC or form; stops at 65535.
    silence_trips
        How often it stopped the drive for silence; stops at 255.
    """

    flags: Flags
    reset_cause: ResetCause
    faults: Faults
    frequency_word_a: int
    frequency_word_b: int
    phase_word_a: int
    phase_word_b: int
    bad_frames: int
    silence_trips: int


def _structs(layouts: dict[RequestType, Layout]) -> dict[int, struct.Struct]:
    return {int(kind): _struct(layout) for kind, layout in layouts.items()}


def _struct(layout: Layout) -> struct.Struct:
    return struct.Struct("<" + "".join(code for _, code in layout))


_REQUESTS: Final = _structs(REQUEST_LAYOUTS)
_REPLIES: Final = _structs(REPLY_LAYOUTS)
_REFUSAL: Final = _struct(_REFUSAL_LAYOUT)


def pack_request(kind: RequestType, *values: int) -> bytes:
    """Pack the payload of a request.

    Parameters
    ----------
    kind
        Which request.
    *values
        Its fields, in order.

    Returns
    -------
    bytes
        The payload.
    """
    return _REQUESTS[kind].pack(*values)


def _unpack(layout: struct.Struct, payload: bytes, what: str) -> tuple[Any, ...]:
    """Unpack a payload that must have exactly the layout's length."""
    if len(payload) != layout.size:
        raise BoardError(
            f"{what} from the board has {len(payload)} bytes where {layout.size} are due; "
            "flash the firmware that belongs to this usmbench"
        )
    return layout.unpack(payload)


def unpack_flags(kind: RequestType, payload: bytes) -> Flags:
    """Return the flags that any acknowledgement starts with.

    Parameters
    ----------
    kind
        What was acknowledged.
    payload
        Payload of the acknowledgement.

    Raises
    ------
    usmbench.errors.BoardError
        The payload does not have its length.
    """
    return Flags(_unpack(_REPLIES[kind], payload, f"acknowledgement of {kind.name.lower()}")[0])


def unpack_identity(payload: bytes) -> Identity:
    """Unpack the reply to identify.

    Parameters
    ----------
    payload
        Payload of the acknowledgement.

    Raises
    ------
    usmbench.errors.BoardError
        The payload does not have its length.
    """
    flags, *rest = _unpack(_REPLIES[RequestType.IDENTIFY], payload, "identity")
    return Identity(Flags(flags), *rest)


def unpack_status(payload: bytes) -> Status:
    """Unpack the reply to status.

    Parameters
    ----------
    payload
        Payload of the acknowledgement.

    Raises
    ------
    usmbench.errors.BoardError
        The payload does not have its length, or the reset cause is unknown.
    """
    flags, cause, faults, *rest = _unpack(_REPLIES[RequestType.STATUS], payload, "status")
    try:
        reset_cause = ResetCause(cause)
    except ValueError:
        raise BoardError(f"status from the board has the unknown reset cause {cause}") from None
    return Status(Flags(flags), reset_cause, Faults(faults), *rest)


def unpack_refusal(payload: bytes) -> tuple[Refusal, Flags]:
    """Unpack a refusal.

    Parameters
    ----------
    payload
        Payload of the refusal.

    Returns
    -------
    tuple of Refusal and Flags
        Why, and the state of the board.

    Raises
    ------
    usmbench.errors.BoardError
        The payload does not have its length, or the reason is unknown.
    """
    reason, flags = _unpack(_REFUSAL, payload, "refusal")
    try:
        return Refusal(reason), Flags(flags)
    except ValueError:
        raise BoardError(f"the board refused a command for the unknown reason {reason}") from None


def describe(frame: Frame) -> str:
    """Say in words what a frame means, for the frame log.

    Parameters
    ----------
    frame
        A frame of either direction.

    Returns
    -------
    str
        Such as "set_phase sequence=7 phase_word=1024".
    """
    reply_bits = frame.type & REFUSAL_BITS
    kind = frame.type & ~REFUSAL_BITS
    layouts = REPLY_LAYOUTS if reply_bits == ACK_BIT else REQUEST_LAYOUTS
    layout = _REFUSAL_LAYOUT if reply_bits == REFUSAL_BITS else _layout(layouts, kind)
    prefix = {ACK_BIT: "ack ", REFUSAL_BITS: "refusal "}.get(reply_bits, "")
    name = RequestType(kind).name.lower() if kind in REQUEST_LAYOUTS else f"type 0x{frame.type:02X}"
    form = _struct(layout)
    if form.size != len(frame.payload):
        fields = [f"payload={frame.payload.hex(' ')}"]
    else:
        values = form.unpack(frame.payload)
        fields = [_field(n, value) for (n, _), value in zip(layout, values, strict=True)]
    return " ".join([f"{prefix}{name}", f"sequence={frame.sequence}", *fields])


def _layout(layouts: dict[RequestType, Layout], kind: int) -> Layout:
    return layouts[RequestType(kind)] if kind in layouts else ()


def _field(name: str, value: int) -> str:
    """Write one field, with the names of flags and reasons."""
    groups: dict[str, type[Flags | Faults | Refusal | ResetCause]] = {
        "flags": Flags,
        "faults": Faults,
        "reason": Refusal,
        "reset_cause": ResetCause,
    }
    if name not in groups:
        return f"{name}={value}"
    try:
        member = groups[name](value)
    except ValueError:
        return f"{name}={value}"
    return f"{name}={(member.name or '0').lower()}"
