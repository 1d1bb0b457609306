"""The documentation as a site, opened from a folder: the search works without a server or a net."""

import shutil
from pathlib import Path

import pytest
import yaml
from mkdocs.commands.build import build
from mkdocs.config import load_config
from playwright.sync_api import Browser, Route, expect

ROOT = Path(__file__).resolve().parents[2]
PAGE = "# Motor\n\n## Hysteresis\n\nIt starts later than it stops.\n"


@pytest.fixture
def site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a site of one page that is configured as ours."""
    monkeypatch.setenv("NO_MKDOCS_2_WARNING", "1")
    docs = tmp_path / "docs"
    docs.mkdir()
    (docs / "index.md").write_text(PAGE, "utf-8")
    for name in ("site.css", "iframe-worker.js"):
        shutil.copy(ROOT / "docs" / name, docs)
    ours = yaml.safe_load((ROOT / "mkdocs.yml").read_text("utf-8"))
    del ours["hooks"]  # they add the reference
    ours["plugins"] = [plugin for plugin in ours["plugins"] if isinstance(plugin, str)]
    (tmp_path / "mkdocs.yml").write_text(yaml.safe_dump(ours), "utf-8")
    build(load_config(str(tmp_path / "mkdocs.yml")))
    return tmp_path / "site"


@pytest.mark.parametrize("width", [1280, 400])
def test_the_search_works_from_a_folder(site: Path, browser: Browser, width: int) -> None:
    page = browser.new_page(viewport={"width": width, "height": 800})
    page.on("pageerror", lambda error: pytest.fail(f"the page failed: {error}"))

    def refuse(route: Route) -> None:
        pytest.fail(f"asks for {route.request.url}")

    page.route("http*://**", refuse)
    page.goto((site / "index.html").as_uri())
    page.keyboard.press("f")
    page.keyboard.type("hysteresis")
    found = page.locator(".md-search-result__link").last
    expect(found).to_contain_text("starts later than it stops")
    assert (found.get_attribute("href") or "").endswith("/index.html#hysteresis")
    page.close()
