"""usmbench new: what it writes is valid, complete, and known to editors."""

import json
import re
import resource
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlparse

import numpy as np
import pytest
import yaml

from usmbench.cli.main import main
from usmbench.model.hammerstein import HammersteinModel, LinearPart, OperatingPoint, StaticCurve
from usmbench.model.model_file import write_model
from usmbench.settings.bench_file import load_bench
from usmbench.settings.import_mapping import load_mapping
from usmbench.settings.plan_file import load_plan
from usmbench.settings.schema import check
from usmbench.settings.starting_files import KINDS, schema_path
from usmbench.settings.yaml_source import read_source
from usmbench.sweep.preflight import check_plan

LOADERS: dict[str, Callable[[Any], Any]] = {
    "plan": lambda file: load_plan(str(file)),
    "bench": load_bench,
    "mapping": load_mapping,
}
ROOT = Path(__file__).parents[3]


def property_names(schema: dict[str, Any]) -> Iterator[str]:
    for name, inner in schema.get("properties", {}).items():
        yield name
        yield from property_names(inner)
    for inner in [*schema.get("anyOf", []), *schema.get("$defs", {}).values()]:
        yield from property_names(inner)
    if "items" in schema:
        yield from property_names(schema["items"])


@pytest.mark.parametrize("kind", sorted(KINDS))
def test_a_new_file_is_valid_and_shows_every_key(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["new", kind]) == 0
    file = tmp_path / capsys.readouterr().out.strip()
    LOADERS[kind](file)
    text = file.read_text(encoding="utf-8")
    schema = json.loads(schema_path(KINDS[kind][0]).read_text(encoding="utf-8"))
    assert {n for n in property_names(schema) if not re.search(rf"\b{n}:[ \n]", text)} == set()


@pytest.mark.parametrize("kind", sorted(KINDS))
def test_the_first_line_leads_editors_to_the_schema(
    kind: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["new", kind, "-"]) == 0
    line = capsys.readouterr().out.splitlines()[0]
    address = urlparse(line.removeprefix("# yaml-language-server: $schema="))
    assert json.loads(Path(unquote(address.path)).read_text(encoding="utf-8"))["properties"]


def test_every_file_that_ships_leads_to_its_schema() -> None:
    settings = ROOT / "src" / "usmbench" / "settings"
    files = [*settings.glob("plans/*.yaml"), *settings.glob("templates/*.yaml")]
    files += ROOT.glob("examples/bench-*.yaml")
    assert len(files) >= 8
    for file in files:
        line = file.read_text(encoding="utf-8").splitlines()[0]
        schema = file.parent / line.removeprefix("# yaml-language-server: $schema=")
        assert "properties" in json.loads(schema.read_text(encoding="utf-8")), file


def test_what_the_plan_leaves_out_in_comments_is_valid_too(tmp_path: Path) -> None:
    file = tmp_path / "plan.yaml"
    assert main(["new", "plan", str(file)]) == 0
    text = file.read_text(encoding="utf-8")
    check_plan(load_plan(str(file)), load_bench(new_bench(tmp_path)))
    head, _, tail = text.partition("# excitation:")
    excitation = "excitation:" + re.sub(r"(?m)^# ?", "", tail)
    head = re.sub(r"(?ms)^passes:.*", "", head)
    for kind, alien in (("telegraph", "multisine only"), ("multisine", "telegraph only")):
        lines = [line for line in excitation.splitlines() if alien not in line]
        body = "\n".join(lines).replace("kind: telegraph", f"kind: {kind}")
        file.write_text(f"{head}\n{body}\n", encoding="utf-8")
        plan = load_plan(str(file))
        assert plan.excitation is not None
        assert plan.excitation.kind == kind
        assert plan.limits.overspeed_rad_s == 12.0


def new_bench(folder: Path) -> Path:
    file = folder / "bench.yaml"
    assert main(["new", "bench", str(file)]) == 0
    return file


def test_a_file_that_does_not_fit_leaves_no_stump(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    limit = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (100, limit[1]))
    try:
        assert main(["new", "plan", str(tmp_path / "plan.yaml")]) == 2
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limit)
    assert "plan.yaml: cannot be written (File too large)" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_a_model_keeps_to_its_schema(tmp_path: Path) -> None:
    curve = StaticCurve(np.array([-90.0, 90.0]), np.array([-9.0, 9.0]))
    point = OperatingPoint(41e3, None, curve, (-90.0, 90.0), (None, 3.0), 0.1)
    linear = LinearPart(np.array([-0.5]), np.array([0.5]), 0, None)
    effect = {"name": "phase_offset", "form": "", "stage": "input", "parameters": {"angle_deg": 1}}
    file = tmp_path / "model.yaml"
    write_model(file, HammersteinModel(linear, (point,), "fast", effects=(effect,)))
    check(read_source(file), "model")
    document = yaml.safe_load(file.read_text(encoding="utf-8"))
    schema = json.loads(schema_path("model").read_text(encoding="utf-8"))
    assert set(document) == set(schema["properties"])
    assert set(document["points"][0]) == set(schema["$defs"]["point"]["properties"])
    assert set(document["linear"]) == set(schema["properties"]["linear"]["properties"])


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["plan", "old.yaml"], "old.yaml: exists already"),
        (["plan", "link.yaml"], "link.yaml: exists already"),
        (["plan", "none/new.yaml"], "none/new.yaml: cannot be written"),
        (["modle"], "invalid choice"),
    ],
)
def test_wrong_usage_is_one_line_and_status_2(
    words: list[str],
    message: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "old.yaml").write_text("mine\n", encoding="utf-8")
    (tmp_path / "link.yaml").symlink_to("absent.yaml")
    assert main(["new", *words]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert message in said
    assert (tmp_path / "old.yaml").read_text(encoding="utf-8") == "mine\n"
