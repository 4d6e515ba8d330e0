"""Finders of what tools differ about in an SSP package: each yields the elements concerned."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from urllib.parse import unquote

from lxml import etree

from seatrial.errors import InputError
from seatrial.fmi.files.xmlfile import read_xml

from .documents import NAMESPACES, children, schema_problems, tag
from .model import FMU
from .parameters import KINDS

_IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


class View:
    """A description and the package around it."""

    def __init__(self, root: Any, folder: Path) -> None:
        self.root, self._folder = root, folder

    def all(self, name: str) -> Iterator[Any]:
        """Yield all elements called ``name`` (``ssd:Connector``)."""
        prefix, _, local = name.partition(":")
        yield from self.root.iter(f"{{{NAMESPACES[prefix]}}}{local}")

    def connectors(self, system: Any) -> dict[tuple[str, str], Any]:
        """Return the connectors of a system's elements and its own, by both names."""
        found = {("", c.get("name")): c for c in _listed(system, "ssd:Connectors")}
        for element in _listed(system, "ssd:Elements"):
            for connector in _listed(element, "ssd:Connectors"):
                found[element.get("name"), connector.get("name")] = connector
        return found

    def connections(self) -> Iterator[tuple[Any, Any | None, Any | None]]:
        """Yield every connection with the connectors at its start and end."""
        for system in self.all("ssd:System"):
            declared = self.connectors(system)
            for one in _listed(system, "ssd:Connections"):
                yield one, declared.get(_end(one, "start")), declared.get(_end(one, "end"))

    def parameter_sets(self) -> Iterator[tuple[Any, Any]]:
        """Yield (binding, root of its parameter set) where that can be read."""
        for binding in self.all("ssd:ParameterBinding"):
            source = binding.get("source")
            if source is None:
                yield from ((binding, one) for one in binding.iter(_full("ssv:ParameterSet")))
                continue
            # What is wrong, the reader of packages says.
            with contextlib.suppress(InputError, OSError, ValueError):
                path = (self._folder / unquote(source)).resolve()
                if path.is_relative_to(self._folder) and path.is_file():
                    yield binding, read_xml(path, source)


def other_version(view: View) -> Iterator[Any]:
    """Yield the root of a description that is not version 1.0."""
    if view.root.get("version") != "1.0":
        yield view.root


def version_2(view: View) -> Iterator[Any]:
    """Yield the root of a description that is not version 1."""
    if not str(view.root.get("version")).startswith("1."):
        yield view.root


def breaks_schema(view: View) -> Iterator[Any]:
    """Yield the root of a description of version 1 that its schema does not allow."""
    if schema_problems(view.root, "ssd:SystemStructureDescription"):
        yield view.root


def other_prefix(prefix: str) -> Callable[[View], Iterator[Any]]:
    """Return a finder of elements whose namespace should be called ``prefix`` and is not."""

    def finder(view: View) -> Iterator[Any]:
        for element in view.root.iter(f"{{{NAMESPACES[prefix]}}}*"):
            if element.prefix != prefix:
                yield element

    return finder


def other_ssv_prefix(view: View) -> Iterator[Any]:
    """Yield the bindings whose parameter sets have another prefix than ssv."""
    for binding, parameters in view.parameter_sets():
        if parameters.prefix != "ssv":
            yield binding


def inner_systems(view: View) -> Iterator[Any]:
    """Yield elements that are no components."""
    for elements in view.all("ssd:Elements"):
        yield from (one for one in children(elements) if tag(one) != "ssd:Component")


def equal_paths(view: View) -> Iterator[Any]:
    """Yield connectors that have the path of another, such as `a.b` of a system with an `a`."""
    found = set()
    for one in view.all("ssd:Connector"):
        around = one.iterancestors(_full("ssd:System"), _full("ssd:Component"))
        path = ".".join(reversed([each.get("name", "") for each in (one, *around)]))
        if path in found:
            yield one
        found.add(path)


def dictionaries(view: View) -> Iterator[Any]:
    """Yield references to signal dictionaries."""
    yield from view.all("ssd:SignalDictionaryReference")


def sourceless(view: View) -> Iterator[Any]:
    """Yield components without source."""
    yield from (one for one in view.all("ssd:Component") if one.get("source") is None)


def own_to_own(view: View) -> Iterator[Any]:
    """Yield connections between two connectors of the system itself."""
    for one in view.all("ssd:Connection"):
        if one.get("startElement") is None and one.get("endElement") is None:
            yield one


def empty_elements(view: View) -> Iterator[Any]:
    """Yield connections that name the system itself by an empty text."""
    for one in view.all("ssd:Connection"):
        if "" in (one.get("startElement"), one.get("endElement")):
            yield one


def backwards_outside(view: View) -> Iterator[Any]:
    """Yield connections of the system's connectors that start at the wrong end."""
    for one, start, end in view.connections():
        kinds = [None if side is None else side.get("kind") for side in (start, end)]
        inwards = one.get("startElement") is None and kinds[1] == "output"
        if inwards or (one.get("endElement") is None and kinds[0] == "input"):
            yield one


def calculated(view: View) -> Iterator[Any]:
    """Yield connections of calculated parameters."""
    for one, start, end in view.connections():
        if any(side is not None and side.get("kind") == _CALCULATED for side in (start, end)):
            yield one


def element_connections(view: View) -> Iterator[Any]:
    """Yield connections of elements of arrays."""
    for one in view.all("ssd:Connection"):
        if one.get("startIndices") or one.get("endIndices"):
            yield one


def no_outputs(view: View) -> Iterator[Any]:
    """Yield the system of a description if it has no output connector of its own."""
    top = next((one for one in children(view.root) if tag(one) == "ssd:System"), None)
    if top is not None:
        kinds = [one.get("kind") for one in _listed(top, "ssd:Connectors")]
        if "output" not in kinds:
            yield top


def inner_packages(view: View) -> Iterator[Any]:
    """Yield components that are no FMUs."""
    yield from (one for one in view.all("ssd:Component") if one.get("type", FMU) != FMU)


def own_connections(view: View) -> Iterator[Any]:
    """Yield connections that end at a connector of the system itself."""
    for one, _, _ in view.connections():
        if not (one.get("startElement") and one.get("endElement")):
            yield one


def undeclared(view: View) -> Iterator[Any]:
    """Yield connections of connectors that are not declared."""
    yield from (one for one, start, end in view.connections() if start is None or end is None)


def untyped(view: View) -> Iterator[Any]:
    """Yield connectors without a type."""
    yield from (one for one in view.all("ssd:Connector") if _type(one) is None)


def typed(*kinds: str) -> Callable[[View], Iterator[Any]]:
    """Return a finder of connectors of one of the types."""

    def finder(view: View) -> Iterator[Any]:
        for one in view.all("ssd:Connector"):
            kind = _type(one)
            if kind is not None and kind in kinds:
                yield one

    return finder


def unequal_types(view: View) -> Iterator[Any]:
    """Yield connections whose ends have different types, of those that ecos compares."""
    for one, start, end in view.connections():
        types = {_type(side) for side in (start, end) if side is not None}
        if len(types & {"Real", "Integer", "Boolean", "String"}) > 1:
            yield one


def backwards(view: View) -> Iterator[Any]:
    """Yield connections between elements that start at an input."""
    for one, start, _ in view.connections():
        if start is not None and one.get("startElement") and start.get("kind") == "input":
            yield one


def loose_inputs(view: View) -> Iterator[Any]:
    """Yield declared inputs of components that no connection reaches."""
    for system in view.all("ssd:System"):
        ends = {_end(one, side) for one in _listed(system, "ssd:Connections") for side in _SIDES}
        for (element, name), connector in view.connectors(system).items():
            if element and connector.get("kind") == "input" and (element, name) not in ends:
                yield connector


def no_step(view: View) -> Iterator[Any]:
    """Yield the root of a description without OSP's step size."""
    if not any(one.get("baseStepSize") for one in view.all("osp:FixedStepAlgorithm")):
        yield view.root


def no_oms_step(view: View) -> Iterator[Any]:
    """Yield the root of a description without OMSimulator's step size."""
    if not any(one.get("stepSize") for one in view.all("oms:FixedStepMaster")):
        yield view.root


def odd_names(view: View) -> Iterator[Any]:
    """Yield descriptions, systems and components whose names are no identifiers."""
    for name in ("ssd:SystemStructureDescription", "ssd:System", "ssd:Component"):
        for one in view.all(name):
            if not _IDENTIFIER.fullmatch(one.get("name", "")):
                yield one


def geometry(view: View) -> Iterator[Any]:
    """Yield the geometry of systems."""
    yield from view.all("ssd:SystemGeometry")


def transformations(view: View) -> Iterator[Any]:
    """Yield the transformations of connections."""
    for one in view.all("ssd:Connection"):
        yield from (c for c in children(one) if str(tag(c)).endswith("Transformation"))


def half_transformation(view: View) -> Iterator[Any]:
    """Yield linear transformations that leave factor or offset out."""
    for one in view.all("ssc:LinearTransformation"):
        if one.get("factor") is None or one.get("offset") is None:
            yield one


def no_factor(view: View) -> Iterator[Any]:
    """Yield linear transformations without factor."""
    yield from (one for one in view.all("ssc:LinearTransformation") if one.get("factor") is None)


def unlike_units(view: View) -> Iterator[Any]:
    """Yield connections whose ends declare different units that are to be converted."""
    for one, start, end in view.connections():
        units = {_unit(side) for side in (start, end) if side is not None} - {None}
        if len(units) > 1 and one.get("suppressUnitConversion", "false") in ("false", "0"):
            yield one


def component_bindings(view: View) -> Iterator[Any]:
    """Yield parameter bindings of components."""
    for one in view.all("ssd:Component"):
        yield from _listed(one, "ssd:ParameterBindings")


def system_bindings(view: View) -> Iterator[Any]:
    """Yield parameter bindings of systems."""
    for one in view.all("ssd:System"):
        yield from _listed(one, "ssd:ParameterBindings")


def second_bindings(view: View) -> Iterator[Any]:
    """Yield all parameter bindings of a component but the first."""
    for one in view.all("ssd:Component"):
        yield from _listed(one, "ssd:ParameterBindings")[1:]


def prefixed_bindings(view: View) -> Iterator[Any]:
    """Yield the components' parameter bindings with a prefix."""
    yield from (one for one in component_bindings(view) if one.get("prefix"))


def mappings(view: View) -> Iterator[Any]:
    """Yield parameter mappings."""
    yield from view.all("ssd:ParameterMapping")


def measured_values(view: View) -> Iterator[Any]:
    """Yield bindings of parameter sets in which a value has a unit."""
    for binding, parameters in view.parameter_sets():
        if any(one.get("unit") for one in parameters.iter(_full("ssv:Real"))):
            yield binding


def experiment(view: View) -> Iterator[Any]:
    """Yield the default experiment."""
    yield from view.all("ssd:DefaultExperiment")


_SIDES = ("start", "end")
_CALCULATED = "calculatedParameter"


def _full(name: str) -> str:
    prefix, _, local = name.partition(":")
    return f"{{{NAMESPACES[prefix]}}}{local}"


def _listed(element: Any, name: str) -> list[Any]:
    # A second list, which the reader refuses, is looked at too: here nothing is left out by it.
    return [one for found in children(element) if tag(found) == name for one in children(found)]


def _end(connection: Any, side: str) -> tuple[str, str]:
    return connection.get(f"{side}Element", ""), connection.get(f"{side}Connector", "")


def _type(connector: Any) -> str | None:
    names = [etree.QName(one).localname for one in children(connector)]
    return next((name for name in names if name in KINDS), None)


def _unit(connector: Any) -> str | None:
    return next((one.get("unit") for one in children(connector) if one.get("unit")), None)
