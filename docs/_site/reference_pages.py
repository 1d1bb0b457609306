"""Reference pages: one a package from its docstrings, one for the command line."""

import contextlib
import importlib
import inspect
import io
import itertools
import os
import pkgutil
from collections.abc import Callable, Iterator, Sequence
from types import ModuleType

import hil_sim
import hil_sim.__main__
import usmbench
from usmbench.cli.main import COMMANDS, build_parser
from usmbench.model.effects.registry import library

# Its users see the command line, which has a page of its own.
WITHOUT_PAGE = {"usmbench.cli"}


def reference_pages() -> Iterator[tuple[str, str]]:
    """Give each page's path on the site and its text."""
    yield "reference/command-line.md", _command_line_page()
    yield "reference/causes.md", _causes_page()
    for root in usmbench, hil_sim:
        for package in _packages(root):
            if package.__name__ not in WITHOUT_PAGE:
                yield f"reference/{package.__name__}.md", _package_page(package)


def _packages(root: ModuleType) -> Iterator[ModuleType]:
    yield root
    for found in pkgutil.walk_packages(root.__path__, root.__name__ + "."):
        if found.ispkg:
            yield importlib.import_module(found.name)


def _package_page(package: ModuleType) -> str:
    """Return the page on which mkdocstrings writes what the package and its modules say."""
    modules = [m.name for m in pkgutil.iter_modules(package.__path__) if not m.ispkg]
    public = [f"{package.__name__}.{name}" for name in modules if not name.startswith("_")]
    return "\n\n".join(
        [f"# {package.__name__}", *(f"::: {name}" for name in (package.__name__, *public)), ""]
    )


def _command_line_page() -> str:
    """Return what every command says when asked for help."""
    os.environ["COLUMNS"] = "80"  # where argparse breaks its lines
    lines = [
        "# Command line",
        "",
        "What each command prints with `--help`. Exit status: 0 done; 2 bad input, nothing has",
        "moved; 3 the bench failed, the drive was stopped; 130 stopped by the user, drive off,",
        "run folder closed.",
    ]
    for name in COMMANDS:
        parser = build_parser(name)
        lines += _section(f"usmbench {name}", parser.parse_args, [name, "--help"])
    lines += _section("python -m hil_sim", hil_sim.__main__.main, ["--help"])
    return "\n".join(lines) + "\n"


def _causes_page() -> str:
    """Return what the library knows of every cause: its forms and what their parameters are."""
    lines = [
        "# Causes",
        "",
        "What `usmbench diagnose` may name, in which forms, how each changes the phase φ, the",
        "settled speed v or the speed ω, and what the numbers are that it is sized by.",
    ]
    for name, found in itertools.groupby(library(), key=lambda effect: effect.name):
        forms = list(found)
        lines += ["", f"## {name.replace('_', ' ')}", "", f"`{name}`"]
        for effect in forms:
            lines += ["", f"### {effect.form or 'plain'}"] if len(forms) > 1 else []
            said = inspect.cleandoc(type(effect).__doc__ or "").split("\n\n")[0]
            lines += ["", effect.meaning, "", said, ""]
            if effect.parameters:
                lines += ["| parameter | unit | what |", "|---|---|---|"]
                lines += [f"| `{p.name}` | {p.unit} | {p.what} |" for p in effect.parameters]
    return "\n".join(lines) + "\n"


def _section(title: str, command: Callable[[Sequence[str]], object], words: list[str]) -> list[str]:
    printed = io.StringIO()
    with contextlib.suppress(SystemExit), contextlib.redirect_stdout(printed):
        command(words)
    return ["", f"## {title}", "", "```text", printed.getvalue().rstrip(), "```"]
