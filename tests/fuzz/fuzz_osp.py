"""OSP-IS: system structures, variable groups, and scenarios in JSON and YAML."""

from __future__ import annotations

import contextlib
import tempfile
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from seatrial.errors import InputError
from seatrial.trial.files.scenario import read_scenario
from seatrial_kits.interchange.osp.joining import Groups
from seatrial_kits.interchange.osp.structure import read_structure

_GROUPS = "x_OspModelDescription.xml"


def one(data: bytes) -> None:
    """Let every reader have the file."""
    with tempfile.TemporaryDirectory() as folder:
        for name in ("x.xml", _GROUPS, "x.json", "x.yml"):
            Path(folder, name).write_bytes(data)
        with contextlib.suppress(InputError):
            structure = read_structure(Path(folder, "x.xml"))
            assert all(each.source.suffix == ".fmu" for each in structure.simulators.values())
        with contextlib.suppress(InputError):
            _named(Path(folder))
        for name in ("x.json", "x.yml"):
            with contextlib.suppress(InputError):
                scenario = read_scenario(Path(folder, name))
                assert scenario.end_ns >= 0


def _named(folder: Path) -> None:
    fmu: Any = SimpleNamespace(
        path=folder / "x.fmu",
        description=SimpleNamespace(modelName="x"),
        variables=dict.fromkeys(("q[1]", "q[2]", "p[1]", "p[2]", "j", "r", "c", "i", "s", "b")),
    )
    Groups(fmu, folder).named("gives ints")
