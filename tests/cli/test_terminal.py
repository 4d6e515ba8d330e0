"""Text of others on the terminal: it is shown, and does nothing there."""

from __future__ import annotations

import json
import re
import shutil
import zipfile
from pathlib import Path

import pytest

from seatrial.cli.show import SafeConsole
from seatrial.printable import printable
from tests.command import Done, seatrial
from tests.kit import needs_kits
from tests.trials.conftest import write_run_folder

EVIL = "\x1b]0;gone\x07\x1b[2J\r\x08\x7f\x9b31m\u202edrawkcab\u2066\u2028\x85"
"""Titles and clears the terminal, overwrites the line, turns the text round."""
ACTS = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u2028-\u202e\u2066-\u2069]")
ROOT = Path(__file__).parents[2]
PROFILES = ROOT / "harness/kits/ships/profiles"
TOML = json.dumps(EVIL)  # TOML's escapes are those of JSON
DESCRIPTION = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="a&#x202e;b&#x9b;2J" guid="{}" description="&#x9b;2J&#x202e;x">
<CoSimulation modelIdentifier="a"/><ModelVariables>
<ScalarVariable name="x&#x9b;2J" valueReference="0" causality="output" description="&#x202e;&#x9b;2J"><Real unit="&#x9b;"/></ScalarVariable>
</ModelVariables><ModelStructure><Outputs><Unknown index="1"/></Outputs></ModelStructure></fmiModelDescription>
"""  # XML 1.0 has no ESC: C1's one-byte CSI does the same


def assert_harmless(done: Done, *, shown: str = r"\x1b[2J") -> None:
    said = done.stdout + done.stderr
    # Rich colours its own text on a terminal; here it is none.
    assert not ACTS.search(said), repr(said)
    assert shown in said.replace("\n", ""), said


def test_what_is_replaced_and_what_stays() -> None:
    assert not ACTS.search(printable(EVIL))
    assert printable("é ü 漢字 \t tab\n\U0001f6a4") == "é ü 漢字 \t tab\n\U0001f6a4"
    assert printable("\udcff\ud800") == r"\udcff\ud800"
    assert printable("\u200f\u061c\u202e") == r"\u200f\u061c\u202e"


@pytest.mark.parametrize(
    "text",
    [
        f"title = {TOML}\nrig = {TOML}\nstop = '1 s'\n",
        f"{TOML} = 1\n",
        f"rig = 'landing'\nstop = {TOML}\n",
        f"rig = 'landing'\nstop = '1 s'\n[set]\n{TOML} = 1\n",
        f"rig = 'landing'\nstop = '1 s'\n[[criteria]]\nname = {TOML}\ncheck = {TOML}\n",
    ],
)
def test_errors_that_quote_a_file(text: str, tmp_path: Path) -> None:
    (tmp_path / "x.toml").write_text(text)
    done = seatrial("run", "x.toml", cwd=tmp_path)
    assert done.returncode == 2
    assert_harmless(done, shown="[2J")


def test_titles_in_listings(tmp_path: Path) -> None:
    folder = tmp_path / "harness" / "trials"
    folder.mkdir(parents=True)
    (folder / "x.toml").write_text(f"title = {TOML}\n")
    assert_harmless(seatrial("list", cwd=tmp_path))


@needs_kits("ardupilot", "mavlink", "nmea", "ships")
def test_a_profile_of_others(tmp_path: Path) -> None:
    text = (PROFILES / "mariner.toml").read_text("utf-8")
    text = text.replace("../../../ships/", "../harness/ships/")
    text = re.sub(r"^(title|source) = .*$", lambda m: f"{m[1]} = {TOML}", text, flags=re.M)
    folder = tmp_path / "hil_profiles"
    folder.mkdir()
    (folder / "x.toml").write_text(text)
    shutil.copy(PROFILES / "mariner.parm", folder)
    shutil.copytree(ROOT / "harness" / "ships", tmp_path / "harness" / "ships")
    done = seatrial("profile", "describe", "hil_profiles/x.toml", cwd=tmp_path)
    assert done.returncode == 0, done
    assert_harmless(done)


def test_an_fmu_of_others(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "x.fmu", "w") as archive:
        archive.writestr("modelDescription.xml", DESCRIPTION)
    for command in ("describe", "check"):
        assert_harmless(seatrial("fmu", command, "x.fmu", cwd=tmp_path), shown=r"\x9b")


def test_runs_of_others_compared(tmp_path: Path) -> None:
    name = f"box{EVIL}"
    for folder in ("a", "b"):
        run = write_run_folder(tmp_path / folder, extra={"box.x": ("m", [1.0] * 201)})
        manifest = (run / "manifest.json").read_text()
        (run / "manifest.json").write_text(manifest.replace('"box.x"', json.dumps(f"{name}.x")))
        content = json.loads((run / "manifest.json").read_text())
        content["components"][name] = {
            "fmu": EVIL + folder, "sha256": EVIL, "step": 0.1,
            "parameters": {EVIL: {"value": EVIL + folder, "unit": EVIL}},
        }  # fmt: skip
        (run / "manifest.json").write_text(json.dumps(content))
    done = seatrial("compare", "a", "b", cwd=tmp_path)
    assert done.returncode == 2  # the record has another name than the manifest
    for folder in ("a", "b"):
        path = tmp_path / folder / "signals.csv"
        path.write_text(
            path.read_text().replace("box.x", name.replace("\r", "") + ".x"), newline=""
        )
        manifest = (tmp_path / folder / "manifest.json").read_text()
        (tmp_path / folder / "manifest.json").write_text(manifest.replace("\\r", ""))
    done = seatrial("compare", "a", "b", cwd=tmp_path)
    assert_harmless(done, shown="What was set")


def test_colours_of_the_console_are_not_escaped(tmp_path: Path) -> None:
    with (tmp_path / "out").open("w+", newline="") as file:
        console = SafeConsole(
            highlight=False, file=file, force_terminal=True, color_system="standard", width=200
        )
        console.print(f"[red]bad[/red] {EVIL}", soft_wrap=True)
        file.seek(0)
        said = file.read()
    assert said.startswith("\x1b[31mbad\x1b[0m ")
    assert not ACTS.search(said.removeprefix("\x1b[31mbad\x1b[0m "))
