"""The shipped trials make logs from which the shipped experiments find the vehicle again.

A vehicle in six degrees of freedom with thrusters and sensors, not the model that is fitted: the
tolerances contain what the other axes do. Truth is vehicles/videoray.toml.
"""

import pytest

from seatrial.errors import InputError
from seatrial.system.files import available
from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.run import run_trial
from seatrial_kits.identify.studies.experiment import load_experiment
from seatrial_kits.identify.studies.study import study

AXES = {
    # mass with added mass, linear and quadratic drag, each with its relative tolerance
    "surge": ((8.44, 0.02), (0.95, 0.2), (6.04, 0.05)),
    "yaw": ((0.1338, 0.01), (0.023, 0.02), (0.45, 0.002)),
    "heave": ((10.45, 0.005), (3.70, 0.02), (26.36, 0.005)),
}


@pytest.mark.long
@pytest.mark.interop
@pytest.mark.parametrize("axis", AXES)
def test_the_vehicle_is_found_again(axis, tmp_path):
    log = run_trial(load_trial(f"videoray-excite-{axis}"), tmp_path / "log", engine="direct")
    found = study(load_experiment(f"videoray-{axis}"), log.folder)
    physical = found.physical()
    names = ("total mass", "linear", "quadratic")
    for name, (value, tolerance) in zip(names, AXES[axis], strict=True):
        assert physical[name].value == pytest.approx(value, rel=tolerance), name
    assert found.accepted
    assert found.delay == pytest.approx(0.1)
    assert found.estimate.values["time_constant"] == pytest.approx(0.15, rel=0.05)


def test_a_unit_that_contradicts_the_run_is_refused(tmp_path):
    trial = load_trial("videoray-excite-yaw", changes={"stop": "10 s"}, origin="test")
    log = run_trial(trial, tmp_path / "log", engine="direct").folder
    text = available("harness/identification")["videoray-yaw"].read_text("utf-8")
    path = tmp_path / "yaw.toml"
    path.write_text(
        text.replace('"vehicle.ahrs.euler.psi"', '"vehicle.ahrs.euler.psi", unit = "deg"')
    )
    with pytest.raises(
        InputError, match=r"vehicle.ahrs.euler.psi': the file has it in rad, not deg"
    ):
        study(load_experiment(str(path)), log)
