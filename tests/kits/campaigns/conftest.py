"""A campaign whose component does what its case says, to try what becomes of the case."""

import pytest

from seatrial_kits.campaigns.campaign import load_campaign

COMPONENT = '''
import os, time
from pathlib import Path
from seatrial.model.component import Component, Output, Parameter


class Case(Component):
    """Leaves a file for each run; waits or dies if it is to."""

    way = Parameter("", "1", "run, wait, die or die once")
    number = Parameter(0.0, "m", "of the case")
    y = Output("m", "number of the case, and then its square")
    noise = Output("1", "of its seed")
    seed = Parameter(1, "1", "seed", role="seed")

    def start(self, t):
        self.y = self.number
        self.noise = float(self.seed % 1000)

    def step(self, t, h):
        here = Path(os.environ["CASES"])
        case = f"{self.number:g}-{self.way.replace(' ', '-')}"
        first = not list(here.glob(f"{case}-*"))
        (here / f"{case}-{os.getpid()}").touch()
        if self.way == "die" or (self.way == "die once" and first):
            os._exit(7)
        while self.way == "wait" and not (here / "go").exists():
            time.sleep(0.01)
        self.y = self.number**2
'''
RIG = 'step = "100 ms"\n[components]\ncase = { fmu = "case.py:Case" }\n'
TRIAL = (
    'rig = "rig.toml"\nstop = "300 ms"\n'
    '[[criteria]]\nname = "few"\ncheck = "case.y < 12 m"\nexpect = "pass"\n'
)


@pytest.fixture
def written(tmp_path, monkeypatch):
    """Return a function that writes a campaign beside its trial; "seen" has a file per run."""
    monkeypatch.setenv("CASES", str(tmp_path / "seen"))
    (tmp_path / "seen").mkdir()
    for name, text in (("case.py", COMPONENT), ("rig.toml", RIG), ("t.toml", TRIAL)):
        (tmp_path / name).write_text(text, "utf-8")

    def write(text: str):
        path = tmp_path / "campaign.toml"
        path.write_text(f'trials = ["t.toml"]\n{text}', "utf-8")
        return load_campaign(str(path))

    return write
