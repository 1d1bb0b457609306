"""The page that ``diagnose --report`` writes: one HTML file that needs nothing else."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from usmbench.diagnose.result import Diagnosis
from usmbench.model.hammerstein import HammersteinModel
from usmbench.report.diagnosis_causes import causes_section
from usmbench.report.diagnosis_lone import lone_section
from usmbench.report.diagnosis_sections import (
    driven_section,
    evidence_section,
    figures_section,
    next_section,
    remainder_section,
    traces_section,
    views_section,
)
from usmbench.report.diagnosis_style import STYLE
from usmbench.report.diagnosis_tables import (
    detectable_table,
    files_table,
    fitted_on,
    runs_table,
)
from usmbench.report.diagnosis_text import escaped, headline, verdict_sentence
from usmbench.runs.columns import WINDOWS_FILE
from usmbench.runs.meta import sha256_of
from usmbench.runs.output_files import write_output
from usmbench.runs.record import Record

# The page must not fetch anything, whatever a hostile name should smuggle into it.
_POLICY = "default-src 'none'; style-src 'unsafe-inline'"


def write_diagnosis_page(
    path: Path,
    diagnosis: Diagnosis,
    records: Sequence[Record],
    model: HammersteinModel,
    model_file: Path,
    driven: Sequence[tuple[str, str]] = (),
) -> None:
    """Write the page.

    Parameters
    ----------
    path
        The file; an existing one is replaced.
    diagnosis
        What was found.
    records
        The runs that were diagnosed.
    model
        The model they were held against.
    model_file
        Where it was read from.
    driven
        Of each experiment that was driven to decide, the run and what it was to show.

    Raises
    ------
    usmbench.errors.InputError
        The file cannot be written.
    """
    files = [model_file, *(_windows_of(Path(record.name)) for record in records)]
    sums = {str(file): sha256_of(file) for file in files}
    write_output(path, diagnosis_page(diagnosis, records, model, sums, driven))


def _windows_of(run: Path) -> Path:
    """Return the file that was read of a run."""
    return run / WINDOWS_FILE if run.is_dir() else run


def diagnosis_page(
    diagnosis: Diagnosis,
    records: Sequence[Record],
    model: HammersteinModel,
    sums: Mapping[str, str],
    driven: Sequence[tuple[str, str]] = (),
) -> str:
    """Return the page.

    Parameters
    ----------
    diagnosis
        What was found.
    records
        The runs that were diagnosed.
    model
        The model they were held against.
    sums
        SHA-256 of every file that was read, by its name.
    driven
        Of each experiment that was driven to decide, the run and what it was to show.
    """
    body = "\n".join(_sections(diagnosis, records, model, sums, driven))
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{_POLICY}">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>Diagnosis: {escaped(headline(diagnosis))}</title>\n"
        f"<style>{STYLE}</style>\n</head>\n<body>\n<main>\n{body}\n</main>\n</body>\n</html>\n"
    )


def _sections(
    diagnosis: Diagnosis,
    records: Sequence[Record],
    model: HammersteinModel,
    sums: Mapping[str, str],
    driven: Sequence[tuple[str, str]],
) -> Iterator[str]:
    """Yield the page's parts from top to bottom."""
    motors = list(dict.fromkeys(r.motor for r in records if r.motor is not None))
    of = f" of {escaped(', '.join(motors))}" if motors else ""
    yield f"<h1>usmbench diagnosis{of}</h1>"
    yield (
        f'<div class="verdict {diagnosis.verdict}"><strong>{escaped(headline(diagnosis))}</strong>'
        f"<p>{escaped(verdict_sentence(diagnosis))}</p></div>"
    )
    yield figures_section(diagnosis)
    for warning in diagnosis.warnings:
        yield f'<p class="warning">{escaped(warning)}</p>'
    yield traces_section(diagnosis)
    yield lone_section(diagnosis)
    yield views_section(diagnosis)
    yield evidence_section(diagnosis)
    yield causes_section(diagnosis)
    yield remainder_section(diagnosis)
    yield driven_section(driven)
    yield next_section(diagnosis)
    yield detectable_table(diagnosis)
    yield f'<h2 id="data">What was held against what</h2>{runs_table(records)}'
    yield fitted_on(model)
    yield files_table(sums)
