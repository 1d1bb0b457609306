import json
from dataclasses import fields, is_dataclass, replace
from importlib import resources
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from usmbench.errors import InputError
from usmbench.settings.bench import BenchSettings, TemperatureSettings
from usmbench.settings.bench_file import bench_document, load_bench, parse_bench
from usmbench.settings.yaml_source import Source, parse_source

ROOT = Path(__file__).parents[3]
TEMPLATE = ROOT / "src" / "usmbench" / "settings" / "templates" / "bench.yaml"
HEAD = "format: usmbench-bench/1\n"


def test_what_a_file_leaves_out_has_the_default() -> None:
    assert parse_bench(parse_source(HEAD, "bench.yaml")) == BenchSettings()


def test_a_bench_survives_the_run_folder() -> None:
    bench = replace(BenchSettings(), temperature=TemperatureSettings("ai3"), motor="ten of them")
    text = yaml.safe_dump(bench_document(bench))
    assert parse_bench(parse_source(text, "run.yaml")) == bench


def test_the_examples_are_what_they_say() -> None:
    m_series = load_bench(TEMPLATE)
    assert m_series.counts_per_rev == 2000
    assert replace(m_series, name="bench", temperature=None) == BenchSettings()
    e_series = load_bench(ROOT / "examples" / "bench-usr60-pci-6071e.yaml")
    assert (e_series.daq.family, e_series.counts_per_rev) == ("e_series", 500)


def schema_keys(schema: dict[str, Any], path: tuple[str, ...] = ()) -> set[tuple[str, ...]]:
    found = {path} if path else set()
    for key, part in schema.get("properties", {}).items():
        found |= schema_keys(part, (*path, key))
    return found


def setting_keys(kind: Any, path: tuple[str, ...] = ()) -> set[tuple[str, ...]]:
    found = {path} if path else set()
    for part in fields(kind):
        default = TemperatureSettings("ai0") if part.name == "temperature" else None
        value = default or getattr(kind, part.name)
        name = (*path, part.name)
        found |= setting_keys(value, name) if is_dataclass(value) else {name}
    return found


def test_the_schema_knows_every_setting_and_no_other() -> None:
    text = resources.files("usmbench.settings").joinpath("schemas/bench.schema.json").read_text()
    assert schema_keys(json.loads(text)) == setting_keys(BenchSettings()) | {("format",)}


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("daq:\n  family: x_series\n", 3, "choose from: m_x, e_series"),
        ("daq:\n  counter: ctr1\n", 3, "ctr1 already counts the encoder"),
        ("daq:\n  samples_per_average: 50000\n", 3, "take fewer samples"),
        ("daq:\n  address: nowhere\n", 3, "host:port"),
        ("generator:\n  frequency_limits_hz: [42000, 40000]\n", 3, "swap them"),
        ("generator:\n  frequency_limits_hz: [42000]\n", 3, "give at least 2"),
        ("encoder:\n  sign: 0\n", 3, "choose from: 1, -1"),
        ("interlocks:\n  overspeed: 3\n", 3, "did you mean overspeed_rad_s?"),
        ("temperature: {}\n", 2, "has no key channel"),
        ("interlocks: 3\n", 2, "3 is not a mapping"),
        ("motor: ''\n", 2, "has 0 characters; give at least 1"),
        ("motor: 60\n", 2, "60 is not text"),
    ],
)
def test_what_is_wrong_is_named_with_its_line_and_the_mend(
    text: str, line: int, words: str
) -> None:
    with pytest.raises(InputError) as caught:
        parse_bench(parse_source(HEAD + text, "bench.yaml"))
    assert caught.value.line == line
    assert words in str(caught.value)


KEYS = st.sampled_from(
    [
        "format",
        "name",
        "generator",
        "daq",
        "encoder",
        "interlocks",
        "temperature",
        "port",
        "frequency_limits_hz",
        "sample_rate_hz",
        "samples_per_average",
        "lines",
        "sign",
        "channel",
    ]
)
TREES = st.recursive(
    st.none() | st.integers() | st.floats() | KEYS | st.booleans(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(KEYS, inner, max_size=5),
    max_leaves=12,
)


@given(TREES)
@settings(deadline=None)
def test_any_document_is_a_bench_or_bad_input(document: object) -> None:
    if isinstance(document, dict):
        document["format"] = "usmbench-bench/1"
    source = Source("bench.yaml", document)
    try:
        parse_source(yaml.safe_dump(document), "bench.yaml")
        parse_bench(source)
    except InputError as error:
        message = str(error)
    else:
        message = ""
    assert "\n" not in message
