"""The motor that most cases are about: identified once."""

import pytest

from known_motor import identified
from usmbench.model.hammerstein import HammersteinModel


@pytest.fixture(scope="session")
def model() -> HammersteinModel:
    return identified()
