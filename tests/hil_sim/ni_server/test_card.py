"""The card: whose tasks it forgets when an event stream breaks off."""

from collections.abc import Iterator

import pytest

from hil_sim.faults import FaultSchedule
from hil_sim.ni_server.card import Card
from tests.conftest import TurningEncoder


@pytest.fixture
def card() -> Iterator[Card]:
    made = Card(TurningEncoder(), lock_step=True, faults=FaultSchedule(()))
    yield made
    made.close()


def test_a_stream_that_breaks_off_takes_its_clients_tasks_along(card: Card) -> None:
    task, other, stranger = (card.tasks.create("", client) for client in ("a", "a", "b"))
    task.event_samples, task.registrations = 100, 1
    card.client_gone(task, 1)
    assert [t in card.tasks for t in (task, other, stranger)] == [False, False, True]


def test_a_stream_that_another_has_replaced_takes_nothing_along(card: Card) -> None:
    task = card.tasks.create("", "a")
    task.event_samples, task.registrations = 100, 2
    card.client_gone(task, 1)
    assert task in card.tasks
