"""DDS as a transport: the participant, its services, and the node that it is announced as."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ..transport import Endpoint, Handler
from .announced import Announced
from .graph import Graph
from .participant import Participant
from .services import DdsService


class DdsTransport(Participant):
    """A participant announced as the ``node``, a name in full; a `Transport`."""

    title = "cyclonedds"

    def __init__(self, domain: int, node: str) -> None:
        super().__init__(domain)
        self._graph = Graph(self, node)
        self._announced = Announced(self.dds)

    def lacks(self, kind: str) -> str:
        """Return nothing: all definitions are here."""
        return ""

    def service(self, name: str, kind: str, handler: Handler) -> DdsService:
        """Return a service, answered as rmw_cyclonedds does."""
        return DdsService(self, name, kind, handler)

    def announce(self) -> None:
        """Announce the node anew, if readers or writers have come since."""
        self._graph.tell()

    def endpoints(
        self, read: Iterable[str], written: Iterable[str]
    ) -> tuple[Iterator[Endpoint], Iterator[Endpoint]]:
        """Return all publishers and subscribers of the domain that were announced since."""
        ours = self.of_this_process
        return self._announced.publishers(ours), self._announced.subscribers(ours)
