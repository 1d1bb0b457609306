"""The data files of a run that is measured: opened, forced to disk and closed together."""

from pathlib import Path
from typing import Final

from usmbench.errors import UsmbenchError
from usmbench.runs.columns import (
    PAIR_COLUMNS_WRITTEN,
    PAIRS_FILE,
    RAW_FILE,
    WINDOW_COLUMNS,
    WINDOW_COLUMNS_T,
    WINDOWS_FILE,
)
from usmbench.runs.files import AppendedFile, refuse_links
from usmbench.runs.raw import RawWriter
from usmbench.runs.run_lock import lock


class DataFiles:
    """windows.csv, pairs.csv and, where it is kept, raw.h5, open for appending.

    Parameters
    ----------
    folder
        The run folder.
    temperature
        Whether windows.csv has the temperature column.
    raw
        Whether raw.h5 is kept.

    Raises
    ------
    usmbench.errors.InputError
        Another program writes the run, or a file is a link; nothing has been changed.
    usmbench.errors.BenchError
        A file cannot be opened or written.
    """

    def __init__(self, folder: Path, *, temperature: bool, raw: bool):
        self.closed: Final[list[str]] = []
        """Names of the files that were closed, with everything in them that they were given."""
        self.temperature: Final = temperature
        self.raw: RawWriter | None = None
        refuse_links(folder)
        self.windows: Final = AppendedFile(folder / WINDOWS_FILE)
        self.pairs: Final = AppendedFile(folder / PAIRS_FILE)
        try:
            lock(self.windows.descriptor, folder)
            self._begin_rows(WINDOW_COLUMNS_T if temperature else WINDOW_COLUMNS)
            if raw:
                self.raw = RawWriter(folder / RAW_FILE)
        except UsmbenchError:
            self.close()
            raise

    def _begin_rows(self, columns: tuple[str, ...]) -> None:
        """Drop rows that a cut tore, and write the column names into files that have none."""
        for file, names in ((self.windows, columns), (self.pairs, PAIR_COLUMNS_WRITTEN)):
            file.drop_torn_row()
            if not file.size:
                file.append((",".join(names) + "\n").encode())
            file.sync()

    def sync(self) -> None:
        """Force everything to disk, windows before the pairs that were made from them.

        Raises
        ------
        usmbench.errors.BenchError
            The disk does not take it.
        """
        self.windows.sync()
        self.pairs.sync()
        if self.raw is not None:
            self.raw.sync()

    def close(self) -> None:
        """Release the files.

        Raises
        ------
        usmbench.errors.BenchError
            HDF5 could not write what it still held; the CSV files are closed.
        """
        files = {WINDOWS_FILE: self.windows, PAIRS_FILE: self.pairs, RAW_FILE: self.raw}
        for name, file in files.items():
            if file is not None:
                file.close()
                self.closed.append(name)
