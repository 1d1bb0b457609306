"""``usmbench watch``: the live page of a run, while another process measures it or after."""

import argparse
from pathlib import Path

from usmbench.errors import InputError
from usmbench.model.model_file import read_model
from usmbench.watch.server import HOST, LiveServer
from usmbench.watch.view import LiveView


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments.

    Parameters
    ----------
    parser
        The subcommand's parser.
    """
    parser.add_argument("run_path", metavar="RUN", type=Path, help="run folder or CSV")
    parser.add_argument("--model", type=Path, metavar="MODEL.yaml", help="show it beside the run")
    parser.add_argument("--port", type=int, default=0, metavar="N", help="port [a free one]")


def run(args: argparse.Namespace) -> int:
    """Serve the page until Ctrl-C, which ends the page and not the sweep.

    Parameters
    ----------
    args
        The parsed arguments.

    Raises
    ------
    usmbench.errors.InputError
        No such run or model, or the port cannot be had.
    """
    if not 0 <= args.port <= 65535:
        raise InputError("--port takes a number from 0 to 65535")
    model = None if args.model is None else read_model(args.model)
    view = LiveView(args.run_path, model)
    view.look()
    with LiveServer(view, args.port) as server:
        page = f"http://{HOST}:{server.server_port}/"
        print(f"page   {page}#{server.token}")
        print(f"token  {server.token}   the stop button asks for it where it is not in the address")
        print("Ctrl-C ends the page; a sweep goes on.", flush=True)
        try:
            server.serve_forever()
        except KeyboardInterrupt:
            print()
    return 0
