import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from nidaqmx._stubs import nidaqmx_pb2 as pb

from hil_sim.ni_server.wire import read_answer, varint


@settings(deadline=None, max_examples=50)
@given(arrays(float, st.integers(1, 400), elements=st.floats(-1e12, 1e12)))
def test_doubles_arrive_as_they_are(values: np.ndarray) -> None:
    for response in (pb.ReadCounterF64ExResponse, pb.ReadAnalogF64Response):
        answer = response.FromString(read_answer(response, values).SerializeToString())
        assert list(answer.read_array) == values.tolist()
        assert answer.samps_per_chan_read == len(values)


@settings(deadline=None, max_examples=50)
@given(st.lists(st.tuples(st.integers(0, 2**32 - 1), st.integers(1, 5)), min_size=1, max_size=40))
@example([(0, 1), (127, 2), (128, 1), (2**24 - 1, 3), (2**32 - 1, 1)])
def test_counts_arrive_as_they_are(runs: list[tuple[int, int]]) -> None:
    values = np.repeat([value for value, _ in runs], [n for _, n in runs]).astype(np.uint32)
    response = pb.ReadCounterU32ExResponse
    answer = response.FromString(read_answer(response, values).SerializeToString())
    assert list(answer.read_array) == values.tolist()
    assert answer.samps_per_chan_read == len(values)


@pytest.mark.parametrize(
    ("number", "encoded"), [(0, b"\x00"), (127, b"\x7f"), (128, b"\x80\x01"), (300, b"\xac\x02")]
)
def test_varint(number: int, encoded: bytes) -> None:
    assert varint(number) == encoded
