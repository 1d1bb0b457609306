"""The counter of the data acquisition card: how encoder edges become register values."""

from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from hil_sim.faults import FaultKind, FaultSchedule

Family = Literal["m_x", "e_series"]

COUNTER_BITS: Final[dict[Family, int]] = {"m_x": 32, "e_series": 24}
"""Width of the counters: M and X series 32 bit, E series (NI PCI-6071E manual) 24 bit."""

SENSOR_DEGREES_C_PER_VOLT: Final = 100.0
"""Sensitivity of the stator's temperature sensor, 0 V at 0 °C."""
_SENSOR_STEP_V: Final = 2.0**-16
# A power of two keeps sums of readings exact, so that a mean over a block is the reading itself.


@dataclass(frozen=True, slots=True)
class Counter:
    """An up/down counter that wraps.

    Parameters
    ----------
    family
        "m_x" decodes X4; "e_series" counts the edges of channel A alone, with B as direction (X1).
    bits
        Width; the counter wraps at 2**bits.
    initial
        Value at position 0.
    """

    family: Family = "m_x"
    bits: int = 32
    initial: int = 0

    def values(self, position: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the register's values, unsigned, shape as `position`.

        Parameters
        ----------
        position
            Quadrature count (X4), signed and unwrapped.
        """
        counts = position if self.family == "m_x" else position >> 2
        return (counts + self.initial) & ((1 << self.bits) - 1)


def card_counter(family: Family, faults: FaultSchedule) -> Counter:
    """Return the counter of a card, preset where the schedule wants it to wrap.

    Parameters
    ----------
    family
        Family of the card.
    faults
        The run's faults.
    """
    width = COUNTER_BITS[family]
    presets = faults.of(FaultKind.COUNTER_WRAP)
    return Counter(family, width, (1 << width) - presets[0].counts if presets else 0)


def sensor_volts(temperature_c: float) -> float:
    """Return what the analogue input reads: the sensor's voltage in whole steps of the converter.

    Parameters
    ----------
    temperature_c
        Stator temperature.
    """
    return round(temperature_c / SENSOR_DEGREES_C_PER_VOLT / _SENSOR_STEP_V) * _SENSOR_STEP_V
