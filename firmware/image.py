"""Make the flash image of what gplink wrote.

``python firmware/image.py LINKED.hex IMAGE.hex``. Two things are changed, and the result is what is
flashed and what the simulator runs:

* Configuration bytes are written as whole even-aligned words. gpasm starts a record at the odd
  address 0x300001, which some readers (gpsim among them) take for the word before.
* Unused flash is filled with "branch to itself", so that a program counter gone astray stays there
  until the watchdog resets the chip, instead of walking through erased words back to the start.
"""

import sys
from collections.abc import Iterator
from pathlib import Path

FLASH_BYTES = 0x8000
CONFIG_START, CONFIG_END = 0x300000, 0x30000E
BRANCH_TO_ITSELF = b"\xff\xd7"
ERASED = 0xFF
RECORD_BYTES = 16
DATA, END_OF_FILE, UPPER_ADDRESS = 0, 1, 4


def read_hex(text: str) -> dict[int, int]:
    """Read an Intel hex file.

    Parameters
    ----------
    text
        Its contents.

    Returns
    -------
    dict
        Byte at each address.

    Raises
    ------
    ValueError
        A record is malformed, or its checksum is wrong.
    """
    memory: dict[int, int] = {}
    upper = 0
    for line in text.split():
        record = bytes.fromhex(line.removeprefix(":"))
        if sum(record) & 0xFF or len(record) != record[0] + 5:
            raise ValueError(f"bad record {line}")
        kind, payload = record[3], record[4:-1]
        if kind == UPPER_ADDRESS:
            upper = int.from_bytes(payload, "big") << 16
        elif kind == DATA:
            start = upper + int.from_bytes(record[1:3], "big")
            memory.update(enumerate(payload, start))
    return memory


def make_image(memory: dict[int, int]) -> dict[int, int]:
    """Fill the flash and complete the configuration words.

    Parameters
    ----------
    memory
        Byte at each address, as linked.

    Returns
    -------
    dict
        Byte at each address of the whole flash and the configuration.
    """
    image = {address: BRANCH_TO_ITSELF[address % 2] for address in range(FLASH_BYTES)}
    image |= dict.fromkeys(range(CONFIG_START, CONFIG_END), ERASED)
    return image | memory


def write_hex(memory: dict[int, int]) -> str:
    """Write an Intel hex file with even-aligned records.

    Parameters
    ----------
    memory
        Byte at each address.

    Returns
    -------
    str
        The file's contents.
    """
    lines = []
    upper = None
    for start, payload in _records(memory):
        if start >> 16 != upper:
            upper = start >> 16
            lines.append(_record(UPPER_ADDRESS, 0, upper.to_bytes(2, "big")))
        lines.append(_record(DATA, start & 0xFFFF, payload))
    lines.append(_record(END_OF_FILE, 0, b""))
    return "\n".join(lines) + "\n"


def _records(memory: dict[int, int]) -> Iterator[tuple[int, bytes]]:
    """Cut the memory into runs that start at multiples of the record length."""
    for start in sorted({address // RECORD_BYTES * RECORD_BYTES for address in memory}):
        yield start, bytes(memory[a] for a in range(start, start + RECORD_BYTES) if a in memory)


def _record(kind: int, address: int, payload: bytes) -> str:
    """Write one record with its checksum."""
    body = bytes([len(payload), address >> 8, address & 0xFF, kind]) + payload
    return f":{(body + bytes([-sum(body) & 0xFF])).hex().upper()}"


def main(arguments: list[str]) -> None:
    """Read the first file and write the second.

    Parameters
    ----------
    arguments
        The two paths.
    """
    linked, image = map(Path, arguments)
    memory = read_hex(linked.read_text(encoding="ascii"))
    image.write_text(write_hex(make_image(memory)), encoding="ascii")


if __name__ == "__main__":
    main(sys.argv[1:])
