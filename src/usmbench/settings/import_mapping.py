"""Mapping files: how the columns of somebody else's file become a run."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import pi
from pathlib import Path
from typing import Any, Final

from usmbench.settings.schema import check
from usmbench.settings.yaml_source import Source, read_source

_RPM: Final = 2.0 * pi / 60.0
_DEG: Final = pi / 180.0
_KGF_CM: Final = 9.80665e-2  # standard gravity, CGPM 1901

# Factor and offset to the unit in the column's name; V and counts depend on the mapping.
UNITS: Final[dict[str, dict[str, tuple[float, float]]]] = {
    "t_s": {"s": (1, 0), "ms": (1e-3, 0), "us": (1e-6, 0), "min": (60, 0), "h": (3600, 0)},
    "phase_deg": {"deg": (1, 0), "rad": (1 / _DEG, 0), "turn": (360, 0)},
    "speed_rad_s": {"rad/s": (1, 0), "deg/s": (_DEG, 0), "rpm": (_RPM, 0), "rev/s": (2 * pi, 0)},
    "angle_rad": {"rad": (1, 0), "deg": (_DEG, 0), "rev": (2 * pi, 0)},
    "frequency_hz": {"Hz": (1, 0), "kHz": (1e3, 0)},
    "torque_nm": {
        **dict.fromkeys(("N·m", "Nm"), (1.0, 0.0)),
        **dict.fromkeys(("mN·m", "mNm"), (1e-3, 0.0)),
        **dict.fromkeys(("N·cm", "Ncm"), (1e-2, 0.0)),
        "kgf·cm": (_KGF_CM, 0),
    },
    "temperature_c": {
        **dict.fromkeys(("°C", "C"), (1.0, 0.0)),
        "K": (1, -273.15),
        **dict.fromkeys(("°F", "F"), (5 / 9, -160 / 9)),
    },
    "window_s": {"s": (1, 0), "ms": (1e-3, 0), "us": (1e-6, 0)},
    "sweep": {"1": (1, 0)},
    "settled": {"1": (1, 0)},
}
VOLT: Final = "V"
COUNTS: Final = ("counts", "counts/s")


@dataclass(frozen=True, slots=True)
class ForeignColumn:
    """Where a column of the run comes from.

    Parameters
    ----------
    source
        Name in the file.
    unit
        Unit in the file.
    per_volt
        For volts: what one volt stands for, in the unit of the run's column.
    zero_v
        For volts: the voltage that stands for 0.
    sign
        -1 turns the sign round.
    round_to
        Step to round to, in the unit of the run's column; None leaves the values alone.
    """

    source: str
    unit: str
    per_volt: float = 0.0
    zero_v: float = 0.0
    sign: int = 1
    round_to: float | None = None


@dataclass(frozen=True, slots=True)
class CsvDialect:
    """How a CSV file is written.

    Parameters
    ----------
    delimiter
        What stands between two fields.
    decimal
        Decimal sign.
    skip_lines
        Lines before the one that names the columns.
    encoding
        Encoding of the text.
    """

    delimiter: str = ","
    decimal: str = "."
    skip_lines: int = 0
    encoding: str = "utf-8"


@dataclass(frozen=True, slots=True)
class ImportMapping:
    """What a mapping file says.

    Parameters
    ----------
    source
        The document, for messages that name the line.
    columns
        Where each column of the run comes from.
    constants
        Columns that are the same in every row.
    keep
        Further columns, under their own names.
    csv
        How a CSV file is written.
    counts_per_rev
        Counts of one revolution, None where no column is in counts.
    counter_bits
        Width of a counter that wraps, or None.
    """

    source: Source
    columns: Mapping[str, ForeignColumn]
    constants: Mapping[str, float] = field(default_factory=dict)
    keep: tuple[str, ...] = ()
    csv: CsvDialect = field(default_factory=CsvDialect)
    counts_per_rev: int | None = None
    counter_bits: int | None = None


def load_mapping(file: Path) -> ImportMapping:
    """Read a mapping file.

    Parameters
    ----------
    file
        The file.

    Raises
    ------
    usmbench.errors.InputError
        The file is not there or wrong; names the line and the mend.
    """
    return parse_mapping(read_source(file))


def parse_mapping(source: Source) -> ImportMapping:
    """Return the mapping that a document holds.

    Parameters
    ----------
    source
        The document.

    Raises
    ------
    usmbench.errors.InputError
        Something is wrong; names the line and the mend.
    """
    check(source, "import")
    document: dict[str, Any] = source.document
    encoder = document.get("encoder", {})
    mapping = ImportMapping(
        source=source,
        columns={name: _column(said) for name, said in document["columns"].items()},
        constants={name: float(said) for name, said in document.get("constants", {}).items()},
        keep=tuple(document.get("keep", ())),
        csv=CsvDialect(**document.get("csv", {})),
        counts_per_rev=encoder.get("counts_per_rev"),
        counter_bits=encoder.get("counter_bits"),
    )
    _check_units(mapping)
    _check_complete(mapping)
    _check_names(mapping)
    return mapping


def _column(said: dict[str, Any]) -> ForeignColumn:
    return ForeignColumn(source=said["from"], **{k: v for k, v in said.items() if k != "from"})


def _check_units(mapping: ImportMapping) -> None:
    """Refuse volts and counts that stand for nothing, and a scale or step that is not for them."""
    for name, column in mapping.columns.items():
        place = ("columns", name)
        if (column.unit == VOLT) != (column.per_volt != 0.0):
            message = (
                "say with per_volt what one volt stands for"
                if column.unit == VOLT
                else f"per_volt is for unit V, not for {column.unit}; remove one of them"
            )
            raise mapping.source.error((*place, "unit"), message)
        if column.unit != VOLT and column.zero_v != 0.0:
            message = f"zero_v is for unit V, not for {column.unit}; remove one of them"
            raise mapping.source.error((*place, "zero_v"), message)
        if column.unit in COUNTS and column.round_to is not None:
            message = f"round_to is not for {column.unit}; remove it"
            raise mapping.source.error((*place, "round_to"), message)
        if column.unit in COUNTS and mapping.counts_per_rev is None:
            message = "counts need encoder: {counts_per_rev: …}; add it"
            raise mapping.source.error((*place, "unit"), message)


def _check_complete(mapping: ImportMapping) -> None:
    """Refuse what gives no time or no speed, or the same column twice."""
    given, source = mapping.columns, mapping.source
    if "speed_rad_s" not in given and "angle_rad" not in given:
        message = "neither speed_rad_s nor angle_rad is there; add one of them"
        raise source.error(("columns",), message)
    timed = "t_s" in given or "window_s" in given or "window_s" in mapping.constants
    if not timed:
        message = "no t_s and no window_s; add one, or constants: {window_s: …}"
        raise source.error(("columns",), message)
    for name in mapping.constants:
        if name in given:
            message = f"columns.{name} gives it already; remove one of them"
            raise source.error(("constants", name), message)


def _check_names(mapping: ImportMapping) -> None:
    """Refuse names that would stand twice in the run, or that a CSV file cannot hold."""
    for number, name in enumerate(mapping.keep):
        place = ("keep", number)
        if name in UNITS or name in mapping.keep[:number]:
            raise mapping.source.error(place, f"{name} is a column already; remove it")
        if not name.isprintable():
            raise mapping.source.error(place, f"{name!r} is no name of a column; remove it")
