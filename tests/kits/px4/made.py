"""A component that tests step themselves, and firmware that answers it in a thread."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from seatrial_kits.px4.component import Px4

from .peer import Peer

SERVOS = "1 port 1100 1500 1900; 3 starboard 1100 1520 1900"
SETTINGS = {
    "link": "tcpin:127.0.0.1:0",
    "actuators": SERVOS,
    "speedup": 1000.0,
    "date": "2026-02-05T12:00:00Z",
}
QUIET = dict.fromkeys(
    ("gyro_noise", "accelerometer_noise", "field_noise", "pressure_noise", "velocity_noise"), 0.0
) | {"position_noise": (0.0, 0.0, 0.0)}


@contextmanager
def component(**values: object) -> Iterator[Px4]:
    """A component that has begun."""
    made = Px4("autopilot")
    try:
        for name, value in {**SETTINGS, **values}.items():
            made.set(name, value)
        made.setup(0.0)
        made.initialise()
        made.begin()
        yield made
    finally:
        made.close()


def port_of(made: Px4) -> int:
    return int(str(made.get("reached_at")).rpartition(":")[2])


@contextmanager
def firmware(made: Px4, does: Callable[[Peer], None]) -> Iterator[Peer]:
    """A peer that does something in a thread; what it raises is raised here."""
    peer, raised = Peer(port_of(made)), []

    def run() -> None:
        try:
            does(peer)
        except BaseException as error:
            raised.append(error)

    thread = threading.Thread(target=run)
    thread.start()
    try:
        yield peer
    finally:
        thread.join(20.0)
        peer.close()
    if raised:
        raise raised[0]
    assert not thread.is_alive()
