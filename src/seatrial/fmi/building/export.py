"""Components to FMUs: self-contained, reproducible ``.fmu`` files."""

from __future__ import annotations

import hashlib
import json
import zipfile
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, tostring

import pythonfmu

from ... import __version__
from ...errors import InputError
from ..cache import cache_folder, write_named
from ..compiler import HERE
from ..components.source import ComponentSource
from ..dependencies.checked import refuse_mistakes
from ..description import describe
from ..forwarding.libraries import Compiler, bare_libraries, checked_libraries
from ..slave import START_VALUES
from .bundle import bundled
from .packing import described_files, zipped

_DESCRIBING = ("description", "building/export", "building/packing", "files/terminals")


def build_fmu(
    source: ComponentSource,
    destination: Path,
    start_values: Mapping[str, Any] | None = None,
    version: int = 2,
    platforms: Sequence[str] = (),
    compiled: Compiler | None = None,
) -> Path:
    """Build the FMU of ``source`` at ``destination`` (a file) and return its path.

    ``start_values`` (by port name, SI) are baked in as start values. ``version`` of FMI is 2 or 3.
    The FMU runs on the ``platforms`` named, where it checks every call; without any, one of FMI
    2.0 runs on all that pythonfmu has, and checks them on this one, if a compiler is here. The
    same input gives the same bytes.

    Raises InputError for a component that cannot be imported, a start value that does not fit its
    port, a platform that pythonfmu has not, and without a compiler for those named; nothing is
    written then.
    """
    content = fmu_bytes(source, start_values, version, platforms, compiled)
    destination.parent.mkdir(parents=True, exist_ok=True)
    write_named(destination, content)
    return destination


def cached_fmu(source: ComponentSource, code: str) -> Path:
    """Return the FMU of ``source`` in the user's cache, built if it is not there yet.

    ``code`` is the script's name in its bundle, which carries the hash of all its code. It is for
    our own host, which checks what it calls: nothing is compiled.
    """
    path = cache_folder("fmus") / f"{code}-{_tool_tag()}.fmu"
    if not zipfile.is_zipfile(path):
        write_named(path, zipped(fmu_files(source, None, bare_libraries(source.stem))))
    return path


def fmu_bytes(
    source: ComponentSource,
    start_values: Mapping[str, Any] | None = None,
    version: int = 2,
    platforms: Sequence[str] = (),
    compiled: Compiler | None = None,
) -> bytes:
    """Return the content of the FMU file; see `build_fmu`."""
    if platforms or version == 3:
        component = source.component_class()(source.name)
        carried = checked_libraries(source.stem, platforms, version, compiled, component)
    else:
        carried = bare_libraries(source.stem)
        with suppress(InputError):
            carried |= checked_libraries(source.stem, [HERE], version, compiled)
    return zipped(fmu_files(source, start_values, carried, version))


def fmu_files(
    source: ComponentSource,
    start_values: Mapping[str, Any] | None,
    carried: Mapping[str, bytes],
    version: int = 2,
) -> dict[str, bytes]:
    """Return the files of a component's FMU by path, with those ``carried`` besides its own."""
    bundle = bundled(source)
    files = {f"resources/{name}": data for name, data in bundle.files.items()}
    if start_values:
        text = json.dumps(dict(sorted(start_values.items())), indent=1)
        files[f"resources/{START_VALUES}"] = text.encode()
    files |= carried
    root = _model_description(source, files, start_values or {})
    return described_files(root, source.component_class()(source.name), version) | files


def _model_description(
    source: ComponentSource, files: Mapping[str, bytes], start_values: Mapping[str, Any]
) -> Element:
    cls = source.component_class()
    refuse_mistakes(cls)
    root = describe(cls, source.name, start_values)
    root.set("generationTool", f"seatrial {__version__}, pythonfmu {pythonfmu.__version__}")
    simulation = root.find("CoSimulation")
    assert simulation is not None
    simulation.set("modelIdentifier", source.stem)
    root.set("guid", "")
    digest = hashlib.sha256(tostring(root))
    for name, data in sorted(files.items()):
        digest.update(name.encode() + b"\0" + hashlib.sha256(data).digest())
    root.set("guid", f"{{{digest.hexdigest()[:32]}}}")
    return root


def _tool_tag() -> str:
    """Return a tag of what besides the bundle decides an FMU's bytes."""
    digest = hashlib.sha256(f"{__version__} {pythonfmu.__version__}".encode())
    fmi = Path(__file__).parents[1]
    modules = [fmi / f"{name}.py" for name in _DESCRIBING]
    for module in (*modules, *sorted(fmi.glob("dependencies/*.py"))):
        digest.update(module.read_bytes())
    return digest.hexdigest()[:8]
