"""Energy-conserving step control: against a closed form, its own tolerance, and what is no bond."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Any

import pytest

from seatrial.errors import InputError
from seatrial.sim.master import Master
from seatrial.trial.files.trial import load_trial
from seatrial_kits.interchange.export import export_osp
from seatrial_kits.interchange.osp.reading import read_osp
from seatrial_kits.interchange.rig_fmu.face import face_of
from seatrial_kits.interchange.rig_fmu.frozen import rig_source
from tests.kits.interchange.osp_files import write_osp

from .conftest import Bench, value
from .test_algorithms import BODY_CONNECTIONS, TWO_BODIES, exact_two_bodies

AXLE = 'axle = ["appendage.v_hull", "hull.force"]'
"""The bond of `TWO_BODIES`: velocity there, force back."""
WIDE = 'min_step = "1 ns", max_step = "1 s"'


def top(step: str = "1 s", ecco: str = WIDE, bonds: str = AXLE) -> str:
    return f'step = "{step}"\nalgorithm = "ecco"\necco = {{ {ecco} }}\n[bonds]\n{bonds}\n'


def two_bodies(direct: Bench, **options: str) -> Master:
    return direct.master(TWO_BODIES, BODY_CONNECTIONS, top=top(**options))


def watched(master: Master) -> list[tuple[float, float, dict[str, float]]]:
    """Return a list that gets, before each step, its begin, its length and what the bond carries."""
    steps: list[tuple[float, float, dict[str, float]]] = []
    instance = master.system.parts["hull"].instance
    taken = instance.step

    def step(t: float, h: float) -> None:
        steps.append((t, h, {n: value(master, n) for n in ("hull.v", "appendage.force")}))
        taken(t, h)

    instance.step = step  # type: ignore[method-assign]
    return steps


@pytest.mark.slow
def test_a_fourth_of_the_tolerance_is_half_of_the_error(direct: Bench) -> None:
    """Lost energy is of second order in h, the solution of first: h ~ tolerance^(1/2)."""
    errors, lengths = [], []
    for tolerance in (4e-4, 1e-4, 2.5e-5):
        given = f'{WIDE}, step = "0.1 ms", absolute_tolerance = {tolerance}'
        master = two_bodies(direct, ecco=given)
        steps = watched(master)
        master.step()
        assert master.time == 1.0
        errors.append(abs(value(master, "hull.x") - exact_two_bodies(1.0)))
        lengths.append(len(steps))
    assert [a / b for a, b in itertools.pairwise(errors)] == pytest.approx([2.0] * 2, rel=0.1)
    assert [b / a for a, b in itertools.pairwise(lengths)] == pytest.approx([2.0] * 2, rel=0.1)


@pytest.mark.slow
def test_each_step_loses_the_energy_of_the_tolerance(direct: Bench) -> None:
    """h |v_new F_old - F_new v_old|, summed up by hand, settles at alpha^(1/I) of the tolerance."""
    given = f'{WIDE}, step = "0.1 ms", absolute_tolerance = 1e-5, relative_tolerance = 0.0'
    master = two_bodies(direct, ecco=given)
    steps = watched(master)
    master.step()
    lost = []
    for (_, h, old), (_, _, new) in itertools.pairwise(steps):
        power = new["hull.v"] * old["appendage.force"] - new["appendage.force"] * old["hull.v"]
        lost.append(h * abs(power))
    lost.sort()
    assert lost[len(lost) // 2] == pytest.approx(1e-5 * 0.9 ** (1 / 0.15), rel=0.1)


def test_steps_end_at_communication_points(direct: Bench) -> None:
    """All in whole nanoseconds; a point hardly changes how long the steps are."""
    given = f'{WIDE}, step = "0.1 ms", absolute_tolerance = 1e-4'
    free, cut = two_bodies(direct, ecco=given), two_bodies(direct, step="33 ms", ecco=given)
    of_free, of_cut = watched(free), watched(cut)
    free.step()
    for _ in range(30):
        cut.step()
        assert of_cut[-1][0] + of_cut[-1][1] == cut.time
    for steps in (of_free, of_cut):
        for (t, h, _), (following, _, _) in itertools.pairwise(steps):
            assert t + h == following
            assert round(t * 1e9) / 1e9 == t
    at = 0.5
    lengths = [next(h for t, h, _ in steps if t >= at) for steps in (of_free, of_cut)]
    assert lengths[0] == pytest.approx(lengths[1], rel=0.1)
    assert min(h for _, h, _ in of_cut[:-1]) >= 1e-9


def test_limits_of_length_and_change(direct: Bench) -> None:
    given = 'min_step = "2 ms", step = "2 ms", max_step = "7 ms", absolute_tolerance = 1e9'
    loose, tight = two_bodies(direct, ecco=given), two_bodies(direct, ecco=given.replace("1e9", "1e-9"))  # fmt: skip
    steps, others = watched(loose), watched(tight)
    loose.step()
    tight.step()
    assert [h for _, h, _ in steps[:7]] == pytest.approx([0.002, 0.002, 0.003, 0.0045, 0.00675, 0.007, 0.007])  # fmt: skip
    assert {round(h, 9) for _, h, _ in others} == {0.002}
    (taken,) = loose.notes()
    assert taken == f"ecco took {len(steps)} steps of 0.002 s to 0.007 s for 1 communication steps"
    assert "missed the tolerance of the power bonds at ecco.min_step, 0.002 s" in tight.notes()[1]


@pytest.mark.slow
def test_factors_of_a_bond_are_those_of_its_connections(direct: Bench) -> None:
    """A force that is given with the other sign, and turned on its way, is the same bond."""
    text = (direct.folder / "bodies.py").read_text("utf-8")
    turned = text[text.index("class Appendage") : text.index("class Rigid")]
    turned = turned.replace("Appendage", "Turned").replace('{"force": force}', '{"force": -force}')
    (direct.folder / "bodies.py").write_text(f"{text}\n\n{turned}", "utf-8")
    back = BODY_CONNECTIONS.replace('"hull.force"', '{ to = "hull.force", factor = -1.0 }')
    masters = [
        two_bodies(direct),
        direct.master(TWO_BODIES.replace("Appendage", "Turned"), back, top=top()),
    ]
    for master in masters:
        master.step()
    positions = [value(master, "hull.x") for master in masters]
    assert positions[0] == positions[1]


@pytest.mark.slow
def test_saved_and_restored_it_goes_on_the_same(direct: Bench) -> None:
    master = two_bodies(direct, step="50 ms")
    for _ in range(4):
        master.step()
    saved = master.save()
    rows = []
    for _ in range(2):
        for _ in range(6):
            master.step()
        rows.append((list(master.signals), master.notes()))
        master.restore(saved)
    assert rows[0] == rows[1]


def test_an_event_begins_the_control_anew(direct: Bench) -> None:
    master = two_bodies(direct, step="100 ms", ecco='step = "1 ms", absolute_tolerance = 1.0')
    steps = watched(master)
    master.step()
    before = len(steps)
    master.override("hull", "force", 2.0)
    master.step()
    assert steps[before - 1][1] > 0.002
    assert [h for _, h, _ in steps[before : before + 2]] == pytest.approx([0.001, 0.001])


def test_discarded_steps_are_repeated_in_smaller_ones(direct: Bench) -> None:
    """A component that takes no step above 30 ms from 0.35 s on: the integral of 1 is the time."""
    parts = TWO_BODIES + 'meter = { fmu = "bodies.py:Coarse", set = { u = 1.0 } }\n'
    given = 'step = "10 ms", absolute_tolerance = 1e9'
    master = direct.master(parts, BODY_CONNECTIONS, top=top("250 ms", given))
    for _ in range(4):
        master.step()
    assert value(master, "meter.x") == pytest.approx(1.0, rel=1e-12)
    assert any("were discarded" in note for note in master.notes())


@pytest.mark.slow
def test_a_rig_as_an_fmu_takes_the_same_steps(direct: Bench) -> None:
    system = direct.system(TWO_BODIES, BODY_CONNECTIONS, top=top("50 ms"))
    rig = rig_source(system, face_of(system), "rig").component_class()("rig")
    rig.setup(0.0)
    rig.initialise()
    rig.begin()
    master = Master(system)
    master.initialise()
    for i in range(10):
        rig.advance(i * 0.05, 0.05)
        master.step()
    assert rig.get("hull.x") == value(master, "hull.x")


@pytest.mark.parametrize(
    ("bonds", "message"),
    [
        ('axle = ["appendage.v_hul", "hull.force"]', r"rig\.toml: bonds\.axle: appendage: unknown input 'v_hul'.*did you mean 'v_hull'"),
        ('axle = ["apendage.v_hull", "hull.force"]', r"bonds\.axle: unknown component 'apendage'"),
        ('axle = ["hull.v", "hull.force"]', r"bonds\.axle: hull\.v is output; a bond names the two inputs"),
        ('axle = ["hull.drag", "hull.force"]', r"hull\.drag is parameter; a bond names"),
        ('axle = ["appendage.v_hull", "appendage.x_hull"]', r"one connection there and one back .*v_hull \(hull -> appendage\) and appendage\.x_hull \(hull -> appendage\)"),
        ('axle = ["appendage.v_hull", "other.force"]', r"other\.force: no connection feeds it"),
        ('axle = ["own.force", "own.force"]', r"own -> own"),
        ('axle = ["appendage.v_hull", "summed.force"]', r"summed\.force is fed by the sum total"),
        ('axle = ["appendage.v_hull"]', r"bonds\.axle"),
        ('axle = ["appendage.v_hull", "hull.force"]\nkeel = ["hull.force", "appendage.x_hull"]', r"bonds\.keel: hull\.force is in axle too"),
        ("", r'algorithm = "ecco" controls its steps by power bonds; bonds names none'),
    ],
)  # fmt: skip
def test_what_is_no_bond_is_named(direct: Bench, bonds: str, message: str) -> None:
    parts = TWO_BODIES + (
        'other = { fmu = "bodies.py:Body" }\nown = { fmu = "bodies.py:Own" }\n'
        'summed = { fmu = "bodies.py:Body" }\ntotal = { sum = { inputs = 1 } }\n'
    )
    with (direct.folder / "bodies.py").open("a", encoding="utf-8") as file:
        file.write('\n\nclass Own(Body):\n    """Fed by itself."""\n')
    more = (
        '"own.v" = { to = "own.force", convert = false }\n'
        '"appendage.force" = ["hull.force", "total.in[0]"]\n"total.out" = "summed.force"\n'
    )
    connections = BODY_CONNECTIONS.replace('"appendage.force" = "hull.force"\n', more)
    with pytest.raises(InputError, match=message):
        direct.master(parts, connections, top=top(bonds=bonds))


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ('step = "2 s"', r"ecco: 0 < min_step <= step <= max_step is needed, found 0\.001 s, 2\.0 s and 1\.0 s"),
        ('min_step = "2 s", step = "2 s", max_step = "2 s"', r"ecco\.min_step: 2\.0 s is longer than the communication step of 1\.0 s"),
        ('min_step = "0 s"', r"0 < min_step"),
        ('step = "fast"', r"ecco\.step: "),
        ("absolute_tolerance = 0.0", r"ecco\.absolute_tolerance"),
        ("tolerance = 1.0", r"ecco.*tolerance"),
    ],
)  # fmt: skip
def test_settings_that_do_not_fit_are_named(direct: Bench, given: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        two_bodies(direct, ecco=given)


def test_components_with_a_step_of_their_own_are_named(direct: Bench) -> None:
    parts = TWO_BODIES.replace('fmu = "bodies.py:Body"', 'fmu = "bodies.py:Body", step = "2 s"')
    with pytest.raises(InputError, match='algorithm = "ecco": hull has a step of its own'):
        direct.master(parts, BODY_CONNECTIONS, top=top())


def test_a_trial_names_algorithm_and_settings(direct: Bench) -> None:
    """Settings of another algorithm are dropped when --set chooses one; bonds stay."""
    direct.system(TWO_BODIES, BODY_CONNECTIONS, top=f'step = "1 s"\n[bonds]\n{AXLE}\n')
    (direct.folder / "t.toml").write_text('rig = "rig.toml"\nstop = "1 s"\n', "utf-8")

    def loaded(**changes: Any) -> Any:
        written = {key.replace("__", "."): one for key, one in changes.items()}
        return load_trial(str(direct.folder / "t.toml"), changes=written, origin="--set").rig.file

    given = loaded(algorithm="ecco", ecco__absolute_tolerance=1e-3, ecco__max_step="5 ms")
    assert (given.ecco.absolute_tolerance, given.ecco.max_step) == (1e-3, "5 ms")
    with pytest.raises(InputError, match="ecco has no effect with 'jacobi'"):
        loaded(ecco__absolute_tolerance=1e-3)
    direct.system(TWO_BODIES, BODY_CONNECTIONS, top=top())
    assert loaded(algorithm="jacobi").ecco is None
    both = loaded(ecco__step="1 ms").ecco
    assert (both.step, both.max_step) == ("1 ms", "1 s")


# ---------------------------------------------------------------------- system structures of OSP


CONFIGURATION = """    <EccoConfiguration>
        <SafetyFactor>0.99</SafetyFactor><StepSize>0.001</StepSize>
        <MinimumStepSize>0.00001</MinimumStepSize><MaximumStepSize>0.05</MaximumStepSize>
        <MinimumChangeRate>0.2</MinimumChangeRate><MaximumChangeRate>1.5</MaximumChangeRate>
        <ProportionalGain>0.2</ProportionalGain><IntegralGain>0.15</IntegralGain>
        <RelativeTolerance>1e-6</RelativeTolerance><AbsoluteTolerance>1e-5</AbsoluteTolerance>
    </EccoConfiguration>
"""
PAIR = """<VariableConnection powerBond="axle">
            <Variable simulator="two" name="q[1]"/><Variable simulator="three" name="x"/>
        </VariableConnection>
        <VariableConnection{}>
            <Variable simulator="two" name="y"/><Variable simulator="three" name="{}"/>
        </VariableConnection>"""
OWN = """<VariableConnection>
            <Variable simulator="two" name="y"/><Variable simulator="two" name="q[1]"/>
        </VariableConnection>"""


def ecco_file(folder: Path, second: str = ' powerBond="axle"', name: str = "q[1]", *more: tuple[str, str]) -> Path:  # fmt: skip
    return write_osp(
        folder,
        ("<Algorithm>fixedStep", "<Algorithm>ecco"),
        (OWN, PAIR.format(second, name)),
        ("</OspSystemStructure>", f"{CONFIGURATION}</OspSystemStructure>"),
        *more,
    )


def test_a_system_structure_with_ecco_is_read_and_written(tmp_path: Path) -> None:
    package = read_osp(ecco_file(tmp_path / "in"))
    rig = package.rig
    assert rig.file.algorithm == "ecco"
    assert rig.file.bonds == {"axle": ["two.q[1]", "three.q[1]"]}
    assert rig.file.ecco.model_dump() == {
        "step": "1000000 ns", "min_step": "10000 ns", "max_step": "50000000 ns",
        "safety_factor": 0.99, "min_change": 0.2, "max_change": 1.5,
        "proportional_gain": 0.2, "integral_gain": 0.15,
        "relative_tolerance": 1e-6, "absolute_tolerance": 1e-5,
    }  # fmt: skip
    assert rig.step_ns == 50_000_000
    notes = "\n".join(package.notes)
    assert "BaseStepSize has no effect with ecco" in notes
    assert "stepSize of slow, last has no effect with ecco, as in libcosim" in notes
    folder, notes_ = export_osp(str(tmp_path / "in" / "OspSystemStructure.xml"), tmp_path / "out")
    assert not any("cannot be said" in note for note in notes_)
    again = read_osp(folder).rig.file
    assert (again.bonds, again.algorithm) == (rig.file.bonds, "ecco")
    lengths = [one.ecco.lengths(50_000_000, "") for one in (again, rig.file)]
    assert lengths[0] == lengths[1]


@pytest.mark.slow
@pytest.mark.parametrize(("algorithm", "left_out"), [("ecco", False), ("jacobi", True)])
def test_what_libcosim_does_not_read_is_noted(
    algorithm: str, left_out: bool, direct: Bench
) -> None:
    """Its reader refuses more than one bond, with either algorithm."""
    parts = (
        TWO_BODIES + 'other = { fmu = "bodies.py:Body" }\nnext = { fmu = "bodies.py:Appendage" }\n'
    )
    more = '"other.v" = "next.v_hull"\n"next.force" = "other.force"\n'
    two = f'{AXLE}\nkeel = ["next.v_hull", "other.force"]'
    text = top(bonds=two) if algorithm == "ecco" else f'step = "1 s"\n[bonds]\n{two}\n'
    direct.system(parts, BODY_CONNECTIONS + more, top=text)
    folder, notes = export_osp(str(direct.folder / "rig.toml"), direct.folder / "osp")
    (note,) = (note for note in notes if "power bonds axle, keel" in note)
    assert note.endswith("left out") is left_out
    assert len(read_osp(folder).rig.file.bonds) == (0 if left_out else 2)


def test_a_bond_with_a_factor_is_not_exported(direct: Bench) -> None:
    turned = BODY_CONNECTIONS.replace('"hull.force"', '{ to = "hull.force", factor = -1.0 }')
    direct.system(TWO_BODIES, turned, top=top())
    with pytest.raises(InputError, match="the power bond axle: OSP-IS has none on connections"):
        export_osp(str(direct.folder / "rig.toml"), direct.folder / "osp")


@pytest.mark.parametrize(
    ("second", "name", "more", "message"),
    [
        ("", "q[1]", (), r"line \d+: the power bond 'axle' is one connection there and one back .* feed two\.q\[1\]"),
        (' powerBond="other"', "q[1]", (), r"the power bond 'axle'"),
        (' powerBond="axle"', "q[1]", (("<IntegralGain>0.15</IntegralGain>", ""),), r"missing: IntegralGain"),
        (' powerBond="axle"', "q[1]", (("<SafetyFactor>0.99", "<SafetyFactor>1.99"),), r"ecco\.safety_factor"),
        (' powerBond="axle"', "q[1]", ((CONFIGURATION, ""),), "ecco needs an EccoConfiguration"),
    ],
)  # fmt: skip
def test_what_is_wrong_in_a_system_structure_is_named(
    second: str, name: str, more: tuple[tuple[str, str], ...], message: str, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=message):
        read_osp(ecco_file(tmp_path, second, name, *more))
