"""Terminals in FMUs: ``terminalsAndIcons/terminalsAndIcons.xml``, written and read.

FMI 3.0 defines the file (2.4.9), and FMI 2.0.4 takes it over at the same place: ours have it
there too. A member that is a port with axes is written as one member for each, ``force.x``.

Other tools know no inputs that sum. So a terminal with a member that is a sum is written once
for each term: ``wrench`` with the first one, ``wrench_2`` with the second. Each is a terminal to
connect to; an annotation says that the further ones are terms, and reading gives ``wrench``,
with the sum, alone.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from ...errors import InputError, unknown
from ...model.terminals import Terminal
from ..instance import Variable, Variables
from .xmlfile import read_xml

PLACE = "terminalsAndIcons/terminalsAndIcons.xml"
"""Of the file, in an FMU."""

TOOL = "seatrial"
"""Name of ours, in annotations."""


Scalars = dict[str, Variable]
"""Variables by what their names add to that of the port: ``.x``, ``[1]``; nothing for one alone."""


def scalars_of(variables: Variables, target: str, term: int = 1) -> Scalars:
    """Return the variables of a port, a scalar, or one term of a sum (none after its last)."""
    if target in variables.terms:
        terms = variables.terms[target]
        if term > len(terms):
            return {}
        target = terms[term - 1]
    found = [variables[target]] if target in variables else variables.ports[target]
    return {v.name[len(target) :]: v for v in found}


def by_term(
    terminals: Mapping[str, Terminal], variables: Variables
) -> Iterator[tuple[str, str, dict[str, Scalars]]]:
    """Yield name, name of the whole and variables by member, of each terminal and each term.

    Raises InputError if the name of a further term is that of another terminal.
    """
    for whole, terminal in terminals.items():
        sums = [variables.terms[t] for t in terminal.members.values() if t in variables.terms]
        for term in range(1, max(map(len, sums), default=1) + 1):
            name = whole if term == 1 else f"{whole}_{term}"
            if term > 1 and name in terminals:
                raise InputError(f"terminal {name!r} has the name of term {term} of {whole!r}")
            members = {m: scalars_of(variables, t, term) for m, t in terminal.members.items()}
            yield name, whole, members


def terminals_xml(
    terminals: Mapping[str, Terminal], variables: Variables, arrays: Collection[str] = ()
) -> bytes:
    """Return the content of the file; ``arrays`` are ports that are one variable each.

    Raises InputError as `by_term`.
    """
    return xml_text(terminals_element(terminals, variables, arrays))


def terminals_element(
    terminals: Mapping[str, Terminal], variables: Variables, arrays: Collection[str] = ()
) -> Element:
    """Return what `terminals_xml` writes; its first element holds the terminals."""
    root = Element("fmiTerminalsAndIcons", {"fmiVersion": "3.0"})
    listed = SubElement(root, "Terminals")
    for name, whole, members in by_term(terminals, variables):
        rule = terminals[whole].rule
        element = SubElement(listed, "Terminal", {"name": name, "matchingRule": rule})
        for member, scalars in members.items():
            for shown, name_ in _members_of(member, scalars, arrays).items():
                names = {"variableName": name_, "memberName": shown}
                SubElement(element, "TerminalMemberVariable", {**names, "variableKind": "signal"})
        if name != whole:
            note = SubElement(SubElement(element, "Annotations"), "Annotation", {"type": TOOL})
            SubElement(note, "term", {"of": whole})
    return root


def _members_of(member: str, scalars: Scalars, arrays: Collection[str]) -> dict[str, str]:
    """Return the variables that a member has in the file, by its names there."""
    ports = {variable.name.removesuffix(ending) for ending, variable in scalars.items()}
    if "" not in scalars and len(ports) == 1 and ports <= set(arrays):
        return {member: ports.pop()}
    return {member + ending: variable.name for ending, variable in scalars.items()}


def xml_text(root: Element) -> bytes:
    """Return an XML file, the same bytes for the same content."""
    indent(root)
    text: bytes = tostring(root, encoding="UTF-8", xml_declaration=True)
    return text + b"\n"


def read_terminals(
    folder: Path, path: Path, variables: Variables, others: Collection[str] = ()
) -> dict[str, Terminal]:
    """Return the terminals of the FMU ``path``, unpacked in ``folder``; none without the file.

    Members of nested terminals get the name of theirs before their own: ``nested.member``. A
    matching rule that is not ``plug`` is taken for ``bus``. ``others`` are variables of the FMU
    that are no signals here (clocks): members that name them are left out.

    Raises InputError, with file and line, for a file that is no XML of this kind, a name that
    is missing or given twice, and a variable that the FMU does not have.
    """
    if not (folder / PLACE).is_file():
        return {}
    called = f"{path}: {PLACE}"
    root = read_xml(folder / PLACE, called)
    if root.tag != "fmiTerminalsAndIcons":
        raise InputError(f"{called}: an element fmiTerminalsAndIcons is needed, found {root.tag}")
    found: dict[str, Terminal] = {}
    reading = MemberReader(variables, others)
    try:
        for element in root.iterfind("Terminals/Terminal"):
            name = attribute(element, "name")
            if element.find(f"Annotations/Annotation[@type='{TOOL}']/term") is not None:
                continue
            if name in found:
                raise InputError(f"{_place(element)}: two terminals are called {name!r}")
            rule = attribute(element, "matchingRule")
            members = reading.by_port(_members(element, reading, ""))
            if members:
                found[name] = Terminal(members, "plug" if rule == "plug" else "bus")
    except InputError as error:
        raise InputError(f"{called}: {error}") from None
    return found


class MemberReader:
    """Members of terminals as a file has them, made into ports and sums of one FMU."""

    def __init__(self, variables: Variables, others: Collection[str]) -> None:
        self.variables, self._others = variables, others
        self._firsts = {ports[0]: name for name, ports in variables.terms.items()}

    def add(self, members: dict[str, str], name: str, variable: str, element: Any) -> None:
        """Add a member, if its variable is a signal. Raises InputError with the place."""
        if variable not in self.variables and variable not in self.variables.ports:
            if variable in self._others:
                return
            why = unknown("variable", variable, self.variables)
            raise InputError(f"{_place(element)}: {why}")
        if name in members:
            raise InputError(f"{_place(element)}: two members are called {name!r}")
        members[name] = variable

    def by_port(self, members: Mapping[str, str]) -> dict[str, str]:
        """Return members with one in the place of all scalars of a port.

        ``{"v.x": "velocity.x", "v.y": "velocity.y"}`` is ``{"v": "velocity"}``, if that has
        these two; the first term of a sum stands for the sum.
        """
        places = {member: self._group(member, name) for member, name in members.items()}
        groups: dict[tuple[str, str], set[str]] = {}
        for member, name in members.items():
            groups.setdefault(places[member], set()).add(name)
        whole = {
            (base, port)
            for (base, port), names in groups.items()
            if port
            and base not in members
            and names == {v.name for v in self.variables.ports.get(port, ())}
        }
        found: dict[str, str] = {}
        for member, name in members.items():
            shown, meant = places[member] if places[member] in whole else (member, name)
            found[shown] = self._firsts.get(meant, meant)
        return found

    def _group(self, member: str, name: str) -> tuple[str, str]:
        """Return name and port that a member and its variable end alike after; else empty."""
        port = self.variables.port_of(name)
        ending = name[len(port) :]
        if not port or not member.endswith(ending) or member == ending:
            return "", ""
        return member.removesuffix(ending), port


def attribute(element: Any, name: str) -> str:
    """Return an attribute of an XML element. Raises InputError if it is missing or empty."""
    value: str = element.get(name, "")
    if not value:
        raise InputError(f"{_place(element)}: has no {name}")
    return value


def _place(element: Any) -> str:
    return f"{element.tag.rpartition('}')[2]} (line {element.sourceline})"


def _members(element: Any, reading: MemberReader, prefix: str) -> dict[str, str]:
    members: dict[str, str] = {}
    for child in element:
        if child.tag == "TerminalMemberVariable":
            variable = attribute(child, "variableName")
            reading.add(members, prefix + (child.get("memberName") or variable), variable, child)
        elif child.tag == "TerminalStreamMemberVariable":
            for way in ("in", "out"):
                name = prefix + attribute(child, f"{way}StreamMemberName")
                reading.add(members, name, attribute(child, f"{way}StreamVariableName"), child)
        elif child.tag == "Terminal":
            nested = _members(child, reading, f"{prefix}{attribute(child, 'name')}.")
            for name, variable in nested.items():
                reading.add(members, name, variable, child)
    return members
