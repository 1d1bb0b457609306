"""usmbench doctor: what is printed, and the exit status."""

import json
import signal
from pathlib import Path

import pytest

from usmbench.cli.main import main
from usmbench.instruments.generator import SignalGenerator
from usmbench.instruments.nidaq import NiSampleSource
from usmbench.instruments.protocol.messages import Status
from usmbench.instruments.samples import SampleBlock


def test_the_simulated_bench_is_fit_and_moved_only_when_told(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["doctor", "--bench", "simulated"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].split()[:2] == ["ok", "port"]
    assert lines[-1] == "nothing failed, but not everything was looked at"
    assert main(["doctor", "--bench", "simulated", "--move", "--json", "-"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["failed"] == 0
    assert {check["status"] for check in found["checks"]} == {"ok"}
    assert [check["check"] for check in found["checks"]][-1] == "counts per revolution"


def test_what_is_missing_is_told_with_what_to_do_and_status_3(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bench = tmp_path / "bench.yaml"
    bench.write_text(
        "format: usmbench-bench/1\n"
        'generator: {port: "/dev/no\\x1b[2Jport"}\n'
        "daq: {address: 127.0.0.1:1}\n"
    )
    findings = tmp_path / "findings.json"
    assert main(["doctor", "--bench", str(bench), "--move", "--json", str(findings)]) == 3
    said = capsys.readouterr()
    lines = said.out.splitlines()
    assert lines[0].startswith("failed   port")
    assert lines[1].lstrip().startswith("→ plug the board in")
    assert lines[-1] == "2 of 10 checks failed; mend the first one first"
    assert all(line.isprintable() for line in lines)
    assert json.loads(findings.read_text())["failed"] == 2
    assert said.err == ""


def test_a_wrong_bench_file_is_one_line_and_status_2(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bench = tmp_path / "bench.yaml"
    bench.write_text("format: usmbench-bench/1\ngenerator: {prot: auto}\n")
    assert main(["doctor", "--bench", str(bench)]) == 2
    said = capsys.readouterr().err
    assert "bench.yaml:2: generator.prot: unknown key; did you mean port?" in said
    assert said.count("\n") == 1


def test_ctrl_c_while_the_motor_turns_switches_the_drive_off(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    next_block, status, close = (
        NiSampleSource.next_block,
        SignalGenerator.status,
        SignalGenerator.close,
    )
    generators: list[SignalGenerator] = []
    outputs_on: list[bool] = []
    blocks = 0

    def asked(generator: SignalGenerator) -> Status:
        generators.append(generator)
        return status(generator)

    def interrupted(source: NiSampleSource) -> SampleBlock:
        nonlocal blocks
        blocks += 1
        if blocks == 90:
            outputs_on.append(generators[-1].outputs_on)
            signal.raise_signal(signal.SIGINT)
        return next_block(source)

    def closed(generator: SignalGenerator) -> None:
        outputs_on.append(generator.outputs_on)
        close(generator)

    monkeypatch.setattr(NiSampleSource, "next_block", interrupted)
    monkeypatch.setattr(SignalGenerator, "status", asked)
    monkeypatch.setattr(SignalGenerator, "close", closed)
    assert main(["doctor", "--bench", "simulated", "--move"]) == 130
    assert outputs_on == [True, False]
    said = capsys.readouterr()
    assert "motion" not in said.out
    assert said.err == "usmbench: stopped by the user\n"
