"""XML of other people, read without what an XML file can make a reader do."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from lxml import etree

from ..errors import InputError

LARGEST_XML = 64 * 2**20
"""Bytes of the largest XML file that is read."""


Undeclared = Callable[[str, int], str | None]
"""Says which namespace a prefix without declaration, met in a line, stands for; None: none."""


def read_xml(path: Path, called: str, undeclared: Undeclared | None = None) -> Any:
    """Return the root element of the XML file ``path``, called ``called`` in messages.

    Raises InputError for a file that is not there, is larger than `LARGEST_XML`, is not XML, has
    a prefix that is neither declared nor known to ``undeclared``, or has a document type: what
    that defines (entities, other files) has no place in FMI or SSP.
    """
    try:
        size = path.stat().st_size
    except OSError as error:
        raise InputError(f"{called}: {error.strerror}") from None
    if size > LARGEST_XML:
        raise InputError(f"{called}: has {size} bytes, more than {LARGEST_XML}")
    parser = _parser()
    try:
        tree = etree.parse(str(path), parser)
    except etree.XMLSyntaxError as error:
        tree = _declared(path, undeclared) if _lacks_declarations(parser) and undeclared else None
        if tree is None:
            raise InputError(f"{called}: not XML: {error}") from None
    except (OSError, LookupError, ValueError):  # for bytes that are none of its encoding
        raise InputError(f"{called}: not XML: it cannot be decoded") from None
    if tree.docinfo.doctype:
        raise InputError(f"{called}: has a document type (DOCTYPE), which is not allowed")
    return tree.getroot()


def _parser(*, recover: bool = False) -> etree.XMLParser:
    return etree.XMLParser(
        resolve_entities=False,
        no_network=True,
        load_dtd=False,
        remove_comments=True,
        recover=recover,
    )


def _lacks_declarations(parser: etree.XMLParser) -> bool:
    """Say if prefixes without declaration are all that is wrong."""
    missing = etree.ErrorTypes.NS_ERR_UNDEFINED_NAMESPACE
    return all(error.type == missing for error in parser.error_log)


def _declared(path: Path, undeclared: Undeclared) -> Any:
    """Return a tree whose prefixes are declared now; None if one stands for nothing known.

    A parser that recovers leaves them in the names.
    """
    tree = etree.parse(str(path), _parser(recover=True))
    for element in tree.iter(etree.Element):
        for name in (element.tag, *element.attrib):
            prefix, colon, local = name.partition(":")
            if not colon or name.startswith("{"):
                continue
            namespace = undeclared(prefix, element.sourceline)
            if namespace is None:
                return None
            full = f"{{{namespace}}}{local}"
            if name == element.tag:
                element.tag = full
            else:
                element.set(full, element.attrib.pop(name))
    return tree
