"""Frames as python-can has them."""

from __future__ import annotations

import can

from .frame import Frame
from .operations import Error

_PROTOCOL, _MISSED_ACK, _BUS_ERROR = 0x08, 0x20, 0x80
_DETAILS = {  # kind of protocol violation (byte 2), place (byte 3)
    Error.BIT: (0x01, 0x00),
    Error.STUFF: (0x04, 0x00),
    Error.FORM: (0x02, 0x00),
    Error.CRC: (0x00, 0x08),
    Error.ACK: (0x00, 0x19),
    Error.BROKEN_ERROR_FRAME: (0x00, 0x00),
}


def message(frame: Frame, time_s: float, channel: str | None = None) -> can.Message:
    """Return a frame as a message that was received at ``time_s``."""
    return can.Message(
        timestamp=time_s,
        arbitration_id=frame.identifier,
        is_extended_id=frame.extended,
        is_remote_frame=frame.remote,
        dlc=frame.requested if frame.remote else len(frame.data),
        data=frame.data,
        is_fd=frame.fd,
        bitrate_switch=frame.bit_rate_switch,
        error_state_indicator=frame.error_state,
        channel=channel,
    )


def error_class(error: Error) -> int:
    """Return the class of an error, as Linux writes it (linux/can/error.h)."""
    return _BUS_ERROR | (_MISSED_ACK if error is Error.ACK else _PROTOCOL)


def error_message(error: Error, time_s: float, channel: str | None = None) -> can.Message:
    """Return an error frame: its class as identifier, kind and place in bytes 2 and 3 of 8."""
    kind, place = _DETAILS[error]
    return can.Message(
        timestamp=time_s,
        arbitration_id=error_class(error),
        is_extended_id=False,
        is_error_frame=True,
        dlc=8,
        data=bytes((0, 0, kind, place, 0, 0, 0, 0)),
        channel=channel,
    )


def frame_of(found: can.Message) -> Frame | None:
    """Return the frame of a message, None for an error frame.

    Raises InputError for a message that is no frame of ISO 11898-1.
    """
    if found.is_error_frame:
        return None
    return Frame(
        found.arbitration_id,
        b"" if found.is_remote_frame else bytes(found.data),
        found.is_extended_id,
        found.is_remote_frame,
        found.is_fd,
        found.bitrate_switch,
        found.error_state_indicator,
        found.dlc if found.is_remote_frame else 0,
    )
