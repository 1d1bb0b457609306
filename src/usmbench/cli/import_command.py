"""``usmbench import``: somebody else's CSV or .mat as a run folder."""

import argparse
from datetime import datetime
from pathlib import Path
from typing import Any

from usmbench import __version__
from usmbench.runs.columns import FORMAT
from usmbench.runs.foreign_run import read_foreign
from usmbench.runs.meta import iso, new_id, now_iso, sha256_of
from usmbench.runs.record_folder import write_record
from usmbench.settings.import_mapping import ImportMapping, load_mapping


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments.

    Parameters
    ----------
    parser
        The subcommand's parser.
    """
    parser.add_argument("file", metavar="FILE", type=Path, help="CSV file, or .mat")
    parser.add_argument(
        "--mapping",
        metavar="MAP.yaml",
        type=Path,
        required=True,
        help="what its columns are; `usmbench new mapping MAP.yaml` writes one to start from",
    )
    parser.add_argument("--out", metavar="RUN", type=Path, required=True, help="run folder to make")


def run(args: argparse.Namespace) -> int:
    """Import a file.

    Parameters
    ----------
    args
        The parsed arguments.

    Raises
    ------
    usmbench.errors.InputError
        The mapping is wrong, the file does not hold what it says, or the folder cannot be made.
    """
    mapping = load_mapping(args.mapping)
    record = read_foreign(args.file, mapping)
    write_record(args.out, record, _meta(args.file, mapping))
    print(args.out)
    return 0


def _meta(file: Path, mapping: ImportMapping) -> dict[str, Any]:
    """Say in run.yaml where the run came from."""
    written = datetime.fromtimestamp(file.stat().st_mtime).astimezone()
    document = mapping.source.document
    return {
        "format": FORMAT,
        "id": new_id(written),
        "started": iso(written),
        "software": f"usmbench {__version__}",
        "motor": document.get("motor", "unknown"),
        "encoder": document.get("encoder", {}),
        "imported": {
            "file": file.name,
            "sha256": sha256_of(file),
            "at": now_iso(),
            "mapping": document,
        },
        "stopped": iso(written),
        "exit": "completed",
    }
