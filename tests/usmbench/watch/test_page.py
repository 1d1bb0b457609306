"""The live page in Chromium, as an operator sees it: wide and narrow, light and dark."""

import threading
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Browser, Page, expect

from usmbench.model.hammerstein import HammersteinModel
from usmbench.runs.stop_request import STOP_FILE
from usmbench.settings.bench import BenchSettings
from usmbench.settings.bench_file import bench_document
from usmbench.watch.server import HOST, LiveServer
from usmbench.watch.view import LiveView

EVIL = "<img src=x onerror=document.title='broken'>"
PLAN = {
    "format": "usmbench-plan/1",
    "name": EVIL,
    "frequency_hz": 41_000,
    "passes": [{"phase_deg": [-90, 0, 90], "direction": "both"}],
}
# Text that runs out of its box, or a plot's label that runs out of the plot.
CLIPPED = """() => {
  const out = [];
  if (document.documentElement.scrollWidth > innerWidth) out.push("page");
  for (const box of document.querySelectorAll("h1,h2,p,dd,dt,li,button,label"))
    if (box.offsetParent && box.scrollWidth > box.clientWidth + 1 && box.clientWidth)
      out.push(box.textContent);
  for (const text of document.querySelectorAll("svg.plot text")) {
    const t = text.getBoundingClientRect(), s = text.closest("svg").getBoundingClientRect();
    if (t.left < s.left - 1 || t.right > s.right + 1) out.push(text.textContent);
    if (t.top < s.top - 1 || t.bottom > s.bottom + 1) out.push(text.textContent);
  }
  return out;
}"""
# Relative luminance of WCAG 2.1, for the text that carries the state.
CONTRAST = """(selector) => {
  const light = (css) => {
    const [r, g, b] = css.match(/[\\d.]+/g).map(Number).map((v) => v / 255)
      .map((v) => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const style = getComputedStyle(document.querySelector(selector));
  const groundOf = (part) => getComputedStyle(part).backgroundColor;
  let part = document.querySelector(selector);
  while (groundOf(part) === "rgba(0, 0, 0, 0)") part = part.parentElement;
  const pair = [light(style.color), light(groundOf(part))].sort((a, b) => b - a);
  return (pair[0] + 0.05) / (pair[1] + 0.05);
}"""


@pytest.fixture
def run(make_run: Any) -> Any:
    run = make_run(plan=PLAN, bench=bench_document(BenchSettings()), firmware="1.0")
    for phase_deg in (-90.0, 0.0, 90.0):
        run.windows(np.full(50, phase_deg), speed_rad_s=phase_deg / 10.0 + 0.03)
        run.pair(phase_deg)
    run.pair(90.0, -1)
    return run


@pytest.fixture
def server(run: Any, line_model: HammersteinModel) -> Iterator[LiveServer]:
    server = LiveServer(LiveView(run.folder, line_model))
    thread = threading.Thread(target=server.serve_forever, args=(0.02,))
    thread.start()
    yield server
    server.shutdown()
    thread.join(5.0)
    server.server_close()


def opened(
    browser: Browser, server: LiveServer, width: int = 1280, scheme: Any = "light", token: str = ""
) -> Page:
    page = browser.new_page(viewport={"width": width, "height": 800}, color_scheme=scheme)
    page.on("pageerror", lambda error: pytest.fail(f"the page failed: {error}"))
    page.goto(f"http://{HOST}:{server.server_port}/{token and '#' + token}")
    expect(page.locator("#now")).to_contain_text("rad/s")
    return page


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [1280, 400])
def test_nothing_is_clipped_and_everything_is_labelled(
    browser: Browser, server: LiveServer, width: int, scheme: str
) -> None:
    page = opened(browser, server, width, scheme)
    assert page.evaluate(CLIPPED) == []
    labels = page.locator("svg.plot").all_text_contents()
    assert len(labels) == 3
    assert "phase shift φ (°)" in labels[0]
    assert "speed ω (rad/s)" in labels[0]
    assert "time (s)" in labels[1]
    assert "ω − ω̂ (rad/s)" in labels[2]
    for selector in ("#state span", "dt", "dd", "#stop", ".legend li", "#pace"):
        assert page.evaluate(CONTRAST, selector) >= 4.5, selector
    page.close()


def test_passes_are_told_apart_by_shape_and_the_simulation_by_its_dashes(
    browser: Browser, server: LiveServer
) -> None:
    page = opened(browser, server)
    curve = page.locator("#curve")
    assert curve.locator("path.rising").get_attribute("d").count("M") == 3  # type: ignore[union-attr]
    assert curve.locator("path.falling").get_attribute("d").count("M") == 1  # type: ignore[union-attr]
    dashes = "path => getComputedStyle(path).strokeDasharray"
    assert curve.locator("path.model").evaluate(dashes) != "none"
    assert page.locator("#speed path.line").evaluate(dashes) == "none"
    page.close()


def test_the_page_follows_the_rows(browser: Browser, server: LiveServer, run: Any) -> None:
    page = opened(browser, server)
    expect(page.locator("#now")).to_contain_text("9.030 rad/s")
    expect(page.locator("#daq")).to_contain_text("150 of")
    run.windows(np.full(50, 45.0))
    expect(page.locator("#now")).to_contain_text("4.500 rad/s")
    expect(page.locator("#daq")).to_contain_text("200 of")
    page.get_by_role("button", name="last 20 s").click()
    expect(page.locator("button[aria-pressed=true]")).to_have_text("last 20 s")
    run.writer.close("completed")
    expect(page.locator("#state b")).to_have_text("completed")
    expect(page.locator("#stop")).to_be_disabled()
    page.close()


def test_what_a_run_says_is_text_and_never_markup(browser: Browser, server: LiveServer) -> None:
    page = opened(browser, server)
    expect(page.locator("#run")).to_contain_text(EVIL)
    assert "broken" not in page.title()
    assert page.locator("img").count() == 0
    page.close()


def test_the_stop_button_asks_for_the_token(browser: Browser, server: LiveServer, run: Any) -> None:
    page = opened(browser, server)
    page.locator("#token").fill("wrong")
    page.get_by_role("button", name="Stop, drive off").click()
    expect(page.locator("#answer")).to_contain_text("wrong token")
    assert not (run.folder / STOP_FILE).exists()
    page.locator("#token").fill(server.token)
    page.get_by_role("button", name="Stop, drive off").click()
    expect(page.locator("#answer")).to_have_text("stop requested")
    assert (run.folder / STOP_FILE).exists()
    expect(page.locator("#state b")).to_have_text("stopping")
    page.close()


def test_the_token_comes_with_the_address_and_leaves_it(
    browser: Browser, server: LiveServer, run: Any
) -> None:
    page = opened(browser, server, token=server.token)
    assert server.token not in page.url
    page.get_by_role("button", name="Stop, drive off").click()
    expect(page.locator("#answer")).to_have_text("stop requested")
    page.close()


def test_another_page_cannot_press_the_button(
    browser: Browser, server: LiveServer, run: Any
) -> None:
    page = browser.new_page()
    page.goto("data:text/html,<title>evil</title>")
    address = f"http://{HOST}:{server.server_port}"
    sent = """async ([address, token]) => {
      try {
        await fetch(address + "/stop", { method: "POST", headers: { "X-Usmbench-Token": token } });
        return "sent";
      } catch (error) { return "refused"; }
    }"""
    assert page.evaluate(sent, [address, server.token]) == "refused"
    page.set_content(f'<iframe src="{address}"></iframe>')
    page.wait_for_timeout(500)
    assert "Stop, drive off" not in (page.frames[-1].content() if len(page.frames) > 1 else "")
    assert not (run.folder / STOP_FILE).exists()
    page.close()


def test_the_page_says_that_watch_has_ended(browser: Browser, server: LiveServer) -> None:
    page = opened(browser, server)
    page.route("**/state*", lambda route: route.abort())
    expect(page.locator("#state")).to_contain_text("the sweep is not touched")
    expect(page.locator("#stop")).to_be_disabled()
    page.close()


def test_without_a_model_there_is_no_simulation(browser: Browser, run: Any) -> None:
    server = LiveServer(LiveView(run.folder))
    thread = threading.Thread(target=server.serve_forever, args=(0.02,))
    thread.start()
    page = opened(browser, server)
    for part in page.locator(".simulated").all():
        expect(part).to_be_hidden()
    page.close()
    server.shutdown()
    thread.join(5.0)
    server.server_close()
