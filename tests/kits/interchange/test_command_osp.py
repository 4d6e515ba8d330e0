"""System structures of OSP-IS from the command line."""

from __future__ import annotations

import csv
from pathlib import Path

from tests.command import seatrial
from tests.kits.interchange.osp_files import write_osp
from tests.kits.interchange.ssp_files import BOATS

RIG = """step = "10 ms"
[components]
hull = { fmu = "boats.py:Hull", set = { mass = 8.0 } }
damper = { fmu = "boats.py:Damper" }
[connections]
"hull.v" = "damper.v"
"damper.force" = { to = "hull.force", factor = 2.0 }
"""


def last_row(folder: Path) -> dict[str, str]:
    with (folder / "signals.csv").open(encoding="utf-8") as file:
        return list(csv.DictReader(file))[-1]


def test_a_folder_is_described_run_and_written(tmp_path: Path) -> None:
    write_osp(tmp_path / "fleet", ("    <EndTime>3.0</EndTime>\n", ""))
    done = seatrial("describe", "fleet", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "total: sum of 3" in done.stdout
    assert "-> two.u  (times 2.5, plus -0.1)" in done.stdout
    done = seatrial("run", "fleet", cwd=tmp_path)
    assert done.returncode == 2
    assert 'names no stop time; give one: --set stop="20 s"' in done.stderr
    (tmp_path / "s.json").write_text(
        '{"events": [{"time": 0, "model": "slave uno", "variable": "gain", "action": "override",'
        ' "value": 9}], "end": 99}',
        "utf-8",
    )
    one = ["run", "fleet", "--set", "stop=1 s", "--out", "one"]
    done = seatrial(*one, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    done = seatrial("osp", "export", "fleet", "--out", "copy", cwd=tmp_path)
    assert done.returncode == 2  # it has no stop time
    settings = ["--set", "stop=1 s", "--set", "scenario=s.json", "--set", "slave_uno.u=2"]
    done = seatrial("run", "fleet/OspSystemStructure.xml", *settings, "--out", "two", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert last_row(tmp_path / "one")["slave_uno.y"] == "0.0"
    row = last_row(tmp_path / "two")
    assert row["slave_uno.y"] == "18.0"
    terms = [float(row[name]) for name in ("slave_uno.x", "two.x", "two.y")]
    assert float(row["total.out"]) == sum(terms)  # no step late


def test_a_rig_is_written(tmp_path: Path) -> None:
    (tmp_path / "boats.py").write_text(BOATS, "utf-8")
    (tmp_path / "quay.toml").write_text(RIG, "utf-8")
    done = seatrial("osp", "export", "quay.toml", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "a rig has no stop time" in done.stdout
    assert "Jacobi" in done.stdout
    written = (tmp_path / "quay-osp" / "OspSystemStructure.xml").read_text("utf-8")
    assert '<LinearTransformation name="hull_force" factor="2.0" offset="0.0"/>' in written
    done = seatrial("run", "quay-osp", "--set", "stop=1 s", "--out", "run", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert 0.0 < float(last_row(tmp_path / "run")["hull.v"]) < 1.0


def test_a_mistake_is_no_verdict(tmp_path: Path) -> None:
    write_osp(tmp_path, ('inputCount="3"', 'inputCount="9"'))
    done = seatrial("run", "OspSystemStructure.xml", cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith("seatrial: OspSystemStructure.xml: line 31: function 'total'")
