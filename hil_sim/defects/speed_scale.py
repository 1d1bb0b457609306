"""All speeds are off by one factor: another code wheel, or a contact that has moved outwards."""

from dataclasses import replace
from typing import ClassVar

import numpy as np

from hil_sim.defects.defect import Defect, SignedDefect
from hil_sim.plant import PlantParameters


class OtherCodeWheel(SignedDefect):
    """The code wheel has `size` lines more than the bench file says (a whole number)."""

    mechanism: ClassVar[str] = "other_code_wheel"
    cause: ClassVar[str] = "speed_scale"
    unit: ClassVar[str] = "lines"
    typical: ClassVar[float] = 0.6
    least: ClassVar[float] = -499.0  # of 500

    @classmethod
    def of_strength(cls, strength: float, rng: np.random.Generator) -> Defect:
        """Draw the mechanism; at least one line; see `Defect.of_strength`.

        Parameters
        ----------
        strength
            Root mean square of the effect over the noise of a window.
        rng
            Where the sign comes from.
        """
        return cls(max(1, round(cls.typical * strength)) * float(rng.choice([-1.0, 1.0])))

    def motor(self, healthy: PlantParameters) -> PlantParameters:
        """Return the motor with the other wheel."""
        disc = healthy.disc
        lines = disc.lines + int(self.size)
        return replace(
            healthy, disc=replace(disc, lines=lines, index_count=disc.index_count % (4 * lines))
        )


class WornContact(SignedDefect):
    """The rotor touches the crests at a radius `size` per cent larger, so that it turns slower."""

    mechanism: ClassVar[str] = "worn_contact"
    cause: ClassVar[str] = "speed_scale"
    unit: ClassVar[str] = "%"
    typical: ClassVar[float] = 0.12
    least: ClassVar[float] = -99.0  # a radius is left

    def motor(self, healthy: PlantParameters) -> PlantParameters:
        """Return the motor with the other radius: speeds over it, torques times it."""
        contact, ratio = healthy.contact, 1.0 + 0.01 * self.size
        moved = replace(
            contact,
            speed_per_amplitude_rad_s=contact.speed_per_amplitude_rad_s / ratio,
            traction_slip_rad_s=contact.traction_slip_rad_s / ratio,
            traction_limit_nm=contact.traction_limit_nm * ratio,
            clamp_limit_nm=contact.clamp_limit_nm * ratio,
        )
        return replace(healthy, contact=moved)
