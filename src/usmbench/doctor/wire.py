"""The way to the signal generator board: port, board, protocol, limits."""

from collections.abc import Generator
from contextlib import ExitStack
from dataclasses import replace
from time import perf_counter
from typing import Final

from usmbench.doctor.finding import Finding, skipped
from usmbench.errors import BenchError, InputError
from usmbench.instruments import dds
from usmbench.instruments.generator import AUTO, SignalGenerator
from usmbench.instruments.ports import find_board, open_port
from usmbench.instruments.protocol._generated import ResetCause
from usmbench.instruments.protocol.messages import Identity
from usmbench.settings.bench import GeneratorSettings

_ROUND_TRIPS: Final = 20
# USB adapters hold every short reply back for 16 ms unless told otherwise, a busy computer some.
_SLOW_REPLY_S: Final = 0.010
_ORDINARY_RESETS: Final = (ResetCause.POWER_ON, ResetCause.EXTERNAL)


def check_wire(
    settings: GeneratorSettings, stack: ExitStack
) -> Generator[Finding, None, SignalGenerator | None]:
    """Walk from the port to the board's limits; the drive is off afterwards.

    Parameters
    ----------
    settings
        Port and limits, from the bench file.
    stack
        Closes the generator, with its drive off, when the examination ends.

    Yields
    ------
    Finding
        One for each check.

    Returns
    -------
    SignalGenerator or None
        The open generator, None where it cannot be used.
    """
    try:
        name = find_board() if settings.port == AUTO else settings.port
        open_port(name).close()
    except InputError as error:
        yield Finding(
            "port",
            "failed",
            str(error),
            "plug the board in and switch it on; then see that generator.port in the bench file "
            "names its port, and that you may open it",
        )
        yield from skipped(("board", "protocol", "limits"), "there is no port to ask on")
        return None
    how = "a board answered on it" if settings.port == AUTO else "it opens"
    yield Finding("port", "ok", f"{name}: {how}")
    generator = yield from _open(replace(settings, port=name), stack)
    if generator is None:
        return None
    yield _check_limits(settings, generator.identity)
    return generator


def _open(
    settings: GeneratorSettings, stack: ExitStack
) -> Generator[Finding, None, SignalGenerator | None]:
    """Identify the board and ask what became of it."""
    try:
        generator = stack.enter_context(SignalGenerator.open(settings))
        board = _check_board(generator)
    except InputError as error:
        yield Finding("board", "ok", f"it answers on {settings.port}")
        yield Finding(
            "protocol",
            "failed",
            str(error),
            "bring board and computer to one version: flash the firmware that belongs to this "
            "usmbench (make -C firmware), or install the usmbench that belongs to the board",
        )
        yield from skipped(("limits",), "the board's answers are not understood")
        return None
    except BenchError as error:
        yield Finding(
            "board",
            "failed",
            str(error),
            "look at the board's supply, at TX and RX (crossed, on the board's own ground), and "
            "whether another program talks on this port",
        )
        yield from skipped(("protocol", "limits"), "the board does not answer")
        return None
    identity = generator.identity
    yield board
    yield Finding(
        "protocol",
        "ok",
        f"version {identity.protocol_version}; generators with a {identity.clock_hz / 1e6:g} MHz "
        f"clock, {identity.frequency_bits} frequency bits, {identity.phase_bits} phase bits",
    )
    return generator


def _check_board(generator: SignalGenerator) -> Finding:
    """Ask the board what happened to it, and how long it takes to say so."""
    times_s = []
    for _ in range(_ROUND_TRIPS):
        begin_s = perf_counter()
        status = generator.status()
        times_s.append(perf_counter() - begin_s)
    reply_s = min(times_s)
    identity, cause = generator.identity, status.reset_cause
    saw = (
        f"firmware {identity.firmware_major}.{identity.firmware_minor}, drive off, last restart: "
        f"{cause.name.lower().replace('_', ' ')}, {status.bad_frames} bad frames since, replies "
        f"in {1e3 * reply_s:.1f} ms at best"
    )
    if cause not in _ORDINARY_RESETS:
        return Finding(
            "board", "warning", saw, "look at the board's supply: it did not restart by itself"
        )
    if status.bad_frames:
        return Finding("board", "warning", saw, "look at the serial cable, its ground and length")
    if reply_s > _SLOW_REPLY_S:
        return Finding("board", "warning", saw, "set the latency timer of the USB adapter to 1 ms")
    return Finding("board", "ok", saw)


def _check_limits(settings: GeneratorSettings, board: Identity) -> Finding:
    """Hold the limits of the lab against the board's own."""
    low_hz, high_hz = (
        dds.word_to_frequency_hz(word)
        for word in (board.frequency_word_min, board.frequency_word_max)
    )
    low_deg, high_deg = (
        dds.word_to_phase_deg(word) for word in (board.phase_word_min, board.phase_word_max)
    )
    lab_hz, lab_deg = settings.frequency_limits_hz, settings.phase_limits_deg
    saw = (
        f"bench file {lab_hz[0]:g} to {lab_hz[1]:g} Hz and {lab_deg[0]:g} to {lab_deg[1]:g}°; "
        f"board {low_hz:.0f} to {high_hz:.0f} Hz and {low_deg:.0f} to {high_deg:.0f}°"
    )
    step_hz, step_deg = dds.FREQUENCY_STEP_HZ, dds.PHASE_STEP_DEG
    inside_hz = low_hz - step_hz <= lab_hz[0] and lab_hz[1] <= high_hz + step_hz
    inside_deg = low_deg - step_deg <= lab_deg[0] and lab_deg[1] <= high_deg + step_deg
    if inside_hz and inside_deg:
        return Finding("limits", "ok", saw)
    if lab_hz[1] < low_hz or lab_hz[0] > high_hz:
        do = "correct generator.frequency_limits_hz: the board takes none of these frequencies"
        return Finding("limits", "failed", saw, do)
    part = "phase_limits_deg" if inside_hz else "frequency_limits_hz"
    do = f"narrow generator.{part} to what the board takes; it refuses the rest"
    return Finding("limits", "warning", saw, do)
