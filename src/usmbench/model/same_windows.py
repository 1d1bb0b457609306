"""Whether a run has the windows that a model's dynamics were identified on."""

from usmbench.errors import InputError
from usmbench.model.hammerstein import LinearPart
from usmbench.runs.time_step import alike


def check_windows(name: str, window_s: float, linear: LinearPart) -> None:
    """Refuse windows of another duration than the model's.

    Parameters
    ----------
    name
        The run's name, for the message.
    window_s
        Duration of its windows.
    linear
        The model's linear part; one without a time step takes any.

    Raises
    ------
    usmbench.errors.InputError
        The model was identified on windows of another duration.
    """
    if linear.window_s is None or alike(window_s, linear.window_s):
        return
    todo = "identify it on a run with the same windows"
    if alike(window_s, 1e3 * linear.window_s):
        todo = "if t_s is in milliseconds, divide it by 1000"
    raise InputError(
        f"{name} has windows of {1e3 * window_s:g} ms, the model was identified on "
        f"{1e3 * linear.window_s:g} ms; {todo}"
    )
