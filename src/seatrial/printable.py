"""Text of others as a terminal may show it."""

from __future__ import annotations

import logging
import re

# C0 without tab and line feed, delete, C1; marks and separators that reorder or break a line;
# halves of surrogate pairs, which no stream can write.
_UNPRINTABLE = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]"
)


def printable(text: str) -> str:
    r"""Return ``text`` with what would act on a terminal written as Python escapes it.

    >>> printable("\x1b[2Jgone\r")
    '\\x1b[2Jgone\\r'
    """
    return _UNPRINTABLE.sub(lambda found: found[0].encode("unicode_escape").decode(), text)


class PrintableFormatter(logging.Formatter):
    """Log messages, those of FMUs too, as a terminal may show them."""

    def format(self, record: logging.LogRecord) -> str:
        """Return a record's text."""
        return printable(super().format(record))
