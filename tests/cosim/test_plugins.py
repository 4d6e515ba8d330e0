"""A package that adds a coupling algorithm and a transport, installed beside seatrial."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from seatrial.errors import InputError
from seatrial.links.endpoints.url import check_urls, open_endpoint
from seatrial.system.flattening import load_rig
from tests.kit import needs_kits
from tests.packages import installed

MODULE = '''
from pathlib import Path

from seatrial.sim.algorithms import Algorithm, arrive
from seatrial.links.endpoints.endpoint import Channel, Endpoint


class Backwards(Algorithm):
    """Jacobi that steps the components in reverse order, twice a step."""

    def __init__(self, network, feedthrough):
        self._network, self._feedthrough = network, feedthrough

    def advance(self, steps, t_ns, h_ns):
        half = h_ns // 2
        for begin, length in ((t_ns, half), (t_ns + half, h_ns - half)):
            for node in reversed(self._network.nodes.values()):
                self._network.write(node)
                self._network.step(node, begin, length)
            arrive(self._network, self._feedthrough, steps + 1, begin + length)

    def notes(self, steps):
        return [f"{steps} steps backwards"]


class Tape(Endpoint, Channel):
    """Everything that is sent, in a file."""

    def __init__(self, url):
        self.url = url
        self._file = Path(url.partition(":")[2]).open("wb")

    def channels(self):
        return [self]

    def poll(self):
        return []

    def send(self, data):
        self._file.write(data)

    def close(self):
        self._file.close()
'''
ENTRIES = {
    "seatrial.algorithms": {"backwards": "seafarer:Backwards"},
    "seatrial.transports": {"tape": "seafarer:Tape"},
}
RIG = """
step = "100 ms"
algorithm = "backwards"

[components]
decay  = {{ fmu = "bodies.py:Decay" }}
talker = {{ fmu = "nmea0183", set = {{ links = "tape:{tape}" }} }}

[connections]
"decay.x" = "decay.u"
"""
PROGRAM = """
import sys
from seatrial.sim.master import Master
from seatrial.system.flattening import load_rig
from seatrial.system.assembling.assembly import assemble

system = assemble(load_rig(sys.argv[1]), "direct")
master = Master(system)
master.initialise()
for _ in range(20):
    master.step()
master.terminate()
system.free()
print(master.signals[master.names.index(("decay", "x"))], *master.notes(), sep="\\n")
"""


@pytest.mark.slow
@needs_kits("nmea")
def test_a_rig_runs_with_an_algorithm_and_a_transport_of_a_package(
    write, tmp_path: Path, direct
) -> None:
    """x' = -x, held over half steps: (1 - h / 2)^(2 n); sentences of NMEA 0183 on the tape."""
    site = installed(tmp_path / "site", "seafarer", ENTRIES, MODULE)
    tape = tmp_path / "tape.nmea"
    rig = write("rig-of-plugins.toml", RIG.format(tape=tape))
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, str(rig)],
        env=os.environ | {"PYTHONPATH": str(site)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    x, note = done.stdout.splitlines()
    assert float(x) == pytest.approx(0.95**40, rel=1e-12)
    assert note == "20 steps backwards"
    sentences = tape.read_text("ascii").splitlines()
    assert sentences
    assert all(line[0] in "$!" and line[-3] == "*" for line in sentences)


def rig_with(write, algorithm: str, more: str = "") -> Path:
    return write("r.toml", f'step = "1 s"\nalgorithm = "{algorithm}"\n{more}\n[components]\n')


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Return a function that installs the package with other entry points for this test."""

    def install(name: str, entries: dict[str, dict[str, str]]) -> None:
        monkeypatch.syspath_prepend(installed(tmp_path / name, name, entries))

    return install


def test_an_unknown_algorithm_has_near_misses_file_and_key(write, package) -> None:
    package("seafarer", ENTRIES)
    path = rig_with(write, "bakwards")
    with pytest.raises(InputError) as error:
        load_rig(str(path))
    message = f"{path}: algorithm: unknown algorithm 'bakwards'; did you mean 'backwards'?"
    assert str(error.value).startswith(message)
    with pytest.raises(InputError, match=r"did you mean 'jacobi'\?"):
        load_rig(str(rig_with(write, "jakobi")))


def test_a_shipped_algorithm_is_not_replaced_by_a_package(write, package) -> None:
    package("pirate", {"seatrial.algorithms": {"jacobi": "pirate:Jacobi"}})
    both = (
        r"r\.toml: algorithm: algorithm 'jacobi' comes from seatrial itself "
        r"\(seatrial\.sim\.algorithms:Jacobi\) and from the package pirate \(pirate:Jacobi\)"
    )
    with pytest.raises(InputError, match=both):
        load_rig(str(rig_with(write, "jacobi")))


def test_what_is_no_algorithm_is_named(direct, package) -> None:
    package("seafarer", {"seatrial.algorithms": {"backwards": "math:pi"}})
    top = 'step = "1 s"\nalgorithm = "backwards"'
    with pytest.raises(InputError, match=r"rig\.toml: algorithm: 'backwards' is 3\.14.*Algorithm"):
        direct.master("", top=top)


def test_settings_of_the_iteration_need_an_algorithm_that_iterates(write) -> None:
    path = rig_with(write, "gauss-seidel", "iteration = { count = 3 }")
    with pytest.raises(InputError, match="iteration has no effect with 'gauss-seidel'"):
        load_rig(str(path))
    load_rig(str(rig_with(write, "iterated", "iteration = { count = 3 }")))


def test_links_of_unknown_or_ambiguous_kinds_are_named(package) -> None:
    package("seafarer", ENTRIES)
    check_urls("tape:/somewhere/else udpin:127.0.0.1:0")
    with pytest.raises(InputError, match=r"link 'tap:x': unknown kind .* did you mean 'tape'\?"):
        check_urls("tap:x")
    package("pirate", {"seatrial.transports": {"tape": "pirate:Tape"}})
    with pytest.raises(InputError, match=r"link 'tape:x': .*package pirate .*package seafarer"):
        open_endpoint("tape:x")
