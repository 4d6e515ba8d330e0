"""A rig whose components all have C, as one FMU in C."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import cast
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from seatrial.errors import InputError, SimulationError
from seatrial.fmi.building.packing import zipped
from seatrial.fmi.cache import write_named
from seatrial.fmi.compiler import SEMANTICS, TARGETS, TUPLES, library
from seatrial.fmi.files.terminals import PLACE, terminals_xml
from seatrial.fmi.version3.description import arrays, build_description, version3
from seatrial.fmi.version3.sources import front_sources
from seatrial.sim.compiled import choice
from seatrial.sim.compiled import library as master_library
from seatrial.sim.compiled.structures import CALL
from seatrial.sim.master import Master
from seatrial.system.part import Part
from seatrial.system.sums import SumInstance
from seatrial.system.system import System

from .description import describe_rig, scalars_of
from .face import Face, face_of
from .tables import RigTables

_OWN = Path(__file__).parent
_MASTER = Path(master_library.__file__).with_name("master.c")
_COMPONENT = """\
/* A component of a rig: its sources under names of their own, as others have the same. */
#include "fmi2Functions.h"
{fmi}
#define MODEL_H "{name}_model.h"
#define CASADI_CODEGEN_PREFIX
#define CODEGEN_PREFIX {name}_
#define CASADI_SYMBOL_EXPORT static __attribute__((unused))
#define seatrial_surround {name}_surround
{names}
{includes}

#define CARRIER {name}
#include "carrier.h"
"""
_SUM = """\
#define CARRIER {}
#define TERMS {}
#define OUTPUTS {}
#include "sum.inc"
"""
_DECLARED = re.compile(r"^(?!static|typedef)[a-z][\w *]*?\b(\w+)\([^;{}]*\);", re.MULTILINE)
"""A function that the files of the runtime share, in its headers."""


def why_not_native(system: System, in_python: Mapping[str, Sequence[str]]) -> list[str]:
    """Return why a rig cannot be one FMU in C, nothing if it can.

    ``in_python`` has, by reason, the components that have no C, as `carry_natively` returns them.
    """
    whys = [f"{', '.join(names)}: {why}" for why, names in in_python.items()]
    known = {name for names in in_python.values() for name in names}
    for part in system.parts.values():
        if part.name not in known and not part.is_sum and not _is_ours(part):
            what = "isolated" if part.fmu[-4:] != ".fmu" else "an FMU"
            whys.append(f"{part.name}: it is {what}")
    algorithm = system.rig.file.algorithm
    if algorithm not in choice.ALGORITHMS:
        whys.append(f"the algorithm {algorithm} is not compiled")
    whys += [
        f"{'.'.join(one.source)} -> {'.'.join(one.target)}: a value that is carried once"
        for one in system.initial
    ]
    return whys


def in_weather(system: System) -> list[str]:
    """Return which components of a rig meet weather, whose tables an FMU in C cannot make."""
    return [
        f"{part.name}: the tables of waves, current and wind around it are made in Python"
        for part in system.parts.values()
        if getattr(part.instance, "around", None)
    ]


def _is_ours(part: Part) -> bool:
    return bool(getattr(part.instance, "is_native", False)) and not part.fmu.endswith(".fmu")


@dataclass(frozen=True)
class RigInC:
    """The C of a rig, by file name, and what it is a rig of."""

    sources: Mapping[str, bytes]
    face: Face
    root: Element
    """Of its model description."""
    identifier: str
    guid: str
    step_ns: int


def rig_in_c(system: System, name: str, version: int = 2) -> RigInC:
    """Return the C of a rig of which `why_not_native` says nothing, as an FMU called ``name``.

    ``system`` has its parameters; it is started for that. Raises InputError if it cannot start,
    and for connections that only Python can make.
    """
    master = Master(system)
    try:
        master.initialise()
    except SimulationError as error:
        raise InputError(f"{system.rig.read_from.path}: the rig cannot start: {error}") from None
    network, program, begins = master.program()
    if any(one.kind == CALL for one in program.operations):
        raise InputError(
            f"{system.rig.read_from.path}: it has connections of texts, or with a mapping, which "
            "a rig in C cannot have"
        )
    at_once = master.algorithm.follows_at_once
    face = face_of(system, at_once=at_once)
    sources, carriers = _components(system)
    tables = RigTables(network, program, begins, face, carriers)
    sources["tables.c"] = tables.text().encode()
    sources["master.inc"] = _MASTER.read_bytes()
    for own in (path for path in _OWN.iterdir() if path.suffix in (".c", ".h", ".inc")):
        sources[own.name] = own.read_bytes()
    if version == 3:
        sources |= front_sources()
    title = system.rig.top.file.title or system.rig.read_from.name
    identifier = re.sub(r"\W", "_", name)
    root = describe_rig(face, name, identifier, title, master.step_ns)
    guid = _identified(root, sources)
    sources["sizes.h"] = tables.sizes(guid, master.step_ns, at_once=at_once).encode()
    return RigInC(sources, face, root, identifier, guid, master.step_ns)


def build_native_rig(
    system: System,
    destination: Path,
    platforms: Sequence[str],
    compiled: Callable[[Mapping[str, bytes], str], bytes] = library,
    version: int = 2,
) -> Path:
    """Build the FMU of a rig, of which `why_not_native` says nothing, at ``destination``.

    ``version`` of FMI is 2 or 3. The same rig gives the same bytes. Raises InputError as
    `rig_in_c` does, and for what the compiler finds; nothing is written then.
    """
    rig = rig_in_c(system, destination.stem, version)
    files = {f"sources/{file}": content for file, content in rig.sources.items()}
    for platform in platforms:
        folder = TUPLES[platform] if version == 3 else platform
        binary = f"binaries/{folder}/{rig.identifier}{TARGETS[platform][1]}"
        files[binary] = compiled(rig.sources, platform)
    files |= _described(rig.root, rig.face, [*rig.sources], version)
    destination.parent.mkdir(parents=True, exist_ok=True)
    write_named(destination, zipped(files))
    return destination


def _described(root: Element, face: Face, sources: Sequence[str], version: int) -> dict[str, bytes]:
    """Return what describes the FMU, as the version of FMI has it, by path."""
    files: dict[str, bytes] = {}
    whole: set[str] = set()
    if version == 3:
        units = [file for file in sorted(sources) if file.endswith(".c")]
        simulation = root.find("CoSimulation")
        identifier = "" if simulation is None else simulation.get("modelIdentifier", "")
        built = build_description(identifier, units, SEMANTICS)
        files["sources/buildDescription.xml"] = built
        scalars = scalars_of(face)
        whole = arrays(scalars, root)
        root = version3(root, scalars)
    if face.terminals:
        files[PLACE] = terminals_xml(face.terminals, face.variables, whole)
    indent(root)
    files["modelDescription.xml"] = tostring(root, encoding="UTF-8", xml_declaration=True)
    return files


def _identified(root: Element, sources: Mapping[str, bytes]) -> str:
    """List the sources in a model description, give it a GUID of all, and return that."""
    simulation = root.find("CoSimulation")
    assert simulation is not None
    listed = SubElement(simulation, "SourceFiles")
    for name in sorted(sources):
        if name.endswith(".c"):
            SubElement(listed, "File", {"name": name})
    digest = hashlib.sha256(tostring(root))
    for name, content in sorted(sources.items()):
        digest.update(name.encode() + b"\0" + hashlib.sha256(content).digest())
    root.set("guid", f"{{{digest.hexdigest()[:32]}}}")
    return root.get("guid", "")


def _components(system: System) -> tuple[dict[str, bytes], dict[str, str]]:
    """Return the sources of all components, and the name of each component's carrier.

    Components of the same code, such as two thrusters, share one.
    """
    sources: dict[str, bytes] = {}
    carriers: dict[str, str] = {}
    of_code: dict[str, str] = {}
    for name, part in system.parts.items():
        if part.is_sum:
            adding = cast(SumInstance, part.instance)
            carriers[name] = f"sum_{adding.terms}_{len(adding.feedthrough)}"
            text = _SUM.format(carriers[name], adding.terms, len(adding.feedthrough))
            sources[f"{carriers[name]}.c"] = text.encode()
            continue
        if part.sha256 not in of_code:
            of_code[part.sha256] = f"c{len(of_code)}"
            folder = part.instance.fmu.folder / "sources"  # type: ignore[attr-defined]
            own = {path.name: path.read_bytes() for path in folder.iterdir()}
            sources |= _prefixed(own, of_code[part.sha256])
        carriers[name] = of_code[part.sha256]
    return sources, carriers


def _prefixed(own: Mapping[str, bytes], name: str) -> dict[str, bytes]:
    """Return the sources of a component, as those of one unit whose names others do not have.

    What components have in common keeps its name.
    """
    texts = b"\n".join(own.values()).decode()
    headers = [own[file].decode() for file in ("component.h", "runtime.h") if file in own]
    shared = {name for text in headers for name in _DECLARED.findall(text)}
    renamed = sorted({*re.findall(r"\bmodel_\w+", texts), *shared})
    parts = [f for f in sorted(own) if f.endswith(".c") and f not in ("fmi2.c", "model.c")]
    included = ["fmi2.inc", *(f.replace(".c", ".inc") for f in parts), f"{name}_model.inc"]
    functions = re.findall(r"#define (fmi2\w+) +fmi2FullName", own["fmi2Functions.h"].decode())
    unit = _COMPONENT.format(
        name=name,
        fmi="\n".join(f"#undef {each}\n#define {each} {name}_{each}" for each in functions),
        names="\n".join(f"#define {each} {name}_{each}" for each in renamed),
        includes="\n".join(f'#include "{each}"' for each in included),
    )
    files = {f"{name}.c": unit.encode()}
    for file, content in own.items():
        place = f"{name}_{file}" if file.startswith("model.") else file
        files[re.sub(r"\.c$", ".inc", place)] = content
    return files
