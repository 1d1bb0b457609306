"""`--bench simulated`: the testbed without hardware, in a process of its own."""

import json
import queue
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from typing import IO, Any

from usmbench.errors import BenchError, InputError, UsmbenchError
from usmbench.settings.bench import SIMULATED, BenchSettings, DaqSettings, GeneratorSettings

START_TIMEOUT_S = 60.0
REPLY_TIMEOUT_S = 10.0
STOP_TIMEOUT_S = 3.0
_LAST_WORDS_S = 0.5
# No byte is lost on a pseudo-terminal, and a frame sent twice would shift what follows it: the
# rows would depend on how busy this machine is.
LOCK_STEP_REPLY_TIMEOUT_S = 2.0


class SimulatedTestbed:
    """A running `python -m hil_sim`, and the hand that turns its load.

    Parameters
    ----------
    process
        The started process, with pipes for its standard input and output.
    messages
        File that takes its standard error, shown where it fails.

    Raises
    ------
    usmbench.errors.BenchError
        The process does not come up.
    usmbench.errors.InputError
        It refuses its arguments.
    """

    def __init__(self, process: "subprocess.Popen[str]", messages: IO[str]):
        if process.stdin is None or process.stdout is None:
            raise ValueError("the process has no pipes")
        self._process, self._input, self._output = process, process.stdin, process.stdout
        self._messages = messages
        self._lines: queue.Queue[str] = queue.Queue()
        reader = threading.Thread(target=self._read_lines, name="hil_sim output", daemon=True)
        reader.start()
        self._reader = reader
        try:
            address = self._next_reply(START_TIMEOUT_S)
            self.port = str(address["port"])
            self.daq_address = str(address["daq"])
        except BaseException:
            process.kill()
            self.stop()
            raise

    def _read_lines(self) -> None:
        # Closed here: anybody else would wait for a child of the process that holds it.
        with self._output:
            for line in self._output:
                self._lines.put(line)
        self._lines.put("")

    def _next_reply(self, timeout_s: float) -> dict[str, Any]:
        try:
            line = self._lines.get(timeout=timeout_s)
        except queue.Empty:
            line = ""
        if not line:
            raise self._why_silent(timeout_s)
        reply: dict[str, Any] = json.loads(line)
        return reply

    def _why_silent(self, timeout_s: float) -> UsmbenchError:
        """Return what is wrong where no reply came: our arguments, or the testbed."""
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(_LAST_WORDS_S)
        self._messages.seek(0)
        said = (self._messages.read().strip().splitlines() or ["none"])[-1]
        if self._process.returncode == InputError.exit_status:
            return InputError(f"the simulated testbed refuses its arguments: {said}")
        what = f"said nothing for {timeout_s:g} s"
        if self._process.returncode is not None:
            what = f"ended with status {self._process.returncode}"
        return BenchError(
            f"the simulated testbed (python -m hil_sim) {what}; its last words: {said}"
        )

    def set_load(self, torque_nm: float) -> None:
        """Set the load torque of the simulated motor.

        Parameters
        ----------
        torque_nm
            Load torque.

        Raises
        ------
        usmbench.errors.BenchError
            The testbed does not answer.
        """
        try:
            self._input.write(json.dumps({"load_nm": torque_nm}) + "\n")
            self._input.flush()
        except OSError:
            raise BenchError("the simulated testbed has ended: its load cannot be set") from None
        reply = self._next_reply(REPLY_TIMEOUT_S)
        if not reply.get("ok"):
            raise BenchError(f"the simulated testbed refused the load {torque_nm:g} N·m: {reply}")

    def stop(self) -> None:
        """End the process; it also ends by itself when this one dies and its input closes."""
        for end in (self._input.close, self._process.terminate, self._process.kill):
            try:
                end()
                self._process.wait(STOP_TIMEOUT_S)
            except (OSError, subprocess.TimeoutExpired):
                continue
            break
        self._reader.join(STOP_TIMEOUT_S)


@contextmanager
def start_testbed(arguments: Sequence[str]) -> Iterator[SimulatedTestbed]:
    """Run `python -m hil_sim` for as long as the context lasts.

    Parameters
    ----------
    arguments
        Further arguments of hil_sim, such as ``["--lock-step", "--seed", "3"]``.

    Raises
    ------
    usmbench.errors.BenchError
        It does not start.
    usmbench.errors.InputError
        It refuses its arguments.
    """
    command = [sys.executable, "-m", "hil_sim", "--json", "--stdin-control", *arguments]
    with tempfile.TemporaryFile("w+") as messages:
        # A session of its own: Ctrl-C must reach us, who switch the drive off, and not the bench.
        process = subprocess.Popen(  # noqa: S603 - our own module, no shell
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=messages,
            text=True,
            start_new_session=True,
        )
        testbed = SimulatedTestbed(process, messages)
        try:
            yield testbed
        finally:
            testbed.stop()


def simulated_settings(base: BenchSettings, port: str, daq_address: str) -> BenchSettings:
    """Return the settings of the embedded testbed.

    Parameters
    ----------
    base
        Settings whose limits and encoder are kept.
    port
        Serial port of the simulated board.
    daq_address
        host:port of the stand-in NI device server.
    """
    daq: DaqSettings = replace(
        base.daq,
        address=daq_address,
        # Lock step moves on demand, so silence means that the process is gone or starved of CPU.
        no_data_timeout_s=REPLY_TIMEOUT_S,
    )
    generator: GeneratorSettings = replace(
        base.generator, port=port, reply_timeout_s=LOCK_STEP_REPLY_TIMEOUT_S
    )
    return replace(base, name=SIMULATED, generator=generator, daq=daq)


@dataclass(frozen=True, slots=True)
class SimulatedOperator:
    """Sets the load on the simulated motor instead of asking a person.

    Parameters
    ----------
    testbed
        The running testbed.
    """

    testbed: SimulatedTestbed

    def set_load(self, torque_nm: float, *, ask: bool) -> None:
        """Set the load torque.

        Parameters
        ----------
        torque_nm
            Load torque.
        ask
            Whether a person would be asked; the simulated motor needs its load either way.
        """
        self.testbed.set_load(torque_nm)

    def load_is_set(self) -> bool:
        """Return True: the testbed has confirmed the load before `set_load` returned."""
        return True
