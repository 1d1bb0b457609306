"""All defects by name."""

import math
from typing import Final

from hil_sim.defects.belt_load import SeamedBelt
from hil_sim.defects.bent_wheel import BentWheel
from hil_sim.defects.count_glitches import Spikes
from hil_sim.defects.coupling_backlash import LooseCoupling
from hil_sim.defects.crystal_error import OffCrystal
from hil_sim.defects.damaged_disc import ScratchedDisc
from hil_sim.defects.dead_zone_hysteresis import StickyFriction
from hil_sim.defects.defect import Defect
from hil_sim.defects.drive_droop import SoftSupply
from hil_sim.defects.encoder_eccentricity import EccentricDisc
from hil_sim.defects.friction_peak import SingingCage
from hil_sim.defects.gain_asymmetry import LeaningTeeth
from hil_sim.defects.generator_imbalance import WeakGenerator
from hil_sim.defects.load_torque import DraggingBearing, HangingWeight
from hil_sim.defects.mains_hum import HummingSupply
from hil_sim.defects.missed_counts import SlowInputFilter
from hil_sim.defects.mode_hop import ModeHop
from hil_sim.defects.phase_offset import AmplifierDelay
from hil_sim.defects.phase_quantisation import MissingPhaseBits
from hil_sim.defects.phase_scale import AgedShifter
from hil_sim.defects.rubbing_cable import RubbingCable
from hil_sim.defects.shaft_compliance import SoftCoupling
from hil_sim.defects.slow_dynamics import Flywheel
from hil_sim.defects.speed_scale import OtherCodeWheel, WornContact
from hil_sim.defects.stick_slip import DryBearing
from hil_sim.defects.swapped_channels import SwappedOutputs, SwappedWires
from hil_sim.defects.thermal_drift import LossyCeramic
from hil_sim.defects.transport_delay import CommandQueue
from hil_sim.defects.unsigned_counts import DeadDirection
from usmbench.errors import InputError

CATALOGUE: Final[dict[str, type[Defect]]] = {
    kind.mechanism: kind
    for kind in (
        AmplifierDelay,
        AgedShifter,
        LeaningTeeth,
        OtherCodeWheel,
        WornContact,
        LossyCeramic,
        StickyFriction,
        HangingWeight,
        DraggingBearing,
        SlowInputFilter,
        EccentricDisc,
        CommandQueue,
        Flywheel,
        MissingPhaseBits,
        Spikes,
        DeadDirection,
        SwappedWires,
        SwappedOutputs,
        SoftSupply,
        OffCrystal,
        WeakGenerator,
        DryBearing,
        SoftCoupling,
        LooseCoupling,
        ScratchedDisc,
        SeamedBelt,
        HummingSupply,
        ModeHop,
        RubbingCable,
        BentWheel,
        SingingCage,
    )
}
"""Every mechanism by its name."""


def parse_defect(text: str) -> Defect:
    """Return the defect that a string such as "eccentric_disc=20" describes.

    Parameters
    ----------
    text
        mechanism=size, the size in the mechanism's unit.

    Raises
    ------
    usmbench.errors.InputError
        There is no such mechanism, or it cannot be of that size.
    """
    name, equals, size = text.partition("=")
    if name not in CATALOGUE:
        raise InputError(f"defect {text!r}: no such mechanism; there are {', '.join(CATALOGUE)}")
    kind = CATALOGUE[name]
    try:
        value = float(size) if equals else kind.typical
    except ValueError:
        value = math.nan
    if not kind.least <= value <= kind.most:
        unit = f" in {kind.unit}" if kind.unit else ""
        raise InputError(
            f"defect {text!r}: {size!r} is no size; give a number{unit} between {kind.least:g} and "
            f"{kind.most:g}, such as {kind.typical:g}"
        )
    return kind(value)
