"""Block by block, run.yaml says what YAML makes of the whole of it."""

from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from usmbench.errors import InputError
from usmbench.runs.meta_blocks import MetaBlocks

SETTINGS = settings(
    deadline=None, max_examples=80, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
FORMAT = "format: usmbench-run/1\n"

words = st.text("abcXYZ_ -:#&*!'\"{}[]|>%é\n,", max_size=12)
scalars = st.none() | st.booleans() | st.integers(-9, 9) | st.floats(-1e3, 1e3) | words
values = st.recursive(
    scalars,
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.sampled_from("abcd"), inner, max_size=3)
    ),
    max_leaves=8,
)


def followed(value: Any, keys: list[str]) -> list[Any]:
    """What the keys lead to, written the plain way."""
    if isinstance(value, list):
        return [found for item in value for found in followed(item, keys)]
    if not keys:
        return [] if value is None else [value]
    return followed(value.get(keys[0]), keys[1:]) if isinstance(value, dict) else []


@given(st.dictionaries(st.sampled_from(["plan", "bench", "exit", "seed"]), values), st.booleans())
@SETTINGS
def test_every_key_is_what_yaml_makes_of_it(
    tmp_path: Path, content: dict[str, Any], flow: bool
) -> None:
    text = yaml.safe_dump({"format": "usmbench-run/1", **content}, default_flow_style=flow)
    (tmp_path / "run.yaml").write_text(text)
    whole = yaml.safe_load(text)
    blocks = MetaBlocks(tmp_path)
    for key in ("format", "plan", "bench", "exit", "seed", "absent"):
        assert blocks.get(key) == whole.get(key)
        for below in ("a", "b.c", "a.a.a"):
            found = blocks.values(f"{key}.{below}")
            assert found == followed(whole.get(key), below.split("."))


@pytest.mark.parametrize(
    "text",
    [
        "a: &here {b: 1}\nc: *here\n",
        "? a\n: {b: 1}\n",
        "'a': {b: 1}\n",
        "{a: {b: 1}}",
        "a:\n  b: 1\n",
        "a:\n  b:\n  - 1\n  - null\n",
        "a:\n- b: 1\n- b: null\n",
    ],
)
def test_what_cannot_be_cut_is_read_whole(tmp_path: Path, text: str) -> None:
    whole = text if text.startswith("{") else FORMAT + text
    if text.startswith("{"):
        whole = "{format: usmbench-run/1, a: {b: 1}}"
    (tmp_path / "run.yaml").write_text(whole)
    assert MetaBlocks(tmp_path).values("a.b") == [1]


def test_a_block_that_is_no_yaml_names_its_line(tmp_path: Path) -> None:
    (tmp_path / "run.yaml").write_text(FORMAT + "plan:\n  name: [a\nexit: completed\n")
    blocks = MetaBlocks(tmp_path)
    assert blocks.get("exit") == "completed"
    with pytest.raises(InputError, match=r"run.yaml:\d: is not YAML"):
        blocks.get("plan")


@pytest.mark.parametrize("text", ["", "format: other/1\n", "\x00\xff", "- 1\n"])
def test_what_is_no_run_is_refused(tmp_path: Path, text: str) -> None:
    (tmp_path / "run.yaml").write_bytes(text.encode("latin-1"))
    with pytest.raises(InputError):
        MetaBlocks(tmp_path)
