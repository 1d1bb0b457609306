"""``--plot``, as the commands that always draw have it."""

import argparse
from pathlib import Path


def add_plot_argument(parser: argparse.ArgumentParser, default: str) -> None:
    """Declare ``--plot``.

    Parameters
    ----------
    parser
        The subcommand's parser.
    default
        The plot's file where the user names none.
    """
    parser.add_argument(
        "--plot",
        type=Path,
        metavar="FILE",
        default=Path(default),
        help=f"the plot: .png, .svg or .pdf [{default}]",
    )
