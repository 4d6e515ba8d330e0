"""The description of a vehicle: places and turns of its parts by SciPy, in the axes of ROS."""

import json
from xml.etree import ElementTree

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from seatrial.system.parameters import load_vehicle
from seatrial_kits.ros2.description import urdf

PLAIN = {"at": [0.0, 0.0, 0.0], "turned": [0.0, 0.0, 0.0], "colour": "#ff0000", "opacity": 0.5}


def visuals(*parts):
    text = urdf("boat", json.dumps([{**PLAIN, **part} for part in parts]), "base_link")
    return ElementTree.fromstring(text).findall("link/visual")


def placed(visual):
    origin = visual.find("origin")
    xyz, rpy = (np.array([float(v) for v in origin.get(a).split()]) for a in ("xyz", "rpy"))
    return xyz, Rotation.from_euler("xyz", rpy)  # URDF: about the fixed axes, x first


@pytest.mark.parametrize(
    "angles", [[0, 0, 0], [10, 20, 30], [-170, 5, 100], [0, 90, 0], [90, -90, 40]]
)
def test_a_cylinder_lies_along_its_x_axis(angles):
    (visual,) = visuals(
        {"cylinder": {"radius": 0.1, "length": 2.0}, "at": [1.0, 2.0, 3.0], "turned": angles}
    )
    xyz, turn = placed(visual)
    assert xyz == pytest.approx([1.0, -2.0, -3.0])
    roll, pitch, yaw = np.radians(angles)
    ahead = Rotation.from_euler("ZYX", [yaw, pitch, roll]).apply([1, 0, 0]) * [1, -1, -1]
    assert abs(turn.apply([0, 0, 1]) @ ahead) == pytest.approx(1.0, abs=1e-5)
    assert visual.find("geometry/cylinder").attrib == {"radius": "0.1", "length": "2"}
    assert visual.find("material/color").get("rgba") == "1 0 0 0.5"


def test_a_part_on_another_goes_with_it_and_a_hull_floats():
    turned, carried, hull = visuals(
        {"box": [1, 1, 1], "name": "mast", "at": [0, 0, -1], "turned": [0, 0, 90]},
        {"box": [3, 2, 1], "on": "mast", "at": [2, 0, 0]},
        {"hull": {"length": 2, "beam": [0.1, 0.3], "draught": [0.2, 0.1], "freeboard": 0.4}},
    )
    assert placed(turned)[0] == pytest.approx([0, 0, 1])
    assert placed(carried)[0] == pytest.approx([0, -2, 1])  # to starboard of the mast
    assert placed(hull)[0] == pytest.approx([0, 0, 0.1])
    assert hull.find("geometry/box").get("size") == "2 0.3 0.6"


def test_jets_are_left_out_and_every_shipped_vehicle_has_a_description():
    jet = {"cylinder": {"radius": 1, "length": 1}, "stretch": {"port": "a.b", "full": 1.0}}
    assert visuals(jet) == []
    for name in ("otter", "wam-v", "bluerov2", "gloria", "remus100"):
        parts = [part for table in load_vehicle(name).file.shape.values() for part in table]
        text = urdf(name, json.dumps([p.model_dump(exclude_none=True) for p in parts]), "base_link")
        assert len(ElementTree.fromstring(text).findall("link/visual")) > 2
