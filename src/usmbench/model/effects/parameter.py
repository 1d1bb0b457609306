"""What sizes an effect."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Parameter:
    """A number that sizes an effect.

    Parameters
    ----------
    name
        Its name, with the unit in it where it has one.
    unit
        Unit; "1" where it is a plain ratio.
    null
        Value at which the effect vanishes, or, of a parameter that only shapes the effect (a
        threshold, a time constant), any value.
    low, high
        Plausible bounds.
    typical
        A size (distance from null) that is small and yet worth finding; the step of derivatives.
    scanned
        Whether it shapes the effect: it means nothing where the effect has no size, so it is
        searched over a grid; see `Effect.grid`.
    least_windows
        Of a period: how many windows it lasts at least, since a shorter one shows as something
        else.
    what
        What it says of the motor or the bench, in a few words: which way is positive, of what a
        share is one.
    """

    name: str
    unit: str
    null: float
    low: float
    high: float
    typical: float
    scanned: bool = False
    least_windows: float = 0.0
    what: str = ""

    @property
    def one_way(self) -> bool:
        """Whether it sizes an effect that has one sign."""
        return not self.scanned and self.null in (self.low, self.high)


@dataclass(frozen=True, slots=True)
class Wave:
    """Two parameters that are one quantity with an angle: c cos α + s sin α.

    Parameters
    ----------
    name
        What its amplitude is called.
    cosine, sine
        The parameters.
    what
        What the amplitude says of the motor or the bench, in a few words.
    """

    name: str
    cosine: str
    sine: str
    what: str
