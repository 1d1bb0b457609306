"""mkdocs hooks: the pages of the site that are made, the order of all, and links out of docs/.

Pages under docs/ are found by themselves. Made are the reference pages and the pages whose source
stands beside the firmware; a linked file that is no page, such as a bench file, is copied.
"""

import os
import posixpath
import re
from pathlib import Path
from typing import Any, Final

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page
from reference_pages import reference_pages
from schema_tables import schema_table

ROOT: Final = Path(__file__).resolve().parents[2]

# Page of the site: file of the project that it is made from.
FROM_ELSEWHERE: Final = {
    f"explanations/{file.stem.lower()}.md": f"firmware/{file.name}"
    for file in sorted((ROOT / "firmware").glob("*.md"))
}
SECTIONS: Final = {
    "How-to": "how-to/",
    "Explanations": "explanations/",
    "Reference": "reference/",
    "Decisions": "decisions/",
}
# Pages that come before those of their section in alphabetical order.
FIRST: Final = ("reference/command-line.md", "reference/file-formats.md", "reference/causes.md")

_LINK: Final = re.compile(r"(\]\()([^)#:\s]+)([)#])")
_SCHEMA: Final = re.compile(r"<!-- schema: (\w+) -->")


def on_files(files: Files, *, config: MkDocsConfig) -> Files:
    """Add the pages that are made and the files that are linked; set the order of the pages.

    Parameters
    ----------
    files
        What stands under docs/.
    config
        Configuration of the site, whose `nav` is set.
    """
    made = dict(reference_pages())
    made |= {page: (ROOT / file).read_text("utf-8") for page, file in FROM_ELSEWHERE.items()}
    for page, text in made.items():
        files.append(File.generated(config, page, content=text))
    for file in sorted(_linked_files(files)):
        files.append(File.generated(config, f"files/{file}", abs_src_path=str(ROOT / file)))
    config.nav = _navigation(files)
    return files


def on_page_markdown(markdown: str, *, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Fill in the tables of the YAML files, and turn links to files that are moved on the site.

    Parameters
    ----------
    markdown
        Text of the page.
    page
        The page.
    config
        Configuration of the site.
    files
        All pages.
    """
    source = page.file.src_uri

    def on_site(link: re.Match[str]) -> str:
        file = _linked_file(source, link[2])
        if file is None:
            return link[0]
        relative = posixpath.relpath(_site_path(file), posixpath.dirname(source))
        return link[1] + relative + link[3]

    return _SCHEMA.sub(lambda mark: schema_table(mark[1]), _LINK.sub(on_site, markdown))


def _linked_file(page: str, link: str) -> str | None:
    """Return the file of the project that a link of a page leads to, from the project's top."""
    folder = (ROOT / FROM_ELSEWHERE.get(page, f"docs/{page}")).parent
    target = Path(os.path.normpath(folder / link))
    if not target.is_relative_to(ROOT) or not target.is_file():
        return None
    return target.relative_to(ROOT).as_posix()


def _site_path(file: str) -> str:
    """Return where on the site a file of the project is."""
    moved = {source: page for page, source in FROM_ELSEWHERE.items()}
    if file.startswith("docs/"):
        return file.removeprefix("docs/")
    return moved.get(file, f"files/{file}")


def _linked_files(files: Files) -> set[str]:
    """Return the files that pages link to and that are no pages."""
    pages = files.documentation_pages()
    links = ((page.src_uri, found[2]) for page in pages for found in _all_links(page))
    linked = {_linked_file(page, link) for page, link in links}
    return {file for file in linked if file and _site_path(file).startswith("files/")}


def _all_links(page: File) -> list[re.Match[str]]:
    return list(_LINK.finditer(page.content_string))


def _navigation(files: Files) -> list[Any]:
    """Return the order of the pages: one section a folder."""
    pages = sorted(file.src_uri for file in files.documentation_pages())
    sections = {
        name: sorted((page for page in pages if page.startswith(folder)), key=_rank)
        for name, folder in SECTIONS.items()
    }
    sections["Explanations"].insert(0, "architecture.md")
    return ["index.md", "tutorial.md", *({n: s} for n, s in sections.items()), "figures.md"]


def _rank(page: str) -> tuple[bool, str]:
    return page not in FIRST, page
