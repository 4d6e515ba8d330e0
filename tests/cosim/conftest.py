"""Rigs of users' small components, in either carrier."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from seatrial.sim.master import Master
from seatrial.system.assembling.assembly import assemble
from seatrial.system.flattening import load_rig
from seatrial.system.system import System

from .. import users
from . import bodies


class Bench:
    """Writes a rig file beside the components and assembles it."""

    def __init__(self, folder: Path, engine: str) -> None:
        self.folder, self.engine = folder, engine
        (folder / "users.py").write_text(users.CHAIN, "utf-8")
        (folder / "bodies.py").write_text(bodies.TEXT, "utf-8")
        self.systems: list[System] = []

    def system(
        self, components: str, connections: str = "", top: str = 'step = "100 ms"'
    ) -> System:
        path = self.folder / "rig.toml"
        path.write_text(f"{top}\n[components]\n{components}\n[connections]\n{connections}\n")
        self.systems.append(assemble(load_rig(str(path)), self.engine))
        return self.systems[-1]

    def master(self, *arguments: str, **options: str) -> Master:
        master = Master(self.system(*arguments, **options))
        master.initialise()
        return master


@pytest.fixture(params=["fmu", "direct"])
def bench(request: pytest.FixtureRequest, tmp_path: Path):
    bench = Bench(tmp_path, request.param)
    yield bench
    for system in bench.systems:
        system.free()


@pytest.fixture
def direct(tmp_path: Path) -> Callable[..., System]:
    return Bench(tmp_path, "direct")


def value(master: Master, name: str):
    component, _, port = name.partition(".")
    return master.signals[master.names.index((component, port))]
