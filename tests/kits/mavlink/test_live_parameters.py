"""Parameters that are set while the vehicle runs, and what they change from then on."""

from __future__ import annotations

import pytest
from pymavlink.dialects.v20 import all as mavlink

from .bench import Bench


def put(bench: Bench, name: str, value: float) -> None:
    """Set a parameter as a ground station does, and check that it is taken."""
    kind = mavlink.MAV_PARAM_TYPE_REAL32
    bench.receive(mavlink.MAVLink_param_set_message(7, 1, name.encode(), value, kind))
    (reported,) = bench.transport.take("PARAM_VALUE")
    assert (reported.param_id, reported.param_value) == (name, pytest.approx(value))


def guided_alone(bench: Bench) -> None:
    """Arm, go into guided mode, and let a ground station be received once."""
    bench.enter("guided")
    bench.arm()
    bench.heartbeat()


@pytest.mark.parametrize(("action", "mode"), [(1, "return"), (2, "hold"), (6, "loiter")])
def test_fs_action_is_what_the_failsafe_does(action: int, mode: str) -> None:
    bench = Bench(failsafe="none")
    guided_alone(bench)
    put(bench, "FS_ACTION", action)
    bench.wait(6.0)
    assert bench.vehicle.mode.name == mode


def test_fs_gcs_timeout_is_how_long_it_waits() -> None:
    bench = Bench(station_timeout=5.0)
    guided_alone(bench)
    put(bench, "FS_GCS_TIMEOUT", 1.5)
    bench.wait(1.5)
    assert bench.vehicle.mode.name == "guided"
    bench.tick()
    assert bench.vehicle.mode.name == "hold"


@pytest.mark.slow
def test_fs_gcs_enable_switches_it_off() -> None:
    bench = Bench()
    guided_alone(bench)
    put(bench, "FS_GCS_ENABLE", 0)
    bench.wait(60.0)
    assert (bench.vehicle.mode.name, bench.vehicle.failsafe) == ("guided", False)


@pytest.mark.parametrize(("enabled", "mode"), [(1, "hold"), (0, "manual")])
def test_fs_timeout_and_fs_thr_enable_are_for_manual_control(enabled: int, mode: str) -> None:
    bench = Bench(manual_timeout=30.0)
    bench.enter("manual")
    bench.arm()
    put(bench, "FS_TIMEOUT", 0.5)
    put(bench, "FS_THR_ENABLE", enabled)
    bench.receive(mavlink.MAVLink_manual_control_message(7, 0, 500, 800, 0, 0))
    bench.wait(0.5)
    assert bench.vehicle.mode.name == "manual"
    assert bench.vehicle.manual != (0.0, 0.0, 0.0, 0.0)
    bench.tick()
    assert bench.vehicle.mode.name == mode
    assert bench.vehicle.manual == (0.0, 0.0, 0.0, 0.0)


def test_guid_timeout_is_how_long_a_set_point_is_valid() -> None:
    bench = Bench()
    bench.enter("guided")
    put(bench, "GUID_TIMEOUT", 0.5)
    ahead = mavlink.MAVLink_set_position_target_local_ned_message(
        0, 7, 1, mavlink.MAV_FRAME_LOCAL_NED, 0xDC7, 0, 0, 0, 1.0, 0, 0, 0, 0, 0, 0, 0
    )
    bench.receive(ahead)
    bench.wait(0.5)
    assert bench.vehicle.target is not None
    bench.tick()
    assert bench.vehicle.target is None


@pytest.mark.parametrize(
    ("mask", "reasons"),
    [(1, {"position", "heading"}), (4, {"heading"}), (8, {"position"}), (0, set())],
)
def test_arming_check_says_what_arming_waits_for(mask: int, reasons: set[str]) -> None:
    bench = Bench(valid=False)
    put(bench, "ARMING_CHECK", mask)
    result = bench.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1)
    assert result == (mavlink.MAV_RESULT_FAILED if reasons else mavlink.MAV_RESULT_ACCEPTED)
    assert set(bench.texts()) >= {f"PreArm: no {reason}" for reason in reasons}
    assert bench.vehicle.armed is not bool(reasons)


def test_px4_arms_without_gps_if_set_to() -> None:
    bench = Bench(autopilot="px4", valid=False)
    bench.measure(heading_valid=True)
    arm = (mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1)
    assert bench.command(*arm) == mavlink.MAV_RESULT_FAILED
    bench.receive(
        mavlink.MAVLink_param_set_message(
            7, 1, b"COM_ARM_WO_GPS", 1.401298464324817e-45, mavlink.MAV_PARAM_TYPE_INT32
        )
    )
    assert bench.command(*arm) == mavlink.MAV_RESULT_ACCEPTED


def test_a_submarine_surfaces_if_set_to() -> None:
    bench = Bench(submerged=True)
    guided_alone(bench)
    put(bench, "FS_GCS_ENABLE", 4)
    bench.wait(6.0)
    assert bench.vehicle.mode.name == "surface"
