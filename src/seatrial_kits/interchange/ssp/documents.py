"""The XML files of SSP: read with care, by the standard's schema, every error with its line."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from difflib import get_close_matches
from functools import cache, partial
from pathlib import Path
from typing import Any, overload

import fmpy
from lxml import etree

from seatrial.errors import InputError
from seatrial.fmi.files.xmlfile import read_xml

from .notes import Notes

_STANDARD = "http://ssp-standard.org/SSP1/SystemStructure"
NAMESPACES = {
    "ssd": f"{_STANDARD}Description",
    "ssc": f"{_STANDARD}Common",
    "ssv": f"{_STANDARD}ParameterValues",
    "ssm": f"{_STANDARD}ParameterMapping",
    "ssb": f"{_STANDARD}SignalDictionary",
    "osp": "http://opensimulationplatform.com/SSP/OSPAnnotations",
    "oms": "https://raw.githubusercontent.com/OpenModelica/OMSimulator/master/schema/oms.xsd",
}
"""Prefixes as other tools expect them literally; SSP 2.0 has the namespaces of 1.0."""

SCHEMAS = {
    "ssd:SystemStructureDescription": "SystemStructureDescription.xsd",
    "ssv:ParameterSet": "SystemStructureParameterValues.xsd",
    "ssm:ParameterMapping": "SystemStructureParameterMapping.xsd",
    "ssb:SignalDictionary": "SystemStructureSignalDictionary.xsd",
}
"""Root elements that are read, and the schemas of version 1.0."""

_SCHEMA_FOLDER = Path(fmpy.__file__).parent / "ssp" / "schema"
_PREFIXES = {uri: prefix for prefix, uri in NAMESPACES.items()}
_ABOUT = {"ssc:MetaData", "ssc:Signature"}
"""What says something about any element."""
_OF_XML = ("{http://www.w3.org/2001/XMLSchema-instance}", "{http://www.w3.org/XML/")
"""Attributes that any XML file may have: where its schema is, its language."""
_META = {
    "id", "description", "author", "fileversion", "copyright", "license", "generationTool",
    "generationDateAndTime",
}  # fmt: skip


def read_document(path: Path, label: str, root: str, notes: Notes) -> Any:
    """Return the root element of the XML file at ``path``, which must be a ``root``.

    ``label`` names the file in messages. Raises InputError for what is no XML, has a document
    type (and so could have entities), or is of another kind or version.
    """
    element = read_xml(path, label, partial(_usual, label, notes))
    element.getroottree().docinfo.URL = label
    return checked(element, root, notes)


def _usual(label: str, notes: Notes, prefix: str, line: int) -> str | None:
    """Return the namespace that tools which ignore declarations take a prefix for."""
    if prefix in NAMESPACES:
        text = f"prefix {prefix!r} is not declared; it is taken for {NAMESPACES[prefix]}"
        notes.pass_over(f"{label}: line {line}", text)
    return NAMESPACES.get(prefix)


def checked(element: Any, root: str, notes: Notes) -> Any:
    """Return ``element`` if it is a ``root`` of a version that is read. Raises InputError.

    What does not fit the schema of version 1 is noted: what matters of it, the readers refuse.
    There is no schema of version 2 here.
    """
    if tag(element) != root:
        raise InputError(f"{where(element)}: {root} is needed, found {tag(element)}")
    version = needed(element, "version")
    if not version.startswith(("1.", "2.")):
        raise InputError(f"{where(element)}: SSP version {version!r}; 1.0 and 2.0 are read")
    problems = schema_problems(element, root)
    if problems:
        more = f" (and {len(problems) - 1} more)" if len(problems) > 1 else ""
        place, _, text = problems[0].partition(": Element ")
        notes.pass_over(place, f"does not fit the schema of SSP 1.0: Element {text}{more}")
    return element


def schema_problems(element: Any, root: str) -> list[str]:
    """Return where and how ``element``, a ``root`` of version 1, does not fit its schema."""
    schema = _schema(SCHEMAS[root])
    if not str(element.get("version")).startswith("1.") or schema.validate(element):
        return []
    return [
        f"{base(element)}: line {p.line}: {_with_prefixes(p.message)}" for p in schema.error_log
    ]


def _with_prefixes(message: str) -> str:
    for uri, prefix in _PREFIXES.items():
        message = message.replace(f"{{{uri}}}", f"{prefix}:")
    return message


def tag(element: Any) -> str:
    """Return ``ssd:Component`` for an element of a known namespace, else its full name."""
    name = etree.QName(element)
    prefix = _PREFIXES.get(name.namespace)
    return f"{prefix}:{name.localname}" if prefix else str(element.tag)


def base(element: Any) -> str:
    """Return the name of the file that ``element`` is in."""
    return str(element.getroottree().docinfo.URL)


def where(element: Any) -> str:
    """Return the file and line of ``element``, for messages."""
    return f"{base(element)}: line {element.sourceline}"


def children(element: Any) -> Iterator[Any]:
    """Return the child elements, without comments and processing instructions."""
    yield from element.iterchildren(tag=etree.Element)


def child(element: Any, name: str) -> Any | None:
    """Return the child element called ``name`` (``ssd:Elements``), if there is one.

    Raises InputError if there are several: one of them would be left out.
    """
    found = [c for c in children(element) if tag(c) == name]
    if len(found) > 1:
        raise InputError(f"{where(found[1])}: a second {name} in {tag(element)}")
    return found[0] if found else None


def known(
    element: Any, attributes: Collection[str], elements: Collection[str], notes: Notes
) -> None:
    """Note what else ``element`` has; raise InputError for an element of SSP: it could matter."""
    for name in element.attrib:
        if name not in _META and name not in attributes and not name.startswith(_OF_XML):
            near = get_close_matches(name, [*attributes, *_META], 1)
            hint = f"; {near[0]!r} is one that is known" if near else ""
            notes.pass_over(
                where(element), f"attribute {name!r} of {tag(element)} is not known, not used{hint}"
            )
    for one in children(element):
        if tag(one) in elements:
            continue
        if etree.QName(one).namespace == NAMESPACES["ssc"] and tag(one) in _ABOUT:
            notes.pass_over(where(one), f"{tag(one)} of {tag(element)} is not read")
        elif str(etree.QName(one).namespace).startswith(_STANDARD):
            raise InputError(
                f"{where(one)}: {tag(one)} in {tag(element)} is not supported "
                f"(read are: {', '.join(sorted(elements)) or 'none'})"
            )
        else:
            notes.pass_over(where(one), f"{tag(one)} in {tag(element)} is not known, not used")


def listed(element: Any, name: str, allowed: Collection[str], notes: Notes) -> list[Any]:
    """Return the children of the child ``name`` that are ``allowed``. Raises InputError."""
    holder = child(element, name)
    if holder is None:
        return []
    known(holder, (), allowed, notes)
    return [one for one in children(holder) if tag(one) in allowed]


def needed(element: Any, name: str) -> str:
    """Return an attribute; raise InputError if it is missing."""
    value = element.get(name)
    if value is None:
        raise InputError(f"{where(element)}: {tag(element)}: attribute {name!r} is missing")
    return str(value)


@overload
def number(element: Any, name: str) -> float | None: ...
@overload
def number(element: Any, name: str, default: float) -> float: ...
def number(element: Any, name: str, default: float | None = None) -> float | None:
    """Return an attribute as a finite number, if it is there. Raises InputError."""
    text = element.get(name)
    if text is None:
        return default
    return finite(text, f"{where(element)}: {tag(element)}: {name}")


def finite(text: str, place: str) -> float:
    """Return ``text`` as a finite number. Raises InputError naming ``place``."""
    try:
        value = float(text)
        if value - value != 0.0 or "_" in text:
            raise ValueError
    except ValueError:
        raise InputError(f"{place}: a finite number is needed, found {text!r}") from None
    return value


def flag(element: Any, name: str) -> bool:
    """Return an attribute as XML Schema's boolean, false by default. Raises InputError."""
    return boolean(element.get(name, "false"), f"{where(element)}: {tag(element)}: {name}")


def boolean(text: str, place: str) -> bool:
    """Return XML Schema's boolean. Raises InputError naming ``place``."""
    if text.strip() in ("true", "1"):
        return True
    if text.strip() in ("false", "0"):
        return False
    raise InputError(f"{place}: true or false is needed, found {text!r}")


@cache
def _schema(name: str) -> Any:
    return etree.XMLSchema(file=str(_SCHEMA_FOLDER / name))
