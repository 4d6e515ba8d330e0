"""FMUs that carry Python: hosts without one, hosts with one, and what cannot be built."""

from __future__ import annotations

import ctypes
import subprocess
from pathlib import Path

import fmpy
import pytest
from pymavlink import mavutil

from seatrial.errors import InputError
from seatrial.fmi.building.export import build_fmu
from seatrial.fmi.components.source import ComponentSource, find_source
from seatrial_kits.native.standalone.distribution import distributions, files_of
from seatrial_kits.native.standalone.export import build_standalone_fmu
from seatrial_kits.native.standalone.shared_objects import least_glibc
from tests.bwrap import needs_bwrap
from tests.command import seatrial
from tests.interop.running import free_port

HOST = Path(__file__).parents[2] / "fmi" / "slaves" / "paced_host.c"
HEADERS = Path(fmpy.__file__).parent / "c-code"


def built(name: str, folder: Path) -> Path:
    source = find_source(name, Path.cwd())
    assert isinstance(source, ComponentSource)
    path = folder / f"{source.name}.fmu"
    build_standalone_fmu(source, path)
    return path


@pytest.fixture(scope="module")
def gnss(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return built("gnss", tmp_path_factory.mktemp("standalone"))


def image_of(fmu: Path, folder: Path) -> tuple[list[str], str]:
    """Return a command that runs the host where there is glibc, the FMU and no other file."""
    image = folder / "image"
    fmpy.extract(str(fmu), str(image))
    host = image / "host"
    subprocess.run(["cc", f"-I{HEADERS}", HOST, "-o", host, "-ldl"], check=True)
    ldd = subprocess.run(["ldd", host], capture_output=True, text=True, check=True).stdout
    libraries = {word for word in ldd.split() if word.startswith("/")}
    folder_of_libc = next(Path(name).parent for name in libraries if "libc.so" in name)
    libraries |= {
        str(path)
        for name in ("libm.so.6", "libdl.so.2", "libpthread.so.0", "librt.so.1", "libutil.so.1")
        if (path := folder_of_libc / name).is_file()
    }
    bound = [a for each in sorted(libraries) for a in ("--ro-bind", each, each)]
    inside = ["bwrap", "--unshare-all", "--share-net", "--clearenv", *bound]
    inside += ["--dev", "/dev", "--proc", "/proc", "--ro-bind", str(image), "/fmu"]
    if subprocess.run([*inside, "/fmu/host"], capture_output=True).returncode != 2:
        pytest.skip("this system gives its users no namespaces")
    description = fmpy.read_model_description(str(fmu))
    library = f"/fmu/binaries/linux64/{description.coSimulation.modelIdentifier}.so"
    return [*inside, "/fmu/host", library], description.guid


RESOURCES = "file:///fmu/resources"


@pytest.mark.interop
@needs_bwrap
def test_a_ground_station_sees_a_vehicle_of_a_host_without_python(tmp_path: Path) -> None:
    """The link of `mavlink` in a C program that sees glibc and the FMU, and no other file."""
    fmu = built("mavlink", tmp_path)
    host, guid = image_of(fmu, tmp_path)
    references = {
        v.name: v.valueReference for v in fmpy.read_model_description(str(fmu)).modelVariables
    }
    station = mavutil.mavlink_connection(f"udpin:127.0.0.1:{(port := free_port())}")
    texts = [str(references["links"]), f"udpout:127.0.0.1:{port}"]
    with subprocess.Popen(
        [*host, guid, RESOURCES, "4", *texts],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as run:
        heartbeat = station.wait_heartbeat(timeout=60)
        status = station.recv_match(type="SYS_STATUS", blocking=True, timeout=10)
        out, err = run.communicate(timeout=60)
    station.close()
    # Status 0: nothing goes wrong in the exit handlers, which pythonfmu's library alone crashes in.
    assert (run.returncode, err) == (0, "")
    assert out.startswith("ready after")
    assert heartbeat.type == mavutil.mavlink.MAV_TYPE_SURFACE_BOAT
    assert status is not None


@pytest.mark.interop
def test_in_a_process_with_python_that_one_is_used(gnss: Path, tmp_path: Path) -> None:
    """FMPy, in this process: the same results as the FMU that needs a Python."""
    plain = build_fmu(find_source("gnss", Path.cwd()), tmp_path / "plain.fmu")  # type: ignore[arg-type]
    found, expected = (
        fmpy.simulate_fmu(str(each), stop_time=2.0, output_interval=0.05) for each in (gnss, plain)
    )
    assert found.tobytes() == expected.tobytes()
    assert ctypes.pythonapi.Py_IsInitialized()


@pytest.mark.interop
@needs_bwrap
def test_the_command_says_what_it_needs(gnss: Path, tmp_path: Path) -> None:
    run = seatrial("fmu", "build", "gnss", "--standalone", "--out", ".", cwd=tmp_path)
    assert run.returncode == 0
    assert "runs on Linux on x86-64 with glibc 2." in run.stdout
    assert (tmp_path / "gnss.fmu").read_bytes() == gnss.read_bytes()
    host, guid = image_of(gnss, tmp_path)
    steps = subprocess.run([*host, guid, RESOURCES, "0.2"], capture_output=True, text=True)
    assert (steps.returncode, steps.stderr) == (0, "")
    wrong = subprocess.run([*host, guid, "http://x/y", "0.2"], capture_output=True, text=True)
    assert (wrong.returncode, wrong.stderr) == (
        4,
        "x: fmi2Instantiate: the location of the resources is no file: http://x/y\n",
    )


@pytest.mark.long
@needs_bwrap
def test_packages_with_libraries_of_their_own_travel(tmp_path: Path) -> None:
    """CasADi's: libraries beside it, of the system, and plug-ins of solvers that are not here."""
    host, guid = image_of(built("marine-craft", tmp_path), tmp_path)
    run = subprocess.run([*host, guid, RESOURCES, "0.2"], capture_output=True, text=True)
    assert (run.returncode, run.stderr) == (0, "")


def test_it_is_native_or_standalone(tmp_path: Path) -> None:
    run = seatrial("fmu", "build", "gnss", "--standalone", "--native", cwd=tmp_path)
    assert run.returncode == 2
    assert "--native FMUs need no Python, --standalone ones carry it" in run.stderr


def test_distributions_and_what_they_need() -> None:
    found = distributions(["pymavlink>=2.4", 'nothing-at-all; python_version < "3"'])
    assert {"pymavlink", "lxml"} <= set(found)
    names = {name for name, _ in files_of(found["pymavlink"])}
    assert "pymavlink/mavutil.py" in names
    assert not any(name.endswith(".pyc") for name in names)
    with pytest.raises(InputError, match="nothing-at-all has to travel in the FMU: it is not"):
        distributions(["nothing-at-all"])
    with pytest.raises(InputError, match="install it, not a link to its sources"):
        list(files_of(distributions(["seatrial"])["seatrial"]))


def test_the_glibc_that_is_needed() -> None:
    assert least_glibc([b"..GLIBC_2.4\0GLIBC_2.17", b"GLIBC_2.9"]) == "2.17"
