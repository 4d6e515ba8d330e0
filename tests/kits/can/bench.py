"""A simulated bus of 1 Mbit/s, whose bits last a microsecond, and what happened on it."""

from collections.abc import Callable

from seatrial_kits.can.controller import Controller
from seatrial_kits.can.frame import Frame
from seatrial_kits.can.simulated_bus import Broken, GivenUp, Sent, SimulatedBus

US = 10**6
"""Picoseconds in a microsecond."""


class Bench:
    """Nodes ``a``, ``b``, ...; times are in us, which are bits."""

    def __init__(
        self,
        nodes: int,
        *,
        queue: int = 100,
        mailboxes: int = 3,
        error_injector: Callable = lambda *_: None,
        rate: int = 1_000_000,
        **options: object,
    ) -> None:
        self.nodes = [
            Controller(name, queue, mailboxes, **options) for name in "abcdefghijkl"[:nodes]
        ]
        self.sent: list[Sent] = []
        self.broken: list[Broken] = []
        self.given_up: list[GivenUp] = []
        self.bus = SimulatedBus(
            self.nodes,
            rate,
            2_000_000,
            error_injector,
            self.sent.append,
            self.broken.append,
            self.given_up.append,
        )

    def request(self, when_us: float, node: int, frame: Frame) -> None:
        self.bus.request(round(when_us * US), node, frame)

    def run(self, until_us: float) -> None:
        self.bus.run(round(until_us * US))

    @property
    def times(self) -> list[tuple[float, float, int]]:
        """(start, end, identifier) of each frame."""
        return [(s.start_ps / US, s.end_ps / US, s.frame.identifier) for s in self.sent]

    @property
    def failed_at(self) -> list[float]:
        """Ends of error frames."""
        return [broken.end_ps / US for broken in self.broken]
