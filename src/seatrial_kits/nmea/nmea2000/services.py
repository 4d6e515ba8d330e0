"""Mandatory services of an NMEA 2000 node: identity, PGN lists, heartbeat."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from .address_claim import Identity
from .catalogue import NETWORK, RECEIVED
from .codec import GLOBAL, Message

HEARTBEAT_S = 60.0
_MOST_HEARTBEATS = 253
"""Its counter runs from 0 to 252."""
_NACK = 1
_TRANSMIT, _RECEIVE = 0, 1


def answer(
    request: Message,
    identity: Identity,
    sends: Sequence[int],
    beats: int,
    now: Callable[[int], list[Message]],
) -> list[Message]:
    """Return the answers to an ISO request (59904); their source is for the caller to set.

    Product and configuration information and PGN lists go out as they are, a PGN that the node
    sends with its values of ``now``. What it does not have is refused (ISO acknowledgement, NACK,
    to all, as ISO 11783-3 says) unless the request was to all. Claims are `AddressClaim`'s.
    """
    wanted, everybody = request.fields.get("pgn"), request.destination == GLOBAL
    if wanted is None or wanted == 60928:
        return []
    if wanted == 126996:
        return [Message(126996, identity.product())]
    if wanted == 126998:
        return [Message(126998, identity.configuration())]
    if wanted == 126464:
        to = request.source
        return [
            _listed(_TRANSMIT, to, [*NETWORK, *sends]),
            _listed(_RECEIVE, to, [59392, 59904, 60928, 126208, *RECEIVED]),
        ]
    if wanted == 126993:
        return [heartbeat(beats)]
    if wanted in sends:
        return now(int(wanted))
    if everybody:
        return []
    return [Message(59392, {"control": _NACK, "groupFunction": GLOBAL, "pgn": wanted})]


def heartbeat(number: int) -> Message:
    """Return the heartbeat (126993) of a number."""
    return Message(
        126993,
        {
            "dataTransmitOffset": HEARTBEAT_S,
            "sequenceCounter": number % _MOST_HEARTBEATS,
            "controller1State": 0,
            "equipmentStatus": 0,
        },
    )


def _listed(which: int, to: int, numbers: Sequence[int]) -> Message:
    items = tuple({"pgn": number} for number in sorted(numbers))
    return Message(126464, {"functionCode": which}, destination=to, items=items)
