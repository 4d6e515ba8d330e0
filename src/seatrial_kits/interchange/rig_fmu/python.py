"""A rig with components that only Python has, as one FMU in Python."""

from __future__ import annotations

from pathlib import Path

from seatrial.errors import InputError, SimulationError
from seatrial.fmi.building.export import build_fmu
from seatrial.model.component import Component
from seatrial.system.registry import ALGORITHMS
from seatrial.system.system import System
from seatrial_kits.native.standalone.export import build_standalone_fmu

from .face import face_of
from .frozen import rig_source


def build_python_rig(
    system: System, destination: Path, *, standalone: bool, version: int = 2
) -> str:
    """Build the FMU of a rig, all of it in process, at ``destination``.

    A ``standalone`` one carries its Python; the version of glibc that it needs is returned then,
    else nothing. ``version`` of FMI is 2 or 3. A rig that does not reach outside is started, to
    see that it can. The same rig gives the same bytes. Raises InputError for a rig that cannot be
    one, or cannot start.
    """
    at_once = ALGORITHMS.load(system.rig.file.algorithm).follows_at_once
    face = face_of(system, at_once=at_once)
    source = rig_source(system, face, destination.stem)
    if all(part.instance.rolls_back for part in system.parts.values()):
        _start(source.component_class()(source.name), system)
    if standalone:
        return build_standalone_fmu(source, destination, version=version)
    build_fmu(source, destination, version=version, platforms=["linux64"] if version == 3 else [])
    return ""


def _start(component: Component, system: System) -> None:
    try:
        component.setup(0.0)
        component.initialise()
    except SimulationError as error:
        raise InputError(f"{system.rig.read_from.path}: the rig cannot start: {error}") from None
    finally:
        component.close()
