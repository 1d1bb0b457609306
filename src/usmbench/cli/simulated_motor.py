"""Which motor `--bench simulated` has: how the testbed is started, and what run.yaml keeps."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from usmbench.errors import InputError

MODEL_FILE = "model_file"


def last_seed(meta: Mapping[str, Any]) -> int:
    """Return the seed of a run's last noise: each time it is taken up it has the next.

    Parameters
    ----------
    meta
        The run's run.yaml.
    """
    seed, taken_up = meta.get("seed"), meta.get("resumed")
    first = seed if isinstance(seed, int) else 0
    return first + (len(taken_up) if isinstance(taken_up, list) else 0)


@dataclass(frozen=True, slots=True)
class SimulatedMotor:
    """A motor of the embedded testbed.

    Parameters
    ----------
    seed
        Seed of its noise; None for the testbed's own.
    defects
        What is wrong with it, each as ``mechanism=size``.
    model
        Model file that it follows instead of its physics, without noise; None for none.
    """

    seed: int | None = None
    defects: tuple[str, ...] = ()
    model: str | None = None

    @property
    def arguments(self) -> list[str]:
        """Arguments of the testbed's process."""
        words = [] if self.seed is None else ["--seed", str(self.seed)]
        words += [] if self.model is None else ["--model", self.model]
        return words + [word for defect in self.defects for word in ("--defect", defect)]

    @property
    def meta(self) -> dict[str, Any]:
        """Keys of run.yaml, from which the same motor can be made again."""
        defects = list(self.defects) or None
        entries = {"seed": self.seed, MODEL_FILE: self.model, "defects": defects}
        return {key: value for key, value in entries.items() if value is not None}

    @classmethod
    def of_run(
        cls, meta: Mapping[str, Any], *, later: int = 0, model: str | None = None
    ) -> "SimulatedMotor":
        """Return the motor that a run was measured on.

        Parameters
        ----------
        meta
            The run's run.yaml.
        later
            How many noises after the last of the run: the motor is the same.
        model
            Model file that it follows; None for none.

        Raises
        ------
        usmbench.errors.InputError
            The run's motor followed a model file, and none is named: no path is taken from a run.
        """
        followed = meta.get(MODEL_FILE)
        if (followed is None) != (model is None):
            what = "its physics" if followed is None else f"the model file {followed}"
            mend = "leave --model out" if followed is None else "name that file by --model"
            raise InputError(f"the run's simulated motor followed {what}; {mend}")
        seed, defects = meta.get("seed"), meta.get("defects")
        known = seed if isinstance(seed, int) else None
        return cls(
            last_seed(meta) + later if later else known,
            tuple(str(defect) for defect in defects) if isinstance(defects, list) else (),
            model,
        )
