"""Terminals as variable groups of OSP-IS 1.0: ``NAME_OspModelDescription.xml``.

NAME is the FMU's modelName. libcosim looks for the file beside the FMU, then beside the
OspSystemStructure.xml; it has no place inside. It connects groups by their order and
needs equal numbers of variables. So a terminal is a Generic group, and each of its members one
inside, which can be connected alone: ``motion``, ``motion.position``. A group has the type of
its quantity where OSP-IS has one. Terminals with sums are written term by term, as in
`terminals`.
"""

from __future__ import annotations

import os
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, SubElement

from ...errors import InputError
from ...model.terminals import Terminal
from ..instance import Variables
from .terminals import MemberReader, Scalars, attribute, by_term, xml_text
from .xmlfile import read_xml

_NAMESPACE = "https://open-simulation-platform.com/OspModelDescription/1.0.1"

QUANTITIES = {
    "N": "Force",
    "N.m": "Torque",
    "V": "Voltage",
    "Pa": "Pressure",
    "m/s": "LinearVelocity",
    "rad/s": "AngularVelocity",
    "A": "Current",
    "m3/s": "VolumeFlowRate",
    "m": "LinearDisplacement",
    "rad": "AngularDisplacement",
    "C": "Charge",
    "m3": "Volume",
    "m/s2": "LinearAcceleration",
    "rad/s2": "AngularAcceleration",
}
"""Types of groups by unit, in the order that the schema wants: quantities by OSP's names."""
_ORDER = ["Generic", *QUANTITIES.values()]
_MOST_IN_A_TYPE = 3
_AXES = (".x", ".y", ".z")


def osp_file(folder: Path, model_name: str) -> Path:
    """Return the file of an FMU in ``folder``, as libcosim calls it."""
    return folder / f"{model_name}_OspModelDescription.xml"


def osp_xml(terminals: Mapping[str, Terminal], variables: Variables) -> bytes:
    """Return the content of the file. Raises InputError as `terminals.by_term`."""
    root = Element("OspModelDescription", {"xmlns": _NAMESPACE, "version": "1.0"})
    groups = SubElement(root, "VariableGroups")
    for name, _, members in by_term(terminals, variables):
        terminal = SubElement(groups, "Generic", {"name": name})
        inside = [_group(f"{name}.{m}", scalars) for m, scalars in members.items() if scalars]
        terminal.extend(sorted(inside, key=lambda group: _ORDER.index(group.tag)))
    return xml_text(root)


def _group(name: str, scalars: Scalars) -> Element:
    alike = {(v.unit, v.causality) for v in scalars.values()}
    kind = "Generic"
    if len(alike) == 1 and len(scalars) <= _MOST_IN_A_TYPE:
        ((unit, _),) = alike
        kind = QUANTITIES.get(unit, kind)
    group = Element(kind, {"name": name})
    for ending, variable in scalars.items():
        attributes = {"ref": variable.name}
        if variable.unit:
            attributes["unit"] = variable.unit
        if ending in _AXES:
            attributes["axis"] = ending[1:]
        SubElement(group, "Variable", attributes)
    return group


def read_osp(
    path: Path, model_name: str, variables: Variables, others: Collection[str] = ()
) -> dict[str, Terminal]:
    """Return the variable groups in the file beside the FMU ``path``; none without the file.

    Each group that is in no other is a terminal. Members have no names in OSP-IS: they are
    named as their variables, or as the port of which they are all. ``others`` are variables of
    the FMU that are no signals here.

    Raises InputError, with file and line, for a file that is no XML of this kind, a name that
    is missing or given twice, and a variable that the FMU does not have.
    """
    file = osp_file(path.parent, model_name)
    # Any text may be a modelName: no other folder, and no name that the system refuses.
    if Path(model_name).name != model_name or not os.path.isfile(file):
        return {}
    root = read_xml(file, str(file))
    if _tag(root) != "OspModelDescription":
        raise InputError(f"{file}: an element OspModelDescription is needed, found {_tag(root)}")
    found: dict[str, Terminal] = {}
    reading = MemberReader(variables, others)
    try:
        for group in root.iterfind("{*}VariableGroups/{*}*"):
            name = attribute(group, "name")
            if name in found:
                raise InputError(f"line {group.sourceline}: two groups are called {name!r}")
            members: dict[str, str] = {}
            for variable in group.iterfind(".//{*}Variable"):
                reference = attribute(variable, "ref")
                reading.add(members, reference, reference, variable)
            if members:
                found[name] = Terminal(reading.by_port(members))
    except InputError as error:
        raise InputError(f"{file}: {error}") from None
    return found


def _tag(element: Any) -> str:
    return str(element.tag).rpartition("}")[2]
