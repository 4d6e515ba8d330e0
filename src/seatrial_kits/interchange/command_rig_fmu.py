"""``seatrial fmu build --rig``: a whole rig as one FMU."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from seatrial.cli.show import console, print_notes
from seatrial.errors import InputError
from seatrial.shipped import available
from seatrial.system.assembling.assembly import assemble
from seatrial.system.rig import Rig
from seatrial.system.system import Engine, System
from seatrial.system.unread import leave_out_unread
from seatrial_kits.native.engine import carry_natively

from .rig_changes import changed_rig, set_values
from .rig_fmu.native import build_native_rig, in_weather, why_not_native
from .rig_fmu.python import build_python_rig


@dataclass(frozen=True)
class RigBuild:
    """A rig to build, with what the command line changes in it."""

    name: str
    changes: Mapping[str, Any]
    variant: str | None = None
    seed: int = 1
    version: int = 2
    """Of FMI."""

    def build(self, out: Path, carrier: str, platforms: Sequence[str]) -> Path:
        """Build its FMU in the folder ``out``.

        ``carrier`` is "native", "standalone" or empty: in C if all components have C, else in
        Python. Empty ``platforms`` are those of that carrier. Raises InputError for what cannot be.
        """
        path = out / f"{Path(self.name).stem}.fmu"
        whys = [] if carrier == "standalone" else self._in_c(path, platforms or ("linux64",))
        if whys and (carrier == "native" or platforms):
            raise InputError(f"{self.name} cannot be one FMU in C; {'; '.join(whys)}")
        if whys or carrier == "standalone":
            self._in_python(path, carrier == "standalone")
        size = path.stat().st_size / 1000
        print_notes([f"in Python, as it has what cannot be in C: {why}" for why in whys])
        console.print(f"{path}  ({size:.0f} kB)", soft_wrap=True)
        return path

    def _in_c(self, path: Path, platforms: Sequence[str]) -> list[str]:
        """Build the FMU in C; return why not if that cannot be."""
        system = self._assembled("native")
        try:
            whys = why_not_native(system, carry_natively(system)) + in_weather(system)
            if not whys:
                build_native_rig(system, path, platforms, version=self.version)
                print_notes(system.notes)
                console.print(f"in C: {len(system.parts)} components", soft_wrap=True)
            return whys
        finally:
            system.discard()

    def _in_python(self, path: Path, standalone: bool) -> None:
        system = self._assembled("direct")
        try:
            glibc = build_python_rig(system, path, standalone=standalone, version=self.version)
            print_notes(system.notes)
        finally:
            system.discard()
        if glibc:
            print_notes([f"{path} runs on Linux on x86-64 with glibc {glibc} or newer"])

    def _assembled(self, engine: Engine) -> System:
        rig = _loaded(self.name, self.changes)
        system = assemble(rig, engine, variant=self.variant, seed=self.seed)
        try:
            leave_out_unread(system, set_values(system, self.changes))
        except BaseException:
            system.discard()
            raise
        return system


def _loaded(name: str, changes: Mapping[str, Any]) -> Rig:
    """Return the rig of a name, which may be that of a vehicle's rig, or of a file."""
    if not name.endswith(".toml") and name not in available("harness/rigs"):
        vehicles = available("harness/rigs/vehicles")
        if name in vehicles:
            name = str(vehicles[name])
    return changed_rig(name, changes)
