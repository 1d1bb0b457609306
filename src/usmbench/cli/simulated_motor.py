"""Which motor `--bench simulated` has: how the testbed is started, and what run.yaml keeps."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class SimulatedMotor:
    """A motor of the embedded testbed.

    Parameters
    ----------
    seed
        Seed of its noise; None for the testbed's own.
    defects
        What is wrong with it, each as ``mechanism=size``.
    """

    seed: int | None = None
    defects: tuple[str, ...] = ()

    @property
    def arguments(self) -> list[str]:
        """Arguments of the testbed's process."""
        words = [] if self.seed is None else ["--seed", str(self.seed)]
        return words + [word for defect in self.defects for word in ("--defect", defect)]

    @property
    def meta(self) -> dict[str, Any]:
        """Keys of run.yaml, from which the same motor can be made again."""
        entries: dict[str, Any] = {} if self.seed is None else {"seed": self.seed}
        return {**entries, "defects": list(self.defects)} if self.defects else entries

    @classmethod
    def of_run(cls, meta: Mapping[str, Any], *, later: int = 0) -> "SimulatedMotor":
        """Return the motor that a run was measured on.

        Parameters
        ----------
        meta
            The run's run.yaml.
        later
            How many runs later: the motor is the same, its noise another.
        """
        seed, defects = meta.get("seed"), meta.get("defects")
        known = seed if isinstance(seed, int) else None
        return cls(
            (known or 0) + later if later else known,
            tuple(str(defect) for defect in defects) if isinstance(defects, list) else (),
        )
