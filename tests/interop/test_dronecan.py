"""The dronecan package as the other node of a simulated bus."""

import math
from itertools import pairwise

import pytest
from dronecan import uavcan
from dronecan.app.dynamic_node_id import CentralizedServer
from dronecan.app.node_monitor import NodeMonitor
from dronecan.transport import get_active_union_field

from seatrial_kits.can.dronecan.autopilot import DroneCanAutopilot
from seatrial_kits.can.dronecan.peripheral import DroneCanPeripheral
from tests.kits.can.dronecan.bench import bench, made

RPM = math.tau / 60.0


def peripheral(name="esc", **values):
    return made(DroneCanPeripheral, name, **{"node_id": 10.0, **values})


def autopilot(**values):
    return made(DroneCanAutopilot, "autopilot", **{"node_id": 1.0, **values})


def test_raw_commands_reach_the_channels_that_they_name():
    node = peripheral(channels="esc2 esc0")
    with bench(node) as b:
        b.peer.broadcast(uavcan.equipment.esc.RawCommand(cmd=[8191, 4000, -2048]))
        b.until(lambda: node.get("command.c1"), 0.1)
        assert node.get("command.c1") == pytest.approx(-2048 / 8191, abs=1e-12)
        assert node.get("command.c2") == 1.0
        assert node.get("pulse.c2") == pytest.approx(1.9e-3, abs=1e-12)
        assert node.get("pulse.c1") == pytest.approx(1.5e-3 - 0.4e-3 * 2048 / 8191, abs=1e-9)
        assert node.get("pulse.c3") == 1.5e-3
        b.peer.broadcast(uavcan.equipment.esc.RawCommand(cmd=[-8192]))
        b.until(lambda: node.get("command.c2") < 0, 0.1)
        assert node.get("command.c2") == -1.0  # full scale is 8191
        assert node.get("command.c1") == pytest.approx(-2048 / 8191, abs=1e-12)  # not mentioned


def test_actuators_take_their_own_type_of_command_and_no_other():
    node = peripheral(channels="rpm0 actuator3 actuator4:position actuator200:pwm")
    command = uavcan.equipment.actuator.Command
    with bench(node) as b:
        commands = [
            command(actuator_id=3, command_type=0, command_value=-0.5),
            command(actuator_id=4, command_type=1, command_value=0.25),
            command(actuator_id=200, command_type=4, command_value=1700.0),
        ]
        b.peer.broadcast(uavcan.equipment.actuator.ArrayCommand(commands=commands))
        b.peer.broadcast(uavcan.equipment.esc.RPMCommand(rpm=[-3000]))
        b.until(lambda: node.get("command.c1"), 0.1)
        found = node.get("command")[:4]
        assert found == pytest.approx([-3000 * RPM, -0.5, 0.25, 1.7e-3], abs=1e-9)
        assert node.get("pulse")[:4] == pytest.approx([1.5e-3, 1.3e-3, 1.5e-3, 1.7e-3])
        wrong = [
            command(actuator_id=3, command_type=1, command_value=1.0),
            command(actuator_id=4, command_type=1, command_value=math.nan),
            command(actuator_id=200, command_type=0, command_value=1.0),
        ]
        b.peer.broadcast(uavcan.equipment.actuator.ArrayCommand(commands=wrong))
        b.run(0.01)
        assert node.get("command")[:4] == found


def test_commands_that_stop_make_the_outputs_neutral():
    node = peripheral(channels="esc0 actuator1:pwm", command_timeout=0.25)
    pwm = uavcan.equipment.actuator.Command(actuator_id=1, command_type=4, command_value=1600.0)
    with bench(node) as b:
        statuses = b.collect(uavcan.protocol.NodeStatus)
        b.run(1.1)
        assert node.get("failsafe")  # nobody has commanded yet, and so nothing is wrong
        assert statuses[-1].message.health == 0
        b.peer.broadcast(uavcan.equipment.esc.RawCommand(cmd=[4096]))
        b.peer.broadcast(uavcan.equipment.actuator.ArrayCommand(commands=[pwm]))
        begun = b.until(lambda: node.get("pulse.c2") != 1.5e-3, 0.1)
        ended = b.until(lambda: node.get("command.c1") == 0.0, 1.0)
        assert 0.24 < ended - begun < 0.253  # from the end of the frame
        b.run(0.002)
        assert node.get("command.c2") == node.get("pulse.c2") == 1.5e-3
        assert node.get("failsafe")
        b.run(1.0)
        assert statuses[-1].message.health == 1
        b.peer.broadcast(uavcan.equipment.esc.RawCommand(cmd=[4096]))
        b.peer.broadcast(uavcan.equipment.actuator.ArrayCommand(commands=[pwm]))
        b.until(lambda: not node.get("failsafe"), 0.1)
        assert node.get("command.c1") == pytest.approx(4096 / 8191)


def test_status_has_what_is_measured_and_nan_for_the_rest():
    node = peripheral(
        channels="esc3 actuator7", measured="voltage current speed", status_period=0.1
    )
    with bench(node) as b:
        escs = b.collect(uavcan.equipment.esc.Status)
        servos = b.collect(uavcan.equipment.actuator.Status)
        node.set("voltage.c1", 15.9)
        node.set("current.c1", -0.7071)
        node.set("speed", [1500 * RPM, 0.5, *[0.0] * 6])
        b.run(1.05)
        assert 9 <= len(escs) <= 11
        assert len(servos) == len(escs)
        esc, servo = escs[-1].message, servos[-1].message
        # float16: the spec's own figures.
        assert esc.voltage == pytest.approx(15.8984, abs=1e-4)
        assert esc.current == pytest.approx(-0.7070, abs=1e-4)
        assert math.isnan(esc.temperature)
        assert (esc.rpm, esc.esc_index, esc.power_rating_pct) == (1500, 3, 0)
        assert (servo.actuator_id, servo.speed, servo.power_rating_pct) == (7, 0.5, 127)
        assert math.isnan(servo.position)
        assert math.isnan(servo.force)


def test_the_packages_monitor_discovers_the_node():
    node = peripheral(node_name="org.seatrial.esc", unique_id="00112233445566778899aabbccddeeff")
    node.set("software_version", "2.7")
    with bench(node) as b:
        monitor = NodeMonitor(b.peer)
        b.until(lambda: monitor.exists(10) and monitor.get(10).discovered, 3.0)
        info = monitor.get(10).info
        assert info.name.decode() == "org.seatrial.esc"
        assert bytes(info.hardware_version.unique_id).hex() == "00112233445566778899aabbccddeeff"
        assert (info.software_version.major, info.software_version.minor) == (2, 7)
        b.run(5.0)
        assert monitor.get(10).status.mode == info.status.MODE_OPERATIONAL
        assert 4 <= monitor.get(10).status.uptime_sec <= b.now()
        statuses = [when for when, frame in b.frames if frame.identifier >> 8 & 0xFFFF == 341]
        gaps = [late - early for early, late in pairwise(statuses)]
        assert gaps == pytest.approx([1e9] * len(gaps), abs=1e6)  # others' frames may be first


def param(**fields):
    return uavcan.protocol.param.GetSet.Request(**fields)


def value(**fields):
    return uavcan.protocol.param.Value(**fields)


def shown(response):
    field = get_active_union_field(response.value)
    found = getattr(response.value, field)
    return found.decode() if field == "string_value" else found


def test_parameters_are_listed_read_and_set():
    node = peripheral()
    with bench(node) as b:
        names = []
        while True:
            response = b.request(param(index=len(names)), 10)
            if not response.name.decode():
                break
            names.append(response.name.decode())
        assert names[:2] == ["NODE_ID", "CHANNELS"]
        assert {"COMMAND_TIMEOUT", "STATUS_PERIOD"} <= set(names)
        # Of each type: integer, real, string.
        response = b.request(param(name="NODE_ID"), 10)
        assert (shown(response), response.max_value.integer_value) == (10, 127)
        assert shown(b.request(param(name="CHANNELS"), 10)) == "esc0"
        response = b.request(param(name="COMMAND_TIMEOUT", value=value(real_value=0.5)), 10)
        assert shown(response) == 0.5
        assert response.default_value.real_value == pytest.approx(0.2)
        # What does not fit is not taken, and the answer says what stays.
        for wrong in (value(real_value=-1.0), value(integer_value=1), value(real_value=math.nan)):
            assert shown(b.request(param(name="COMMAND_TIMEOUT", value=wrong), 10)) == 0.5
        assert (
            shown(b.request(param(name="CHANNELS", value=value(string_value="fin")), 10)) == "esc0"
        )
        unknown = b.request(param(name="NO_SUCH", value=value(real_value=1.0)), 10)
        assert (unknown.name.decode(), get_active_union_field(unknown.value)) == ("", "empty")
        b.peer.broadcast(uavcan.equipment.esc.RawCommand(cmd=[4096]))
        begun = b.until(lambda: node.get("command.c1"), 0.1)
        assert b.until(lambda: not node.get("command.c1"), 1.0) - begun > 0.49


def execute(b, opcode):
    return b.request(uavcan.protocol.param.ExecuteOpcode.Request(opcode=opcode), 10).ok


def restart(b, magic=0xACCE551B1E):
    return b.request(uavcan.protocol.RestartNode.Request(magic_number=magic), 10).ok


def test_what_is_saved_outlives_a_restart():
    node = peripheral(status_period=0.2)
    with bench(node) as b:
        period = param(name="STATUS_PERIOD")
        b.request(param(name="STATUS_PERIOD", value=value(real_value=0.05)), 10)
        assert not restart(b, magic=1)
        assert shown(b.request(period, 10)) == pytest.approx(0.05)
        assert restart(b)
        assert shown(b.request(period, 10)) == pytest.approx(0.2)
        b.request(param(name="STATUS_PERIOD", value=value(real_value=0.05)), 10)
        b.request(param(name="CHANNELS", value=value(string_value="esc5")), 10)
        assert execute(b, 0)
        assert restart(b)
        assert shown(b.request(period, 10)) == pytest.approx(0.05)
        statuses = b.collect(uavcan.equipment.esc.Status)
        b.run(1.0)
        assert 19 <= len(statuses) <= 21
        assert statuses[-1].message.esc_index == 5
        assert execute(b, 1)
        assert shown(b.request(period, 10)) == pytest.approx(0.2)
        assert not execute(b, 7)


def test_the_packages_allocator_gives_each_node_an_id():
    nodes = [peripheral(name, node_id=0.0) for name in ("esc1", "esc2", "gps")]
    with bench(*nodes) as b:
        server = CentralizedServer(b.peer, NodeMonitor(b.peer))
        b.until(lambda: all(node.get("own_id") for node in nodes), 20.0)
        ids = {node.get("own_id") for node in nodes}
        assert ids == {125, 124, 123}
        anonymous = [f for _, f in b.frames if f.identifier & 0x7F == 0]
        assert len({f.identifier for f in anonymous}) == len(anonymous)  # discriminators differ
        assert len(anonymous) >= 9  # three parts each
        table = server.get_allocation_table()
        unique = {number: bytes(found) for found, number in table if found is not None}
        for node in nodes:
            info = b.request(uavcan.protocol.GetNodeInfo.Request(), node.get("own_id"))
            assert bytes(info.hardware_version.unique_id) == unique[node.get("own_id")]
        server.close()


def test_a_node_without_an_id_is_silent_but_for_asking():
    node = peripheral(node_id=0.0)
    with bench(node) as b:
        b.peer.broadcast(uavcan.equipment.esc.RawCommand(cmd=[4096]))
        b.run(5.0)
        assert node.get("own_id") == 0
        assert node.get("command.c1") == 0.0
        assert {frame.identifier & 0x7F for _, frame in b.frames} == {0}
        times = [when / 1e9 for when, _ in b.frames]
        gaps = [late - early for early, late in pairwise(times)]
        assert all(0.6 <= gap <= 1.002 for gap in gaps)
        assert len(set(gaps)) == len(gaps)


def test_the_autopilot_commands_as_the_package_reads_it():
    node = autopilot(channels="esc1 esc3 rpm0 actuator9:pwm actuator2", command_period=0.02)
    with bench(node) as b:
        kinds = uavcan.equipment.esc.RawCommand, uavcan.equipment.esc.RPMCommand
        raw, rpm = map(b.collect, kinds)
        arrays = b.collect(uavcan.equipment.actuator.ArrayCommand)
        node.set("command", [0.5, -2.0, 1000 * RPM, 1.234e-3, -0.25, 0.0, 0.0, 0.0])
        b.run(1.005)
        assert len(raw) == len(rpm) == len(arrays) == 51
        assert list(raw[0].message.cmd) == [0, 4096, 0, -8191]
        assert list(rpm[0].message.rpm) == [1000]
        assert raw[0].transfer.transfer_priority == 8
        pwm, fin = arrays[0].message.commands
        assert (pwm.actuator_id, pwm.command_type, pwm.command_value) == (9, 4, 1234.0)
        assert (fin.actuator_id, fin.command_type, fin.command_value) == (2, 0, -0.25)
        assert [each.transfer.transfer_id for each in raw[:34]] == [*range(32), 0, 1]
        node.set("enabled", False)
        b.run(0.005)
        before = len(raw)
        b.run(0.1)
        assert len(raw) == before


def test_the_autopilot_reads_status_of_the_packages_nodes():
    node = autopilot(channels="esc0 actuator2", timeout=0.5)
    with bench(node) as b:
        esc = uavcan.equipment.esc.Status(
            voltage=15.0, current=2.5, temperature=math.nan, rpm=-600, esc_index=0
        )
        servo = uavcan.equipment.actuator.Status(
            actuator_id=2, position=0.125, force=math.nan, speed=-1.5
        )
        b.peer.broadcast(esc)
        b.peer.broadcast(servo)
        b.until(lambda: all(node.get("status_valid")[:2]), 0.1)
        assert node.get("voltage")[:2] == [15.0, 0.0]
        assert node.get("current.c1") == 2.5
        assert node.get("temperature.c1") == 0.0
        assert node.get("speed")[:2] == pytest.approx([-600 * RPM, -1.5])
        assert node.get("position")[:2] == [0.0, 0.125]
        b.run(0.6)
        assert not any(node.get("status_valid"))
        assert node.get("voltage.c1") == 15.0
        b.run(1.0)
        assert node.get("others") == 1  # the peer


def test_a_fix_crosses_the_bus_and_the_package_reads_where_it_is():
    home = {"latitude": math.radians(-31.78), "longitude": math.radians(-52.26), "altitude": 3.0}
    gps = peripheral("gps", node_id=20.0, channels="", gnss_period=0.2, date="2026-02-05", **home)
    node = autopilot(**home)
    with bench(node, gps) as b:
        fixes = b.collect(uavcan.equipment.gnss.Fix2)
        gps.set("position_n", [120.5, -43.21, -0.5])
        gps.set("velocity_n", [1.25, -0.5, 0.0625])
        b.run(1.1)
        assert len(fixes) == 6
        fix = fixes[-1].message
        # 111 132.954 - 559.822 cos 2 phi + 1.175 cos 4 phi m per degree (Snyder, 1987).
        phi = math.radians(-31.78)
        degree = 111132.954 - 559.822 * math.cos(2 * phi) + 1.175 * math.cos(4 * phi)
        assert fix.latitude_deg_1e8 / 1e8 == pytest.approx(-31.78 + 120.5 / degree, abs=2e-8)
        assert fix.height_msl_mm == 3500
        assert list(fix.ned_velocity) == [1.25, -0.5, 0.0625]
        assert (fix.status, fix.gnss_time_standard) == (3, 2)
        # 5 February 2026, 0 h UTC, and a second.
        assert fix.gnss_timestamp.usec == 1770249601_000_000
        assert node.get("position_valid")
        assert node.get("position_n") == pytest.approx([120.5, -43.21, -0.5], abs=2e-3)
        assert node.get("velocity_n") == [1.25, -0.5, 0.0625]
        gps.set("position_valid", False)
        b.until(lambda: not node.get("position_valid"), 0.3)
        assert fixes[-1].message.status == 0
        assert node.get("position_n") == pytest.approx([120.5, -43.21, -0.5], abs=2e-3)


def test_an_acceleration_that_nothing_measures_is_unknown():
    """0 would be free fall."""
    ahrs = peripheral("ahrs", node_id=21.0, channels="", ahrs_period=0.02)
    node = autopilot()
    with bench(node, ahrs) as b:
        solutions = b.collect(uavcan.equipment.ahrs.Solution)
        ahrs.set("attitude", [0.3, -0.4, -2.9])
        b.run(0.1)
        found = solutions[-1].message
        assert all(map(math.isnan, (*found.linear_acceleration, *found.angular_velocity)))
        assert node.get("attitude_valid")
        assert node.get("attitude") == pytest.approx([0.3, -0.4, -2.9], abs=1e-3)
        assert node.get("acceleration") == [0.0, 0.0, 0.0]


def test_attitude_crosses_the_bus():
    ahrs = peripheral("ahrs", node_id=21.0, channels="", ahrs_period=0.02)
    node = autopilot()
    with bench(node, ahrs) as b:
        solutions = b.collect(uavcan.equipment.ahrs.Solution)
        attitude, rates, force = [0.3, -0.4, -2.9], [0.1, -0.2, 0.5], [1.0, 0.5, -9.8]
        ahrs.set("attitude", attitude)
        ahrs.set("rates", rates)
        ahrs.set("acceleration", force)
        b.run(0.1)
        assert len(solutions) == 5
        assert sum(q * q for q in solutions[-1].message.orientation_xyzw) == pytest.approx(
            1, abs=2e-3
        )
        assert node.get("attitude_valid")
        # Eleven bits of a float16: 5e-4 of 1, twice as much as an angle.
        assert node.get("attitude") == pytest.approx(attitude, abs=1e-3)
        assert node.get("rates") == pytest.approx(rates, abs=3e-4)
        assert node.get("acceleration") == pytest.approx(force, abs=4e-3)
        ahrs.set("attitude_valid", False)
        b.run(1.1)
        assert not node.get("attitude_valid")


def test_a_battery_crosses_the_bus_and_what_is_unknown_stays_so():
    pack = peripheral("pack", node_id=22.0, channels="", battery_period=0.1, battery_id=3.0)
    node = autopilot()
    with bench(node, pack) as b:
        infos = b.collect(uavcan.equipment.power.BatteryInfo)
        pack.set("battery_voltage", 15.9)
        pack.set("battery_current", -2.5)
        b.run(0.25)
        found = infos[-1].message
        assert found.voltage == pytest.approx(15.9, abs=0.008)
        assert (found.current, found.battery_id) == (-2.5, 3)
        assert math.isnan(found.temperature)
        assert math.isnan(found.remaining_capacity_wh)
        assert found.state_of_charge_pct == 127
        assert node.get("battery_valid")
        assert node.get("battery_current") == -2.5
        assert (node.get("battery_temperature"), node.get("battery_charge")) == (0.0, 0.0)
        pack.set("battery_charge", 0.42)
        pack.set("battery_temperature", 300.0)
        b.run(0.2)
        assert infos[-1].message.state_of_charge_pct == 42
        assert node.get("battery_charge") == pytest.approx(0.42)
        assert node.get("battery_temperature") == pytest.approx(300.0, abs=0.13)
        b.peer.broadcast(uavcan.equipment.power.BatteryInfo(voltage=12.0, state_of_charge_pct=7))
        b.run(0.02)
        assert node.get("battery_charge") == pytest.approx(0.07)


def test_a_magnetometer_reads_the_earths_field_in_body_axes():
    """NOAA's calculator (WMM2025, 2026.0) at 63.4 N, 10.4 E: some 52.3 uT, 76 degrees down."""
    home = {"latitude": math.radians(63.4), "longitude": math.radians(10.4)}
    compass = peripheral("compass", node_id=23.0, channels="", magnetometer_period=0.05, **home)
    node = autopilot()
    with bench(node, compass) as b:
        fields = b.collect(uavcan.equipment.ahrs.MagneticFieldStrength2)
        b.run(0.2)
        north, east, down = fields[-1].message.magnetic_field_ga
        assert math.hypot(north, east, down) == pytest.approx(0.523, abs=0.01)
        assert math.degrees(math.atan2(down, math.hypot(north, east))) == pytest.approx(
            75.5, abs=1.5
        )
        assert node.get("magnetic_field") == pytest.approx(
            [north * 1e-4, east * 1e-4, down * 1e-4], rel=1e-6
        )
        compass.set("attitude", [0.0, 0.0, math.pi / 2])  # the bow to the east
        b.run(0.1)
        turned = fields[-1].message.magnetic_field_ga
        assert list(turned) == pytest.approx([east, -north, down], abs=3e-4)
        compass.set("magnetic_field", [1e-5, 2e-5, -3e-5])
        b.run(0.1)
        assert node.get("magnetic_field") == pytest.approx([1e-5, 2e-5, -3e-5], rel=1e-3)
        older = uavcan.equipment.ahrs.MagneticFieldStrength(magnetic_field_ga=[0.1, 0.2, 0.3])
        b.peer.broadcast(older)
        b.run(0.02)
        assert node.get("magnetic_field") == pytest.approx([1e-5, 2e-5, 3e-5], rel=1e-3)


def test_a_barometer_reads_the_standard_atmosphere():
    """ISO 2533: 89 874.6 Pa at 1000 m."""
    baro = peripheral("baro", node_id=24.0, channels="", barometer_period=0.1, altitude=1000.0)
    node = autopilot(timeout=0.5)
    with bench(node, baro) as b:
        pressures = b.collect(uavcan.equipment.air_data.StaticPressure)
        b.run(0.15)
        assert pressures[-1].message.static_pressure == pytest.approx(89_874.6, abs=1.0)
        assert node.get("static_pressure") == pytest.approx(89_874.6, abs=1.0)
        assert node.get("air_temperature") == pytest.approx(288.15, abs=0.13)
        baro.set("static_pressure", 101_000.0)
        baro.set("air_temperature", 280.0)
        b.run(0.1)
        assert node.get("static_pressure") == 101_000.0
        assert node.get("air_temperature") == 280.0
        b.peer.broadcast(uavcan.equipment.air_data.StaticPressure(static_pressure=math.nan))
        b.run(0.02)
        assert node.get("static_pressure") == 101_000.0


def test_the_autopilot_says_whether_it_is_armed():
    esc, node = peripheral("esc"), autopilot()
    with bench(node, esc) as b:
        statuses = b.collect(uavcan.equipment.safety.ArmingStatus)
        b.run(0.6)
        assert statuses[-1].message.status == 0  # nothing arms it by itself
        assert not esc.get("armed")
        node.set("armed", True)
        b.until(lambda: esc.get("armed"), 0.6)
        assert statuses[-1].message.status == 255
        node.set("armed", False)
        b.until(lambda: not esc.get("armed"), 0.6)
    esc = peripheral("esc")
    with bench(esc) as b:
        b.peer.broadcast(uavcan.equipment.safety.ArmingStatus(status=255))
        begun = b.until(lambda: esc.get("armed"), 0.1)
        ended = b.until(lambda: not esc.get("armed"), 3.5)
        assert 2.9 < ended - begun < 3.1
