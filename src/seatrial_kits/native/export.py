"""Components to native FMUs: co-simulation of FMI 2.0 or 3.0 in C, with its sources."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from xml.etree.ElementTree import Element, SubElement, tostring

import fmpy

from seatrial import __version__
from seatrial.errors import InputError
from seatrial.fmi.building.packing import described_files, zipped
from seatrial.fmi.cache import write_named
from seatrial.fmi.compiler import HERE, SEMANTICS, TARGETS, TUPLES, library
from seatrial.fmi.components.source import ComponentSource
from seatrial.fmi.description import describe
from seatrial.fmi.forwarding.sources import SEAL
from seatrial.fmi.version3.description import build_description
from seatrial.fmi.version3.sources import front_sources
from seatrial.model.component import Component
from seatrial.model.plant import Plant

from .carriers import checked, refuse
from .equations import header as plant_header
from .equations import model, require_start
from .selfcheck import refuse_difference
from .statements import Translation
from .tables import header

_OWN = Path(__file__).parent
_HEADERS = ("fmi2Functions.h", "fmi2FunctionTypes.h", "fmi2TypesPlatform.h")
"""FMI's own (2-clause BSD, as they say), from FMPy: they travel with the sources."""


def build_native_fmu(
    source: ComponentSource,
    destination: Path,
    platforms: Sequence[str],
    start_values: Mapping[str, Any] | None = None,
    compiled: Callable[[Mapping[str, bytes], str], bytes] = library,
    version: int = 2,
    given: Mapping[str, Any] | None = None,
    *,
    surrounded: bool = False,
) -> Path:
    """Build the native FMU of ``source`` at ``destination`` (a file) and return its path.

    ``start_values`` (by port name, SI) are baked in; text parameters, waves, current and wind
    cannot change afterwards. ``surrounded`` says that the FMU will meet weather, which its host
    evaluates (`surroundings.surround`): its numbers may change before each run then. ``version``
    of FMI is 2 or 3. The same input gives the same bytes.
    Where its binary runs on this machine, it has done the same as the Python (`selfcheck`), also
    with the values ``given`` before a run (by scalar).
    Raises InputError for a component that has no C, naming the line, values it cannot start
    with, for a difference from the Python, and without a compiler; nothing is written then.
    """
    cls = source.component_class()
    refuse(source)
    made = partial(_made, source, start_values or {})
    sources, own = _sources(made, given or {}, source.origin, surrounded)
    example = cls(source.name)
    if version == 3:
        sources |= front_sources(example)
    root = _described(source, sources, start_values or {})
    sources["model.h"] = header(example, str(root.get("guid")), own).encode()
    files = {f"sources/{name}": content for name, content in sources.items()}
    if version == 3:
        names = [name for name in sorted(sources) if name.endswith(".c")]
        files["sources/buildDescription.xml"] = build_description(source.stem, names, SEMANTICS)
    for platform in platforms:
        folder = TUPLES[platform] if version == 3 else platform
        name = f"{source.stem}{TARGETS[platform][1]}"
        files[f"binaries/{folder}/{name}"] = compiled(sources, platform)
    files |= described_files(root, example, version)
    content = zipped(files)
    if HERE in platforms:
        with TemporaryDirectory() as folder:
            built = Path(folder, destination.name)
            built.write_bytes(content)
            refuse_difference(source, built, start_values or {}, given or {}, surrounded)
    destination.parent.mkdir(parents=True, exist_ok=True)
    write_named(destination, content)
    return destination


def _made(source: ComponentSource, values: Mapping[str, Any]) -> Component:
    component = source.component_class()(source.name)
    for port, value in values.items():
        component.set(port, value)
    return component


def _sources(
    made: Callable[[], Component], given: Mapping[str, Any], name: str, surrounded: bool
) -> tuple[dict[str, bytes], str]:
    """Return the sources by file name, but for ``model.h``, and what that has of its own.

    Whether a plant can start is found out with the values ``given`` before a run, by scalar.
    """
    folder = Path(fmpy.__file__).parent / "c-code"
    component = made()
    if isinstance(component, Plant):
        run = made()
        for scalar, value in given.items():
            run.set(scalar, value)
        assert isinstance(run, Plant)
        require_start(run, name)
        if getattr(run, "_met", None) is not None and not surrounded:
            raise InputError(
                f"{name}: a native FMU is built in still water and air, found waves, a current or "
                "wind among its parameters"
            )
        text, own = model(component, surrounded), plant_header(component, surrounded)
        parts = ["plant.c", "together.inc", "sines.inc"]
    else:
        translation = Translation(component)
        checked(made(), name)
        text, own, parts = translation.model(), translation.header(), translation.parts()
    ours = [*(_OWN / each for each in ("component.h", "fmi2.c", *parts)), SEAL]
    return {
        "model.c": text.encode(),
        **{each.name: each.read_bytes() for each in ours},
        **{each: (folder / each).read_bytes() for each in _HEADERS},
    }, own


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
    if issubclass(source.component_class(), Plant):
        simulation.set("providesDirectionalDerivative", "true")
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
