"""`python -m hil_sim`: the simulated testbed alone, for any client."""

import argparse
import json
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from hil_sim.board import Board
from hil_sim.control import run_until_stopped, stop_signals
from hil_sim.defects import CATALOGUE, defective_plant, parse_defect
from hil_sim.fault_entries import parse_fault, read_faults
from hil_sim.faults import FaultKind, FaultSchedule
from hil_sim.gpsim_board import GpsimBoard
from hil_sim.gpsim_bridge import GpsimBridge
from hil_sim.plant import MotorPlant, PlantParameters
from hil_sim.running import RunningTestbed
from hil_sim.testbed import BoardMachine, FaultablePlant
from usmbench.errors import BenchError, InputError, UsmbenchError
from usmbench.one_line_parser import OneLineParser
from usmbench.output import complain

# The pseudo-terminal's thread must get its turn within a byte's time, whatever the others compute.
_SWITCH_INTERVAL_S: Final = 100e-6


def _parser() -> argparse.ArgumentParser:
    parser = OneLineParser(
        prog="python -m hil_sim",
        description="Simulated testbed: signal generator board, USR60 motor, encoder and DAQ card.",
    )
    parser.add_argument("--seed", type=int, default=0, help="seed of the motor's noise")
    parser.add_argument(
        "--lock-step",
        action="store_true",
        help="move time with the samples read, as fast as they are, instead of with the clock",
    )
    parser.add_argument(
        "--board",
        choices=("emulated", "gpsim"),
        default="emulated",
        help="the board as a model, or its very firmware run in gpsim (build it: make -C firmware)",
    )
    parser.add_argument("--load", type=float, default=0.0, metavar="NM", help="load torque in N·m")
    parser.add_argument(
        "--fault",
        action="append",
        default=[],
        metavar="KIND@SECONDS[,OPTION=VALUE…]",
        help=f"a fault and its simulated time; kinds: {', '.join(FaultKind)}",
    )
    parser.add_argument("--fault-file", type=Path, metavar="FILE", help="faults as a YAML list")
    motor = parser.add_mutually_exclusive_group()
    motor.add_argument(
        "--model",
        type=Path,
        metavar="MODEL.yaml",
        help="the motor as a model file says, identified or extended by a diagnosis; no noise",
    )
    motor.add_argument(
        "--defect",
        action="append",
        default=[],
        metavar="MECHANISM[=SIZE]",
        help="something wrong with the motor or the bench, of its typical size or of another; "
        f"mechanisms, typical sizes and units: {_mechanisms()}",
    )
    parser.add_argument("--json", action="store_true", help="print port and address as JSON")
    parser.add_argument(
        "--stdin-control",
        action="store_true",
        help='take lines such as {"load_nm": 0.1} from standard input, and stop at its end',
    )
    return parser


def _mechanisms() -> str:
    """List the defects, for argparse, to which a percent sign means something."""
    listed = (f"{name}={kind.typical:g} ({kind.unit})" for name, kind in CATALOGUE.items())
    return ", ".join(listed).replace("%", "%%")


@contextmanager
def _board(kind: str) -> Iterator[BoardMachine]:
    """Give the board asked for, and end its processor after use."""
    if kind == "emulated":
        yield Board()
    else:
        with GpsimBridge() as bridge:
            yield GpsimBoard(bridge)


def build_plant(defects: Sequence[str], seed: int, model: Path | None = None) -> FaultablePlant:
    """Return the motor, with what is wrong with it.

    Parameters
    ----------
    defects
        Mechanisms and sizes, as the command line gives them; may be empty.
    seed
        Seed of the noise.
    model
        Model file that the motor follows instead of its physics, or None.

    Raises
    ------
    usmbench.errors.InputError
        There is no such mechanism, or the model will not do.
    """
    if model is not None:
        # Half of the time that the testbed would take to start.
        from hil_sim.model_plant import ModelPlant
        from usmbench.model.model_file import read_model

        return ModelPlant(read_model(model))
    if not defects:
        return MotorPlant(seed=seed)
    return defective_plant(PlantParameters(), [parse_defect(text) for text in defects], seed=seed)


def _run(arguments: argparse.Namespace) -> None:
    if arguments.seed < 0:
        raise InputError(f"the seed must be 0 or more, not {arguments.seed}")
    if arguments.stdin_control and sys.stdin is None:
        raise InputError("--stdin-control needs standard input, which is closed; open it")
    faults = [parse_fault(text) for text in arguments.fault]
    if arguments.fault_file is not None:
        faults += read_faults(arguments.fault_file)
    plant = build_plant(arguments.defect, arguments.seed, arguments.model)
    schedule = FaultSchedule(faults)
    sys.setswitchinterval(_SWITCH_INTERVAL_S)
    with (
        stop_signals() as stop,
        _board(arguments.board) as board,
        RunningTestbed(plant, schedule, lock_step=arguments.lock_step, board=board) as running,
    ):
        running.testbed.set_load(arguments.load)
        if arguments.json:
            print(json.dumps({"port": running.port, "daq": running.daq_address}), flush=True)
        else:
            print(f"serial port: {running.port}")
            print(f"DAQ address: {running.daq_address}", flush=True)
        run_until_stopped(running.testbed, stop, stdin_control=arguments.stdin_control)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the testbed until it is stopped; return the exit status.

    Parameters
    ----------
    argv
        Arguments; None for those of the process.
    """
    try:
        _run(_parser().parse_args(argv))
    except UsmbenchError as error:
        complain(f"hil_sim: {error}")
        return error.exit_status
    except OSError as error:
        complain(f"hil_sim: no port or pseudo-terminal can be opened: {error}")
        return BenchError.exit_status
    return 0


if __name__ == "__main__":
    sys.exit(main())
