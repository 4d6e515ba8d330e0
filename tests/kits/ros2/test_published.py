"""Messages of vehicles, by a reader in the same process: against their signals, and each other."""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from seatrial import Simulation
from seatrial.links.geodesy import Origin
from seatrial_kits.ros2.component import Ros2
from seatrial_kits.ros2.instruments import Instruments
from seatrial_kits.ros2.joining import join
from seatrial_kits.ros2.messages.packing import packed
from seatrial_kits.ros2.published import MEASURED, Here, measured
from seatrial_kits.ros2.topics import COMMANDED, PUBLISHED, Names


class Ears:
    """Reads all topics of a vehicle from its first instant on."""

    def __init__(self, domain, vehicle, **settings):
        self.participant = join(domain, "/test", "dds")
        names = Names(vehicle, "")
        self.readers = {
            key: self.participant.reader(names.of(key, topic), topic.kind, 1000)
            for key, topic in PUBLISHED.items()
        }
        self.simulation = Simulation(
            "sil",
            choices={"vehicle": vehicle, "autopilot": "ros2"},
            set={
                "autopilot.ros2.domain": domain,
                **{f"autopilot.ros2.{key}": value for key, value in settings.items()},
            },
        )
        self.writer = self.participant.writer(
            names.of("cmd_vel", COMMANDED["cmd_vel"]), "geometry_msgs/msg/Twist"
        )

    def steer(self, speed, turn):
        twist = {"linear": (speed, 0.0, 0.0), "angular": (0.0, 0.0, turn)}
        self.writer.write(packed("geometry_msgs/msg/Twist", twist))

    def taken(self, key):
        return [s.message for s in self.readers[key].take(1000)]

    def at_one_instant(self, *names):
        """Return signals, and take the step that writes them."""
        found = [self.simulation.get(f"vehicle.{name}") for name in names]
        self.simulation.step(1)
        return found

    def close(self):
        self.simulation.close()
        self.participant.close()


@pytest.fixture
def ears(domain):
    made = []

    def make(vehicle, **settings):
        made.append(Ears(domain, vehicle, **settings))
        return made[-1]

    yield make
    for each in made:
        each.close()


def vector(part):
    return np.array([part.x, part.y, part.z])


def test_an_odometry_integrated_from_its_own_twist_meets_its_own_pose(ears):
    """A turn to port under way, roll and pitch included; and tf says the same."""
    otter = ears("otter", truth_period="10 ms")
    found, frames = [], []
    for _ in range(20):
        otter.steer(1.5, 0.4)
        otter.simulation.step(20)
        found += otter.taken("odometry")
        frames += otter.taken("tf")
    assert len(found) == 400
    place, turn = vector(found[0].pose.pose.position), None
    for before, after in pairwise(found):
        quaternion = before.pose.pose.orientation
        turn = turn or Rotation.from_quat([quaternion.x, quaternion.y, quaternion.z, quaternion.w])
        mean = [
            0.5
            * (vector(getattr(before.twist.twist, part)) + vector(getattr(after.twist.twist, part)))
            for part in ("linear", "angular")
        ]
        half = turn * Rotation.from_rotvec(0.5 * 0.01 * mean[1])
        place = place + 0.01 * half.apply(mean[0])
        turn = turn * Rotation.from_rotvec(0.01 * mean[1])
    last = found[-1].pose.pose
    np.testing.assert_allclose(place, vector(last.position), atol=2e-3)
    q = last.orientation
    assert (turn.inv() * Rotation.from_quat([q.x, q.y, q.z, q.w])).magnitude() < 1e-3
    assert last.position.x < -0.05  # it set out to the north and turned to port: west
    assert found[-1].twist.twist.angular.z > 0.1
    moved = frames[-1].transforms[1]
    assert (moved.header.frame_id, moved.child_frame_id) == ("odom", "base_link")
    assert moved.transform.rotation == q
    assert vector(moved.transform.translation).tolist() == vector(last.position).tolist()


def test_the_sensors_of_a_boat(ears):
    otter = ears("otter")
    otter.simulation.run("1 s")
    (heading,) = otter.at_one_instant("compass.heading")
    imu, fix = otter.taken("imu"), otter.taken("fix")
    assert len(imu) == 101
    force = np.mean([vector(each.linear_acceleration) for each in imu], axis=0)
    # Its data sheet: scales 0.5 %, 16 bits of +-16 g; 2.8 mdeg/s/sqrt(Hz) in the 50 Hz of 10 ms.
    np.testing.assert_allclose(force, [0.0, 0.0, 9.81], atol=0.005 * 9.81 + 0.005)
    noise = math.radians(0.0028) ** 2 * 50.0 + math.radians(0.003) ** 2
    np.testing.assert_allclose(imu[-1].angular_velocity_covariance, np.diag([noise] * 3).ravel())
    yaw = Rotation.from_quat([getattr(imu[-1].orientation, a) for a in "xyzw"]).as_euler("ZYX")[0]
    assert math.remainder(yaw - math.pi / 2 + heading, math.tau) == pytest.approx(0.0, abs=1e-9)
    assert [each.header.frame_id for each in (imu[0], fix[0])] == ["imu_link", "gnss_link"]
    good = [each for each in fix if each.status.status == 0]
    assert good
    assert good[-1].latitude == pytest.approx(63.44, abs=1e-5)
    assert good[-1].longitude == pytest.approx(10.40, abs=1e-5)
    assert good[-1].position_covariance_type == 2
    (field,) = {np.linalg.norm(vector(each.magnetic_field)) for each in otter.taken("compass")[-1:]}
    assert field == pytest.approx(52.1e-6, rel=0.03)  # Trondheim, by NOAA's calculator
    clock = otter.taken("clock")
    assert [each.clock.sec for each in clock] == [0] * 100 + [1]
    (static,) = otter.taken("tf_static")
    antenna = next(t for t in static.transforms if t.child_frame_id == "gnss_link")
    assert vector(antenna.transform.translation).tolist() == [0.0, 0.0, 0.5]
    (described,) = otter.taken("description")
    assert described.data.startswith('<robot name="otter">')
    assert "<visual" in described.data
    speeds = otter.taken("joints")[-1]
    assert speeds.name == ["motor1", "motor2"]
    assert not otter.taken("pressure")
    assert not otter.taken("wind")


@pytest.fixture
def link():
    """The component alone: its inputs are what the functions of messages read."""
    return Ros2("ros2")


def here(**instruments):
    field = (1.4e-5, 1e-6, 5e-5)
    return Here(2_500_000_000, "", Origin(1.0, 0.2), field, Instruments(instruments))


def test_nothing_is_measured_that_nothing_is_connected_to(link):
    assert measured(link) == []
    link.velocity_n, link.motor_speed = (0.0, 0.0, 0.0), [3.0, *[1e30] * 7]
    assert measured(link) == ["velocity", "joints"]


def test_the_wind_blows_to_port_of_the_bow_and_the_joints_are_those_that_are_there(link):
    link.wind_speed, link.wind_angle, link.wind_valid = 5.0, math.radians(-30.0), True
    linear = MEASURED["wind"].make(link, here())["twist"]["linear"]
    assert linear == pytest.approx((5.0 * math.cos(math.radians(30.0)), 2.5, 0.0))
    vector = MEASURED["wind_vector"].make(link, here())
    assert (vector["x"], vector["y"], vector["z"]) == linear
    link.joint, speeds = (0.1, 1.2, 1e30), [30.0, *[1e30] * 7]
    link.motor_speed = speeds
    joints = MEASURED["joints"].make(link, here())
    assert joints["name"] == ["rudder", "sail", "motor1"]
    assert joints["position"][:2] == [0.1, 1.2]
    assert joints["velocity"][2] == 30.0


def test_a_ping_to_starboard_is_a_scan_of_one_range_there(link):
    link.sonar_distance, link.sonar_angle = 12.5, math.radians(90.0)
    lost = MEASURED["sonar"].make(link, here())
    assert lost["ranges"] == [math.inf]
    link.sonar_distance_valid = True
    scan = MEASURED["sonar"].make(link, here())
    assert scan["ranges"] == [12.5]
    assert scan["header"]["frame_id"] == "sonar_link"
    # the point is where the turn about z up puts it: abeam to starboard is -y ahead-left-up
    at = Rotation.from_euler("z", scan["angle_min"]).apply([12.5, 0.0, 0.0])
    assert at == pytest.approx([0.0, -12.5, 0.0])
    link.sonar_angle = math.radians(270.0)
    scan = MEASURED["sonar"].make(link, here())
    assert scan["angle_min"] == scan["angle_max"] == pytest.approx(math.pi / 2.0)
    assert packed("sensor_msgs/msg/LaserScan", scan)


def test_a_dive_is_pressure_and_an_echo_that_lacks_is_infinite(link):
    link.depth, link.depth_valid = 10.0, True
    depth = {"kind": "depth", "depth_noise": 0.03, "depth_instability": [0.04]}
    found = MEASURED["pressure"].make(link, here(depth=depth))
    assert found["fluid_pressure"] == pytest.approx(101_325.0 + 98_066.5)
    assert math.sqrt(found["variance"]) == pytest.approx(9806.65 * 0.05)
    link.water_depth = 7.0
    assert MEASURED["water_depth"].make(link, here())["range"] == math.inf
    link.water_depth_valid = True
    assert MEASURED["water_depth"].make(link, here())["range"] == 7.0
    link.velocity_b = (1.0, 0.2, 0.1)
    assert MEASURED["dvl"].make(link, here()) is None  # no bottom
    link.velocity_b_valid = True
    assert MEASURED["dvl"].make(link, here())["twist"]["twist"]["linear"] == (1.0, -0.2, -0.1)


def test_a_dvl_reports_in_its_own_axes_and_with_the_noise_of_its_beams(link):
    """Its z axis points down: the velocity is that of {b}. The Janus array's covariance by hand:
    beams at 30 degrees and 1 cm/s make 1 / sqrt(2) * 2 cm/s level, 1 / sqrt(3) cm/s down."""
    link.velocity_b, link.velocity_b_valid = (0.6, -0.8, 0.1), True
    found = MEASURED["dvl_report"].make(link, here())
    assert found["velocity"] == (0.6, -0.8, 0.1)
    assert found["velocity_covar"] == [-1.0] * 9  # unknown
    assert math.isnan(found["altitude"])
    assert (found["speed_gnd"], found["course_gnd"]) == pytest.approx((1.0, math.atan2(-0.8, 0.6)))
    link.water_depth, link.water_depth_valid = 12.0, True
    janus = {"kind": "dvl", "bottom_noise": 0.01, "beam_angle": math.radians(30.0)}
    found = MEASURED["dvl_report"].make(link, here(dvl=janus))
    assert found["altitude"] == 12.0
    assert found["velocity_covar"][::4] == pytest.approx([2e-4, 2e-4, 1e-4 / 3])
    twist = MEASURED["dvl"].make(link, here(dvl=janus))["twist"]["covariance"]
    assert [twist[i] for i in (0, 7, 14)] == pytest.approx([2e-4, 2e-4, 1e-4 / 3])
    assert sum(twist) == pytest.approx(4e-4 + 1e-4 / 3)


def test_a_battery_that_discharges_has_a_negative_current(link):
    link.voltage, link.current, link.charge = 15.0, 4.0, 0.8
    found = MEASURED["battery"].make(link, here())
    assert (found["voltage"], found["current"], found["percentage"]) == (15.0, -4.0, 0.8)
    assert math.isnan(found["capacity"])


def test_the_field_turns_with_the_heading_and_an_imu_without_attitude_says_so(link):
    link.heading = math.pi / 2  # east: north is to port
    north, east, down = here().field
    field = MEASURED["compass"].make(link, here())["magnetic_field"]
    assert field == pytest.approx((east, north, -down))
    link.gyro = (0.1, 0.2, 0.3)
    found = MEASURED["imu"].make(link, here())
    assert found["angular_velocity"] == (0.1, -0.2, -0.3)
    assert found["orientation_covariance"][0] == -1.0
    assert found["linear_acceleration_covariance"][0] == -1.0


@pytest.mark.slow
def test_a_receiver_that_fails_says_no_fix_and_a_stuck_one_goes_on(ears):
    otter = ears("otter")
    otter.simulation.run("2 s")
    otter.simulation.override("vehicle.gnss.fault", "stuck")
    otter.taken("fix")
    otter.simulation.run("4 s")
    stuck = otter.taken("fix")
    assert len(stuck) > 4
    assert len({each.latitude for each in stuck[2:]}) == 1
    otter.simulation.override("vehicle.gnss.fault", "off")
    otter.simulation.run("6 s")
    assert otter.taken("fix")[-1].status.status == -1


def test_topics_have_other_names_or_none_and_frames_a_prefix(ears, domain):
    otter = ears(
        "otter", topics="imu /other/imu; odometry off; port.thrust /left", frame_prefix="otter/"
    )
    reader = otter.participant.reader("/other/imu", "sensor_msgs/msg/Imu")
    left = otter.participant.writer("/left", "std_msgs/msg/Float64")
    otter.simulation.run("0.1 s")
    left.write(packed("std_msgs/msg/Float64", {"data": 60.0}))
    otter.simulation.run("0.2 s")
    assert reader.take(1)[0].message.header.frame_id == "otter/imu_link"
    assert not otter.taken("odometry")
    assert otter.simulation.get("autopilot.ros2.pulse.ch1") > 1.6e-3


def test_simulated_time_begins_at_the_date(ears):
    otter = ears("otter", clock="date")
    otter.simulation.step(1)
    assert otter.taken("clock")[0].clock.sec == 1780272000  # 2026-06-01T00:00:00Z


@pytest.mark.parametrize("key", MEASURED)
def test_messages_are_made_of_the_inputs_that_are_looked_at_for_changes(key, link):
    """An input that is not looked at would move, and no message would follow."""
    read = set()

    class Spied:
        def __getattr__(self, name):
            read.add(name)
            return getattr(link, name)

    for port in link.ports.values():  # all valid, and measured
        if port.kind == "input" and port.type in (bool, float):
            setattr(link, port.name, [1] * port.size if port.axes else 1)
    MEASURED[key].make(Spied(), here())
    assert read == {*MEASURED[key].ports, *MEASURED[key].beside}
