"""Runs beside an offset of the phase, over random phases or stairs."""

import numpy as np

from known_motor import applied, driven
from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.residual.own_effects import cut_beside_own
from usmbench.model.applied import Applied
from usmbench.model.hammerstein import HammersteinModel


def offset(degrees: float) -> Applied:
    return applied("phase_offset", "", offset_deg=degrees)


def cut_run(model: HammersteinModel, *hidden: Applied, stairs: bool = False) -> list[Stretch]:
    phase_deg = np.repeat(np.random.default_rng(8).uniform(-88.0, 88.0, 240), 5)
    if stairs:
        up_deg = np.linspace(-88.0, 88.0, 23)
        phase_deg = np.repeat(np.concatenate([up_deg, up_deg[::-1]]), 25)
    return cut_beside_own([driven(phase_deg, 41, *hidden)], model)[0]
