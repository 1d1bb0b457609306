"""Whether a bench may go on with what another bench, or the same, has measured."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from usmbench.cli.sweep_run import encoder_meta
from usmbench.errors import InputError
from usmbench.runs.columns import RUN_FILE
from usmbench.runs.meta import said_motor
from usmbench.settings.bench import SIMULATED, BenchSettings

# What one windows.csv has one of.
_WINDOWS_OF: Final = {
    "counts_per_rev": "counts per revolution",
    "sample_rate_hz": "samples per second",
    "samples_per_average": "samples per window",
}


def why_another_motor(meta: Mapping[str, Any], bench: str, settings: BenchSettings) -> str | None:
    """Say why a bench does not have the motor of a run, or return None.

    Parameters
    ----------
    meta
        The run's run.yaml; what it does not say may be anything.
    bench
        Bench file, or "simulated".
    settings
        What it says.
    """
    own, motor = meta.get("bench"), said_motor(meta)
    name = own.get("name") if isinstance(own, dict) else None
    if name is not None and (name == SIMULATED) != (settings.name == SIMULATED):
        return f"was measured on the bench {name}, on {bench} is another motor"
    if settings.name != SIMULATED and motor not in (None, settings.motor):
        return f"was measured on the motor {motor}, {bench} has {settings.motor}"
    return None


def check_same_bench(
    folder: Path, meta: Mapping[str, Any], bench: str, settings: BenchSettings
) -> None:
    """Refuse a bench whose rows would be of another motor, encoder or window than a run's.

    Parameters
    ----------
    folder
        The run folder.
    meta
        Its run.yaml.
    bench
        Bench file, or "simulated", on which the run is to go on.
    settings
        What it says.

    Raises
    ------
    usmbench.errors.InputError
        It would; nothing has moved.
    """
    why = why_another_motor(meta, bench, settings) or _another_encoder(meta, bench, settings)
    if why is not None:
        raise InputError(
            f"{why}; name the bench that measured it, or sweep into a folder of its own",
            file=folder / RUN_FILE,
        )


def _another_encoder(meta: Mapping[str, Any], bench: str, settings: BenchSettings) -> str | None:
    """Say in what the windows of a bench differ from those of a run, or return None."""
    encoder = meta.get("encoder") or {}
    here = encoder_meta(settings)
    for name, what in _WINDOWS_OF.items():
        there = encoder.get(name)
        if there not in (None, here[name]):
            return f"was measured at {there:.12g} {what}, {bench} has {here[name]:.12g}"
    return None
