"""An FMU file as read: where it lies unpacked, and what its model description says."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import fmpy
from fmpy.model_description import ModelDescription

from ...model.terminals import Terminal
from ..clocks import Clocks
from ..files.lsbus import BusTerminal
from ..files.modelfile import ModelFile
from ..files.options import DEFAULTS, INTERFACES, FmuOptions, Interface
from ..files.variables import Array
from ..instance import Variables


@dataclass(frozen=True)
class LoadedFmu:
    """An FMU file unpacked and described; instances are made from it."""

    path: Path
    folder: Path
    sha256: str
    description: ModelDescription
    """Without its variables."""
    model: ModelFile
    """What ``description`` was read from, which has more."""
    views: Mapping[str, Mapping[str, str]]
    """What reports draw of it; see `ports.VIEWS`."""
    variables: Variables = field(default_factory=Variables)
    arrays: Mapping[int, Array] = field(default_factory=dict)
    """What each value reference of an FMI 3 FMU stands for."""
    feedthrough: Mapping[str, Sequence[str]] = field(default_factory=dict)
    others: frozenset[str] = frozenset()
    """Names of variables that are no signals here."""
    terminals: Mapping[str, Terminal] = field(default_factory=dict)
    """Groups of variables that are connected together."""
    notes: tuple[str, ...] = ()
    """What this FMU has that cannot be used here, for its user."""
    clocks: Clocks = field(default_factory=Clocks)
    buses: Sequence[BusTerminal] = ()
    """Terminals of FMI-LS-BUS, whose data and clocks are two ports here."""
    options: FmuOptions = DEFAULTS
    origin: Path | None = None
    """Where the user's modules lie that it has copies of, if somebody knows."""
    built: Path | None = None
    """Folder with what was built of its sources, if the archive has no library for this machine."""

    @property
    def version(self) -> int:
        """Major version of FMI."""
        return int(self.description.fmiMajorVersion)

    @property
    def interfaces(self) -> list[Interface]:
        """What it has of the interfaces that are used here."""
        has = (self.description.coSimulation, self.description.modelExchange)
        return [name for name, one in zip(INTERFACES, has, strict=True) if one is not None]

    @property
    def interface(self) -> Interface:
        """The one that instances use."""
        return self.options.interface or self.interfaces[0]

    @property
    def simulation(self) -> Any:
        """What its model description says of that interface."""
        description = self.description
        of = {
            "co-simulation": description.coSimulation,
            "model exchange": description.modelExchange,
        }
        return of[self.interface]

    @property
    def rolls_back(self) -> bool:
        """Whether the whole state can be saved and restored."""
        return bool(self.simulation.canGetAndSetFMUstate)

    @property
    def any_step(self) -> bool:
        """Whether it takes steps of different lengths."""
        if self.interface == "model exchange":
            return True
        if self.version == 1:
            return self._says("canHandleVariableCommunicationStepSize")
        return bool(self.simulation.canHandleVariableCommunicationStepSize)

    @property
    def tolerance(self) -> float | None:
        """The relative tolerance to use: of the options, else of its default experiment."""
        if self.options.tolerance is not None:
            return self.options.tolerance
        said = self.description.defaultExperiment
        try:
            found = float(said.tolerance)
        except (AttributeError, TypeError, ValueError):
            return None
        return found if 0.0 < found < math.inf else None

    def takes_tolerance(self, interface: Interface | None) -> bool:
        """Return whether its functions take a tolerance, with an interface, or its first."""
        return self.version > 1 or (interface or self.interfaces[0]) == "model exchange"

    @property
    def at_once(self) -> bool:
        """Whether it is initialised in one call, for which inputs are set before."""
        return self.version == 1

    @property
    def only_once(self) -> bool:
        """Whether a process can have one instance only."""
        if self.version == 1:
            return self._says("canBeInstantiatedOnlyOncePerProcess")
        return bool(self.simulation.canBeInstantiatedOnlyOncePerProcess)

    @property
    def platform(self) -> str:
        """This machine's, as its version of FMI calls it."""
        return str(fmpy.platform_tuple if self.version == 3 else fmpy.platform)

    @property
    def binary(self) -> Path:
        """Its library for this machine and its interface, which may not be there."""
        name = f"{self.simulation.modelIdentifier}{fmpy.sharedLibraryExtension}"
        return (self.built or self.folder) / "binaries" / self.platform / name

    @property
    def lacking(self) -> str:
        """What is missing of it to run here, where its library is not there; else empty."""
        having, library = self.platforms, self.binary
        if library.is_file():
            return ""
        if self.platform in having:
            return f"binaries/{self.platform} has no {library.name}"
        return (
            f"cannot be loaded on this machine, which needs binaries for {self.platform}, or "
            f"sources; the FMU has binaries for {', '.join(having) or 'no platform'}"
        )

    @property
    def platforms(self) -> list[str]:
        """Platforms that it has binaries for, as its folders call them."""
        binaries = (self.folder / "binaries").glob("*/*")
        return sorted({path.parent.name for path in binaries if path.is_file()})

    def _says(self, capability: str) -> bool:
        """Return a capability of FMI 1.0 co-simulation, which FMPy leaves out."""
        found = self.model.root.find("Implementation//Capabilities")
        return found is not None and found.get(capability) in ("true", "1")
