"""XML of other people, read without what an XML file can make a reader do."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from lxml import etree

from ..errors import InputError

LARGEST_XML = 64 * 2**20
"""Bytes of the largest XML file that is read."""


def read_xml(path: Path, called: str) -> Any:
    """Return the root element of the XML file ``path``, called ``called`` in messages.

    Raises InputError for a file that is not there, is larger than `LARGEST_XML`, is not XML or
    has a document type: what that defines (entities, other files) has no place in FMI or SSP.
    """
    try:
        size = path.stat().st_size
    except OSError as error:
        raise InputError(f"{called}: {error.strerror}") from None
    if size > LARGEST_XML:
        raise InputError(f"{called}: has {size} bytes, more than {LARGEST_XML}")
    parser = etree.XMLParser(
        resolve_entities=False, no_network=True, load_dtd=False, remove_comments=True
    )
    try:
        tree = etree.parse(str(path), parser)
    except etree.XMLSyntaxError as error:
        raise InputError(f"{called}: not XML: {error}") from None
    except (OSError, LookupError, ValueError):  # for bytes that are none of its encoding
        raise InputError(f"{called}: not XML: it cannot be decoded") from None
    if tree.docinfo.doctype:
        raise InputError(f"{called}: has a document type (DOCTYPE), which is not allowed")
    return tree.getroot()
