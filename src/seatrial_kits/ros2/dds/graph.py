"""Nodes by name: ROS 2 announces them beside DDS, which knows participants alone."""

from __future__ import annotations

from functools import cache

from ..messages.definitions import type_store
from ..messages.packing import packed
from .participant import Participant

KIND = "rmw_dds_common/msg/ParticipantEntitiesInfo"
_GID = "rmw_dds_common/msg/Gid"


class Graph:
    """Announces one node, which has all readers and writers of its participant.

    ``name`` is the node's name in full, ``/seatrial``. The topic is ``ros_discovery_info``, without
    the prefix of topics of nodes, as rmw_dds_common has it.
    """

    def __init__(self, participant: Participant, name: str) -> None:
        self._participant = participant
        self._namespace, _, self._name = name.rpartition("/")
        self._writer = participant.writer("ros_discovery_info", KIND, "latched", prefix="")
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
    return {"data": identity.ljust(_gid_length(), b"\0")}


@cache
def _gid_length() -> int:
    """Return the bytes of an identifier, of which DDS has the first 16: up to Humble 24."""
    ((_, (_, (_, length))),) = type_store().fielddefs[_GID][1]
    return int(length)
