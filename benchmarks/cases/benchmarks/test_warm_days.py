"""Motors that are warm when a run begins: what is made of them."""

from benchmarks.warm_days import draw


def test_a_healthy_motor_that_begins_warm_gets_no_name() -> None:
    day = draw(71, 0, 700)
    assert (day.group, day.cause) == ("warm, healthy", "")
    assert day.begins > 0.3
    assert day.right
