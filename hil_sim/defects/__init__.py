"""Hidden defects: physical mechanisms that make a motor differ from its healthy self.

One file a mechanism, at the level where it happens: the path of the drive, the motor's parts, what
hangs on the shaft, the disc, the counter. `CATALOGUE` holds them all.
"""

from hil_sim.defects.catalogue import CATALOGUE, parse_defect
from hil_sim.defects.defect import Defect, defective_plant

__all__ = ["CATALOGUE", "Defect", "defective_plant", "parse_defect"]
