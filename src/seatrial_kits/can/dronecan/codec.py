"""DroneCAN's messages and services as payloads of transfers, and transfers as CAN frames.

Types, their encoding, tail bytes and checksums are those of the `dronecan` package. Its nodes are
not used: they count wall time, and their state cannot be copied.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import dronecan
from dronecan.transport import Frame as PackageFrame
from dronecan.transport import Transfer, TransferError

from ..frame import Frame

protocol: Any = dronecan.uavcan.protocol
equipment: Any = dronecan.uavcan.equipment

MOST_FRAMES = 64
"""Frames of the longest transfer that a node takes in: the longest here has 56."""


def frames(transfer: Transfer) -> list[Frame]:
    """Return a transfer as CAN frames."""
    return [Frame(each.message_id, bytes(each.bytes), True) for each in transfer.to_frames()]


def transfer_of(identifier: int, datas: Sequence[bytes]) -> Transfer | None:
    """Return the transfer that frames with this identifier carry, None if it is malformed.

    Malformed: a wrong checksum or order of toggle bits, an unknown type, too little data.
    """
    found = Transfer()
    try:
        found.from_frames([PackageFrame(identifier, data) for data in datas])
    except (TransferError, ValueError, IndexError):
        return None
    return found
