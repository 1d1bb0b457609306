"""Command lines whose usage errors are one line, for every program of the bench."""

import argparse
from typing import NoReturn

from usmbench.errors import InputError


class OneLineParser(argparse.ArgumentParser):
    """An argument parser whose errors are one line, like every other bad input."""

    def error(self, message: str) -> NoReturn:
        """Raise the usage error as bad input.

        Parameters
        ----------
        message
            What is wrong with the arguments.

        Raises
        ------
        InputError
            Always.
        """
        raise InputError(f"{message} (see `{self.prog} --help`)")
