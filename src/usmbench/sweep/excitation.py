"""Free excitation: phases of a random telegraph or a random-phase multisine."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from usmbench.settings.plan import Excitation
from usmbench.settings.yaml_source import Source

# One period is held in memory: 2**22 phases are 32 MB, or 11 hours of single windows of 10 ms.
MAX_PERIOD_HOLDS = 2**22
CHUNK_HOLDS = 4096


def n_holds(excitation: Excitation, window_s: float) -> int:
    """Return the number of phases of an excitation, at least one.

    Parameters
    ----------
    excitation
        The excitation.
    window_s
        Duration of one window.
    """
    return max(1, round(excitation.duration_s / (excitation.hold_windows * window_s)))


def held_phases(excitation: Excitation, window_s: float, source: Source) -> Iterator[float]:
    """Yield the phases of an excitation, in degrees, one for each hold.

    Parameters
    ----------
    excitation
        The excitation.
    window_s
        Duration of one window.
    source
        The plan's document, for messages.

    Raises
    ------
    usmbench.errors.InputError
        The band of a multisine holds no frequency of its period, or its period is too long.
    """
    total = n_holds(excitation, window_s)
    if excitation.kind == "telegraph":
        yield from _telegraph(excitation, total)
        return
    period = _multisine_period(excitation, window_s, source)
    for hold in range(total):
        yield float(period[hold % len(period)])


def _telegraph(excitation: Excitation, total: int) -> Iterator[float]:
    """Yield levels; drawn in chunks, so that a day's excitation takes no more memory."""
    rng = np.random.default_rng(excitation.seed)
    levels = excitation.centre_deg + excitation.amplitude_deg * np.linspace(
        -1.0, 1.0, excitation.levels
    )
    level = int(rng.integers(excitation.levels))
    for start in range(0, total, CHUNK_HOLDS):
        switches = rng.random(CHUNK_HOLDS) < excitation.switch_probability
        # A jump of 1 … levels - 1 places, round the end: every other level is as likely.
        jumps = rng.integers(1, excitation.levels, CHUNK_HOLDS)
        for switch, jump in zip(switches[: total - start], jumps, strict=False):
            yield float(levels[level])
            if switch:
                level = (level + int(jump)) % excitation.levels


def _multisine_period(
    excitation: Excitation, window_s: float, source: Source
) -> NDArray[np.float64]:
    hold_s = excitation.hold_windows * window_s
    n = max(2, round((excitation.period_s or excitation.duration_s) / hold_s))
    if n > MAX_PERIOD_HOLDS:
        message = (
            f"the period has {n} phases; choose a shorter period_s or a longer hold_windows "
            f"({MAX_PERIOD_HOLDS} phases at most)"
        )
        raise source.error(("excitation",), message)
    low_hz, high_hz = excitation.band_hz or (0.0, 0.5 / hold_s)
    if high_hz > 0.5 / hold_s * (1 + 1e-9):
        message = (
            f"{high_hz:g} Hz cannot be made of phases held for {hold_s:g} s; "
            f"choose at most {0.5 / hold_s:g}"
        )
        raise source.error(("excitation", "band_hz"), message)
    shape = multisine(n, low_hz * n * hold_s, high_hz * n * hold_s, excitation.seed)
    if shape is None:
        message = f"no multiple of 1/period = {1 / (n * hold_s):g} Hz lies in it; widen the band"
        raise source.error(("excitation", "band_hz"), message)
    return excitation.centre_deg + excitation.amplitude_deg * shape


def multisine(n: int, low: float, high: float, seed: int) -> NDArray[np.float64] | None:
    """Return one period of a random-phase multisine with largest value 1, shape (n,).

    Harmonics of equal amplitude and independent, uniform phases: Pintelon and Schoukens, *System
    Identification: A Frequency Domain Approach*, 2nd ed., chapter 5, doi:10.1002/9781118287422.

    Parameters
    ----------
    n
        Number of values.
    low, high
        Lowest and highest harmonic, both included where they are whole numbers. The mean and, for
        even `n`, the highest possible harmonic n/2 are left out: they cannot have any phase.
    seed
        Seed of the phases.

    Returns
    -------
    ndarray or None
        None where no harmonic lies between `low` and `high`.
    """
    # The ends come from a product of decimals: 0.05 Hz · 20 s must not miss harmonic 1.
    first = max(1, int(np.ceil(low - 1e-9)))
    last = min((n - 1) // 2, int(np.floor(high + 1e-9)))
    if last < first:
        return None
    rng = np.random.default_rng(seed)
    spectrum = np.zeros(n // 2 + 1, dtype=np.complex128)
    angles = rng.uniform(0.0, 2.0 * np.pi, last - first + 1)
    spectrum[first : last + 1] = np.exp(1j * angles)
    values: NDArray[np.float64] = np.fft.irfft(spectrum, n)
    values /= np.max(np.abs(values))
    return values


def check_excitation(excitation: Excitation, window_s: float, source: Source) -> None:
    """Refuse an excitation that cannot be made with windows of this length.

    Parameters
    ----------
    excitation
        The excitation.
    window_s
        Duration of one window.
    source
        The plan's document, for messages.

    Raises
    ------
    usmbench.errors.InputError
        As for `held_phases`.
    """
    if excitation.kind == "multisine":
        _multisine_period(excitation, window_s, source)
