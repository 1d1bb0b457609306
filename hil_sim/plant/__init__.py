"""The simulated USR60: stator, contact, rotor, thermal and disc, joined in `MotorPlant`."""

from hil_sim.plant.motor_plant import MotorPlant
from hil_sim.plant.parameters import PlantParameters

__all__ = ["MotorPlant", "PlantParameters"]
