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
