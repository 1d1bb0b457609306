"""Lists and ranges of a plan file."""

from typing import Any

from usmbench.settings.yaml_source import PathInDocument, Source

MAX_PHASES = 100_000
# Rounding of ranges such as 0…1 by 0.1: far below the 0.09° of the generator's phase word.
ROUNDING_DEG = 1e-6


def listed(value: Any) -> tuple[float, ...]:
    """Return one number or a list of numbers as a tuple.

    Parameters
    ----------
    value
        A number or a list.
    """
    return tuple(float(item) for item in (value if isinstance(value, list) else [value]))


def phases_of(source: Source, place: PathInDocument, value: Any) -> tuple[float, ...]:
    """Return the phases of a pass, from a list or a range with both ends included.

    Parameters
    ----------
    source
        The plan's document, for messages.
    place
        Where in it the phases are.
    value
        A list of phases in degrees, or ``{"from": …, "to": …, "step": …}``.

    Raises
    ------
    usmbench.errors.InputError
        The step does not lead from one end of the range to the other.
    """
    if isinstance(value, list):
        return listed(value)
    start, end, step = float(value["from"]), float(value["to"]), float(value["step"])
    steps = round(abs(end - start) / step)
    if abs(abs(end - start) - steps * step) > ROUNDING_DEG:
        fitting = abs(end - start) / max(steps, 1)
        message = (
            f"{step:g} does not lead from {start:g} to {end:g} in whole steps; "
            f"choose {fitting:g}, or other ends"
        )
        raise source.error((*place, "step"), message)
    if steps >= MAX_PHASES:
        message = f"{step:g} makes more than {MAX_PHASES} phases; choose a larger step"
        raise source.error((*place, "step"), message)
    span = end - start
    # Each phase from its number: a running sum would carry its rounding to the far end.
    return (*(start + span * index / steps for index in range(steps)), end)
