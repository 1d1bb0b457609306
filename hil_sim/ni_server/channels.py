"""What a channel of the card shows of the testbed's samples."""

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from nidaqmx.constants import CountDirection
from numpy.typing import NDArray

from hil_sim.counter import card_counter, sensor_volts
from hil_sim.faults import FaultSchedule
from hil_sim.ni_server.errors import NiCode, NiError
from hil_sim.signals import Samples

Values = NDArray[Any]

_CHANNELS: Final = {"counter": r"ctr[0-3]", "analogue": r"ai\d{1,2}"}


@dataclass(frozen=True, slots=True)
class Channel:
    """One channel.

    Parameters
    ----------
    resource
        The circuit of the card that it uses, such as "Dev1/ctr0".
    values
        From samples to the values that a read returns.
    """

    resource: str
    values: Callable[[Samples], Values]


@dataclass(frozen=True, slots=True)
class Wiring:
    """What the card's terminals are connected to, and how its counters start.

    Parameters
    ----------
    device
        Name of the card.
    faults
        The run's faults, which may preset the encoder's counter.
    """

    device: str
    faults: FaultSchedule

    def _resource(self, physical: str, kind: str) -> str:
        device, _, channel = physical.partition("/")
        if device != self.device:
            raise NiError(NiCode.INVALID_DEVICE, f"Device identifier is invalid: {device}")
        if not re.fullmatch(_CHANNELS[kind], channel):
            raise NiError(
                NiCode.CHANNEL_DOES_NOT_EXIST, f"Physical channel does not exist: {physical}"
            )
        return physical

    def angular_encoder(self, physical: str) -> Channel:
        """Return the X4 decoder of a counter of the M and X series.

        Parameters
        ----------
        physical
            Physical channel, such as "Dev1/ctr0".

        Raises
        ------
        hil_sim.ni_server.errors.NiError
            There is no such channel.
        """
        resource = self._resource(physical, "counter")
        counter = card_counter("m_x", self.faults)
        return Channel(resource, lambda samples: counter.values(samples.position).astype(float))

    def count_edges(self, physical: str, direction: int, initial: int) -> Channel:
        """Return an edge counter: the encoder's where B gives the direction, else the index's.

        Parameters
        ----------
        physical
            Physical channel, such as "Dev1/ctr0".
        direction
            Count direction, by NI-DAQmx's number.
        initial
            Value before the first edge.

        Raises
        ------
        hil_sim.ni_server.errors.NiError
            There is no such channel.
        """
        resource = self._resource(physical, "counter")
        if direction == CountDirection.EXTERNAL_SOURCE.value:
            preset = card_counter("e_series", self.faults)
            counter = replace(preset, initial=preset.initial + initial)
            return Channel(
                resource, lambda samples: counter.values(samples.position).astype(np.uint32)
            )
        return Channel(resource, lambda samples: (samples.index_pulses + initial).astype(np.uint32))

    def voltage(self, physical: str) -> Channel:
        """Return an analogue input, which the temperature sensor is wired to.

        Parameters
        ----------
        physical
            Physical channel, such as "Dev1/ai0".

        Raises
        ------
        hil_sim.ni_server.errors.NiError
            There is no such channel.
        """
        return Channel(
            self._resource(physical, "analogue"),
            lambda samples: np.full(len(samples.position), sensor_volts(samples.temperature_c)),
        )
