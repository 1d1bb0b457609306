from pathlib import Path

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from usmbench.errors import InputError
from usmbench.settings.yaml_source import Source, parse_source, read_source, spelled

PLAIN = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(10**9), 10**9)
    | st.floats(-1e9, 1e9)
    | st.text(st.characters(codec="ascii", categories=["L", "N", "P", "S"]), max_size=8),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(st.from_regex(r"[a-z]{2,5}_", fullmatch=True), inner, max_size=4)
    ),
    max_leaves=12,
)


@given(PLAIN)
@settings(deadline=None)
def test_a_document_is_what_safe_load_makes_of_it(document: object) -> None:
    text = yaml.safe_dump(document)
    assert parse_source(text, "x.yaml").document == yaml.safe_load(text)


@given(st.text(max_size=200))
@settings(deadline=None)
def test_any_text_is_a_document_or_bad_input(text: str) -> None:
    try:
        parse_source(text, "x.yaml")
    except InputError as error:
        message = str(error)
    else:
        message = ""
    assert "\n" not in message


@given(st.binary(max_size=100))
@settings(deadline=None)
def test_any_file_is_a_document_or_bad_input(
    tmp_path_factory: pytest.TempPathFactory, content: bytes
) -> None:
    file = tmp_path_factory.mktemp("yaml") / "x.yaml"
    file.write_bytes(content)
    try:
        read_source(file)
    except InputError as error:
        message = str(error)
    else:
        message = str(file)
    assert message.startswith(str(file))


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("a: 1\nb: 2\na: 3\n", 3, "already given on line 1"),
        ("a: 1\nb: [1,\n", 3, "not YAML"),
        ("a: 1\nb: .nan\n", 2, "b: not a number"),
        ("a: 1\nb: [0, 1.0e+300]\n", 2, "b[1]: too large"),
        ("a: 1\nb: 1" + 400 * "0" + "\n", 2, "b: too large"),
        ("a: 1\nb:\n  on: 3\n", 3, "plain word, not 'on'"),
        ("a: &a {b: 1}\nc: {<<: *a}\n", 2, "plain word, not '<<'"),
        ("? [1, 2]\n: 3\n", 1, "plain word"),
        ("a: &a [*a]\n", 1, "aliases (*name) multiply or lead in a circle"),
        ("a: !!python/object:os.system 1\n", 1, "not YAML"),
        ("a: !!int x\n", None, "cannot make sense"),
        ("a: !!bool x\n", None, "cannot make sense"),
        ("a: !!int ''\n", None, "cannot make sense"),
        ("", None, "is empty"),
        ("[" * 5000, None, "nested too deeply"),
    ],
)
def test_what_is_wrong_is_named_with_its_line(text: str, line: int | None, words: str) -> None:
    with pytest.raises(InputError) as caught:
        parse_source(text, "x.yaml")
    assert caught.value.line == line
    assert words in str(caught.value)


def test_aliases_that_multiply_are_refused_before_they_fill_the_memory() -> None:
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 10)}]" for n in range(1, 8)]
    for plain in (True, False):
        with pytest.raises(InputError, match=r"x.yaml:\d: its aliases .* multiply"):
            parse_source("\n".join(lines), "x.yaml", plain=plain)


@pytest.mark.parametrize(
    ("text", "document"),
    [
        ("a: 1\na: 2\n", {"a": 2}),
        ("1: {on: 2}\n", {1: {True: 2}}),
        ("a: 1.0e+300\n", {"a": 1e300}),
        ("a: &a {b: 1}\nc: {<<: *a}\n", {"a": {"b": 1}, "c": {"b": 1}}),
    ],
)
def test_what_is_no_settings_file_may_hold_more(text: str, document: object) -> None:
    assert parse_source(text, "x.yaml", plain=False).document == document


def test_dates_stay_text() -> None:
    assert parse_source("a: 2001-02-03\nb: 2001-99-99\n", "x.yaml").document == {
        "a": "2001-02-03",
        "b": "2001-99-99",
    }


def test_a_part_without_a_line_is_placed_at_its_parent() -> None:
    source = parse_source("a:\n  b: [1, 2]\n", "x.yaml")
    error = source.error(("a", "b", 7, "c"), "is missing")
    assert str(error) == "x.yaml:2: a.b[7].c: is missing"


def test_a_document_that_was_never_a_file_has_no_lines() -> None:
    error = Source("run.yaml", {"a": 1}).error(("a",), "is wrong")
    assert str(error) == "run.yaml: a: is wrong"


def test_paths_are_spelled_as_they_are_written() -> None:
    assert spelled(("passes", 0, "phase_deg", 3)) == "passes[0].phase_deg[3]"


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="No such file"):
        read_source(tmp_path / "absent.yaml")
    latin = tmp_path / "latin.yaml"
    latin.write_bytes(b"a: 1\nb: \xb0\n")
    with pytest.raises(InputError, match=r"latin\.yaml:2: is not UTF-8"):
        read_source(latin)
    long = tmp_path / "long.yaml"
    long.write_bytes(b"#" * 1_000_001)
    with pytest.raises(InputError, match="is longer than 1000000 bytes"):
        read_source(long)
