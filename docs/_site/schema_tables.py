"""Tables of the keys of the YAML files, from their JSON Schemas."""

import json
from collections.abc import Iterator
from importlib.resources import files
from typing import Any

Schema = dict[str, Any]


def schema_table(name: str) -> str:
    """Return the keys of a kind of YAML file as a table.

    Parameters
    ----------
    name
        Kind of file: plan, bench or import.
    """
    text = (files("usmbench.settings") / "schemas" / f"{name}.schema.json").read_text("utf-8")
    schema: Schema = json.loads(text)
    rows = [
        f"| `{key}` | {entry.get('description', '')} | {_takes(entry)} |"
        for key, entry in _entries(schema, schema, "")
    ]
    return "\n".join(["| key | what | takes |", "|---|---|---|", *rows])


def _entries(part: Schema, schema: Schema, prefix: str) -> Iterator[tuple[str, Schema]]:
    """Give every key below a part of the schema, with what is said of it."""
    for name, said in part.get("properties", {}).items():
        entry = _resolved(said, schema)
        key = prefix + name
        yield key, entry
        yield from _entries(entry, schema, f"{key}.")
        yield from _entries(entry.get("items", {}), schema, f"{key}[].")


def _resolved(entry: Schema, schema: Schema) -> Schema:
    """Return an entry with the definition that it refers to; what it says itself goes first."""
    if "$ref" not in entry:
        return entry
    definition = schema["$defs"][entry["$ref"].rsplit("/", 1)[1]]
    below = definition.get("properties", {}) | entry.get("properties", {})
    return {**definition, **entry, "properties": below} if below else {**definition, **entry}


def _takes(entry: Schema) -> str:
    """Return the values that an entry takes, in a few words."""
    if "const" in entry:
        return f"`{entry['const']}`"
    if "enum" in entry:
        return ", ".join(f"`{value}`" for value in entry["enum"])
    kinds = entry.get("type", "")
    words = " or ".join([kinds] if isinstance(kinds, str) else kinds)
    bounds = [
        f"{sign} {entry[bound]:g}"
        for bound, sign in (
            ("minimum", "≥"),
            ("exclusiveMinimum", ">"),
            ("maximum", "≤"),
        )
        if bound in entry
    ]
    return " ".join([words, ", ".join(bounds)]).strip()
