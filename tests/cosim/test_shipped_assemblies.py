"""Shipped vehicles under shipped autopilots, against connections that were written by hand."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from seatrial.errors import InputError
from seatrial.fmi.components.index import component_class
from seatrial.system.assembling.assembly import assemble
from seatrial.system.flattening import load_rig
from seatrial.system.references.values import port_scalars
from seatrial.system.system import System
from tests.kit import needs_kits

pytestmark = needs_kits("arduino", "fitted", "mavlink", "nmea", "sailing", "ships", "videoray")

BY_HAND = Path(__file__).parents[1] / "reference" / "connections"
RENAMED = {
    "propulsion_force": "force_1",
    "propulsion_moment": "moment_1",
}
SERVOS = {f"{name}_servo": f"servos.{name}" for name in ("rudder", "sail", "flap")}
THRUSTERS = {name: f"thrusters.{name}" for name in ("port", "starboard", "vertical", "propulsion")}
PATHS = {"gloria": SERVOS, "videoray": {"vehicle": "hull", **THRUSTERS}}
"""Components of the flat rigs that have another name in the vehicle."""
PORTS = {
    "mavlink.attitude.psi": "mavlink.heading",
    "mavlink.attitude.phi": "mavlink.roll_pitch.phi",
    "mavlink.attitude.theta": "mavlink.roll_pitch.theta",
    "mavlink.rates": "mavlink.gyro",
}
LATER = {
    "hydrone": {
        "guidance.depth_wanted mavlink.nav_depth",
        "compass.valid heading_hold.heading_valid",
        "imu.valid mavlink.gyro_valid",
        *(f"{side}_thruster.{what} mavlink.motor_{what}.m{n}" for n, side in enumerate(("port", "starboard"), 1) for what in ("speed", "current")),
    },
    "mariner": {
        "guidance.depth_wanted mavlink.nav_depth",
        "imu.valid mavlink.imu_valid",
        "imu.valid mavlink.gyro_valid",
        "helm.rudder rudder.angle",
        "rudder.pulse mavlink.pulse.ch1",
    },
    "gloria": {
        "imu.valid mavlink.imu_valid",
        "imu.valid mavlink.gyro_valid",
        "servos.sail.speed boat.sail_rate",
        *(f"{a} {n}.angle" for a, n in [("helm.rudder", "rudder"), ("trimmer.sail", "sail"), ("trimmer.flap", "flap")]),
        *(f"{n}.pulse mavlink.pulse.ch{i}" for i, n in enumerate(("rudder", "flap", "sail"), 1)),
    },
    "videoray": {
        *(f"allocation.{n} mavlink.share.{n}" for n in ("port", "starboard", "vertical")),
        "ahrs.valid mavlink.imu_valid",
        "imu.gyro mavlink.gyro",
        "imu.valid mavlink.gyro_valid",
        *(f"hull.{port} imu.{port}" for port in ("attitude", "rates", "acceleration")),
        "ahrs.valid mavlink.heading_valid",
        "ahrs.valid heading_hold.heading_valid",
        "ahrs.euler.psi mavlink.heading",
        "ahrs.euler.phi mavlink.roll_pitch.phi",
        "ahrs.euler.theta mavlink.roll_pitch.theta",
        "depth.depth mavlink.depth",
        "depth.valid mavlink.depth_valid",
        "depth.valid depth_hold.depth_valid",
        "positioning.position_n guidance.position_n",
        "positioning.position_n mavlink.position_n",
    },
}  # fmt: skip
"""Members that join since; failures are let out, and so is what they replace."""
GONE = {
    "videoray": {
        "ahrs.euler mavlink.attitude",
        "depth.depth mavlink.position_n.down",
        *(f"positioning.position_n.{a} {c}.position_n.{a}" for a in ("north", "east") for c in ("guidance", "mavlink")),
    },
}  # fmt: skip


@pytest.fixture
def sil():
    systems: list[System] = []

    def build(**choices: str) -> System:
        systems.append(assemble(load_rig("sil", None, choices), "direct"))
        return systems[-1]

    yield build
    for system in systems:
        system.free()


def short(name: str, system: System) -> str:
    """Return a port's name as the flat rigs had it: without the rigs around it."""
    part, port = system.located(name, name)[0]
    path = part.name.removeprefix("vehicle.").removeprefix("autopilot.").removeprefix("pilot.")
    return f"{path}.{port}"


def by_hand(vehicle: str) -> set[str]:
    """Return what the flat rig connected, with the names of today."""
    found = set()
    for line in (BY_HAND / f"{vehicle}-mavlink.txt").read_text().splitlines():
        if line in GONE.get(vehicle, ()) or ".failure." in line:
            continue
        ends = []
        for end in line.split():
            component, port = (PORTS.get(end) or end).split(".", 1)
            port = RENAMED.get(port, port)
            ends.append(f"{PATHS.get(vehicle, {}).get(component, component)}.{port}")
        found.add(" ".join(ends))
    return found


@pytest.mark.parametrize("vehicle", ["hydrone", "gloria", "videoray", "mariner"])
def test_terminals_join_what_was_connected_by_hand(vehicle: str, sil) -> None:
    system = sil(vehicle=vehicle, autopilot="mavlink")
    joined = {
        f"{short(j.source, system)} {short(j.target, system)}"
        for j in system.joints
        if ".tunable." not in j.source and ".failure." not in j.source
    }
    by_scalar = scalars(by_hand(vehicle) | LATER[vehicle], system)
    assert scalars(joined, system) == by_scalar


def scalars(pairs: set[str], system: System) -> set[tuple[str, str]]:
    """Return connections scalar by scalar."""
    paths = {short(f"{name}.x", system).removesuffix(".x"): name for name in system.parts}
    found = set()
    for pair in pairs:
        ends = []
        for end in pair.split():
            component = next(
                p for p in sorted(paths, key=len, reverse=True) if end.startswith(f"{p}.")
            )
            port = end.removeprefix(f"{component}.")
            variables = system.parts[paths[component]].instance.variables
            ends.append([f"{component}.{v.name}" for v in port_scalars(variables, port)])
            assert ends[-1], end
        found |= set(zip(*ends, strict=True))
    return found


@pytest.mark.parametrize(
    "vehicle",
    [
        "hydrone",
        "gloria",
        "videoray",
        "mariner",
        "kvlcc2",
        "otter",
        "bluerov2",
        "remus100",
        "glider",
        "wam-v",
        "supply-ship",
    ],
)
def test_tunables_start_at_what_they_set(vehicle: str, sil) -> None:
    system = sil(vehicle=vehicle, autopilot="mavlink")
    (tuning,) = system.tunings
    text = system.parts["autopilot.mavlink"].given["tunables"].value
    assert [entry.split()[0] for entry in text.split(";")] == [t.name for t in tuning.tunables]
    starts = [float(entry.split()[1]) for entry in text.split(";")]
    fed = {c.target: c for c in system.connections if ".tunable." in ".".join(c.source)}
    for start, tunable, targets in zip(starts, tuning.tunables, tuning.targets, strict=True):
        assert tunable.min <= start <= tunable.max
        for component, name in targets:
            port = component_class(system.parts[component].fmu).ports[name]
            assert port.tunable
            given = system.parts[component].given.get(name)
            value = port.start[0] if given is None else given.value
            connection = fed[component, name]
            assert connection.factor * start + connection.offset == pytest.approx(value, rel=1e-12)


def test_a_target_that_is_set_moves_the_start_of_its_tunable(sil) -> None:
    system = sil(autopilot="mavlink")
    system.set("autopilot.pilot.guidance.cruise_speed", "0.5 m/s", "test")
    assert "CRUISE_SPEED 0.5 0.0 1.5" in system.parts["autopilot.mavlink"].given["tunables"].value
    with pytest.raises(InputError, match=r"CRUISE_SPEED sets .*cruise_speed, which is 2\.0"):
        system.set("autopilot.pilot.guidance.cruise_speed", "2 m/s", "test")


def test_the_home_of_a_rig_is_that_of_all_links_in_it() -> None:
    """The fleet's boats are 100 m apart, however deep their links stand."""
    system = assemble(load_rig("fleet"), "direct")
    places = [
        tuple(
            system.parts[f"{boat}.autopilot.mavlink"].given[port].value
            for port in ("latitude", "longitude")
        )
        for boat in ("hydrone", "videoray", "gloria")
    ]
    system.free()
    degrees = [tuple(round(math.degrees(angle), 9) for angle in place) for place in places]
    assert degrees == [(-31.78, -52.26), (-31.78, -52.259), (-31.779, -52.26)]


@pytest.mark.parametrize("wanted", ["source", "consistent"])
def test_a_variant_reaches_the_vehicle_inside(wanted: str) -> None:
    system = assemble(load_rig("sil"), "direct", variant=wanted)
    given = system.parts["vehicle.hull"].given["coriolis"]
    system.free()
    assert given.value == {"source": "diagonal", "consistent": "full"}[wanted]
    assert f"variant {wanted}" in given.origin


def test_a_variant_that_no_vehicle_inside_has_is_refused() -> None:
    with pytest.raises(InputError, match="unknown variant 'sauce'; did you mean 'source'"):
        assemble(load_rig("sil"), "direct", variant="sauce")


@pytest.mark.parametrize(
    ("choices", "said"),
    [
        ({"vehicle": "gloria", "autopilot": "station-keeping"}, "actuators"),
        ({"vehicle": "gloria", "autopilot": "pro4"}, "unknown section 'links.topside"),
        ({"vehicle": "mariner", "autopilot": "sketch"}, "unknown section 'links.mega"),
        ({"vehicle": "hydrona"}, "did you mean 'vehicles/hydrone'"),
    ],
)
def test_an_autopilot_that_does_not_fit_is_refused_before_the_start(choices, said, sil) -> None:
    with pytest.raises(InputError, match=said):
        sil(**choices)


@pytest.mark.parametrize(
    "vehicle",
    [
        "hydrone",
        "gloria",
        "mariner",
        "kvlcc2",
        "videoray",
        "otter",
        "bluerov2",
        "remus100",
        "glider",
        "wam-v",
        "supply-ship",
    ],
)
def test_a_tether_fits_any_vehicle(vehicle: str, tmp_path: Path) -> None:
    path = tmp_path / "tow.toml"
    path.write_text(
        f'step = "10 ms"\n[components]\nloop = {{ rig = "sil", choices = {{ vehicle = "{vehicle}" }} }}\n'
        'tether = { fmu = "tether", parameters = "tether" }\n'
        '[connections]\n"loop.attachment" = "tether.bottom"\n'
    )
    system = assemble(load_rig(str(path)), "direct")
    joined = {
        tuple(name.rpartition(".")[2] for name in (joint.source, joint.target))
        for joint in system.joints
        if "tether" in (joint.source.split(".")[0], joint.target.split(".")[0])
    }
    system.free()
    assert joined == {
        ("attachment_point", "bottom_position"),
        ("attachment_velocity", "bottom_velocity"),
        ("force", "attachment_force"),
    }
