"""The small version of the loop's cost: a second or two of CPU time."""

from benchmarks import sweep_loop


def test_the_loop_takes_no_more_than_it_may() -> None:
    # The least of many short ones: the other core runs tests, too. A slow machine decodes as
    # slowly: 20 µs and more a window.
    loop_s, decode_s = sweep_loop.measure(1_000, repeats=20)
    assert decode_s > 0
    assert loop_s < max(sweep_loop.ALLOWED_S, 2.0 * decode_s)
