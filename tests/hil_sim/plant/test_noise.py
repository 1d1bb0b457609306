"""Torque noise: its size, its colour, and that it depends on nothing but seed and step."""

import math

import numpy as np
import pytest

from hil_sim.plant.noise import BLOCK, TorqueNoise

STEP_S = 1e-3


def stretch(noise: TorqueNoise, n_blocks: int) -> np.ndarray:
    return np.concatenate([noise.block(k) for k in range(n_blocks)])


def test_size_and_colour() -> None:
    values = stretch(TorqueNoise(5, 0.002, 0.01, STEP_S), 200)
    # 200 blocks hold some 20,000 correlation times: the standard deviation is known to 0.5 %.
    assert values.std() == pytest.approx(0.002, rel=0.03)
    assert abs(values.mean()) < 5 * 0.002 * math.sqrt(2 * 10 / values.size)
    lagged = np.corrcoef(values[:-10], values[10:])[0, 1]
    assert lagged == pytest.approx(math.exp(-1.0), abs=0.04)


def test_blocks_join_without_a_seam() -> None:
    values = stretch(TorqueNoise(5, 0.002, 0.01, STEP_S), 400)
    decay = math.exp(-0.1)
    innovations = values[1:] - decay * values[:-1]
    seams = innovations[BLOCK - 1 :: BLOCK]
    assert seams.std() == pytest.approx(innovations.std(), rel=0.2)


def test_a_block_is_the_same_in_any_order() -> None:
    forward, backward = (TorqueNoise(9, 0.002, 0.01, STEP_S) for _ in range(2))
    first = [forward.block(k) for k in range(5)]
    second = [backward.block(k) for k in reversed(range(5))]
    assert first == second[::-1]


def test_seeds_differ() -> None:
    assert TorqueNoise(1, 1.0, 0.01, STEP_S).block(0) != TorqueNoise(2, 1.0, 0.01, STEP_S).block(0)
