"""SSP packages of slaves in C, structured as other people's tools structure theirs."""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from pathlib import Path

from ...fmi.native import build_native_fmu, changed

NAMESPACES = " ".join(
    f'xmlns:{prefix}="http://ssp-standard.org/SSP1/SystemStructure{name}"'
    for prefix, name in (
        ("ssc", "Common"),
        ("ssd", "Description"),
        ("ssv", "ParameterValues"),
        ("ssm", "ParameterMapping"),
        ("ssb", "SignalDictionary"),
    )
)
TYPES = {"i": "Integer", "j": "Integer", "b": "Boolean", "c": "Boolean", "mode": "Enumeration"}


def build(folder: Path) -> dict[str, bytes]:
    """Return the slaves as members of a package.

    ``two`` is of FMI 2.0: y = gain u, j = 2 i, c = not b, mode = mode_in, x' = -k x from 1.
    ``calc`` is the same with y a calculated parameter. ``three`` is of FMI 3.0, with arrays:
    out = in for most types, gain in for Float64, and the transpose of a matrix.
    """
    folder.mkdir(exist_ok=True)
    two, three = (build_native_fmu(name, folder) for name in ("fmi2", "fmi3"))
    calc = changed(
        two,
        folder / "calc.fmu",
        (
            'name="y" valueReference="8" causality="output"',
            'name="y" valueReference="8" causality="calculatedParameter" variability="fixed"',
        ),
        ('<Unknown index="16"/>', ""),
    )
    files = {"two": two, "three": three, "calc": calc}
    return {f"resources/{name}.fmu": path.read_bytes() for name, path in files.items()}


def package(path: Path, ssd: str, members: Mapping[str, str | bytes]) -> Path:
    """Write a package with ``ssd`` as its description."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("SystemStructure.ssd", ssd)
        for name, data in members.items():
            archive.writestr(name, data)
    return path


def ssd(inside: str, *, version: str = "1.0", after: str = "") -> str:
    """Return a description with ``inside`` in its system; it ends after 20 ms."""
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<ssd:SystemStructureDescription {NAMESPACES} name="foreign" version="{version}">
<ssd:System name="root">{inside}</ssd:System>{after}
<ssd:DefaultExperiment startTime="0" stopTime="0.02"/></ssd:SystemStructureDescription>"""


def connector(name: str, kind: str, of: str = "Real", inside: str = "", **attributes: str) -> str:
    """Return a connector; ``inside`` stands behind its type."""
    more = "".join(f' {key}="{value}"' for key, value in attributes.items())
    return f'<ssd:Connector name="{name}" kind="{kind}"><ssc:{of}{more}/>{inside}</ssd:Connector>'


def connectors(*listed: str) -> str:
    """Return a list of connectors."""
    return f"<ssd:Connectors>{''.join(listed)}</ssd:Connectors>"


def component(name: str, *listed: str, fmu: str = "two", bindings: str = "", more: str = "") -> str:
    """Return a component with connectors."""
    held = connectors(*listed) if listed else ""
    return (
        f'<ssd:Component name="{name}" source="resources/{fmu}.fmu" {more}>{held}{bindings}'
        "</ssd:Component>"
    )


def connection(start: str, end: str, inside: str = "", more: str = "") -> str:
    """Return a connection of ``element/connector``, or a connector of the system itself."""
    ends = ""
    for side, text in (("start", start), ("end", end)):
        element, _, name = text.rpartition("/")
        ends += f' {side}Element="{element}"' if element else ""
        ends += f' {side}Connector="{name}"'
    return f"<ssd:Connection{ends} {more}>{inside}</ssd:Connection>"


def elements(*listed: str, connections: str = "") -> str:
    """Return elements and the connections between them."""
    made = f"<ssd:Connections>{connections}</ssd:Connections>" if connections else ""
    return f"<ssd:Elements>{''.join(listed)}</ssd:Elements>{made}"


def value(name: str, text: str, of: str = "Real", inside: str = "", **attributes: str) -> str:
    """Return a parameter of a set."""
    more = "".join(f' {key}="{each}"' for key, each in attributes.items())
    return f'<ssv:Parameter name="{name}"><ssv:{of} value="{text}"{more}/>{inside}</ssv:Parameter>'


def values(*listed: str, after: str = "", version: str = "1.0") -> str:
    """Return a parameter set."""
    return (
        f'<ssv:ParameterSet {NAMESPACES} version="{version}" name="set"><ssv:Parameters>'
        f"{''.join(listed)}</ssv:Parameters>{after}</ssv:ParameterSet>"
    )


def entry(source: str, target: str, inside: str = "", more: str = "") -> str:
    """Return an entry of a mapping."""
    return (
        f'<ssm:MappingEntry source="{source}" target="{target}" {more}>{inside}</ssm:MappingEntry>'
    )


def mapping(*entries: str) -> str:
    """Return a parameter mapping."""
    return f'<ssm:ParameterMapping {NAMESPACES} version="1.0">{"".join(entries)}</ssm:ParameterMapping>'


def bound(inline: str = "", *, mapped: str = "", more: str = "") -> str:
    """Return bindings: a set inline, or what ``more`` refers to, behind a mapping."""
    held = f"<ssd:ParameterValues>{inline}</ssd:ParameterValues>" if inline else ""
    behind = f"<ssd:ParameterMapping>{mapped}</ssd:ParameterMapping>" if mapped else ""
    return (
        f"<ssd:ParameterBindings><ssd:ParameterBinding {more}>{held}{behind}"
        "</ssd:ParameterBinding></ssd:ParameterBindings>"
    )


def table(kind: str, *pairs: tuple[str, str]) -> str:
    """Return a mapping transformation."""
    inside = "".join(f'<ssc:MapEntry source="{a}" target="{b}"/>' for a, b in pairs)
    return f"<ssc:{kind}MappingTransformation>{inside}</ssc:{kind}MappingTransformation>"


def linear(factor: float, offset: float) -> str:
    """Return a linear transformation."""
    return f'<ssc:LinearTransformation factor="{factor}" offset="{offset}"/>'
