"""The tasks of the card: configured, started, read, each at its own place in the samples."""

from dataclasses import dataclass, field

from hil_sim.ni_server.channels import Channel
from hil_sim.ni_server.errors import NiCode, NiError


@dataclass(slots=True)
class Task:
    """One NI-DAQmx task.

    Parameters
    ----------
    name
        Its name, which is also its session's.
    client
        Address of the client that made it.
    channel
        Its channel, once created.
    clock_source
        Terminal of its sample clock; "" is the task's own.
    rate_hz
        Rate of its sample clock.
    buffer_samples
        Samples that its buffer holds.
    overwrite
        Whether unread samples may be overwritten.
    running
        Whether it was started.
    start
        Number of its first sample on the clock.
    position
        Number of the next sample that it reads.
    event_samples
        Samples between two events, or 0 without events.
    registrations
        How often events were asked for: each time a stream of its own sends them.
    events
        Events sent since the start.
    """

    name: str
    client: str
    channel: Channel | None = None
    clock_source: str = ""
    rate_hz: float = 1000.0
    buffer_samples: int = 0
    overwrite: bool = False
    running: bool = False
    start: int = 0
    position: int = 0
    event_samples: int = 0
    registrations: int = 0
    events: int = 0

    @property
    def makes_clock(self) -> bool:
        """Whether the sample clock ticks because this task runs.

        The analogue input's clock waits for its task; a clock from outside ticks all the time.
        """
        return self.running and not self.clock_source.endswith("/ai/SampleClock")

    @property
    def events_end(self) -> int:
        """Number of the sample after the last block that an event told of."""
        return self.start + self.events * self.event_samples

    def events_before(self, sample: int) -> int:
        """Return how many events tell of blocks that end at or before a sample.

        Parameters
        ----------
        sample
            Number of the sample after the last of those blocks.
        """
        return (sample - self.start) // self.event_samples

    def require_channel(self) -> Channel:
        """Return the channel.

        Raises
        ------
        hil_sim.ni_server.errors.NiError
            There is none yet.
        """
        if self.channel is None:
            raise NiError(NiCode.NO_CHANNEL_IN_TASK, f"There are no channels in task {self.name}")
        return self.channel

    def arm(self, sample: int) -> None:
        """Begin at a sample of the clock.

        Parameters
        ----------
        sample
            Number of the first sample.
        """
        self.running = True
        self.start = self.position = sample
        self.events = 0

    def needed_from(self, taken: int) -> int:
        """Return the first sample that this task still keeps in its buffer.

        Parameters
        ----------
        taken
            Number of samples that the clock has taken.
        """
        if not self.running or self.overwrite:
            return taken
        return max(self.position, taken - self.buffer_samples)


@dataclass(slots=True)
class TaskTable:
    """The tasks of all clients, by name."""

    _tasks: dict[str, Task] = field(default_factory=dict)
    _made: int = 0

    def create(self, name: str, client: str) -> Task:
        """Make a task.

        Parameters
        ----------
        name
            Its name, or "" for one of the table's choosing.
        client
            Address of the client.

        Raises
        ------
        hil_sim.ni_server.errors.NiError
            The name is taken.
        """
        self._made += 1
        name = name or f"_unnamedTask<{self._made}>"
        if name in self._tasks:
            raise NiError(NiCode.RESOURCE_RESERVED, f"The task {name} exists already")
        task = self._tasks[name] = Task(name, client)
        return task

    def get(self, name: str) -> Task:
        """Return a task.

        Parameters
        ----------
        name
            Its name.

        Raises
        ------
        hil_sim.ni_server.errors.NiError
            There is none of this name.
        """
        if name not in self._tasks:
            raise NiError(NiCode.INVALID_TASK, f"Task does not exist: {name}")
        return self._tasks[name]

    def remove(self, task: Task) -> None:
        """Forget a task.

        Parameters
        ----------
        task
            The task, which may be forgotten already.
        """
        self._tasks.pop(task.name, None)

    def all(self) -> list[Task]:
        """Return all tasks."""
        return list(self._tasks.values())

    def __contains__(self, task: Task) -> bool:
        return self._tasks.get(task.name) is task
