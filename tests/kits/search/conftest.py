"""A campaign of a trial in closed form, to ask questions of."""

import pytest

from seatrial_kits.campaigns.campaign import load_campaign

FORM = '''
import math
from seatrial.model.component import Component, Output, Parameter


class Form(Component):
    """A quantity in closed form of three parameters."""

    form = Parameter("", "1", "ellipse, sum or ishigami")
    a = Parameter(0.0, "m", "first")
    b = Parameter(0.0, "kg", "second")
    c = Parameter(0.0, "1", "third")
    y = Output("m", "the quantity")

    def start(self, t):
        a, b, c = self.a, self.b, self.c
        if self.form == "ellipse":
            self.y = math.hypot(a - 2.0, (b - 30.0) / 10.0)
        elif self.form == "sum":
            self.y = (a + b + c) / math.sqrt(3.0)
        elif self.form == "ishigami":
            self.y = math.sin(a) + 7.0 * math.sin(b) ** 2 + 0.1 * c**4 * math.sin(a)
'''


@pytest.fixture
def asked(tmp_path):
    """Return a function that writes a campaign of a trial in closed form, and loads it."""
    rig = 'step = "100 ms"\n[components]\nform = { fmu = "form.py:Form" }\n'
    (tmp_path / "form.py").write_text(FORM, "utf-8")
    (tmp_path / "form-rig.toml").write_text(rig, "utf-8")

    def write(form: str, check: str, text: str):
        trial = f'rig = "form-rig.toml"\nstop = "100 ms"\n[set]\n"form.form" = "{form}"\n'
        trial += f'[[criteria]]\nname = "within"\ncheck = "{check}"\n'
        (tmp_path / "form.toml").write_text(trial, "utf-8")
        path = tmp_path / "questions.toml"
        path.write_text(f'trials = ["form.toml"]\n{text}', "utf-8")
        return load_campaign(str(path))

    return write
