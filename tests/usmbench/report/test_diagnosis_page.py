"""The page that diagnose writes: whole, self-contained, and nothing out of a file is markup."""

import hashlib
import re
from collections.abc import Callable
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from usmbench.diagnose.evidence import Estimate
from usmbench.diagnose.result import Diagnosis, LoneView
from usmbench.errors import InputError
from usmbench.model.hammerstein import HammersteinModel
from usmbench.report.diagnosis_page import diagnosis_page, write_diagnosis_page
from usmbench.report.diagnosis_text import HEADLINES
from usmbench.runs.record import Record

Make = Callable[..., Diagnosis]
HOSTILE = "\"'><script>alert(1)</script><img src=x onerror=alert(2)>]]>&amp;\u202e\x00\ud800"


class Reader(HTMLParser):
    """Keeps what the page is made of, and refuses tags that do not close."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.text = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag != "meta":
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.text += data


def read(page: str) -> Reader:
    reader = Reader()
    reader.feed(page)
    reader.close()
    assert not reader.open
    return reader


@pytest.fixture
def show(record: Record, model: HammersteinModel) -> Callable[[Diagnosis], str]:
    return lambda diagnosis: diagnosis_page(diagnosis, [record], model, {"model.yaml": "ab" * 32})


def test_windows_that_stand_alone_are_shown_and_gain_nothing(
    make_diagnosis: Make, show: Callable[[Diagnosis], str]
) -> None:
    hidden = "shaft angle from the gap (rad)" + HOSTILE
    seen = LoneView(
        "damaged_disc",
        hidden,
        np.array([0.0, 0.1, 2.0]),
        np.array([-1.0, -1.1, 0.7]),
        (("count_glitches", 123.4), ("missed_counts", np.inf)),
    )
    (cause,) = make_diagnosis().causes
    single = replace(cause, name="damaged_disc", alternatives=(), gain=0.0, single=True)
    page = show(make_diagnosis(causes=(single,), lone_views=(seen,), gain=0.0))
    said = read(page).text.replace("\N{NO-BREAK SPACE}", " ")
    assert "damaged disc: 3 windows" in said
    assert "Evidence against others: count glitches 123, missed counts does not fit" in said
    assert "single windows are struck, and no simulation foresees which" in said
    assert "to know it removes no error" in said
    assert "0 %" not in said.partition("Evidence, cause by cause")[0]
    assert len(re.findall(r"m-3\.2 0a", page)) >= 3
    assert page.index('id="lone"') < page.index('id="views"')
    assert "<script" not in page
    assert 'id="lone"' not in show(make_diagnosis())


def test_of_many_windows_that_stand_alone_some_are_drawn(
    make_diagnosis: Make, show: Callable[[Diagnosis], str]
) -> None:
    far = np.linspace(-1.0, 1.0, 5000)
    page = show(make_diagnosis(lone_views=(LoneView("count_glitches", "x", far, far, ()),)))
    assert "5000 windows" in page
    assert page.count("a3.2 3.2 0 1 0 6.4 0") <= 1100


def test_the_page_says_everything_once(
    make_diagnosis: Make, show: Callable[[Diagnosis], str]
) -> None:
    text = read(show(make_diagnosis())).text.replace("\N{NO-BREAK SPACE}", " ")
    for said in (
        "The cause is one of 2",
        "either transport delay (delay 0.0053 s) or dead zone hysteresis",
        "0.0053 s (0.0046 … 0.0061 s)",
        "80 %",
        "70 % … 90 %",
        "Time a command.",
        "thermal drift: the run is too short",
        "Something is left: the residual changes over the run.",
        "Odds of telling them apart: 55 % with these runs, more than 99 % with that sweep, if "
        "the simulation is right in all else.",
        "frequency_hz: 41000",
        "0.2 %",
        "ab" * 32,
        "identified on",
    ):
        assert text.count(said) >= 1, said
    assert text.count("speed (rad/s)") == 2  # the wide and the narrow drawing


def test_evidence_that_does_not_count_is_told_from_what_does(
    make_diagnosis: Make, show: Callable[[Diagnosis], str]
) -> None:
    candidate = replace(make_diagnosis().candidates[1], statistic=30.6)
    assert "0 of 30.6" not in read(show(make_diagnosis(candidates=(candidate,)))).text
    discounted = replace(candidate, misfit=50.0)
    assert "0 of 30.6" in read(show(make_diagnosis(candidates=(discounted,)))).text


def test_a_second_number_of_the_evidence_is_explained_where_there_is_one(
    make_diagnosis: Make, show: Callable[[Diagnosis], str]
) -> None:
    explained = "Where a second, larger number follows"
    assert explained not in read(show(make_diagnosis())).text
    discounted = replace(make_diagnosis().candidates[1], misfit=50.0)
    assert explained in read(show(make_diagnosis(candidates=(discounted,)))).text


def test_the_figure_in_which_the_cause_shows_most_comes_first(
    make_diagnosis: Make, show: Callable[[Diagnosis], str]
) -> None:
    """However far another leaves a band that is narrow."""
    told = make_diagnosis().views[0]
    narrow = replace(told, versus="angle", before_rad_s=0.1 * told.before_rad_s, excess_before=9.0)
    views = (narrow, told)
    named = show(make_diagnosis(views=views))
    assert re.findall("Against (lag|angle)", named) == ["lag", "angle"]
    assert "in which the cause shows most comes first" in named
    unnamed = show(make_diagnosis(views=views, causes=(), verdict="unexplained"))
    assert re.findall("Against (lag|angle)", unnamed) == ["angle", "lag"]
    assert "that leaves its band farthest comes first" in unnamed


def test_what_a_share_of_the_error_is_of_is_said_once(
    make_diagnosis: Make, show: Callable[[Diagnosis], str]
) -> None:
    assert read(show(make_diagnosis())).text.count("one of its mean square above") == 1
    assert "mean square above" not in read(show(make_diagnosis(causes=()))).text


def test_every_line_of_a_run_is_in_its_legend(
    make_diagnosis: Make, show: Callable[[Diagnosis], str]
) -> None:
    section = show(make_diagnosis()).split('id="runs"')[1].split("<h2")[0]
    legend, figures = section.split("<figure>", 1)
    drawn = set(re.findall(r'<path class="((?:measured|before|after)[ a-z]*)"', figures))
    assert drawn == set(re.findall(r'<path class="([^"]*)"', legend))
    assert "before dense" in drawn


def test_the_drive_is_no_column_that_is_not_used(
    make_diagnosis: Make, record: Record, model: HammersteinModel
) -> None:
    run = replace(record, extra={"drive_on": np.ones(400), "humidity": np.ones(400)})
    text = read(diagnosis_page(make_diagnosis(), [run], model, {})).text
    assert "humidity" in text
    assert "drive_on" not in text


def test_a_wave_is_shown_by_its_amplitude(
    make_diagnosis: Make, show: Callable[[Diagnosis], str]
) -> None:
    wave = (
        Estimate("ripple", 0.009, 0.0088, 0.0092, "1", "how far it is off"),
        Estimate("ripple_at_deg", -51.8, -53.2, -50.4, "deg"),
    )
    cause = replace(make_diagnosis().causes[0], alternatives=(), waves=wave)
    page = show(make_diagnosis(causes=(cause,)))
    text = read(page).text.replace("\N{NO-BREAK SPACE}", " ")
    assert "transport delay (ripple 0.9 %, ripple at −51.8°)" in text
    assert "0.900 % (0.880 … 0.920 %)" in text
    assert "<code>ripple" not in page


def test_p_of_a_further_cause_is_said_to_be_beside_the_first(
    make_diagnosis: Make, show: Callable[[Diagnosis], str]
) -> None:
    cause = make_diagnosis().causes[0]
    beside = "p of a cause that was found after another is beside that one"
    assert beside not in read(show(make_diagnosis())).text
    assert beside in read(show(make_diagnosis(causes=(cause, cause)))).text


def test_it_needs_nothing_from_outside(
    make_diagnosis: Make, show: Callable[[Diagnosis], str]
) -> None:
    page = show(make_diagnosis())
    reader = read(page)
    assert not re.search(r"https?:|url\(|@import|//", page)
    for tag, attributes in reader.tags:
        assert tag not in {"script", "link", "img", "iframe", "object", "use", "image", "a"}
        assert not {"src", "href", "xlink:href"} & set(attributes)
    policy = [a["content"] for t, a in reader.tags if a.get("http-equiv")]
    assert policy == ["default-src 'none'; style-src 'unsafe-inline'"]


def test_every_axis_names_quantity_and_unit(
    make_diagnosis: Make, show: Callable[[Diagnosis], str]
) -> None:
    labels = re.findall(r'<text class="axis"[^>]*>([^<]*)</text>', show(make_diagnosis()))
    assert set(labels) == {
        "speed (rad/s)",
        "residual (rad/s)",
        "time (s)",
        "mean residual (rad/s)",
        "windows after a step of φ",
    }


def test_no_text_leaves_its_drawing(make_diagnosis: Make, show: Callable[[Diagnosis], str]) -> None:
    page = show(make_diagnosis())
    drawings = list(re.finditer(r'<svg class="\w+" viewBox="0 0 (\d+) (\d+)".*?</svg>', page))
    assert len(drawings) == 3
    for drawing in drawings:
        width = float(drawing[1])
        for x, label in re.findall(
            r'<text class="axis" x="([\d.]+)" y="[\d.]+">([^<]*)<', drawing[0]
        ):
            half = 0.5 * 6.6 * len(label)
            assert half <= float(x) <= width - half, label


@pytest.mark.parametrize("verdict", list(HEADLINES))
def test_each_verdict_has_its_words(
    verdict: str, make_diagnosis: Make, show: Callable[[Diagnosis], str]
) -> None:
    nothing: dict[str, Any] = {"causes": (), "next_experiment": None, "remainder": None}
    named = verdict in ("explained", "partly_explained")
    alone = (replace(make_diagnosis().causes[0], alternatives=()),)
    changes = {"causes": alone} if named else nothing
    text = read(show(make_diagnosis(verdict=verdict, **changes))).text
    assert HEADLINES[verdict] in text
    assert ("None is proposed: no causes are left that a sweep would tell apart." in text) != named
    assert ("simulation with the cause in it" in text) == named
    assert ("do not take anything apart" in text) == (verdict == "unexplained")


def hostile(diagnosis: Diagnosis) -> Diagnosis:
    cause = diagnosis.causes[0]
    estimate = replace(cause.parameters[0], name=HOSTILE, unit=HOSTILE, what=HOSTILE)
    spoilt: dict[str, Any] = dict.fromkeys(("name", "form", "meaning", "mend"), HOSTILE)
    candidate = replace(diagnosis.candidates[0], name=HOSTILE, form=HOSTILE)
    return replace(
        diagnosis,
        causes=(replace(cause, **spoilt, alternatives=(HOSTILE,), parameters=(estimate,)),),
        candidates=(replace(candidate, parameters=(estimate,)),),
        not_testable=((HOSTILE, HOSTILE),),
        remainder=replace(diagnosis.remainder, says=HOSTILE),  # type: ignore[type-var]
        minimum_detectable=(
            replace(diagnosis.minimum_detectable[0], cause=HOSTILE, parameter=HOSTILE),
        ),
        views=(replace(diagnosis.views[0], versus=HOSTILE, label=HOSTILE),),
        traces=(replace(diagnosis.traces[0], name=HOSTILE),),
        warnings=(HOSTILE,),
        next_experiment={"says": HOSTILE, "plan": {"name": HOSTILE}},
    )


def test_nothing_out_of_a_file_is_markup(
    make_diagnosis: Make, record: Record, model: HammersteinModel
) -> None:
    meta = {"motor": HOSTILE, "id": HOSTILE, "started": HOSTILE}
    extra: dict[str, Any] = {HOSTILE: np.zeros(400)}
    run = replace(record, name=HOSTILE, meta=meta, extra=extra)
    spoilt = replace(
        model, method=HOSTILE, fitted_on=({HOSTILE: HOSTILE},), effects=({"name": HOSTILE},)
    )
    driven = [(HOSTILE, HOSTILE)]
    page = diagnosis_page(hostile(make_diagnosis()), [run], spoilt, {HOSTILE: HOSTILE}, driven)
    reader = read(page)
    assert not {tag for tag, _ in reader.tags} & {"script", "img"}
    assert all(not name.startswith("on") for _, attributes in reader.tags for name in attributes)
    assert "\u202e" not in page
    assert "\x00" not in page
    page.encode("utf-8")
    assert "<script>alert(1)</script>" in reader.text  # shown as what it is


def test_experiments_that_were_driven_are_listed_with_why(
    make_diagnosis: Make, record: Record, model: HammersteinModel
) -> None:
    driven = [("runs/one", "To tell a delay from backlash: hold each phase.")]
    page = read(diagnosis_page(make_diagnosis(), [record], model, {}, driven)).text
    assert "Experiments that were driven" in page
    assert page.index("runs/one") < page.index(driven[0][1])
    without = read(diagnosis_page(make_diagnosis(), [record], model, {})).text
    assert "Experiments that were driven" not in without


def test_a_run_without_numbers_in_places_is_still_drawn(
    make_diagnosis: Make, show: Callable[[Diagnosis], str]
) -> None:
    diagnosis = make_diagnosis()
    holes = np.where(np.arange(400) % 7 == 0, np.nan, diagnosis.traces[0].measured_rad_s)
    page = show(replace(diagnosis, traces=(replace(diagnosis.traces[0], measured_rad_s=holes),)))
    assert "nan" not in re.sub("<style>.*</style>", "", page, flags=re.DOTALL)


def test_the_file_carries_the_sums_of_what_was_read(
    tmp_path: Path, make_diagnosis: Make, record: Record, model: HammersteinModel
) -> None:
    run, model_file = tmp_path / "run", tmp_path / "model.yaml"
    run.mkdir()
    (run / "windows.csv").write_text("t_s\n")
    model_file.write_text("format: x\n")
    page = tmp_path / "report.html"
    write_diagnosis_page(
        page, make_diagnosis(), [replace(record, name=str(run))], model, model_file
    )
    text = page.read_text("utf-8")
    for file in (run / "windows.csv", model_file):
        assert hashlib.sha256(file.read_bytes()).hexdigest() in text


def test_a_file_that_cannot_be_written_is_said_in_one_line(
    tmp_path: Path, make_diagnosis: Make, record: Record, model: HammersteinModel
) -> None:
    csv = tmp_path / "run.csv"
    csv.write_text("t_s\n")
    with pytest.raises(InputError, match="give a file in a folder that exists"):
        write_diagnosis_page(
            tmp_path / "absent" / "report.html",
            make_diagnosis(),
            [replace(record, name=str(csv))],
            model,
            csv,
        )
