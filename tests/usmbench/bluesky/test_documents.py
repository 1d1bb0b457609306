"""A run folder as event-model documents, and back."""

import errno
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from bluesky.plans import scan
from event_model import DocumentNames, pack_event_page, schema_validators, unpack_event_page

from usmbench.bluesky import documents as documents_module
from usmbench.bluesky.documents import Document, documents_run, run_documents
from usmbench.errors import InputError
from usmbench.runs.catalogue import changed_data
from usmbench.runs.meta import read_meta
from usmbench.runs.reader import read_run
from usmbench.runs.writer import RunWriter
from usmbench.sweep.rows import PairRow, WindowRow

META = {
    "motor": "Shinsei USR60",
    "encoder": {"counts_per_rev": 2000, "sample_rate_hz": 1e5, "samples_per_average": 1000},
    "plan": {"name": "steps", "passes": [{"phase_deg": [1, 2]}]},
}


PAGE_ROWS = 50


@pytest.fixture(autouse=True)
def short_pages(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(documents_module, "PAGE_ROWS", PAGE_ROWS)


def written(folder: Path, outcome: str = "completed", n: int = 2 * PAGE_ROWS + 7) -> Path:
    writer = RunWriter.create(folder, META, temperature=True, raw=False)
    speeds = np.random.default_rng(1).normal(5.0, 2.0, n).tolist()
    for k, speed in enumerate(speeds, 1):
        temperature_c = None if k == 3 else 25.0 + k / 7.0
        writer.window(
            WindowRow(k / 100, k / 3, speed, 41e3, 0.1, k / 9, 0.01, 0, 1, speed, 1, temperature_c)
        )
        if k % 10 == 0:
            writer.pair(PairRow(k / 3, 41e3, 0.1, speed, 0.05, 40, 1, k / 100, k // 10, 1))
    writer.close(outcome)
    return folder


def back(folder: Path, to: Path, change: Callable[[Document], list[Document]]) -> Path:
    documents = [one for document in run_documents(folder) for one in change(document)]
    for name, content in documents:
        schema_validators[DocumentNames[name]].validate(content)
    documents_run(documents, to)
    return to


def as_it_is(document: Document) -> list[Document]:
    return [document]


def as_single_events(document: Document) -> list[Document]:
    name, content = document
    if name != "event_page":
        return [document]
    return [("event", dict(event)) for event in unpack_event_page(content)]  # type: ignore[arg-type]


def repacked(document: Document) -> list[Document]:
    singles = as_single_events(document)
    if singles[0][0] != "event":
        return singles
    pages = [singles[k : k + 11] for k in range(0, len(singles), 11)]
    return [("event_page", dict(pack_event_page(*(e for _, e in page)))) for page in pages]  # type: ignore[arg-type]


@pytest.mark.parametrize("change", [as_it_is, as_single_events, repacked])
@pytest.mark.parametrize("outcome", ["completed", "interrupted", "failed: the port has gone"])
def test_there_and_back_every_file_is_the_same(
    tmp_path: Path, change: Callable[[Document], list[Document]], outcome: str
) -> None:
    folder = written(tmp_path / "run", outcome)
    again = back(folder, tmp_path / "again", change)
    for name in ("windows.csv", "pairs.csv"):
        assert (again / name).read_bytes() == (folder / name).read_bytes()
    assert read_meta(again) == read_meta(folder)
    assert changed_data(again) == []


def test_the_documents_say_what_a_run_is(tmp_path: Path) -> None:
    documents = list(run_documents(written(tmp_path / "run", "interrupted")))
    start = documents[0][1]
    assert start["plan_name"] == "steps"
    assert start["usmbench"]["motor"] == "Shinsei USR60"
    descriptors = {c["name"]: c for n, c in documents if n == "descriptor"}
    assert descriptors["windows"]["data_keys"]["speed_rad_s"]["units"] == "rad/s"
    assert descriptors["primary"]["data_keys"]["phase_deg"]["units"] == "deg"
    stop = documents[-1][1]
    assert (stop["exit_status"], stop["reason"]) == ("abort", "interrupted")
    assert stop["num_events"] == {"primary": 10, "windows": 107}
    seq_nums = [
        number
        for name, content in documents
        if name == "event_page" and content["descriptor"] == descriptors["windows"]["uid"]
        for number in content["seq_num"]
    ]
    assert seq_nums == list(range(1, 108))


def test_text_columns_of_the_users_own_travel_too(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    folder.mkdir()
    (folder / "run.yaml").write_text("format: usmbench-run/1\n")
    (folder / "windows.csv").write_text(
        "t_s,phase_deg,speed_rad_s,remark\n0.01,90,9,warm\n0.02,90,9.5,cold\n"
    )
    again = back(folder, tmp_path / "again", as_it_is)
    assert read_run(again).extra["remark"].tolist() == ["warm", "cold"]
    assert not (again / "pairs.csv").exists()


def test_a_scan_becomes_a_run_that_the_bench_reads(tmp_path: Path, open_bench: Any) -> None:
    with open_bench() as bench:
        devices = bench.devices
        bench.engine(scan([devices.encoder, devices.frequency], devices.phase, -90, 90, 7))
        documents_run(bench.documents, tmp_path / "run")
    record = read_run(tmp_path / "run")
    assert record.phase_deg.tolist() == [-90.0, -60.0, -30.0, 0.0, 30.0, 60.0, 90.0]
    assert record.pairs is not None
    assert record.pairs.direction.tolist() == [1.0] * 7
    assert record.pairs.frequency_hz.tolist() == [41_000.0] * 7
    assert record.meta["exit"] == "completed"
    assert "scan" in record.meta["software"]
    assert changed_data(tmp_path / "run") == []


def changed(folder: Path, wanted: str, **keys: Any) -> list[Document]:
    return [
        (name, content | keys if name == wanted else content)
        for name, content in run_documents(folder)
    ]


def test_what_is_no_run_is_refused(tmp_path: Path) -> None:
    folder = written(tmp_path / "run", n=10)
    documents = list(run_documents(folder))
    to = tmp_path / "again"
    for wrong, words in (
        (documents[1:], "no start"),
        ([*documents, documents[0]], "several runs"),
        ([documents[0], documents[-1]], "no event has phase_deg"),
        ([d for d in documents if d[0] != "descriptor"], "without its descriptor"),
        ([("nonsense", {})], "no kind of event-model document"),
        (changed(folder, "start", time="noon"), "a start document is not event-model's"),
        (changed(folder, "start", usmbench={"run_yaml": "a: ["}), "is no run.yaml"),
    ):
        with pytest.raises(InputError, match=words):
            documents_run(wrong, to)
        assert not to.exists()
    with pytest.raises(InputError, match="exists already"):
        documents_run(documents, folder)
    assert yaml.safe_load((folder / "run.yaml").read_text())["exit"] == "completed"


def test_a_full_disk_leaves_no_half_of_a_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    documents = list(run_documents(written(tmp_path / "run", n=10)))

    def full_disk(_: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full_disk)
    with pytest.raises(InputError, match=r"cannot be written: No space left"):
        documents_run(documents, tmp_path / "again")
    assert not (tmp_path / "again").exists()
