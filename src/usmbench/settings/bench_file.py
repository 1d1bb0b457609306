"""Bench files: read, checked, and errors that name the line."""

from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

from usmbench.settings.bench import (
    BenchSettings,
    DaqSettings,
    EncoderSettings,
    GeneratorSettings,
    InterlockSettings,
    TemperatureSettings,
)
from usmbench.settings.schema import check
from usmbench.settings.yaml_source import Source, read_source

FORMAT = "usmbench-bench/1"
# The sign of life to the board, which waits one second, goes out between windows.
MAX_WINDOW_S = 0.25


def bench_document(bench: BenchSettings) -> dict[str, Any]:
    """Return settings as a bench file has them, for the run folder.

    Parameters
    ----------
    bench
        The settings.
    """
    return {"format": FORMAT, **_plain(asdict(bench))}


def _plain(value: Any) -> Any:
    """Return the value with lists for tuples, as YAML and the schema know them."""
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    return [_plain(item) for item in value] if isinstance(value, tuple) else value


def load_bench(file: Path | str) -> BenchSettings:
    """Read a bench file.

    Parameters
    ----------
    file
        The file.

    Raises
    ------
    usmbench.errors.InputError
        The file is not there or wrong; names the line and the mend.
    """
    return parse_bench(read_source(Path(file)))


def parse_bench(source: Source) -> BenchSettings:
    """Return the settings a document holds.

    Parameters
    ----------
    source
        The document of a bench file, or of the bench in a run.yaml.

    Raises
    ------
    usmbench.errors.InputError
        A setting is wrong; names the line and the mend.
    """
    check(source, "bench")
    bench: BenchSettings = _build(BenchSettings, source.document)
    _check_consistent(bench, source)
    return bench


_SECTIONS: dict[str, type[Any]] = {
    "generator": GeneratorSettings,
    "daq": DaqSettings,
    "encoder": EncoderSettings,
    "interlocks": InterlockSettings,
    "temperature": TemperatureSettings,
}


def _build(kind: type[Any], document: dict[str, Any]) -> Any:
    names = {part.name for part in fields(kind)}
    values = {key: _value(key, value) for key, value in document.items() if key in names}
    return kind(**values)


def _value(key: str, value: Any) -> Any:
    if isinstance(value, dict):
        return _build(_SECTIONS[key], value)
    return tuple(value) if isinstance(value, list) else value


def _check_consistent(bench: BenchSettings, source: Source) -> None:
    """Refuse settings that are fine alone and wrong together."""
    generator, daq = bench.generator, bench.daq
    for key in ("frequency_limits_hz", "phase_limits_deg"):
        low, high = getattr(generator, key)
        if low > high:
            message = f"the lower limit {low:g} is above the upper {high:g}; swap them"
            raise source.error(("generator", key), message)
    if daq.index_counter == daq.counter:
        message = f"{daq.counter} already counts the encoder; choose another counter, or null"
        raise source.error(("daq", "index_counter"), message)
    if bench.window_s > MAX_WINDOW_S:
        message = (
            f"one average takes {bench.window_s:g} s at {daq.sample_rate_hz:g} Hz; take fewer "
            f"samples: the drive is watched once a window, at least every {MAX_WINDOW_S:g} s"
        )
        raise source.error(("daq", "samples_per_average"), message)
