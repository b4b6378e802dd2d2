"""A scene is served to pages of this machine, and a run is seen where it is."""

import http.client

import missions
import numpy as np
import pinocchio as pin
import pytest
import umsgpack

from ospace import SpaceRobot, models, scenario
from ospace.exceptions import OspaceError
from ospace.visual import Scene, run_report
from ospace.visual.live import Live
from ospace.visual.server import Server

VELOCITY = [0, "7.5 km/s", 0]
HOLD = {"name": "tip", "type": "position", "point": "end_effector", "goal": "hold"}
ORBIT = missions.toml(
    missions.phase(
        "reach", HOLD | {"name": "near", "offset": {"position": ["10 cm", 0, 0]}}, duration="0.2 s", timeout="1 s"
    ),
    missions.phase("hold", HOLD, duration="0.1 s", timeout="1 s"),
    robot={"model": "planar_2r", "position": ["7000 km", 0, 0], "velocity": VELOCITY},
    target={"model": "target", "position": ["7000002 m", "1 m", 0], "velocity": VELOCITY},
)


@pytest.fixture(scope="module")
def content():
    return Scene(SpaceRobot.from_urdf(models.path("planar_2r"))).content


@pytest.fixture(scope="module")
def plan(tmp_path_factory):
    return missions.loaded(tmp_path_factory.mktemp("orbit"), ORBIT)


def status(server, path, host):
    """Return how the server answers one who calls it by a name."""
    connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=10)
    upgrade = {"Upgrade": "websocket", "Connection": "Upgrade", "Sec-WebSocket-Version": "13"}
    key = {"Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==", "Origin": f"http://{host}"}
    headers = {"Host": host} | (upgrade | key if path == "/socket" else {})
    connection.request("GET", path, headers=headers)
    answer = connection.getresponse().status
    connection.close()
    return answer


def test_a_page_of_another_name_is_not_answered(content):
    """Such as that of a web page whose name leads to this machine."""
    with Server(content) as server:
        for name in ("localhost", "127.0.0.1", "[::1]"):
            assert status(server, "/", f"{name}:{server.port}") == 200
            assert status(server, "/socket", f"{name}:{server.port}") == 101
        for path in ("/", "/socket"):
            assert status(server, path, f"evil.example:{server.port}") == 403
        assert server.viewers <= 3
    with Server(content, "0.0.0.0") as server:
        assert status(server, "/", f"robots.example:{server.port}") == 200


@pytest.mark.parametrize("host", ["a..b", "x" * 70 + ".example"])
def test_an_unknown_host_is_refused(content, host):
    with pytest.raises(OspaceError, match=r"cannot listen on .*, port 7000: "):
        Server(content, host)


def test_a_robot_in_orbit_stays_in_the_picture(plan):
    """Live as well as in the replay: seen from the frame that moves along with it."""
    places = {}
    with Live(plan) as live:
        drawn = live._scene.meshcat_scene
        run = scenario.run(plan, watch=live.watch)
        for command in map(umsgpack.unpackb, drawn.commands()):
            if (
                command["type"] == "set_transform"
                and command["path"].startswith("/robots")
                and command["path"].count("/") == 3
            ):
                places[command["path"]] = np.array(command["matrix"][12:15])
    assert run.duration > 0.2
    assert {path.split("/")[2] for path in places} == {"0 planar_2r", "1 target"}
    assert max(np.linalg.norm(place) for place in places.values()) < 4.0


def test_points_at_different_places_of_one_frame_are_all_shown(plan):
    labels = [label for label in run_report.scene_of(plan).content().labels if label.layer == "points"]
    assert [label.text for label in labels] == ["end_effector", "end_effector"]


def test_while_a_target_is_held_quantities_are_those_of_both(tmp_path):
    """The ball of the centre of mass, as it is displayed first in each segment."""
    plan = missions.loaded(tmp_path, missions.MISSION)
    robots, off = [], []
    with Live(plan) as live:

        def watch(time, states):
            combined = states().combined
            due = live._due
            live.watch(time, states)
            if live._due != due and (not robots or robots[-1] is not combined.robot):
                placed = {
                    one["path"]: np.array(one["matrix"][12:15])
                    for one in map(umsgpack.unpackb, live._scene.meshcat_scene.commands())
                    if one["type"] == "set_transform"
                }
                model = combined.robot.model
                centre = pin.centerOfMass(model, model.createData(), combined.q) - combined.q[:3]
                off.append(placed["/quantities/mass centre"] - placed["/robots/0 planar_2r/base"] - centre)
                robots.append(combined.robot)

        scenario.run(plan, watch=watch)
    assert [robot.name for robot in robots] == ["planar_2r", "planar_2r+target", "planar_2r"]
    np.testing.assert_allclose(off, 0.0, atol=1e-8)
