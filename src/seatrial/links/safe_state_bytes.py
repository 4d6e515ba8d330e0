"""Safe-state bytes of a serial port: what stops the vehicle behind it."""

from __future__ import annotations

from ..errors import InputError
from .endpoints.url import reaches_device

UNSET = "unset"
"""Value of a parameter that nobody has written; none at all is written as the empty text."""


def safe_state_bytes(text: str) -> bytes:
    """Return the bytes of hexadecimal numbers. Raises InputError for another text."""
    try:
        return b"" if text == UNSET else bytes.fromhex(text)
    except ValueError:
        raise InputError(f"safe_state: {text!r} is not bytes such as 'FAAF 0100'") from None


def check_safe_state(text: str) -> None:
    """Raise InputError for a text that is not bytes as hexadecimal numbers."""
    safe_state_bytes(text)


def require_safe_state(text: str, urls: str) -> None:
    """Raise InputError if one of ``urls`` reaches a device and nobody has written a safe state."""
    for url in urls.split() if text == UNSET else ():
        if reaches_device(url):
            raise InputError(
                f"safe_state is not set, and {url!r} reaches a device: write the bytes that stop "
                "it, or safe_state = '' if there are none"
            )
