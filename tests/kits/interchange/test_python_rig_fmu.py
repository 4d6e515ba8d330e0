"""A rig as one FMU in Python: what has no C, links to the outside, the rig in process."""

from __future__ import annotations

import subprocess
from pathlib import Path

import fmpy
import pytest
from fmpy.validation import validate_fmu
from pymavlink import mavutil

from seatrial import Simulation
from seatrial.errors import InputError
from seatrial.fmi.loading.load import load_fmu, open_instance
from seatrial.system.assembling.assembly import assemble
from seatrial.system.flattening import load_rig
from seatrial_kits.interchange.rig_fmu.face import face_of
from seatrial_kits.interchange.rig_fmu.frozen import rig_source
from seatrial_kits.interchange.rig_fmu.python import build_python_rig
from tests.bwrap import needs_bwrap
from tests.command import seatrial
from tests.interop.running import free_port
from tests.kits.interchange.test_rig_fmu import RIG, TEXT, bits
from tests.kits.native.test_standalone import RESOURCES, image_of


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("rigs")
    (folder / "bodies.py").write_text(TEXT, "utf-8")
    for algorithm in ("jacobi", "iterated"):
        text = RIG.format(algorithm=algorithm).replace("hold  =", 'total = {{ sum = {{ inputs = 2 }} }}\nhold  ='.format())  # fmt: skip
        text = text.replace(', step = "30 ms"', "") if algorithm == "iterated" else text
        text = text.replace('"mass.x"     = "hold.place"', '"mass.x" = ["hold.place", { to = "total.in[0]", convert = false }]')  # fmt: skip
        (folder / f"{algorithm}.toml").write_text(text, "utf-8")
    return folder


def component_of(rig: Path):
    system = assemble(load_rig(str(rig)), "direct")
    try:
        return rig_source(system, face_of(system), "rig").component_class()("rig")
    finally:
        system.free()


@pytest.mark.parametrize("algorithm", ["jacobi", "iterated"])
def test_the_numbers_of_the_rig(algorithm: str, folder: Path) -> None:
    """Loop, sum, conversions, a longer step; values set before and on the way; save and restore."""
    rig = component_of(folder / f"{algorithm}.toml")
    rig.set("mass.x_start", 0.4)
    rig.setup(0.0)
    rig.initialise()
    rig.set("hold.wanted", 0.1)
    outputs = [s.name for s in rig.scalars if s.port.kind == "output"]
    assert "total.out" in outputs
    rig.begin()
    states = []
    values = {"mass.x_start": 0.4, "hold.wanted": 0.1}
    with Simulation(folder / f"{algorithm}.toml", set=values) as simulation:
        for k in range(60):
            found = [rig.get(name) for name in outputs]
            assert bits(found) == bits([simulation.get(name) for name in outputs])
            if k == 30:
                states = [rig.get_state(), found]
                rig.set("mass.drag", 0.5)
                simulation.set("mass.drag", 0.5)
            rig.advance(k * 0.01, 0.01)
            simulation.step()
    last = [rig.get(name) for name in outputs]
    rig.set_state(states[0])
    assert bits([rig.get(name) for name in outputs]) == bits(states[1])
    rig.set("mass.drag", 0.5)
    rig.advance(0.3, 0.3)
    assert bits([rig.get(name) for name in outputs]) == bits(last)
    with pytest.raises(InputError, match=r"no whole multiple of this rig's, 0\.01 s"):
        rig.advance(0.6, 0.025)
    rig.close()


def test_the_fmu_in_a_rig(folder: Path, tmp_path: Path) -> None:
    system = assemble(load_rig(str(folder / "jacobi.toml")), "direct")
    try:
        build_python_rig(system, tmp_path / "box.fmu", standalone=False)
    finally:
        system.free()
    assert validate_fmu(str(tmp_path / "box.fmu")) == []
    fmu = load_fmu(tmp_path / "box.fmu")
    assert not fmu.any_step
    assert fmu.terminals["wrench"].members == {"force": "mass.push"}
    box = open_instance(fmu, "box")
    box.set_start({"mass.x_start": 0.4})
    box.initialise(0.0, 10.0)
    box.begin()
    read = box.reader(["mass.x", "other.y", "hold.force"])
    with Simulation(folder / "jacobi.toml", set={"mass.x_start": 0.4}) as simulation:
        for k in range(20):
            if k == 10:
                kept = box.get_state()
            box.step(k * 0.01, 0.01)
            simulation.step()
        names = ("mass.x", "other.y", "hold.force")
        assert bits(read()) == bits([simulation.get(name) for name in names])
        box.set_state(kept)
        box.step(0.1, 0.1)
        assert bits(read()) == bits([simulation.get(name) for name in names])
    box.terminate()
    box.free()


def test_what_it_became_is_said(tmp_path: Path) -> None:
    run = seatrial("fmu", "build", "--rig", "tether-towed", cwd=tmp_path)
    assert run.returncode == 0, run.stderr
    assert "in Python, as it has what cannot be in C: tether: " in run.stdout + run.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["tether-towed.fmu"]


def ground_station(
    command: list[str], port: int
) -> tuple[object, subprocess.CompletedProcess[str]]:
    """Return the heartbeat that a ground station gets while a host runs, and how that ended."""
    station = mavutil.mavlink_connection(f"udpin:127.0.0.1:{port}")
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as run:
        heartbeat = station.wait_heartbeat(timeout=60)
        out, err = run.communicate(timeout=120)
    station.close()
    return heartbeat, subprocess.CompletedProcess(command, run.returncode, out, err)


@pytest.mark.long
@needs_bwrap
def test_a_whole_vehicle_in_a_host_without_python(tmp_path: Path) -> None:
    """Hull, sensors, pilot and MAVLink in one box; its host sees glibc, the FMU and no other file."""
    chosen = ["--vehicle", "hydrone", "--autopilot", "mavlink", "--standalone"]
    run = seatrial("fmu", "build", "--rig", "sil", *chosen, cwd=tmp_path)
    assert run.returncode == 0, run.stderr
    host, guid = image_of(tmp_path / "sil.fmu", tmp_path)
    description = fmpy.read_model_description(str(tmp_path / "sil.fmu"))
    links = next(v for v in description.modelVariables if v.name == "autopilot.mavlink.links")
    port = free_port()
    texts = [str(links.valueReference), f"udpout:127.0.0.1:{port}"]
    heartbeat, ended = ground_station([*host, guid, RESOURCES, "4", *texts], port)
    assert (ended.returncode, ended.stderr) == (0, "")
    assert heartbeat.type == mavutil.mavlink.MAV_TYPE_SURFACE_BOAT
