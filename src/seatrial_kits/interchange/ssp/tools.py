"""Limits of other tools: what of an SSP package they reject, ignore or take otherwise."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from seatrial.errors import InputError, unknown
from seatrial.fmi.files.xmlfile import read_xml

from . import rules
from .documents import NAMESPACES, where
from .notes import Notes
from .package import open_package

TOOLS = ("omsimulator", "libcosim", "ecos", "fmpy", "fmucontainer")

Finder = Callable[[Any], Iterator[Any]]
"""Yields the elements of a description that a fact is about."""


@dataclass(frozen=True)
class Fact:
    """How tools take what ``finder`` finds: {tool: what it does}."""

    finder: Finder
    rejected: dict[str, str]
    changed: dict[str, str]


@dataclass(frozen=True)
class Finding:
    """One thing that a tool does with a package."""

    tool: str
    rejects: bool
    where: str
    text: str


_ALL_RUN = ("libcosim", "ecos", "fmpy", "fmucontainer")
_PREFIX = "needs the prefixes ssd, ssc, ssv and osp, literally"
_FLAT = "takes components only: no systems in systems, no signal dictionaries"
_OWN = "takes connections between components only, none of the system's own connectors"
_UNDECLARED = "needs every connected connector declared"
_UNITS = "converts no units: write a LinearTransformation with suppressUnitConversion"
_IDENTIFIER = "needs names of letters, digits and '_' (version 2 ends with an error or crashes)"

FACTS = (
    Fact(rules.other_version, {"ecos": "reads version 1.0 only"}, {}),
    Fact(rules.version_2, {"fmpy": "reads versions 1.x only"}, {}),
    Fact(rules.breaks_schema, {"fmpy": "validates against the schema of version 1.0"}, {}),
    Fact(rules.other_prefix("ssd"), {"libcosim": _PREFIX, "ecos": _PREFIX}, {}),
    Fact(
        rules.other_prefix("ssc"),
        {"libcosim": _PREFIX},
        {"ecos": "does not see types and transformations with another prefix than ssc"},
    ),
    Fact(
        rules.other_prefix("osp"),
        {"libcosim": _PREFIX},
        {"ecos": "does not see step size hints with another prefix than osp"},
    ),
    Fact(
        rules.other_ssv_prefix,
        {"libcosim": _PREFIX},
        {"ecos": "does not see values with another prefix than ssv"},
    ),
    Fact(rules.inner_systems, {"libcosim": _FLAT, "ecos": _FLAT}, {}),
    Fact(
        rules.equal_paths,
        {"fmpy": "fails where two connectors have the same path, names joined by dots"},
        {},
    ),
    Fact(
        rules.inner_packages,
        dict.fromkeys(_ALL_RUN, "takes FMUs only, no packages in packages"),
        {},
    ),
    Fact(rules.dictionaries, {"fmucontainer": "takes no signal dictionaries"}, {}),
    Fact(rules.sourceless, {"fmucontainer": "needs a source in every component"}, {}),
    Fact(rules.own_to_own, {"fmucontainer": "needs an element in every connection"}, {}),
    Fact(rules.empty_elements, {"fmucontainer": "takes no empty startElement or endElement"}, {}),
    Fact(
        rules.backwards_outside,
        {"fmucontainer": "needs the element's output at the start of a connection to the system"},
        {},
    ),
    Fact(rules.calculated, {"fmucontainer": "connects outputs only, no calculated parameters"}, {}),
    Fact(rules.element_connections, {"fmucontainer": "connects no elements of arrays"}, {}),
    Fact(
        rules.no_outputs,
        {},
        {"fmucontainer": "shows nothing but what output connectors of the system carry"},
    ),
    Fact(rules.own_connections, {"libcosim": _OWN, "ecos": _OWN}, {}),
    Fact(rules.undeclared, dict.fromkeys(("libcosim", "ecos", "fmpy"), _UNDECLARED), {}),
    Fact(rules.untyped, {"libcosim": "needs a type in every connector"}, {}),
    Fact(
        rules.typed("Enumeration", "Binary"),
        {"libcosim": "ends the process at connectors of type Enumeration and Binary"},
        {},
    ),
    Fact(rules.typed("String"), {"fmpy": "knows no connectors of type String"}, {}),
    Fact(rules.unequal_types, {"ecos": "needs equal types at both ends of a connection"}, {}),
    Fact(
        rules.backwards,
        {"libcosim": "needs the output at the start of a connection"},
        {"ecos": "moves no value along a connection that starts at an input"},
    ),
    Fact(
        rules.loose_inputs,
        {"fmpy": "fails at a declared input without connection, or feeds it another output"},
        {},
    ),
    Fact(
        rules.no_step, {"libcosim": "needs OSP's baseStepSize, or a step size from its caller"}, {}
    ),
    Fact(rules.no_oms_step, {}, {"omsimulator": "version 2 needs its own annotation with a step"}),
    Fact(rules.odd_names, {"omsimulator": _IDENTIFIER}, {}),
    Fact(rules.geometry, {}, {"omsimulator": "version 2 refuses SystemGeometry"}),
    Fact(
        rules.half_transformation,
        {"omsimulator": "version 3 needs factor and offset in a LinearTransformation"},
        {},
    ),
    Fact(rules.no_factor, {}, {"ecos": "takes a missing factor as 0"}),
    Fact(
        rules.transformations,
        {},
        {
            "fmpy": "ignores transformations",
            "fmucontainer": "ignores transformations",
            "omsimulator": "version 2 ignores transformations",
        },
    ),
    Fact(rules.unlike_units, {}, dict.fromkeys(_ALL_RUN, _UNITS)),
    Fact(
        rules.component_bindings,
        {},
        {
            "fmpy": "ignores parameter bindings: FMUs keep their own start values",
            "fmucontainer": "ignores parameter bindings: FMUs keep their own start values",
            "ecos": "applies a parameter set only if its caller names it",
        },
    ),
    Fact(
        rules.system_bindings, {}, dict.fromkeys(_ALL_RUN, "ignores parameter bindings of systems")
    ),
    Fact(
        rules.second_bindings,
        {},
        {"libcosim": "applies the first parameter binding of a component only"},
    ),
    Fact(
        rules.prefixed_bindings,
        {},
        dict.fromkeys(("libcosim", "ecos"), "ignores the prefix of a parameter binding"),
    ),
    Fact(rules.mappings, {}, dict.fromkeys(_ALL_RUN, "ignores parameter mappings")),
    Fact(
        rules.measured_values,
        {},
        dict.fromkeys(("libcosim", "ecos"), "ignores units of parameters: values go in unchanged"),
    ),
    Fact(rules.experiment, {}, {"fmpy": "ignores the default experiment's times and step"}),
)
"""Measured with the versions that docs/kits/interchange/ssp.md names; OMSimulator's are read."""


def takes_systems(tool: str) -> bool:
    """Say if one of `TOOLS` takes systems inside systems. Raises InputError for another name."""
    if tool not in TOOLS:
        raise InputError(unknown("tool", tool, TOOLS))
    return not any(tool in f.rejected for f in FACTS if f.finder is rules.inner_systems)


def findings(path: Path) -> list[Finding]:
    """Return what the tools do with the package at ``path``, in the order of `TOOLS`.

    Raises InputError for what is no package or no XML.
    """
    package = open_package(path, path.name, Notes())
    label = package.shown(package.description)
    root = read_xml(package.description, label, lambda prefix, _line: NAMESPACES.get(prefix))
    root.getroottree().docinfo.URL = label
    view = rules.View(root, package.folder)
    found = []
    for fact in FACTS:
        elements = list(fact.finder(view))
        if not elements:
            continue
        more = f" (and {len(elements) - 1} more)" if len(elements) > 1 else ""
        for rejects, said in ((True, fact.rejected), (False, fact.changed)):
            for tool, text in said.items():
                found.append(Finding(tool, rejects, where(elements[0]), text + more))
    return sorted(found, key=lambda one: (TOOLS.index(one.tool), not one.rejects))
