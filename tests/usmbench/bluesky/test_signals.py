from typing import Any

from usmbench.bluesky.signals import Signal, data_key


def test_subscribers_hear_of_every_value_until_they_leave() -> None:
    signal = Signal("temperature_c", data_key("sensor", "°C"), 20.0)
    heard: list[Any] = []

    def hear(value: float, timestamp: float) -> None:
        heard.append((value, timestamp))

    signal.subscribe(hear)
    assert heard[0][0] == 20.0
    signal.put(21.0, 5.0)
    signal.clear_sub(hear)
    signal.put(22.0, 6.0)
    assert heard[1:] == [(21.0, 5.0)]
    assert signal.get() == 22.0
    assert signal.read() == {"temperature_c": {"value": 22.0, "timestamp": 6.0}}
    signal.subscribe(hear, event_type="value", run=False)
    assert len(heard) == 2


def test_a_data_key_says_kind_and_unit() -> None:
    assert data_key("encoder", "rad/s")["units"] == "rad/s"
    assert data_key("interlocks", dtype="boolean")["dtype_numpy"] == "|b1"


def test_who_was_too_busy_to_hear_is_told_again() -> None:
    """bluesky's suspenders raise where the RunEngine does not answer within 0.1 s."""
    signal = Signal("ready", data_key("interlocks", dtype="boolean"), value=True)
    heard: list[tuple[str, bool]] = []
    busy = [True, True, False]

    def answer(value: bool, timestamp: float) -> None:
        if busy.pop(0):
            raise RuntimeError
        heard.append(("slow", value))

    signal.subscribe(answer, run=False)
    signal.subscribe(lambda value, timestamp: heard.append(("quick", value)), run=False)
    signal.put(value=False, at_s=5.0)
    assert heard == [("quick", False)]
    signal.tell_again()
    signal.tell_again()
    signal.tell_again()
    assert heard == [("quick", False), ("slow", False)]


def test_who_left_while_being_told_is_not_told_again() -> None:
    signal = Signal("ready", data_key("interlocks", dtype="boolean"), value=True)
    heard: list[bool] = []

    def leave(value: bool, timestamp: float) -> None:
        heard.append(value)
        signal.clear_sub(leave)
        raise RuntimeError

    signal.subscribe(leave, run=False)
    signal.put(value=False, at_s=5.0)
    signal.tell_again()
    assert heard == [False]
