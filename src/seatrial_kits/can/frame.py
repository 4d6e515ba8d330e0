"""A CAN frame."""

from __future__ import annotations

from dataclasses import dataclass

from seatrial.errors import InputError

FD_LENGTHS = (*range(9), 12, 16, 20, 24, 32, 48, 64)
"""Lengths of data that CAN FD has, in bytes, by DLC."""

LARGEST_BASE, LARGEST_EXTENDED = (1 << 11) - 1, (1 << 29) - 1


@dataclass(frozen=True, slots=True)
class Frame:
    """A data or remote frame of classic CAN, or of CAN FD (ISO 11898-1).

    Raises InputError for an identifier, a length or a mixture that there is not.
    """

    identifier: int
    data: bytes = b""
    extended: bool = False
    """29 bits of identifier instead of 11."""
    remote: bool = False
    """A request for data: it has none, and ``dlc`` is how much is wanted."""
    fd: bool = False
    bit_rate_switch: bool = False
    """FD: the data phase has a rate of its own."""
    error_state: bool = False
    """FD: the sender is error passive."""
    requested: int = 0
    """Remote: length of the data wanted, bytes."""

    def __post_init__(self) -> None:
        largest = LARGEST_EXTENDED if self.extended else LARGEST_BASE
        if not 0 <= self.identifier <= largest:
            raise InputError(f"identifier 0x{self.identifier:X}, allowed 0 to 0x{largest:X}")
        length = len(self.data)
        if self.fd:
            if length not in FD_LENGTHS:
                raise InputError(f"{length} bytes in a CAN FD frame, allowed {FD_LENGTHS}")
            if self.remote:
                raise InputError("CAN FD has no remote frames")
        else:
            if length > 8:
                raise InputError(f"{length} bytes in a CAN frame, allowed 0 to 8")
            if self.bit_rate_switch or self.error_state:
                raise InputError("only CAN FD frames switch the bit rate or show an error state")
        if self.remote and length:
            raise InputError("a remote frame has no data")
        if self.requested and not (self.remote and 0 < self.requested <= 8):
            raise InputError("only a remote frame requests data, up to 8 bytes")

    @property
    def dlc(self) -> int:
        """Data length code."""
        if self.remote:
            return self.requested
        return FD_LENGTHS.index(len(self.data))

    @property
    def priority(self) -> int:
        """Bits that arbitration compares, one by one: the lower value wins.

        The arbitration field: 11 bits of identifier, RTR or SRR, IDE, and in extended frames 18
        bits and RTR. A base frame wins against an extended one with the same first 11 bits, a
        data frame against a remote one.
        """
        remote = int(self.remote)
        if self.extended:
            base, rest = self.identifier >> 18, self.identifier & 0x3FFFF
            return base << 21 | 0b11 << 19 | rest << 1 | remote
        return self.identifier << 21 | remote << 20
