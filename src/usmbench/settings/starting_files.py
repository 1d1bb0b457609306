"""Commented files to start from, and the schemas that editors complete and check them by."""

from importlib import resources
from pathlib import Path
from typing import Final

# Kind of file: the template's and the schema's name, and the file written where none is named.
KINDS: Final = {
    "plan": ("plan", "plan.yaml"),
    "bench": ("bench", "bench.yaml"),
    "mapping": ("import", "mapping.yaml"),
}
_SCHEMA_LINE: Final = "# yaml-language-server: $schema="


def schema_path(name: str) -> Path:
    """Return the file of a JSON schema that ships.

    Parameters
    ----------
    name
        "plan", "bench", "import", "model", "diagnosis" or "run".
    """
    return Path(str(resources.files(__package__).joinpath("schemas", f"{name}.schema.json")))


def template(kind: str) -> str:
    """Return a commented file, its first line naming the schema on this computer.

    Parameters
    ----------
    kind
        One of `KINDS`.
    """
    name, _ = KINDS[kind]
    file = resources.files(__package__).joinpath("templates", f"{name}.yaml")
    _, _, rest = file.read_text("utf-8").partition("\n")
    return f"{_SCHEMA_LINE}{schema_path(name).as_uri()}\n{rest}"
