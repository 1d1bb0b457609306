"""The image is the linked program, whole configuration words, and a trap everywhere else."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from firmware import image

memories = st.dictionaries(
    st.one_of(st.integers(0, 0x7FFF), st.integers(0x300000, 0x30000D)), st.integers(0, 255)
)


@settings(max_examples=15, deadline=None)
@given(memories)
def test_what_was_linked_is_in_the_image(memory: dict[int, int]) -> None:
    made = image.read_hex(image.write_hex(image.make_image(memory)))
    assert {address: made[address] for address in memory} == memory
    unused = [address for address in range(0x8000) if address not in memory]
    assert all(made[address] == (0xFF, 0xD7)[address % 2] for address in unused)
    assert set(made) == {*range(0x8000), *range(0x300000, 0x30000E)}


def test_records_start_at_even_addresses_and_add_up() -> None:
    lines = image.write_hex(image.make_image({0x300001: 0x06, 0x300003: 0x09})).split()
    for line in lines:
        record = bytes.fromhex(line[1:])
        assert sum(record) % 256 == 0
        assert record[2] % 2 == 0
    assert lines[-2:] == [":0E000000FF06FF09FFFFFFFFFFFFFFFFFFFFEF", ":00000001FF"]


@pytest.mark.parametrize(
    "text", [":0100000012", ":00000001FE", ":020000040030CB", ":0400000001020304"]
)
def test_a_bad_record_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="bad record"):
        image.read_hex(text)
