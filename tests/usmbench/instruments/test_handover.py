import threading
from collections.abc import Callable

import numpy as np
import pytest

from usmbench.errors import DaqError
from usmbench.instruments.handover import BlockHandover
from usmbench.instruments.samples import SampleBlock


def block(first_sample: int) -> SampleBlock:
    return SampleBlock(first_sample, np.zeros(10, np.int64))


def started(work: Callable[[], object]) -> threading.Thread:
    thread = threading.Thread(target=work, daemon=True)
    thread.start()
    return thread


def test_hands_blocks_over_in_order() -> None:
    handover = BlockHandover(3)
    for first_sample in (0, 10, 20):
        assert handover.wait_for_demand()
        handover.put(block(first_sample))
    taken = [handover.take(1.0) for _ in range(3)]
    assert [b.first_sample for b in taken if b] == [0, 10, 20]


@pytest.mark.parametrize("read_ahead_blocks", [0, 1, 4])
def test_callback_reads_only_so_far_ahead(read_ahead_blocks: int) -> None:
    handover = BlockHandover(read_ahead_blocks)
    read = 0
    waiting = threading.Event()

    def callback() -> None:
        nonlocal read
        while True:
            if read == read_ahead_blocks:
                waiting.set()
            if not handover.wait_for_demand():
                return
            handover.put(block(10 * read))
            read += 1

    thread = started(callback)
    assert waiting.wait(5.0)
    assert read == read_ahead_blocks
    assert handover.take(5.0) is not None
    handover.stop()
    thread.join(5.0)
    assert not thread.is_alive()
    assert read in (read_ahead_blocks, read_ahead_blocks + 1)


def test_a_demand_that_was_not_met_stands() -> None:
    handover = BlockHandover(0)
    assert handover.take(0.01) is None
    assert handover.take(0.01) is None
    assert handover.wait_for_demand()
    handover.put(block(0))
    thread = started(handover.wait_for_demand)
    thread.join(0.1)
    assert thread.is_alive(), "two unmet demands must allow one block, not two"
    assert handover.take(1.0) is not None
    handover.stop()
    thread.join(5.0)


def test_error_comes_after_the_blocks_before_it() -> None:
    handover = BlockHandover(1)
    handover.put(block(0))
    handover.fail(DaqError("overflow", code=-200279))
    handover.fail(DaqError("what followed from it"))
    assert handover.take(1.0) is not None
    for _ in range(2):
        with pytest.raises(DaqError, match="overflow"):
            handover.take(1.0)
    assert handover.stopped
    assert not handover.wait_for_demand()


def test_stop_wakes_both_ends() -> None:
    handover = BlockHandover(0)
    allowed: list[bool] = []
    taken: list[object] = []
    threads = [started(lambda: taken.append(handover.take(60.0)))]
    threads[0].join(0.05)
    handover.stop()
    threads.append(started(lambda: allowed.append(handover.wait_for_demand())))
    for thread in threads:
        thread.join(5.0)
        assert not thread.is_alive()
    assert allowed == [False]
    assert taken == [None]
