"""Content identity of campaigns: no file that decides a case changes without being named."""

import hashlib
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from seatrial.errors import InputError
from seatrial.trial.files.trial import load_trial
from seatrial.trial.records.compare import compare
from seatrial.trial.records.identity import identity_of_run
from seatrial.trial.records.run_folder import read_manifest
from seatrial.trial.running.run import run_trial
from seatrial_kits.campaigns import shipment
from seatrial_kits.campaigns.campaign import load_campaign
from seatrial_kits.campaigns.identity import identity_of
from seatrial_kits.campaigns.in_folders import run_campaign
from seatrial_kits.campaigns.shipment import packed, unpacked
from seatrial_kits.campaigns.sweep import How, run_sweep
from tests.command import seatrial

COMPONENT = """
from pathlib import Path
from seatrial.model.component import Component, Output, Parameter
from helping import squared

DATA_FILES = ("gain.txt",)


class Sum(Component):
    kind = "Sum"
    a = Parameter(0.0, "1", "a")
    b = Parameter(0.0, "1", "b")
    x = Parameter(0.0, "1", "of a table")
    y = Output("1", "value")

    def start(self, t):
        gain = float(Path(__file__).with_name("gain.txt").read_text())
        self.y = gain * squared(self.a) + self.b
"""
FILES = {
    "campaigns/c.toml": 'trials = ["../trials/t.toml", "../trials/u.toml"]\nkeep = "none"\n'
    '[grid]\n"choices.part" = ["one", "two"]\n"part.sum.a" = [1, 2]\n',
    "trials/t.toml": 'rig = "../rigs/outer.toml"\nstop = "100 ms"\n'
    '[[criteria]]\nname = "y"\ncheck = "part.sum.y < 99"\nexpect = "pass"\n',
    "trials/u.toml": 'rig = "../rigs/outer.toml"\nstop = "200 ms"\n'
    '[[criteria]]\nname = "y"\ncheck = "part.sum.y < 99"\nexpect = "pass"\n',
    "rigs/outer.toml": 'step = "100 ms"\n[choices]\npart = "one"\n'
    '[components]\npart = { rig = "inner-{part}.toml" }\ntimes = { fmu = "../parts/times.csv" }\n',
    "rigs/inner-one.toml": 'step = "100 ms"\n[components]\n'
    'sum = { fmu = "../parts/sum.py:Sum", parameters = "../boat.toml.sum" }\n',
    "rigs/inner-two.toml": 'step = "100 ms"\n[components]\n'
    'sum = { fmu = "../parts/sum.py:Sum", set = { b = 5 } }\n',
    "parts/sum.py": COMPONENT,
    "parts/helping.py": "def squared(x):\n    return x * x\n",
    "parts/gain.txt": "1.0",
    "parts/times.csv": "time,out\n0,1\n1,2\n",
    "boat.toml": 'title = "mine"\nsource = "measured"\n[sum]\n'
    'b = { value = 4, unit = "1", source = "tape", mark = "identified" }\n',
}  # fmt: skip
CHANGES = {".toml": "\n# changed\n", ".py": "\n# changed\n", ".csv": "2,3\n", ".txt": "0"}
TRACED = """
import os, sys
log = os.open(sys.argv[1], os.O_WRONLY | os.O_CREAT | os.O_APPEND)

def opened(event, arguments):
    if event == "open" and isinstance(arguments[0], str):
        os.write(log, (os.path.abspath(arguments[0]) + "\\n").encode())

sys.addaudithook(opened)
import seatrial
seatrial.run_campaign("campaigns/c.toml", out=sys.argv[2])
"""
"""Runs a campaign, and writes the name of each file that it opens, in all of its processes."""


@pytest.fixture
def project(tmp_path):
    for name, text in FILES.items():
        path = tmp_path / "project" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, "utf-8")
    return tmp_path / "project"


def campaign_of(project):
    return load_campaign(str(project / "campaigns/c.toml"))


def names_of(project):
    files = identity_of(campaign_of(project)).files
    return {(project / "campaigns" / name).resolve() for each in files.values() for name in each}


def opened_by(project, log):
    """Return the project's files that a run of the campaign opens."""
    command = [sys.executable, "-c", TRACED, str(log), str(log.with_name("out"))]
    subprocess.run(command, cwd=project, check=True, capture_output=True)
    paths = {Path(line) for line in log.read_text("utf-8").splitlines()}
    return {p for p in paths if p.is_relative_to(project) and "__pycache__" not in p.parts}


@pytest.mark.slow
def test_every_file_that_a_case_opens_decides_its_identity(project, tmp_path):
    opened = {path for path in opened_by(project, tmp_path / "log") if path.is_file()}
    assert {project / name for name in FILES} - {project / "parts/helping.py"} <= opened
    assert opened <= names_of(project)
    whole = identity_of(campaign_of(project))
    for name in FILES:
        path = project / name
        path.write_text(FILES[name] + CHANGES[path.suffix], "utf-8")
        changes = identity_of(campaign_of(project)).changed(whole.content())
        touched = {"t", "u"} if "trials" not in name else {path.stem}
        assert changes.files.keys() == touched, name
        said = Path("..", name).as_posix() if "campaigns" not in name else path.name
        assert changes.text() == said
        path.write_text(FILES[name], "utf-8")
    assert not identity_of(campaign_of(project)).changed(whole.content())


def test_the_manifest_of_a_run_has_the_identity_of_what_its_campaign_says(project, tmp_path):
    identity = identity_of(campaign_of(project)).content()
    (case, *_) = campaign_of(project).cases()
    run_trial(case.trial, tmp_path / "a", engine="direct")
    found = read_manifest(tmp_path / "a")["identity"]
    assert found["program"] == identity["program"]
    of_campaign = {Path(name).name: sha for name, sha in identity["files"]["t"].items()}
    of_run = {Path(name).name: sha for name, sha in found["files"]["t"].items()}
    unread = {"c.toml", "inner-two.toml"}  # the campaign itself, and a choice of another case
    assert of_run == {name: sha for name, sha in of_campaign.items() if name not in unread}
    for name, sha in found["files"]["t"].items():
        data = (project / "trials" / name).read_bytes()
        assert sha == hashlib.sha256(data).hexdigest()


def test_files_that_two_runs_do_not_share_are_named(project, tmp_path):
    for out, gain in (("a", "1.0"), ("b", "1.00")):
        (project / "parts/gain.txt").write_text(gain, "utf-8")
        run_trial(load_trial(str(project / "trials/t.toml")), tmp_path / out, engine="direct")
    comparison = compare(tmp_path / "a", tmp_path / "b")
    assert comparison.identical
    assert [change.name for change in comparison.changes] == ["../parts/gain.txt (file)"]


@pytest.mark.slow
def test_a_case_of_a_folder_runs_again_of_the_same_files_alone(project, tmp_path):
    run_sweep(campaign_of(project), tmp_path / "out", how())
    arguments = ("campaign", "rerun", "campaigns/c.toml", "--case", "1", "--engine", "direct")
    of = ("--of", str(tmp_path / "out"))
    same = seatrial(*arguments, *of, "--out", "again", cwd=project)
    assert same.returncode == 0, same.stderr
    (project / "parts/gain.txt").write_text("3.0", "utf-8")
    other = seatrial(*arguments, *of, "--out", "other", cwd=project)
    assert (other.returncode, (project / "other").exists()) == (2, False)
    assert "changed since: ../parts/gain.txt: no run would be the same" in other.stderr


def test_what_is_beside_them_decides_nothing(project):
    before = identity_of(campaign_of(project))
    (project / "parts/notes.md").write_text("to be done", "utf-8")
    # A text of a file may have the name of a folder; results of runs in it are none of its content.
    (project / "parts/Sum/out").mkdir(parents=True)
    (project / "parts/Sum/out/manifest.json").write_text("{}", "utf-8")
    assert not identity_of(campaign_of(project)).changed(before.content())


def test_what_code_names_of_the_system_is_no_content_and_is_not_waited_for(project, tmp_path):
    os.mkfifo(project / "parts/pipe")
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "elsewhere/large.csv").write_text("1", "utf-8")
    names = ["/proc", "/dev", "/dev/shm", "/", "/proc/kmsg", "pipe", str(tmp_path / "elsewhere")]
    (file,) = (project / "parts").glob("helping.py")
    file.write_text(f"{file.read_text('utf-8')}\nNAMES = {names}\n", "utf-8")
    (case, *_) = campaign_of(project).cases()
    found = identity_of_run(case.trial).files["t"]
    assert {Path(name).name for name in found} & {"kmsg", "pipe", "large.csv"} == set()


def table(folder):
    return (folder / "results.parquet").read_bytes()


def how(**given):
    return How("direct", jobs=1, **given)


@pytest.mark.slow
def test_a_table_is_never_of_two_sources(project, tmp_path):
    out = tmp_path / "out"
    run_sweep(campaign_of(project), out, how())
    before = table(out)
    helping = project / "parts/helping.py"
    helping.write_text("def squared(x):\n    return -x * x\n", "utf-8")
    said = r"changed since: \.\./parts/helping\.py; --rerun-changed"
    with pytest.raises(InputError, match=said):
        run_sweep(campaign_of(project), out, how(resume=True))
    assert table(out) == before
    run_sweep(campaign_of(project), out, how(resume=True, rerun_changed=True))
    run_sweep(campaign_of(project), tmp_path / "anew", how())
    assert table(out) == table(tmp_path / "anew") != before


def test_only_what_a_change_touches_runs_again(project, tmp_path):
    campaign = project / "campaigns/c.toml"
    campaign.write_text(FILES["campaigns/c.toml"].replace('keep = "none"\n', ""), "utf-8")
    out = tmp_path / "out"
    _, first = run_campaign(campaign_of(project), out, engine="direct", jobs=1)
    stamps = {r.folder: (r.folder / "manifest.json").stat().st_mtime_ns for _, r in first}
    trial = project / "trials/u.toml"
    trial.write_text(FILES["trials/u.toml"].replace("200 ms", "300 ms"), "utf-8")
    with pytest.raises(InputError, match=r"changed since: \.\./trials/u\.toml"):
        run_campaign(campaign_of(project), out, engine="direct", resume=True)
    again = {"engine": "direct", "jobs": 1, "resume": True, "rerun_changed": True}
    _, second = run_campaign(campaign_of(project), out, **again)
    ran = {c.trial_name for c, r in second
           if (r.folder / "manifest.json").stat().st_mtime_ns != stamps[r.folder]}  # fmt: skip
    assert ran == {"u"}
    stops = {json.loads((r.folder / "manifest.json").read_bytes())["stop"] for _, r in second}
    assert stops == {0.1, 0.3}


def test_a_worker_with_another_source_is_refused(project, monkeypatch):
    archive = packed(campaign_of(project))
    assert unpacked(archive)[0].cases()
    other = {**shipment.program(), "seatrial": "0.1.0, source 0000"}
    monkeypatch.setattr(shipment, "program", lambda: other)
    shipment._unpacked.cache_clear()
    with pytest.raises(InputError, match=r"a worker has seatrial 0\.1\.0, source 0000, and the"):
        unpacked(archive)


def test_rerun_changed_goes_with_resume(project):
    refused = seatrial("run", "campaigns/c.toml", "--rerun-changed", cwd=project)
    assert refused.returncode == 2
    assert "--rerun-changed goes with --resume" in refused.stderr
