"""XML of other people, read without what an XML file can make a reader do."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from lxml import etree

from ...errors import InputError

LARGEST_XML = 64 * 2**20
"""Bytes of the largest XML file that is held whole."""
LARGEST_STREAMED = 512 * 2**20
"""Bytes of the largest one that is read element by element: more than a million variables."""
MOST_ELEMENTS = 1_000_000
"""Elements of such a file that stay, units and types say: some 200 bytes each and more."""
LONGEST_NAME = 32_768
"""Characters of an attribute ``name``: what writes tables, pages and messages of them has time by
the square of that."""
_LONG_NAMES = etree.XPath(f"//@name[string-length() > {LONGEST_NAME}]")
_BLOCK = 2**20

Undeclared = Callable[[str, int], str | None]
"""Says which namespace a prefix without declaration, met in a line, stands for; None: none."""


def read_xml(path: Path, called: str, undeclared: Undeclared | None = None) -> Any:
    """Return the root element of the XML file ``path``, called ``called`` in messages.

    Raises InputError for a file that is not there, is larger than `LARGEST_XML`, is not XML, has
    a prefix that is neither declared nor known to ``undeclared``, a name of more than
    `LONGEST_NAME`, or has a document type: what that defines (entities, other files) has no place
    in FMI or SSP.
    """
    _refuse_large(path, called, LARGEST_XML)
    parser = _parser()
    try:
        tree = etree.parse(str(path), parser)
    except etree.XMLSyntaxError as error:
        tree = _declared(path, undeclared) if _lacks_declarations(parser) and undeclared else None
        if tree is None:
            raise InputError(f"{called}: not XML: {error}") from None
    except (OSError, LookupError, ValueError):  # for bytes that are none of its encoding
        raise InputError(f"{called}: not XML: it cannot be decoded") from None
    _refuse_doctype(tree, called)
    _refuse_names(_LONG_NAMES(tree), called)
    return tree.getroot()


def streamed_xml(
    path: Path, called: str, tags: Sequence[str], chosen: Callable[[Any], bool]
) -> Iterator[Any]:
    """Yield the elements that have one of ``tags`` and are ``chosen``, at last the root.

    The elements are taken out of the tree, each when the next one comes: the root has all the
    rest, of at most `MOST_ELEMENTS`. Raises InputError as `read_xml`, but for a file that is
    larger than `LARGEST_STREAMED`.
    """
    _refuse_large(path, called, LARGEST_STREAMED)
    parser = etree.XMLPullParser(events=("end",), tag=tags, **_SAFE)
    root: Any = None
    last: Any = None
    try:
        for fed in _fed(path, parser):
            for _, element in parser.read_events():
                if not chosen(element):
                    continue
                if len(name := element.get("name", "")) > LONGEST_NAME:
                    _refuse_names([name], called)
                if root is None:
                    root = element.getroottree().getroot()
                    _refuse_doctype(root.getroottree(), called)
                else:
                    last.getparent().remove(last)
                yield element
                last = element
            if root is not None and root.xpath("count(//*)") > MOST_ELEMENTS:
                raise InputError(f"{called}: more than {MOST_ELEMENTS} elements besides variables")
            if root is None and fed > LARGEST_XML:
                raise InputError(f"{called}: no variable in its first {LARGEST_XML} bytes")
        whole = parser.close()
    except etree.XMLSyntaxError as error:
        raise InputError(f"{called}: not XML: {error}") from None
    except (OSError, LookupError, ValueError):  # for bytes that are none of its encoding
        raise InputError(f"{called}: not XML: it cannot be decoded") from None
    if last is not None:
        last.getparent().remove(last)
    _refuse_doctype(whole.getroottree(), called)
    _refuse_names(_LONG_NAMES(whole), called)
    yield whole


def _fed(path: Path, parser: Any) -> Iterator[int]:
    """Feed a parser with a file; yield after each of its blocks how many bytes there were."""
    with path.open("rb") as file:
        while block := file.read(_BLOCK):
            parser.feed(block)
            yield file.tell()


_SAFE: Any = {
    "resolve_entities": False,
    "no_network": True,
    "load_dtd": False,
    "remove_comments": True,
}


def _parser(*, recover: bool = False) -> etree.XMLParser:
    return etree.XMLParser(**_SAFE, recover=recover)


def _refuse_large(path: Path, called: str, most: int) -> None:
    try:
        size = path.stat().st_size
    except OSError as error:
        raise InputError(f"{called}: {error.strerror}") from None
    if size > most:
        raise InputError(f"{called}: has {size} bytes, more than {most}")


def _refuse_doctype(tree: Any, called: str) -> None:
    if tree.docinfo.doctype:
        raise InputError(f"{called}: has a document type (DOCTYPE), which is not allowed")


def _refuse_names(long: Sequence[str], called: str) -> None:
    if long:
        raise InputError(
            f"{called}: a name of {len(long[0])} characters ({long[0][:20]}...), at most "
            f"{LONGEST_NAME} are read"
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
