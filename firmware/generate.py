"""Make the constants of the wire from protocol.yaml, for every program that speaks it.

``python firmware/generate.py`` writes what is generated; with ``--check`` it writes nothing and
exits 1 where a generated file is stale.
"""

import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from firmware.made_files import write_or_check

ROOT = Path(__file__).resolve().parent.parent
DESCRIPTION = ROOT / "firmware" / "protocol.yaml"

STRUCT_CODES = {"u8": "B", "i8": "b", "u16": "H", "i16": "h", "u32": "I", "i32": "i"}
SIZES = {"u8": 1, "i8": 1, "u16": 2, "i16": 2, "u32": 4, "i32": 4}
BIT_GROUPS = ("Flags", "Faults")


class DescriptionError(ValueError):
    """protocol.yaml contradicts itself."""


@dataclass(frozen=True, slots=True)
class Field:
    """One field of a message.

    Parameters
    ----------
    name
        Name, with its unit where it has one.
    type
        One of the keys of `SIZES`.
    """

    name: str
    type: str


@dataclass(frozen=True, slots=True)
class Request:
    """One request and its acknowledgement.

    Parameters
    ----------
    name
        Name in lower case.
    type
        The frame's type byte.
    request, reply
        Fields of the two payloads, in order of the wire.
    """

    name: str
    type: int
    request: tuple[Field, ...]
    reply: tuple[Field, ...]


@dataclass(frozen=True, slots=True)
class Description:
    """All of protocol.yaml, checked.

    Parameters
    ----------
    constants
        Every single number, by its name in the generated files, in order.
    enums
        Name of each group, and its members' values.
    requests
        The messages.
    """

    constants: Mapping[str, int]
    enums: Mapping[str, Mapping[str, int]]
    requests: tuple[Request, ...]


def load_description(path: Path = DESCRIPTION) -> Description:
    """Read and check the protocol description.

    Parameters
    ----------
    path
        The YAML file.

    Returns
    -------
    Description
        Its constants, groups and messages.

    Raises
    ------
    DescriptionError
        A value, a name or a length cannot be right.
    """
    tree = yaml.safe_load(path.read_text(encoding="utf-8"))
    if tree["format"] != "usmbench-protocol/1":
        raise DescriptionError(f"{path}: unknown format {tree['format']!r}")
    requests = tuple(_request(name, entry) for name, entry in tree["requests"].items())
    enums = {
        "Flags": tree["flags"],
        "RequestType": {request.name: request.type for request in requests},
        "Refusal": tree["refusals"],
        "ResetCause": tree["reset_causes"],
        "Faults": tree["faults"],
    }
    description = Description(_constants(tree), enums, requests)
    _check(description)
    return description


def _request(name: str, entry: Mapping[str, Any]) -> Request:
    """Read one message."""
    fields = {
        side: tuple(Field(item["name"], item["type"]) for item in entry[side])
        for side in ("request", "reply")
    }
    return Request(name, entry["type"], fields["request"], fields["reply"])


def _constants(tree: Mapping[str, Any]) -> dict[str, int]:
    """Name every single number, and work out the limits as words of the chip."""
    line, framing, dds, limits = tree["line"], tree["framing"], tree["dds"], tree["limits"]
    hz_min, hz_max = limits["frequency_hz"]
    step_hz = dds["clock_hz"] / 2 ** dds["frequency_bits"]
    return {
        "PROTOCOL_VERSION": tree["protocol_version"],
        "BAUD": line["baud"],
        "BITS_PER_BYTE": line["bits_per_byte"],
        "DELIMITER": framing["delimiter"],
        "CRC_POLYNOMIAL": framing["crc"]["polynomial"],
        "CRC_INITIAL": framing["crc"]["initial"],
        "CRC_CHECK": framing["crc"]["check"],
        "MAX_PAYLOAD": framing["max_payload"],
        "ACK_BIT": framing["ack_bit"],
        "REFUSAL_BITS": framing["refusal_bits"],
        "DDS_CLOCK_HZ": dds["clock_hz"],
        "DDS_FREQUENCY_BITS": dds["frequency_bits"],
        "DDS_PHASE_BITS": dds["phase_bits"],
        "FREQUENCY_WORD_MIN": round(hz_min / step_hz),
        "FREQUENCY_WORD_MAX": round(hz_max / step_hz),
        "PHASE_WORD_MIN": limits["phase_word"][0],
        "PHASE_WORD_MAX": limits["phase_word"][1],
        "HOST_SILENCE_MS": limits["host_silence_ms"],
    }


def _check(description: Description) -> None:
    """Refuse what would make two programs understand the wire differently."""
    for group, members in description.enums.items():
        if len(set(members.values())) != len(members):
            raise DescriptionError(f"{group}: a value is used twice")
        if not all(0 <= value <= 0xFF for value in members.values()):
            raise DescriptionError(f"{group}: a value does not fit a byte")
    for group in BIT_GROUPS:
        if any(value.bit_count() != 1 for value in description.enums[group].values()):
            raise DescriptionError(f"{group}: a value is not a single bit")
    for request in description.requests:
        _check_request(request, description.constants)


def _check_request(request: Request, constants: Mapping[str, int]) -> None:
    """Refuse a message that could be taken for another, or does not fit a frame."""
    if request.type & (constants["ACK_BIT"] | constants["REFUSAL_BITS"]):
        raise DescriptionError(f"{request.name}: its type looks like a reply's")
    if request.reply[:1] != (Field("flags", "u8"),):
        raise DescriptionError(f"{request.name}: its reply does not start with the flags")
    for fields in (request.request, request.reply):
        if sum(SIZES[field.type] for field in fields) > constants["MAX_PAYLOAD"]:
            raise DescriptionError(f"{request.name}: longer than max_payload")


def render_python(description: Description) -> str:
    """Write the host's module.

    Parameters
    ----------
    description
        What to write.

    Returns
    -------
    str
        Source text of usmbench.instruments.protocol._generated.
    """
    lines = [
        '"""The wire in numbers. Made from firmware/protocol.yaml by firmware/generate.py."""',
        "",
        "from enum import IntEnum, IntFlag",
        "from typing import Final",
        "",
        *(f"{name}: Final = {_number(name, v)}" for name, v in description.constants.items()),
    ]
    for group, members in description.enums.items():
        base = "IntFlag" if group in BIT_GROUPS else "IntEnum"
        lines += ["", "", f"class {group}({base}):"]
        lines += [f"    {name.upper()} = 0x{value:02X}" for name, value in members.items()]
    lines += ["", "", "# Name and struct code of each field; little-endian, no padding."]
    lines += ["Layout = tuple[tuple[str, str], ...]"]
    for side in ("request", "reply"):
        lines += ["", f"{side.upper()}_LAYOUTS: Final[dict[RequestType, Layout]] = {{"]
        for request in description.requests:
            lines += _layout(request.name, getattr(request, side))
        lines.append("}")
    return "\n".join(lines) + "\n"


def _number(name: str, value: int) -> str:
    """Write bit patterns in hexadecimal, quantities in decimal."""
    patterns = ("CRC_", "ACK_", "REFUSAL_", "DELIMITER")
    return f"0x{value:02X}" if name.startswith(patterns) else str(value)


def _layout(name: str, fields: tuple[Field, ...]) -> list[str]:
    """Write one message's fields as the formatter would."""
    items = [f'("{field.name}", "{STRUCT_CODES[field.type]}"),' for field in fields]
    key = f"    RequestType.{name.upper()}:"
    if len(items) < 2:
        return [f"{key} ({''.join(items)}),"]
    return [f"{key} (", *(f"        {item}" for item in items), "    ),"]


ASSEMBLER_PREFIXES = {
    "Flags": "FLAG",
    "RequestType": "REQUEST",
    "Refusal": "REFUSAL",
    "ResetCause": "RESET",
    "Faults": "FAULT",
}


def render_assembler(description: Description) -> str:
    """Write the firmware's include file.

    Parameters
    ----------
    description
        What to write.

    Returns
    -------
    str
        Source text of firmware/src/protocol.inc: the same numbers for gpasm, bit numbers for the
        groups of bits, and of each message the payload lengths and the request's field offsets.
    """
    lines = ["; The wire in numbers. Made from firmware/protocol.yaml by firmware/generate.py.", ""]
    lines += [_equate(name, value) for name, value in description.constants.items()]
    for group, members in description.enums.items():
        prefix = ASSEMBLER_PREFIXES[group]
        lines.append("")
        for name, value in members.items():
            lines.append(_equate(f"{prefix}_{name.upper()}", value))
            if group in BIT_GROUPS:
                lines.append(_equate(f"{prefix}_{name.upper()}_BIT", value.bit_length() - 1))
    for request in description.requests:
        lines += ["", *_message_equates(request)]
    return "\n".join(lines) + "\n"


def _equate(name: str, value: int) -> str:
    """Write one constant for gpasm."""
    return f"{name:<40}equ     {value}"


def _message_equates(request: Request) -> list[str]:
    """Write one message's lengths and the offsets in its request's payload."""
    prefix = request.name.upper()
    lines, offset = [], 0
    for field in request.request:
        lines.append(_equate(f"{prefix}_{field.name.upper()}", offset))
        offset += SIZES[field.type]
    lines.append(_equate(f"{prefix}_REQUEST_LENGTH", offset))
    reply_length = sum(SIZES[field.type] for field in request.reply)
    return [*lines, _equate(f"{prefix}_REPLY_LENGTH", reply_length)]


OUTPUTS: dict[Path, Callable[[Description], str]] = {
    ROOT / "src/usmbench/instruments/protocol/_generated.py": render_python,
    ROOT / "firmware/src/protocol.inc": render_assembler,
}


def main(arguments: list[str] | None = None) -> int:
    """Write every output, or compare with it.

    Parameters
    ----------
    arguments
        Command line without the program's name; None takes the process's own.

    Returns
    -------
    int
        Exit status: 1 where `--check` found a stale file, 2 where protocol.yaml is wrong.
    """
    try:
        return write_or_check(arguments, "generate.py", "Make the constants of the wire.", _texts)
    except DescriptionError as error:
        sys.stderr.write(f"{error}\n")
        return 2


def _texts() -> dict[Path, str]:
    description = load_description()
    return {path: render(description) for path, render in OUTPUTS.items()}


if __name__ == "__main__":
    sys.exit(main())
