"""Commands act late."""

from collections.abc import Sequence

import numpy as np

from usmbench.model.effects.base import Array, Context, Effect, Parameter, Values


class TransportDelay(Effect):
    """v′(t) = v(t − d): the line, the board, or the software holds a command back.

    Speeds are averages over windows and φ is held through a window, so a part of a window mixes
    two neighbouring values.
    """

    name = "transport_delay"
    meaning = "Commands act later than the simulation says."
    mend = "Time a command from the host to the generator's pins; look at the line's rate."
    stage = "settled"
    parameters = (Parameter("delay_s", "s", 0.0, 0.0, 1.0, 0.002, scanned=True),)

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the settled speed, late.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        windows = values["delay_s"] / context.window_s
        whole = int(windows)
        part = windows - whole
        rows = np.arange(signal.size)
        late = signal[np.maximum(rows - whole, 0)]
        later = signal[np.maximum(rows - whole - 1, 0)]
        mixed: Array = (1.0 - part) * late + part * later
        return mixed

    def grid(self, contexts: Sequence[Context]) -> dict[str, Array]:
        """Return delays from a tenth of a window up to a hundred, or a second.

        Parameters
        ----------
        contexts
            All stretches.
        """
        windows = np.r_[np.linspace(0.1, 0.9, 9), np.arange(1.0, 13.0), np.geomspace(14, 100, 14)]
        return {"delay_s": np.unique(np.minimum(windows * contexts[0].window_s, 1.0))}

    def untestable(self, contexts: Sequence[Context]) -> str | None:
        """Return why where the phase never moves.

        Parameters
        ----------
        contexts
            All stretches.
        """
        if any(np.ptp(c.phase_deg) > 0.0 for c in contexts):
            return None
        return "the phase never changes"


FORMS = (TransportDelay(),)
