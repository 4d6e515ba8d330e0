"""Plants to native FMUs: FMI 2.0 co-simulation in C, with its sources."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, SubElement, indent, tostring

import fmpy

from ... import __version__
from ...errors import InputError
from ...plant import Plant
from ..cache import write_named
from ..description import describe
from ..direct import DirectInstance
from ..export import zipped
from ..source import ComponentSource
from ..terminals import PLACE, terminals_xml
from .compiler import TARGETS, library
from .equations import header, model, started, why_python

_OWN = Path(__file__).with_name("plant.c")
_HEADERS = ("fmi2Functions.h", "fmi2FunctionTypes.h", "fmi2TypesPlatform.h")
"""FMI's own (2-clause BSD, as they say), from FMPy: they travel with the sources."""


def build_native_fmu(
    source: ComponentSource,
    destination: Path,
    platforms: Sequence[str],
    start_values: Mapping[str, Any] | None = None,
) -> Path:
    """Build the native FMU of ``source`` at ``destination`` (a file) and return its path.

    ``start_values`` (by port name, SI) are baked in; text parameters, waves, current and wind
    cannot change afterwards. The same input gives the same bytes. Raises InputError for a
    component that is no plant, values it cannot start with, and without a compiler; nothing is
    written then.
    """
    cls = source.component_class()
    why = why_python(cls)
    if why:
        raise InputError(f"{source.origin} cannot be native: {why}")
    plant = cls(source.name)
    assert isinstance(plant, Plant)
    for port, value in (start_values or {}).items():
        plant.set(port, value)
    sources = _sources(started(plant, source.origin))
    root = _described(source, sources, start_values or {})
    sources["model.h"] = header(plant, str(root.get("guid"))).encode()
    files = {f"sources/{name}": content for name, content in sources.items()}
    for platform in platforms:
        name = f"{source.stem}{TARGETS[platform][1]}"
        files[f"binaries/{platform}/{name}"] = library(sources, platform)
    instance = DirectInstance(cls(source.name))
    if instance.terminals:
        files[PLACE] = terminals_xml(instance.terminals, instance.variables)
    indent(root)
    files["modelDescription.xml"] = tostring(root, encoding="UTF-8", xml_declaration=True)
    destination.parent.mkdir(parents=True, exist_ok=True)
    write_named(destination, zipped(files))
    return destination


def _sources(plant: Plant) -> dict[str, bytes]:
    folder = Path(fmpy.__file__).parent / "c-code"
    headers = {name: (folder / name).read_bytes() for name in _HEADERS}
    return {"model.c": model(plant).encode(), "plant.c": _OWN.read_bytes(), **headers}


def _described(
    source: ComponentSource, sources: Mapping[str, bytes], start_values: Mapping[str, Any]
) -> Element:
    root = describe(source.component_class(), source.name, start_values)
    root.set("generationTool", f"seatrial {__version__}")
    simulation = root.find("CoSimulation")
    assert simulation is not None
    simulation.set("modelIdentifier", source.stem)
    simulation.set("needsExecutionTool", "false")
    simulation.set("canBeInstantiatedOnlyOncePerProcess", "false")
    listed = SubElement(simulation, "SourceFiles")
    for name in sorted(sources):
        if name.endswith(".c"):
            SubElement(listed, "File", {"name": name})
    root.set("guid", "")
    digest = hashlib.sha256(tostring(root))
    for name, content in sorted(sources.items()):
        digest.update(name.encode() + b"\0" + hashlib.sha256(content).digest())
    root.set("guid", f"{{{digest.hexdigest()[:32]}}}")
    return root
