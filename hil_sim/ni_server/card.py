"""The simulated card: its tasks and its clock, under one lock, with its faults on demand."""

import math
import threading
import time
from typing import Final

from hil_sim.faults import FaultKind, FaultSchedule
from hil_sim.ni_server.channels import Values
from hil_sim.ni_server.clock import SampleClock, SampleFeed
from hil_sim.ni_server.errors import NiCode, NiError, ServerDeadError
from hil_sim.ni_server.tasks import Task, TaskTable

_LONGEST_WAIT_S: Final = 0.5
_KEEP_UP_S: Final = 0.05
_EVENTS_AT_ONCE: Final = 8
"""In lock step nothing waits for an event, so they are sent some at a time, up to twice as many
before their blocks are read: each by itself would cost as much as the read."""


class Card:
    """What the clients' calls act on; every method may be called from any thread.

    Parameters
    ----------
    feed
        Where the samples come from.
    lock_step
        Whether time stands still until samples are read.
    faults
        What goes wrong, and when.
    """

    def __init__(self, feed: SampleFeed, *, lock_step: bool, faults: FaultSchedule):
        self.tasks = TaskTable()
        self._clock = SampleClock(feed, lock_step=lock_step)
        self._lock_step = lock_step
        self._faults = faults
        self._changed = threading.Condition()
        self._closed = threading.Event()
        self._keeper = threading.Thread(target=self._keep_up, name="sample clock", daemon=True)
        if not lock_step:
            self._keeper.start()

    def _keep_up(self) -> None:
        """Take samples nobody waits for: motor and board go on where the client has gone quiet."""
        while not self._closed.wait(_KEEP_UP_S):
            with self._changed:
                self._clock.catch_up(_KEEP_UP_S)
                self._forget()

    def close(self) -> None:
        """Stop the clock for good; safe to call twice, and from any thread."""
        self._closed.set()
        with self._changed:
            self._clock.stop()
            self._changed.notify_all()
        if self._keeper.is_alive():
            self._keeper.join(_LONGEST_WAIT_S)

    def check_alive(self) -> None:
        """Find out whether the server still answers.

        Raises
        ------
        hil_sim.ni_server.errors.ServerDeadError
            It does not, by a fault on demand.
        """
        self._check_alive_at(self._clock.taken)

    def _check_alive_at(self, sample: int) -> None:
        if self._has(FaultKind.SERVER_DEAD, sample):
            raise ServerDeadError

    def _has(self, kind: FaultKind, sample: int) -> bool:
        """Say whether a fault has begun when a sample's interval begins.

        Reads and events go by the end of their block: all tasks lose the same one in lock step.
        """
        return self._faults.active(kind, self._clock.time_s(sample)) is not None

    def start(self, task: Task) -> None:
        """Start a task.

        Parameters
        ----------
        task
            The task.

        Raises
        ------
        hil_sim.ni_server.errors.NiError
            It has no channel, or another task uses its channel.
        """
        with self._changed:
            resource = task.require_channel().resource
            for other in self.tasks.all():
                if other.running and other.channel and other.channel.resource == resource:
                    raise NiError(NiCode.RESOURCE_RESERVED, f"{resource} is used by {other.name}")
            task.arm(self._clock.due())
            if task.makes_clock and not self._clock.running:
                self._clock.start(task.rate_hz)
                for waiting in self.tasks.all():
                    if waiting.running:
                        waiting.arm(0)
            self._changed.notify_all()

    def stop(self, task: Task) -> None:
        """Stop a task, and the clock where nothing else makes it tick.

        Parameters
        ----------
        task
            The task.
        """
        with self._changed:
            task.running = False
            if not any(other.makes_clock for other in self.tasks.all()):
                self._clock.stop()
            self._changed.notify_all()

    def clear(self, task: Task) -> None:
        """Stop a task and forget it.

        Parameters
        ----------
        task
            The task.
        """
        with self._changed:
            self.stop(task)
            self.tasks.remove(task)

    def client_gone(self, task: Task, registration: int) -> None:
        """Forget all tasks of a client whose event stream broke off.

        Parameters
        ----------
        task
            The task of the stream; a task cleared or without events ended its stream in order.
        registration
            Which of the task's registrations the stream was; another has taken its place in order.
        """
        with self._changed:
            current = task.event_samples and task.registrations == registration
            if task in self.tasks and current:
                for orphan in self.tasks.all():
                    if orphan.client == task.client:
                        self.clear(orphan)

    def acquired(self, task: Task) -> int:
        """Return how many samples a task has taken since it was started.

        Parameters
        ----------
        task
            The task.
        """
        with self._changed:
            return self._clock.due() - task.start

    def available(self, task: Task) -> int:
        """Return how many samples a task could read at once.

        Parameters
        ----------
        task
            The task.
        """
        with self._changed:
            return self._clock.due() - task.position

    def read(self, task: Task, n_samples: int, timeout_s: float) -> Values:
        """Wait for samples and return their values, shape (n_samples,).

        Parameters
        ----------
        task
            The task.
        n_samples
            How many.
        timeout_s
            Longest wait, negative for one without end.

        Raises
        ------
        hil_sim.ni_server.errors.NiError
            They do not come in time, the buffer overflowed, or the task does not run.
        hil_sim.ni_server.errors.ServerDeadError
            The server stops answering, by a fault on demand.
        """
        deadline_s = time.monotonic() + (timeout_s if timeout_s >= 0 else math.inf)
        with self._changed:
            while (wait_s := self._readable_in_s(task, n_samples)) > 0:
                remaining_s = deadline_s - time.monotonic()
                if remaining_s <= 0:
                    raise NiError(
                        NiCode.SAMPLES_NOT_YET_AVAILABLE,
                        "Some or all of the samples requested have not yet been acquired",
                        samples_read=0,
                    )
                self._changed.wait(min(wait_s, remaining_s, _LONGEST_WAIT_S))
            return self._read_now(task, n_samples)

    def _readable_in_s(self, task: Task, n_samples: int) -> float:
        self.check_alive()
        if not task.running:
            raise NiError(NiCode.TASK_NOT_RUNNING, f"Task {task.name} is not running")
        return self._clock.wait_s(task.position + n_samples)

    def _read_now(self, task: Task, n_samples: int) -> Values:
        if task.overwrite:
            task.position = max(task.position, self._clock.oldest)
        overflow = self._clock.taken - task.position > task.buffer_samples and not task.overwrite
        end = task.position + n_samples
        self._clock.take(end)
        self._check_alive_at(end)
        if overflow or self._has(FaultKind.DAQ_OVERFLOW, end):
            raise NiError(
                NiCode.SAMPLES_NO_LONGER_AVAILABLE,
                "The samples requested were overwritten before they were read",
                samples_read=0,
            )
        values = task.require_channel().values(self._clock.samples(task.position, end))
        task.position = end
        self._forget()
        if self._event_in_s(task) <= 0:
            self._changed.notify_all()
        return values

    def _forget(self) -> None:
        taken = self._clock.taken
        needed = (task.needed_from(taken) for task in self.tasks.all())
        self._clock.forget(min(needed, default=taken))

    def next_event(self, task: Task, gone: threading.Event) -> bool:
        """Wait until a task's next block is ready; False where its event stream is over.

        Parameters
        ----------
        task
            The task.
        gone
            Set when the client is gone; `wake` makes it seen.

        Raises
        ------
        hil_sim.ni_server.errors.ServerDeadError
            The server stops answering, by a fault on demand.
        """
        with self._changed:
            while task in self.tasks and task.event_samples and not gone.is_set():
                self.check_alive()
                wait_s = self._event_in_s(task)
                if wait_s <= 0:
                    return self._send_event(task)
                self._changed.wait(min(wait_s, _LONGEST_WAIT_S))
            return False

    def _event_in_s(self, task: Task) -> float:
        if not (task.event_samples and task.running and self._clock.running):
            return math.inf
        if self._lock_step:
            batches_read = task.events_before(task.position) // _EVENTS_AT_ONCE
            return 0.0 if task.events < (batches_read + 2) * _EVENTS_AT_ONCE else math.inf
        return self._clock.wait_s(task.events_end + task.event_samples)

    def _send_event(self, task: Task) -> bool:
        """Count an event that is due; False where it is not sent, for the stream is dead."""
        task.events += 1
        if not self._lock_step:
            self._clock.take(task.events_end)
            self._forget()
        return not self._has(FaultKind.EVENT_STREAM_DEAD, task.events_end)

    def wake(self, gone: threading.Event) -> None:
        """Tell the event stream of a client that it is gone.

        Parameters
        ----------
        gone
            What to set.
        """
        gone.set()
        with self._changed:
            self._changed.notify_all()
