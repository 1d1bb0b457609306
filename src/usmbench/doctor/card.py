"""The data acquisition card: its driver, its settings, and a shaft that stands still."""

from collections.abc import Generator
from typing import Final

import numpy as np

from usmbench.doctor.finding import Finding, skipped
from usmbench.errors import DaqError, InputError
from usmbench.instruments.nidaq import NiSampleSource
from usmbench.instruments.nidaq_driver import driver_version
from usmbench.instruments.nidaq_errors import where
from usmbench.instruments.samples import SampleBlock
from usmbench.settings.bench import BenchSettings, DaqSettings

_REST_S: Final = 0.3
# A shaft at rest on the edge of a line: the counter may go there and back.
_REST_COUNTS: Final = 1
_PLAUSIBLE_C: Final = (-10.0, 100.0)


def check_card(bench: BenchSettings) -> Generator[Finding, None, bool]:
    """Walk from the driver to the samples of a motor that is not driven.

    Parameters
    ----------
    bench
        The bench.

    Yields
    ------
    Finding
        One for each check.

    Returns
    -------
    bool
        Whether samples came.
    """
    daq = bench.daq
    place = "on this computer" if daq.address is None else f"at {daq.address}"
    try:
        version = driver_version(daq)
    except InputError as error:
        yield Finding(
            "driver",
            "failed",
            str(error),
            "install NI-DAQmx here, or start the NI gRPC device server on the computer that holds "
            "the card and give its host:port as daq.address",
        )
        yield from skipped(("card", "samples at rest"), "there is no driver")
        return False
    yield Finding("driver", "ok", f"NI-DAQmx {version} {place}")
    try:
        source = NiSampleSource(daq, bench.temperature, lines=bench.encoder.lines)
    except InputError as error:
        yield Finding(
            "card",
            "failed",
            str(error),
            "compare the daq section of the bench file with what NI MAX shows: device, counters, "
            "family, sample clock",
        )
        yield from skipped(("samples at rest",), "the card cannot be opened")
        return False
    with source:
        yield Finding("card", "ok", f"{where(daq)} takes the settings: {_wiring(daq)}")
        try:
            blocks = _blocks(source, bench.window_s)
        except DaqError as error:
            do = "look at the sample clock, and whether another program uses the card"
            yield Finding("samples at rest", "failed", str(error), do)
            return False
    yield _at_rest(blocks, bench)
    return True


def _wiring(daq: DaqSettings) -> str:
    decoding = "X4" if daq.family == "m_x" else "up/down"
    index = "no index" if daq.index_counter is None else f"index on {daq.index_counter}"
    return (
        f"encoder on {daq.counter} ({decoding}), {index}, "
        f"clock {daq.sample_clock} at {daq.sample_rate_hz:g} Hz"
    )


def _blocks(source: NiSampleSource, window_s: float) -> list[SampleBlock]:
    source.start()
    return [source.next_block() for _ in range(max(2, round(_REST_S / window_s)))]


def _at_rest(blocks: list[SampleBlock], bench: BenchSettings) -> Finding:
    """Say whether anything moves that is not driven."""
    counts = np.concatenate([block.counts for block in blocks])
    travelled, edges = int(np.ptp(counts)), int(np.count_nonzero(np.diff(counts)))
    saw = f"{len(counts)} samples, {edges} counts while the drive is off"
    temperature_c = blocks[-1].temperature_c
    if temperature_c is not None:
        saw += f", {temperature_c:.1f} °C"
        if not _PLAUSIBLE_C[0] <= temperature_c <= _PLAUSIBLE_C[1]:
            do = "look at the sensor's wires, and at degrees_c_per_volt in the bench file"
            return Finding("samples at rest", "failed", saw, do)
        if temperature_c > bench.interlocks.temperature_max_c:
            do = "let the motor cool: above interlocks.temperature_max_c it is not driven"
            return Finding("samples at rest", "failed", saw, do)
    if travelled > _REST_COUNTS:
        do = "leave the shaft alone; if nobody touched it, look at the encoder's screen and ground"
        return Finding("samples at rest", "warning", saw, do)
    return Finding("samples at rest", "ok", saw)
