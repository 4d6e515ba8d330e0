"""Nodes by name: ROS 2 announces them beside DDS, which knows participants alone."""

from __future__ import annotations

from .packing import packed
from .participant import Participant, Writer

KIND = "rmw_dds_common/msg/ParticipantEntitiesInfo"
_GID = 24
"""Bytes of an identifier in Humble, of which DDS has the first 16."""


class Graph:
    """Announces one node, which has all readers and writers of its participant.

    ``name`` is the node's name in full, ``/seatrial``. The topic is ``ros_discovery_info``, without
    the prefix of topics of nodes, as rmw_dds_common of Humble has it.
    """

    def __init__(self, participant: Participant, name: str) -> None:
        self._participant = participant
        self._namespace, _, self._name = name.rpartition("/")
        self._writer = Writer(participant, "ros_discovery_info", KIND, "latched", prefix="")
        self._told = 0

    def tell(self) -> None:
        """Announce the node anew, if readers or writers have come since."""
        readers, writers = self._participant.readers, self._participant.writers
        if self._told == len(readers) + len(writers):
            return
        self._told = len(readers) + len(writers)
        node = {
            "node_namespace": self._namespace or "/",
            "node_name": self._name,
            "reader_gid_seq": [_gid(each) for each in readers],
            "writer_gid_seq": [_gid(each) for each in writers],
        }
        fields = {"gid": _gid(self._participant.identity), "node_entities_info_seq": [node]}
        self._writer.write(packed(KIND, fields))


def _gid(identity: bytes) -> dict[str, bytes]:
    return {"data": identity.ljust(_GID, b"\0")}
