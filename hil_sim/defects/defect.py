"""What every defect can touch, and the plant that has some of them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from hil_sim.defects.paths import CountPath, DrivePath, WiredPlant
from hil_sim.plant import MotorPlant, PlantParameters
from hil_sim.plant.disc import DiscError
from hil_sim.plant.rotor import ShaftLoad

_BEYOND = 1e9  # in whatever unit


@dataclass(frozen=True)
class Defect:
    """One mechanism of a size; a subclass overrides the level at which it happens.

    Parameters
    ----------
    size
        How large, in the mechanism's unit.

    Attributes
    ----------
    mechanism
        Name of the mechanism, unique.
    cause
        Name of the cause that it shows as; "" where nobody has a name for it.
    unit
        Unit of the size.
    typical
        Size that changes the speed of a default motor by about the noise of a window (root mean
        square over a sweep of all phases).
    least, most
        Sizes that the mechanism can have.
    """

    mechanism: ClassVar[str]
    cause: ClassVar[str]
    unit: ClassVar[str]
    typical: ClassVar[float]
    least: ClassVar[float] = 0.0
    most: ClassVar[float] = _BEYOND

    size: float

    @classmethod
    def of_strength(cls, strength: float, rng: np.random.Generator) -> "Defect":
        """Draw the mechanism with about a given effect on the speed.

        Parameters
        ----------
        strength
            Root mean square of the effect over the noise of a window.
        rng
            Where sign and what else is free comes from.
        """
        return cls(cls.typical * strength)

    def motor(self, healthy: PlantParameters) -> PlantParameters:
        """Return the motor that has the defect.

        Parameters
        ----------
        healthy
            The motor without it.
        """
        return healthy

    def drive_path(self) -> DrivePath | None:
        """Return what lies between generators and stator, or None."""
        return None

    def shaft_load(self) -> ShaftLoad | None:
        """Return what hangs on the shaft, or None."""
        return None

    def disc_error(self) -> DiscError | None:
        """Return how the disc's pattern departs from the shaft's angle, or None."""
        return None

    def count_path(self, seed: int) -> CountPath | None:
        """Return what lies between disc and counter, or None.

        Parameters
        ----------
        seed
            Seed of its noise.
        """
        return None


class SignedDefect(Defect):
    """A mechanism that may go either way."""

    least: ClassVar[float] = -_BEYOND

    @classmethod
    def of_strength(cls, strength: float, rng: np.random.Generator) -> Defect:
        """Draw the mechanism and its sign; see `Defect.of_strength`.

        Parameters
        ----------
        strength
            Root mean square of the effect over the noise of a window.
        rng
            Where the sign comes from.
        """
        return cls(cls.typical * strength * float(rng.choice([-1.0, 1.0])))


@dataclass(frozen=True)
class _Loads:
    """Several loads on one shaft."""

    loads: Sequence[ShaftLoad]

    @property
    def pull_bound_nm(self) -> float:
        return sum(load.pull_bound_nm for load in self.loads)

    def torques_nm(
        self, time_s: float, angle_rad: float, speed_rad_s: float
    ) -> tuple[float, float]:
        torques = [load.torques_nm(time_s, angle_rad, speed_rad_s) for load in self.loads]
        return sum(pull for pull, _ in torques), sum(drag for _, drag in torques)


@dataclass(frozen=True)
class _Errors:
    """Several errors of one disc."""

    errors: Sequence[DiscError]

    def __call__(self, angle_rad: NDArray[np.float64]) -> NDArray[np.float64]:
        total = np.zeros_like(angle_rad)
        for error in self.errors:
            total += error(angle_rad)
        return total


def defective_plant(
    healthy: PlantParameters, defects: Sequence[Defect] = (), *, seed: int = 0
) -> WiredPlant:
    """Return a motor with its defects on the testbed.

    Parameters
    ----------
    healthy
        The motor without them.
    defects
        What is wrong with it; may be empty.
    seed
        Seed of all noise.
    """
    motor = healthy
    for defect in defects:
        motor = defect.motor(motor)
    loads = [load for d in defects if (load := d.shaft_load()) is not None]
    errors = [error for d in defects if (error := d.disc_error()) is not None]
    plant = MotorPlant(
        motor,
        seed,
        load=_Loads(loads) if loads else None,
        disc_error=_Errors(errors) if errors else None,
    )
    drive_paths = [path for d in defects if (path := d.drive_path()) is not None]
    count_paths = [wire for d in defects if (wire := d.count_path(seed)) is not None]
    return WiredPlant(plant, drive_paths, count_paths)


def wandering(healthy: PlantParameters, rng: np.random.Generator, wander: float) -> PlantParameters:
    """Return the same motor on another day: its gain and its dead zone wander.

    Parameters
    ----------
    healthy
        The motor.
    rng
        Where the wander comes from.
    wander
        Relative standard deviation of the surface speed and of the clamping torque that makes the
        dead zone, from run to run.
    """
    contact = healthy.contact
    gain, clamp = 1.0 + wander * rng.standard_normal(2)
    return replace(
        healthy,
        contact=replace(
            contact,
            speed_per_amplitude_rad_s=contact.speed_per_amplitude_rad_s * float(gain),
            clamp_limit_nm=contact.clamp_limit_nm * float(clamp),
        ),
    )
