"""Ships that AIS reports, as nodes see them: against the rig's own truth, and pyais' reading."""

import numpy as np
import pyais
import pytest

from seatrial import Simulation
from seatrial_kits.ros2.joining import join
from seatrial_kits.ros2.topics import PUBLISHED, Names
from tests.kit import needs_kits

pytestmark = [needs_kits("nmea", "ships"), pytest.mark.slow]


def test_ships_that_ais_reports_are_targets_in_map_and_sentences(domain):
    participant = join(domain, "/test", "dds")
    names = Names("mariner", "")
    readers = {
        key: participant.reader(names.of(key, PUBLISHED[key]), PUBLISHED[key].kind, 1000)
        for key in ("nmea", "ais_targets")
    }
    simulation = Simulation(
        "traffic", choices={"autopilot": "ros2"}, set={"mariner_pilot.ros2.domain": domain}
    )
    try:
        simulation.run("12 s")
        truth = simulation.get("hydrone.hull.position")
        known = simulation.get("mariner_ais.targets")
        taken = {key: [s.message for s in each.take(1000)] for key, each in readers.items()}
    finally:
        simulation.close()
        participant.close()
    sentences = [each.sentence for each in taken["nmea"]]
    received = {pyais.decode(s).mmsi for s in sentences if s.startswith("!AIVDM,1,")}
    assert len(received) == known > 3
    last = taken["ais_targets"][-1]
    assert last.header.frame_id == "map"
    assert len(last.poses) == len(received)
    places = np.array([[p.position.x, p.position.y, p.position.z] for p in last.poses])
    hydrone = places[sorted(received).index(710000002)]
    # An AIS report has 1e-4 minutes of arc, 0.2 m, and the drift since it was sent.
    np.testing.assert_allclose(hydrone, [truth[1], truth[0], 0.0], atol=1.0)
    seconds = [
        each.header.stamp.sec + 1e-9 * each.header.stamp.nanosec for each in taken["ais_targets"]
    ]
    np.testing.assert_allclose(np.diff(seconds), 1.0, atol=0.02)
