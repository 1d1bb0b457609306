"""Random frames and noise against the firmware in gpsim, with the emulated board as the oracle.

Every reply, every word that the chips get and every change of the drive is compared, in order;
after the last frame both boards must have stopped for the host's silence. Bus times, interrupt time
and stack depth of the whole run are printed at the end.

``python benchmarks/firmware_fuzz.py`` runs 100,000 chunks; build the image with `make -C firmware`.
"""

import argparse
import random
import struct
import sys
import time
from collections.abc import Iterator

from hil_sim.board import Board
from hil_sim.gpsim_board import GpsimBoard
from hil_sim.gpsim_bridge import CYCLES_PER_SECOND, GpsimBridge
from hil_sim.line import BYTE_S
from hil_sim.signals import Drive
from hil_sim.testbed import BoardMachine
from usmbench.instruments.protocol import _generated as wire
from usmbench.instruments.protocol._generated import RequestType, ResetCause
from usmbench.instruments.protocol.frames import encode_frame

CHUNKS, SMALL_CHUNKS = 100_000, 1500
BATCH = 250
SILENCE_S = 1.1
# Longest reply, and the board's time to make it.
ANSWER_S = 36 * BYTE_S + 0.001
RESET_CAUSES = (ResetCause.EXTERNAL, ResetCause.WATCHDOG, ResetCause.BROWN_OUT, ResetCause.POWER_ON)

Seen = tuple[list[bytes], list[tuple[str, int]], list[Drive]]


class Pair:
    """Both boards on one line, and what they did since the last comparison."""

    def __init__(self, bridge: GpsimBridge):
        self.words: tuple[list[tuple[str, int]], list[tuple[str, int]]] = ([], [])
        self.emulated = Board(spi_log=lambda _t, chips, word: self.words[0].append((chips, word)))
        self.image = GpsimBoard(
            bridge, spi_log=lambda _t, chips, word: self.words[1].append((chips, word))
        )
        self.now_s = 0.001

    def send(self, data: bytes) -> None:
        """Put bytes on the line, and wait for all that they may bring."""
        self.image.advance(self.now_s)
        self.image.receive_burst(data, self.now_s)
        for byte in data:
            self.now_s += BYTE_S
            self.emulated.receive(byte, self.now_s)
        self.wait(ANSWER_S * data.count(0))

    def wait(self, duration_s: float) -> None:
        """Let time pass for both."""
        self.now_s = max(self.now_s, self.image.time_s) + duration_s
        self.emulated.advance(self.now_s)
        self.image.advance(self.now_s)

    def reset(self, cause: ResetCause) -> None:
        """Reset both; by which steps the drive goes off is the board's own affair."""
        self.emulated.reset(self.now_s, cause)
        self.image.reset(self.now_s, cause)
        self.wait(0.001)
        for board in (self.emulated, self.image):
            del board.drive_changes[:-1]

    def seen(self) -> tuple[Seen, Seen]:
        """Return what each did, and forget it."""
        both: list[Seen] = []
        boards: tuple[BoardMachine, BoardMachine] = (self.emulated, self.image)
        for board, words in zip(boards, self.words, strict=True):
            replies = [reply for _, reply in board.replies]
            both.append((replies, words.copy(), [drive for _, drive in board.drive_changes]))
            board.replies.clear()
            board.drive_changes.clear()
            words.clear()
        return both[0], both[1]


def chunks(rng: random.Random, count: int) -> Iterator[bytes]:
    """Give requests, sound, wrong and broken, noise, and several of them at once."""
    last = encode_frame(0, RequestType.IDENTIFY, b"")
    for _ in range(count):
        draw = rng.random()
        if draw < 0.08:
            yield last
        elif draw < 0.20:
            yield bytes(rng.randrange(256) for _ in range(rng.randrange(1, 60))) + b"\0"
        elif draw < 0.30:
            yield corrupted(rng, request(rng))
        elif draw < 0.35:
            yield b"".join(request(rng) for _ in range(rng.randrange(2, 5)))
        else:
            last = request(rng)
            yield last


def request(rng: random.Random) -> bytes:
    """Encode a request; most of them make sense."""
    sequence, draw = rng.randrange(256), rng.random()
    if draw < 0.05:
        payload = bytes(rng.randrange(256) for _ in range(rng.randrange(33)))
        return encode_frame(sequence, rng.randrange(256), payload)
    kind = rng.choice(list(RequestType))
    return encode_frame(sequence, kind, payload_of(rng, kind))


def payload_of(rng: random.Random, kind: RequestType) -> bytes:
    """Draw values in range, at the limits, and beyond."""
    near = (wire.FREQUENCY_WORD_MIN, wire.FREQUENCY_WORD_MAX)
    frequency = rng.choice(near) + rng.randrange(-2, 3)
    if rng.random() < 0.7:
        frequency = rng.randrange(near[0], near[1] + 1)
    phase = rng.choice((rng.randrange(-2048, 2049), rng.randrange(-2051, 2052)))
    if rng.random() < 0.05:
        phase = rng.randrange(-32768, 32768)
    if kind is RequestType.SET_DRIVE:
        return struct.pack("<Ih", frequency, phase)
    if kind is RequestType.SET_PHASE:
        return struct.pack("<h", phase)
    if kind is RequestType.OUTPUTS:
        return bytes((rng.choice((0, 1, 1, 1, 2, 255)),))
    return b""


def corrupted(rng: random.Random, frame: bytes) -> bytes:
    """Flip, lose, double or insert a byte."""
    place = rng.randrange(len(frame))
    kind = rng.randrange(4)
    if kind == 0:
        flipped = bytes((frame[place] ^ (1 << rng.randrange(8)),))
        return frame[:place] + flipped + frame[place + 1 :]
    if kind == 1:
        return frame[:place] + frame[place + 1 :] or b"\0"
    extra = frame[place : place + 1] if kind == 2 else bytes((rng.randrange(256),))
    return frame[:place] + extra + frame[place:]


def compare(pair: Pair, sent: int) -> int:
    """Hold both boards against each other; return the number of replies."""
    emulated, image = pair.seen()
    for name, ours, theirs in zip(("replies", "words", "drives"), emulated, image, strict=True):
        if ours != theirs:
            raise SystemExit(f"after {sent} chunks the {name} differ:\n{ours}\n{theirs}")
    if pair.image.errors:
        raise SystemExit(f"after {sent} chunks: {pair.image.errors}")
    return len(image[0])


def check_stop(pair: Pair) -> None:
    """Drive, fall silent, and see that both boards stop."""
    pair.send(b"\0" + encode_frame(0, RequestType.IDENTIFY, b""))
    fields = struct.pack("<Ih", wire.FREQUENCY_WORD_MIN, 0)
    pair.send(encode_frame(1, RequestType.SET_DRIVE, fields))
    pair.send(encode_frame(2, RequestType.OUTPUTS, b"\1"))
    pair.wait(SILENCE_S)
    for _, _, drives in pair.seen():
        if [drive.amplitude_b for drive in drives[-2:]] != [1.0, 0.0]:
            raise SystemExit("a drive was left on, or would not start")


def run(count: int, seed: int) -> None:
    """Send the chunks, and print what came of it."""
    rng, began_s = random.Random(seed), time.process_time()
    replies = silences = resets = 0
    with GpsimBridge() as bridge:
        pair = Pair(bridge)
        for sent, chunk in enumerate(chunks(rng, count), start=1):
            pair.send(chunk)
            if sent % BATCH == 0:
                replies += compare(pair, sent)
            if rng.random() < 1 / 1000:
                silences += 1
                pair.wait(SILENCE_S)
            if rng.random() < 1 / 300:
                resets += 1
                replies += compare(pair, sent)
                pair.reset(rng.choice(RESET_CAUSES))
        replies += compare(pair, count)
        check_stop(pair)
        (measured,) = bridge.command("measure")
        simulated_s = bridge.cycle / CYCLES_PER_SECOND
    print(f"{count} chunks (seed {seed}): {replies} replies, {silences} silences, {resets} resets")
    print("replies, DDS words and drives of both boards are equal; the drive stops at the end")
    print(
        f"{simulated_s:.0f} s simulated, {time.process_time() - began_s:.0f} s CPU of the host side"
    )
    print(", ".join(f"{name} {value}" for name, value in measured.items() if name != "cycle"))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--small", action="store_true", help=f"{SMALL_CHUNKS} chunks")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    run(SMALL_CHUNKS if arguments.small else CHUNKS, arguments.seed)
    return 0


if __name__ == "__main__":
    sys.exit(main())
