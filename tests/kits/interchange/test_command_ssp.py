"""``seatrial ssp`` and ``seatrial run x.ssp`` from the command line."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from tests.command import seatrial
from tests.kits.interchange.ssp_files import BOATS, MINIMAL, Yard, speed

RIG = """step = "10 ms"
[components]
hull = { fmu = "boats.py:Hull", set = { mass = 8.0 } }
damper = { fmu = "boats.py:Damper" }
[connections]
"hull.v" = "damper.v"
"damper.force" = { to = "hull.force", factor = 2.0 }
"""


@pytest.fixture(scope="module")
def yard(tmp_path_factory: pytest.TempPathFactory) -> Yard:
    return Yard(tmp_path_factory.mktemp("yard"))


def test_export_check_and_run_go_together(write, tmp_path: Path) -> None:
    write("boats.py", BOATS)
    write("quay.toml", RIG)
    done = seatrial("ssp", "export", "quay.toml", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "a rig has no stop time" in done.stdout
    done = seatrial("ssp", "check", "quay.ssp", cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    assert "rejects" not in done.stdout
    done = seatrial(
        "run", "quay.ssp", "--set", "stop=1 s", "--set", "hull.mass=4", "--out", "run",
        cwd=tmp_path,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "run" / "report.html").is_file()
    with (tmp_path / "run" / "signals.csv").open(encoding="utf-8") as file:
        last = list(csv.DictReader(file))[-1]
    assert float(last["hull.v"]) == pytest.approx(speed(4.0, 1.0, seconds=1.0), rel=1e-12)


LOOP = """step = "10 ms"
[choices]
boat = "none"
[components]
loop = { rig = "{boat}.toml" }
"""


def test_a_rig_inside_a_rig_is_a_system_unless_the_tool_takes_none(write, tmp_path: Path) -> None:
    write("boats.py", BOATS)
    write("quay.toml", RIG)
    write("loop.toml", LOOP)
    for tool, signal in (("fmpy", "loop.hull.v"), ("libcosim", "loop_hull.v")):
        done = seatrial(
            "ssp", "export", "loop.toml", "--choose", "boat=quay", "--for", tool, cwd=tmp_path
        )
        assert done.returncode == 0, done.stderr
        done = seatrial("ssp", "check", "loop.ssp", "--for", tool, cwd=tmp_path)
        assert done.returncode == 0, done.stdout
        done = seatrial(
            "run", "loop.ssp", "--set", "stop=1 s", "--out", tool,
            cwd=tmp_path,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
        with (tmp_path / tool / "signals.csv").open(encoding="utf-8") as file:
            assert float(list(csv.DictReader(file))[-1][signal]) == pytest.approx(
                speed(8.0, 1.0, seconds=1.0), rel=1e-12
            )
    done = seatrial("ssp", "export", "loop.toml", "--for", "ecosim", cwd=tmp_path)
    assert done.returncode == 2
    assert "did you mean 'ecos'" in done.stderr


def test_the_status_says_what_is_rejected(yard: Yard, tmp_path: Path) -> None:
    yard.package(tmp_path / "x.ssp", MINIMAL.replace('"Minimal" version="1.0"', '"Minimal" version="1.1"'))  # fmt: skip
    for tool, status in (("libcosim", 0), ("ecos", 1), ("fmpy", 0), ("omsimulator", 0)):
        done = seatrial("ssp", "check", "x.ssp", "--for", tool, cwd=tmp_path)
        assert done.returncode == status, done.stdout
    assert "reads version 1.0 only" in seatrial("ssp", "check", "x.ssp", cwd=tmp_path).stdout


@pytest.mark.parametrize("extra", ["Elements", "Connections", "ParameterBindings", "Connectors"])
def test_a_second_list_is_rejected_by_name(yard: Yard, tmp_path: Path, extra: str) -> None:
    doubled = f"<ssd:{extra}/><ssd:{extra}/></ssd:System>"
    yard.package(tmp_path / "x.ssp", MINIMAL.replace("</ssd:System>", doubled))
    done = seatrial("ssp", "check", "x.ssp", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (1, "")
    assert f"a second ssd:{extra} in ssd:System" in done.stdout
    assert "validates against the schema" in done.stdout  # FMPy does, whose schema has one of each


def test_a_wrong_package_or_tool_is_one_message(yard: Yard, tmp_path: Path) -> None:
    yard.package(tmp_path / "x.ssp", MINIMAL.replace("resources/Hull.fmu", "../Hull.fmu"))
    done = seatrial("run", "x.ssp", cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith("seatrial: x.ssp: SystemStructure.ssd: line 7: source")
    assert not (tmp_path / "runs").exists()
    assert seatrial("ssp", "check", "x.ssp", cwd=tmp_path).returncode == 1
    done = seatrial("ssp", "check", "x.ssp", "--for", "ecosim", cwd=tmp_path)
    assert done.returncode == 2
    assert "did you mean 'ecos'" in done.stderr
    assert seatrial("run", "none.ssp", cwd=tmp_path).returncode == 2


TRIAL = """rig = "quay.toml"
stop = "1 s"
"""


def _last_speed(run: Path) -> float:
    with (run / "signals.csv").open(encoding="utf-8") as file:
        return float(list(csv.DictReader(file))[-1]["hull.v"])


@pytest.mark.parametrize("kind", ["ssp", "osp"])
@pytest.mark.parametrize("of", ["quay.toml", "trial.toml"])
def test_what_is_set_is_in_the_package(kind: str, of: str, write, tmp_path: Path) -> None:
    """The values of a command line, in the units that it names, as a run of it has them."""
    write("boats.py", BOATS)
    algorithm = "jacobi" if kind == "ssp" else "plain-jacobi"  # what readers of each take
    write("quay.toml", f'algorithm = "{algorithm}"\n{RIG}')
    write("trial.toml", TRIAL)
    written = ["--set", "hull.mass=4000 g", "--set", 'step="20 ms"']
    out = tmp_path / ("x.ssp" if kind == "ssp" else "x")
    done = seatrial(kind, "export", of, *written, "--out", str(out), cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    stop = ["--set", "stop=1 s"]
    step = ["--set", 'step="20 ms"'] if kind == "ssp" else []  # SSP 1.0 has no steps
    for runs, name in (
        ([str(out), *stop, *step], "package"),
        (["trial.toml", *written], "trial"),
    ):
        done = seatrial("run", *runs, "--out", name, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
    found, trial = (_last_speed(tmp_path / name) for name in ("package", "trial"))
    assert found == trial
    # Plain Jacobi has the force a step late: of speeds as here a part in 200.
    tolerance = 1e-12 if kind == "ssp" else 0.005
    assert trial == pytest.approx(speed(4.0, 1.0, seconds=1.0, h=0.02), rel=tolerance)


@pytest.mark.parametrize("kind", ["ssp", "osp"])
@pytest.mark.parametrize(
    ("written", "message"),
    [
        ("hull.mas=4", "did you mean 'mass'"),
        ("hull.mass=4 s", "kg"),
        ("hul", "--set: KEY=VALUE is needed, found 'hul'"),
        ("speed=4", "--set: unknown key 'speed'"),
    ],
)
def test_what_cannot_be_set_is_refused_as_a_run_refuses_it(
    kind: str, written: str, message: str, write, tmp_path: Path
) -> None:
    write("boats.py", BOATS)
    write("quay.toml", RIG)
    write("trial.toml", TRIAL)
    said = []
    for command in ([kind, "export", "trial.toml"], ["run", "trial.toml"]):
        done = seatrial(*command, "--set", written, cwd=tmp_path)
        assert done.returncode == 2
        said.append(done.stderr)
    assert message in said[0]
    assert said[0] == said[1]
    done = seatrial(kind, "export", "quay.toml", "--set", written, cwd=tmp_path)
    assert done.returncode == 2
    assert message in done.stderr
    assert {path.name for path in tmp_path.iterdir()} <= {"boats.py", "quay.toml", "trial.toml"}
