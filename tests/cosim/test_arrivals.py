"""What comes from outside between two points is met before the step, and a flood holds no step."""

from pathlib import Path

from seatrial.sim.master import Master

from .conftest import Bench, value

LETTERBOX = '''
from pathlib import Path
from seatrial.model.component import Component, Output

FOLDER = Path({folder!r})

class Letterbox(Component):
    """Value of the first letter: each reading takes the letters before the last one."""

    rolls_back = False
    y = Output("m", "value", role="arrivals")

    def _look(self):
        found = sorted(FOLDER.glob("letter-*"))
        if len(found) > 1:
            found[0].unlink()
            self._stale = True

    def read(self, references, kind):
        self._look()
        return super().read(references, kind)

    def reader(self, references, kind):
        own = super().reader(references, kind)
        def read():
            self._look()
            return own()
        return read

    def outputs(self, t):
        self.y = float(sorted(FOLDER.glob("letter-*"))[0].read_text())
'''
COMPONENTS = 'box = { fmu = "letterbox.py:Letterbox" }\nadd = { fmu = "users.py:Add" }'


def put(folder: Path, first: int, count: int) -> None:
    for number in range(first, first + count):
        (folder / f"letter-{number:03}").write_text(str(number))


def chained(bench: Bench) -> Master:
    put(bench.folder, 0, 1)
    (bench.folder / "letterbox.py").write_text(LETTERBOX.format(folder=str(bench.folder)))
    return bench.master(COMPONENTS, '"box.y" = "add.u"')


def test_all_that_has_come_acts_in_the_step(bench: Bench) -> None:
    master = chained(bench)
    master.step()
    assert value(master, "add.y") == 1.0
    put(bench.folder, 1, 2)  # of two that come one after the other, the newest acts
    master.meet_arrivals()
    assert (value(master, "box.y"), value(master, "add.y")) == (2.0, 3.0)


def test_a_flood_does_not_hold_the_step(bench: Bench) -> None:
    master = chained(bench)
    put(bench.folder, 1, 50)
    master.meet_arrivals()
    assert 0.0 < value(master, "box.y") < 50.0
    assert value(master, "add.y") == value(master, "box.y") + 1.0
