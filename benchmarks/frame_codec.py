"""Corrupted frames against the codec: how many wrong ones it accepts.

A CRC-16 with this polynomial sees every change of up to three bits (at these lengths its Hamming
distance is 4) and every change within 16 consecutive bits. That holds for a frame whose COBS
lengths are intact; where a length or a zero is hit, and for arbitrary bytes, one in 65536 passes.
Run as ``python benchmarks/frame_codec.py``; ``--small`` takes seconds.
"""

import argparse
import itertools
import math
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from usmbench.instruments.protocol._generated import DELIMITER, MAX_PAYLOAD
from usmbench.instruments.protocol.frames import (
    DELIMITER_BYTE,
    MAX_ENCODED,
    FrameReader,
    decode_frame,
    encode_frame,
)

Bytes = NDArray[np.uint8]
Masks = Callable[[np.random.Generator, int, int], Bytes]

CRC_PASSES = 2.0**-16
PER_FRAME = 1000
CRC_SIZE = 2
MAX_BURST_BITS = 16


@dataclass
class Row:
    """What became of one kind of corruption; `sure` are those that a CRC-16 must refuse."""

    name: str
    sure: int = 0
    sure_accepted: int = 0
    other: int = 0
    other_accepted: int = 0

    @property
    def allowed(self) -> float:
        """Wrong frames that a CRC-16 lets through, with five standard deviations."""
        expected = self.other * CRC_PASSES
        return expected + 5.0 * math.sqrt(expected)

    @property
    def passed(self) -> bool:
        """Whether it accepted no more than a CRC-16 must."""
        return self.sure_accepted == 0 and self.other_accepted <= self.allowed

    def take(self, corrupted: Bytes, sure: NDArray[np.bool_]) -> None:
        """Feed corrupted frames, one a line, each between intact delimiters."""
        delimiters = np.full((len(corrupted), 1), DELIMITER, dtype=np.uint8)
        stream = np.hstack([corrupted, delimiters]).tobytes()
        self.sure += int(np.count_nonzero(sure))
        self.other += int(np.count_nonzero(~sure))
        if not FrameReader().feed(stream):
            return
        for line, is_sure in zip(corrupted, sure, strict=True):
            accepted = len(FrameReader().feed(line.tobytes() + DELIMITER_BYTE))
            self.sure_accepted += accepted * bool(is_sure)
            self.other_accepted += accepted * (not is_sure)


def length_bytes(encoded: bytes) -> NDArray[np.bool_]:
    """Mark the COBS lengths of an encoded frame."""
    marked = np.zeros(len(encoded), dtype=np.bool_)
    place = 0
    while place < len(encoded):
        marked[place] = True
        place += encoded[place]
    return marked


def structure_kept(encoded: bytes, corrupted: Bytes) -> NDArray[np.bool_]:
    """Tell which corrupted frames have all their lengths, and no new zero."""
    original = np.frombuffer(encoded, dtype=np.uint8)
    hit = (corrupted != original) & length_bytes(encoded)
    harmed = hit.any(axis=1) | (corrupted == DELIMITER).any(axis=1)
    return np.asarray(~harmed, dtype=np.bool_)


def within_two_bytes(encoded: bytes, corrupted: Bytes) -> NDArray[np.bool_]:
    """Tell which changes span 16 bits as the CRC counts them: two neighbours, not across its edge.

    The line sends the low bit first and the CRC takes the high bit first, so 16 bits on the line
    may touch three bytes; a length byte between two neighbours stands for a zero of the content.
    """
    changed = corrupted != np.frombuffer(encoded, dtype=np.uint8)
    first = changed.argmax(axis=1)
    last = changed.shape[1] - 1 - changed[:, ::-1].argmax(axis=1)
    edge = len(encoded) - CRC_SIZE
    same_side = (first >= edge) == (last >= edge)
    return np.asarray((last - first <= 1) & same_side, dtype=np.bool_)


def flips(rng: np.random.Generator, size: int, n: int) -> Bytes:
    """Draw masks that flip one to three bits."""
    mask = np.zeros((n, size), dtype=np.uint8)
    n_flips = rng.integers(1, 4, n)
    for k in range(3):
        line = np.flatnonzero(n_flips > k)
        bit = rng.integers(0, 8 * size, len(line))
        mask[line, bit // 8] ^= (1 << (bit % 8)).astype(np.uint8)
    return mask


def bursts(rng: np.random.Generator, size: int, n: int) -> Bytes:
    """Draw masks of up to 16 consecutive bits of the line, both ends flipped."""
    length = rng.integers(1, MAX_BURST_BITS + 1, n)[:, None]
    start = (rng.random((n, 1)) * (8 * size - length + 1)).astype(np.int64)
    place = np.arange(8 * size)[None, :] - start
    bits = rng.integers(0, 2, (n, 8 * size), dtype=np.uint8)
    bits = np.where((place == 0) | (place == length - 1), 1, bits)
    bits = np.where((place >= 0) & (place < length), bits, 0).astype(np.uint8)
    return np.packbits(bits, axis=1, bitorder="little")


def random_frame(rng: np.random.Generator) -> bytes:
    """Draw a frame of any length, without its delimiter."""
    content = rng.bytes(2 + int(rng.integers(0, MAX_PAYLOAD + 1)))
    return encode_frame(content[0], content[1], content[2:])[:-1]


def masked(name: str, rng: np.random.Generator, n: int, masks: Masks) -> Row:
    """Corrupt random frames by drawn masks."""
    row = Row(name)
    for _ in range(math.ceil(n / PER_FRAME)):
        encoded = random_frame(rng)
        mask = masks(rng, len(encoded), PER_FRAME)
        mask = mask[mask.any(axis=1)]
        corrupted = mask ^ np.frombuffer(encoded, dtype=np.uint8)
        sure = structure_kept(encoded, corrupted)
        if masks is bursts:
            sure &= within_two_bytes(encoded, corrupted)
        row.take(corrupted, sure)
    return row


def every_flip(rng: np.random.Generator, sizes: range) -> Row:
    """Flip every one, two and three bits of a frame of each payload size."""
    row = Row("every 1 to 3 bits")
    for size in sizes:
        encoded = encode_frame(int(rng.integers(256)), int(rng.integers(256)), rng.bytes(size))[:-1]
        singles = np.packbits(np.eye(8 * len(encoded), dtype=np.uint8), axis=1)
        for k in (1, 2, 3):
            chosen = np.array(list(itertools.combinations(range(len(singles)), k)))
            mask = np.bitwise_xor.reduce(singles[chosen], axis=1)
            corrupted = mask ^ np.frombuffer(encoded, dtype=np.uint8)
            row.take(corrupted, structure_kept(encoded, corrupted))
    return row


def stuffed(rng: np.random.Generator) -> bytes:
    """Draw arbitrary content in sound COBS: only the CRC can refuse it."""
    content = rng.bytes(int(rng.integers(4, MAX_PAYLOAD + 5)))
    return b"".join(bytes((len(run) + 1,)) + run for run in content.split(DELIMITER_BYTE))


def garbage(rng: np.random.Generator) -> bytes:
    """Draw arbitrary bytes."""
    return rng.bytes(int(rng.integers(1, MAX_ENCODED + 4)))


def slipped(rng: np.random.Generator) -> bytes:
    """Lose or double a byte of a frame; a lost delimiter joins it to the next one."""
    encoded = random_frame(rng)
    place = int(rng.integers(0, len(encoded)))
    kind = rng.random()
    if kind < 0.4:
        return encoded[:place] + encoded[place:][:1] + encoded[place:]
    if kind < 0.8:
        return encoded[:place] + encoded[place + 1 :]
    return encoded + random_frame(rng)


def drawn(
    name: str, rng: np.random.Generator, n: int, draw: Callable[[np.random.Generator], bytes]
) -> Row:
    """Feed drawn bytes, one frame after the other."""
    row = Row(name, other=n)
    for _ in range(n):
        stretches = draw(rng).split(DELIMITER_BYTE)
        row.other_accepted += sum(decode_frame(stretch) is not None for stretch in stretches)
    return row


def campaign(n: int, seed: int) -> Iterator[Row]:
    """Corrupt about `n` frames in all ways."""
    rng = np.random.default_rng(seed)
    yield every_flip(rng, range(7 if n > 1_000_000 else 2))
    yield masked("1 to 3 bits, any", rng, round(0.35 * n), flips)
    yield masked("burst up to 16 bits", rng, round(0.35 * n), bursts)
    yield drawn("lost or doubled byte", rng, round(0.05 * n), slipped)
    yield drawn("any bytes", rng, round(0.05 * n), garbage)
    yield drawn("any content, sound COBS", rng, round(0.2 * n), stuffed)


def main(arguments: list[str] | None = None) -> int:
    """Print the table; exit 1 where a row accepts more than a CRC-16 must."""
    parser = argparse.ArgumentParser(description="Corrupted frames against the codec.")
    parser.add_argument("--small", action="store_true", help="seconds instead of minutes")
    parser.add_argument("--seed", type=int, default=0, help="seed of the corruption")
    options = parser.parse_args(arguments)
    rows = list(campaign(200_000 if options.small else 10_000_000, options.seed))
    print("                           CRC must refuse          CRC lets one in 65536 pass")
    print("corruption                   frames  accepted          frames  accepted  allowed")
    for row in rows:
        print(
            f"{row.name:<25} {row.sure:>9} {row.sure_accepted:>9}    "
            f"{row.other:>12} {row.other_accepted:>9} {row.allowed:>8.1f}"
        )
    n = sum(row.sure + row.other for row in rows)
    accepted = sum(row.sure_accepted + row.other_accepted for row in rows)
    print(f"{n} corrupted frames, {accepted} accepted: one in {n / max(accepted, 1):.0f}")
    return 0 if all(row.passed for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
