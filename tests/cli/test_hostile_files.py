"""Files that nobody wrote by mistake, and full disks: a message, its status, no half file."""

from __future__ import annotations

import json
import resource
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from seatrial.trial.reports import report
from tests.command import seatrial
from tests.trials.conftest import write_run_folder

DEEP = 100_000
TOMLS = {
    "array": ("a = " + "[" * DEEP, "more than 64 deep"),
    "closed array": ("a = " + "[" * 200 + "]" * 200, "more than 64 deep"),
    "table": ("a = " + "{a = " * DEEP, "more than 64 deep"),
    "dotted key": (".".join(["a"] * DEEP) + " = 1", "more than 64 deep"),
    "dotted header": ("[" + ".".join(["a"] * DEEP) + "]", "more than 64 deep"),
    "digits": ("seed = " + "9" * 5000, "not TOML: "),
    "wide integer": (f"seed = {2**64}", "an integer of 65 bits"),
    "large": ("#" * (4 * 2**20 + 1), "at most 4194304 are read"),
}


@pytest.mark.parametrize("kind", TOMLS)
def test_toml_that_breaks_parsers_is_bad_input(kind: str, tmp_path: Path) -> None:
    text, message = TOMLS[kind]
    (tmp_path / "x.toml").write_text(text)
    done = seatrial("run", "x.toml", cwd=tmp_path)
    assert done.returncode == 2
    assert message in done.stderr
    assert "x.toml: " in done.stderr
    assert "Traceback" not in done.stderr


JSONS = {
    "deep": "[" * DEEP,
    "closed": "[" * 200 + "]" * 200,
    "digits": "9" * 5000,
    "wide": str(10**40),
    "nan": "NaN",
    "text": '"x"',
    "null": "null",
    "nothing": "",
}


@pytest.mark.parametrize("name", ["manifest.json", "verdicts.json", "timing.json"])
@pytest.mark.parametrize("kind", JSONS)
def test_a_run_folder_of_others_is_bad_input(kind: str, name: str, tmp_path: Path) -> None:
    good = write_run_folder(tmp_path / "good")
    bad = shutil.copytree(good, tmp_path / "bad")
    (bad / name).write_text(JSONS[kind])
    for command in (["report", "bad"], ["compare", "good", "bad"]):
        done = seatrial(*command, cwd=tmp_path)
        assert done.returncode == 2, done
        assert name in done.stderr
        assert "Traceback" not in done.stderr


def test_every_key_is_checked_and_named(tmp_path: Path) -> None:
    folder = write_run_folder(tmp_path / "run")
    path = folder / "manifest.json"
    manifest = json.loads(path.read_text())
    manifest["components"]["hull"]["parameters"]["mass"]["unit"] = 7
    manifest["components"]["downwash"]["outline"]["beam"] = float("nan")
    manifest["connections"][0] = ["hull.attitude"]
    path.write_text(json.dumps(manifest))
    done = seatrial("report", "run", cwd=tmp_path)
    assert done.returncode == 2
    for place in ("components.hull.parameters.mass.unit: ", "outline.beam: ", "connections.0."):
        assert f"manifest.json: {place}" in done.stderr or place in done.stderr
    assert "found 7" in done.stderr
    assert "found nan" in done.stderr


def test_a_time_that_goes_back_is_no_record(tmp_path: Path) -> None:
    folder = write_run_folder(tmp_path / "run")
    lines = (folder / "signals.csv").read_text().splitlines(keepends=True)
    lines[2], lines[3] = lines[3], lines[2]
    (folder / "signals.csv").write_text("".join(lines))
    done = seatrial("compare", "run", "run", cwd=tmp_path)
    assert done.returncode == 2
    assert "the time goes back from 0.2" in done.stderr


def test_an_error_of_ours_is_never_a_criterion_that_failed(tmp_path: Path, monkeypatch) -> None:
    def broken(_run: object) -> None:
        raise ValueError("a defect")

    monkeypatch.setattr(report, "parameter_tables", broken)
    write_run_folder(tmp_path / "run")
    done = seatrial("report", "run", cwd=tmp_path)
    assert done.returncode == 3
    assert "Traceback" in done.stderr
    assert "an error of seatrial itself, please report it: ValueError: a defect" in done.stderr


# ---------------------------------------------------------------------- disks

RUN = (
    "import sys; from seatrial.cli import main; sys.argv = ['seatrial', 'run', 'hydrone-landing', "
    "'--engine', 'direct', '--out', sys.argv[1]]; main()"
)


def assert_failed_for(run: Path, done: subprocess.CompletedProcess[str], why: str) -> None:
    assert done.returncode == 3, done.stderr
    assert f"cannot write {run / 'signals.csv'}: {why}" in done.stderr


@pytest.mark.slow
def test_a_record_that_cannot_grow_fails_the_run(tmp_path: Path) -> None:
    run = tmp_path / "run"
    done = subprocess.run(
        [sys.executable, "-c", RUN, str(run)],
        capture_output=True,
        text=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (200_000, 200_000)),
    )
    assert_failed_for(run, done, "File too large")
    manifest = json.loads((run / "manifest.json").read_text())
    assert manifest["status"] == "failed"
    assert manifest["error"] == f"cannot write {run / 'signals.csv'}: File too large"
    lines = (run / "signals.csv").read_text().splitlines(keepends=True)
    assert len(lines) > 2
    assert {(line.count(","), line[-1]) for line in lines} == {(lines[0].count(","), "\n")}
    # The page carries more than the limit: there is none, rather than the half of one.
    assert {path.name for path in run.iterdir()} == {"manifest.json", "signals.csv", "timing.json"}


def _full_disk(size: str, tmp_path: Path) -> tuple[Path, subprocess.CompletedProcess[str]]:
    """Run on a file system of its own, of ``size``; return what it left, copied, and the end."""
    disk, left = tmp_path / "disk", tmp_path / "left"
    disk.mkdir()
    script = (
        'mount -t tmpfs -o size="$2" none "$1" || exit 99; "$3" -c "$4" "$1/run"; status=$?; '
        'cp -r "$1" "$5"; exit $status'
    )
    arguments = [str(disk), size, sys.executable, RUN, str(left)]
    done = subprocess.run(
        ["unshare", "-Urm", "sh", "-c", script, "sh", *arguments], capture_output=True, text=True
    )
    if done.returncode == 99 or "unshare:" in done.stderr:
        pytest.skip("no name spaces here")
    return left / "run", done


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("unshare") is None, reason="no unshare here")
def test_a_full_disk_ends_the_run_as_failed(tmp_path: Path) -> None:
    left, done = _full_disk("200k", tmp_path)
    assert_failed_for(tmp_path / "disk" / "run", done, "No space left on device")
    manifest = json.loads((left / "manifest.json").read_text())
    assert manifest["status"] == "failed"
    assert "signals.csv: No space left on device" in manifest["error"]
    assert {path.name for path in left.iterdir()} == {"manifest.json", "signals.csv"}


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("unshare") is None, reason="no unshare here")
def test_a_disk_too_small_for_the_manifest_holds_no_empty_one(tmp_path: Path) -> None:
    left, done = _full_disk("40k", tmp_path)
    assert done.returncode == 3
    assert "manifest.json: No space left on device" in done.stderr
    assert list(left.iterdir()) == []
