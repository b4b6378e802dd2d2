"""Live pages: served to this machine alone, followed by all that are open, ended by Ctrl-C."""

import re
import select
import signal
import socket
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

import missions
import numpy as np
import pinocchio as pin
import pytest

import ospace
from ospace import SpaceRobot
from ospace.visual import Scene
from ospace.visual.scene import SHOWN
from ospace.visual.server import Server

pytestmark = pytest.mark.browser
ROOT = Path(ospace.__file__).parents[1]
SECONDS = 60
ENDED = "() => document.getElementById('status').textContent.includes('has ended')"


@contextmanager
def command(*arguments):
    """Yield a process of `ospace`, and the address that it prints."""
    process = subprocess.Popen(
        [sys.executable, "-m", "ospace.cli", *map(str, arguments)],
        cwd=ROOT, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    try:
        assert select.select([process.stdout], [], [], SECONDS)[0]
        line = process.stdout.readline()
        found = re.search(r" at (http://\S+:\d+/)", line)
        assert found, line + (process.stderr.read() if process.poll() is not None else "")
        yield process, found[1]
    finally:
        if process.poll() is None:
            process.kill()
        process.communicate(timeout=SECONDS)


def interrupted(process):
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=SECONDS)
    return process.returncode, out, err


@pytest.fixture
def robot():
    return SpaceRobot.from_urdf(ROOT / "models" / "planar_2r.urdf")


@pytest.fixture
def scene(robot):
    shown = Scene(robot)
    shown.display(robot.configuration())
    return shown


@pytest.fixture
def server(scene):
    with Server(scene.content) as running:
        yield running


def hand(scene):
    return next(label.path for label in scene.content().labels if label.text == "end_effector")


AT = """([path, wanted]) => {
  const { scene } = ospace.viewer, node = ospace.node(path);
  scene.updateMatrixWorld(true);
  const found = node.matrixWorld.clone().premultiply(scene.matrixWorld.clone().invert()).elements;
  return wanted.every((one, k) => Math.abs(one - found[k]) < 1e-9);
}"""


def follows(page, scene, q):
    """Wait until the page shows the hand where forward kinematics has it."""
    robot = scene.robot
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    wanted = data.oMf[robot.model.getFrameId("end_effector")].homogeneous
    page.until(AT, [hand(scene), wanted.T.ravel().tolist()])


def test_all_open_pages_follow_the_robot(open_page, scene, server, robot):
    first, second = open_page(server.address), open_page(server.address)
    q = robot.configuration({"joint_1": 0.7, "joint_2": -0.4})
    for page in (first, second):
        follows(page, scene, robot.configuration())
    scene.display(q)
    for page in (first, second):
        follows(page, scene, q)
    assert server.viewers == 2
    first.page.close()
    q = robot.configuration({"joint_1": -0.2})
    scene.display(q)
    follows(second, scene, q)
    third = open_page(server.address)  # opened later, it has the whole scene as it is now
    follows(third, scene, q)
    assert third.meshes().keys() == second.meshes().keys()
    assert len(third.meshes()) > 30
    shown = {box: third.locator(f"[data-layer='{box}']").is_checked() for box in ("robot", "momentum")}
    assert shown == {name: name in SHOWN for name in shown}
    assert not any(mesh["shown"] for path, mesh in third.meshes().items() if "/inertia" in path)
    third.reload()
    follows(third, scene, q)


def test_a_layer_stays_on_while_the_scene_moves(open_page, scene, server, robot):
    page = open_page(server.address)
    follows(page, scene, robot.configuration())
    page.locator("[data-layer='inertia']").press("Space")
    q = robot.configuration({"joint_1": 0.3})
    scene.display(q)
    follows(page, scene, q)
    assert all(mesh["shown"] for path, mesh in page.meshes().items() if "/inertia/" in path)


def test_an_animation_brings_the_slider(open_page, scene, server, robot):
    page = open_page(server.address)
    follows(page, scene, robot.configuration())
    assert not page.locator("#player").is_visible()

    class Motion:
        time = np.array([0.0, 1.0])
        q = np.array([robot.configuration(), robot.configuration({"joint_2": 0.01})])
        v = np.zeros((2, robot.nv))

    scene.animate(Motion())
    page.locator("#player").wait_for()
    assert page.evaluate("ospace.duration()") == pytest.approx(1.0)
    page.evaluate("ospace.seek(1)")
    found = page.placed(hand(scene))[0]
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, Motion.q[1])
    np.testing.assert_allclose(found, data.oMf[robot.model.getFrameId("end_effector")].homogeneous, rtol=0, atol=1e-6)


def addresses():
    """Return an address of this machine other than loopback, where it has one."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.1", 9))  # a datagram socket sends nothing for that
        except OSError:
            return []
        return [address for address in {probe.getsockname()[0]} if not address.startswith("127.")]


def test_a_view_is_served_until_ctrl_c(open_page):
    with command("view", "planar_2r", "--sweep") as (process, address):
        port = int(address.rstrip("/").rsplit(":", 1)[1])
        assert address == f"http://127.0.0.1:{port}/"
        table = "".join(process.stdout.readline() for _ in range(4))
        assert re.search(r"^joint_1 .* 80\.9 deg +209 mm\njoint_2 ", table, re.MULTILINE)
        for other in addresses():
            with pytest.raises(OSError, match=r"refused|timed out|unreachable"):
                socket.create_connection((other, port), timeout=2.0)
        listening = [line.split()[1] for line in Path("/proc/net/tcp").read_text().splitlines() if " 0A " in line]
        assert [one.split(":")[0] for one in listening if one.endswith(f":{port:04X}")] == ["0100007F"]
        page = open_page(address, drawn=True)
        path = "/robots/0 planar_2r/joint joint_1"
        page.until("() => ospace.node('/robots/0 planar_2r/joint joint_1/robot').children.length > 0")
        before = page.placed(path)[0]
        page.until("([path, x]) => Math.abs(ospace.node(path).matrix.elements[0] - x) > 0.01", [path, before[0, 0]])
        status, out, err = interrupted(process)
        assert (status, err) == (0, "")
        assert "Traceback" not in out
        page.until(ENDED)
        assert page.locator("#status").is_visible()


def test_a_run_plays_while_it_is_computed_and_then_has_a_slider(open_page, tmp_path):
    """Plays while it runs, and then offers the slider."""
    with command("run", missions.written(tmp_path), "--view", "--headless") as (process, address):
        page = open_page(address)
        page.locator("#player").wait_for(timeout=SECONDS * 1000)
        assert page.evaluate("ospace.duration()") > 0.3
        tip = "/robots/0 planar_2r/joint joint_2"
        start, end = page.along([tip], [0.0, page.evaluate("ospace.duration()")])[:, 0]
        assert np.abs(start - end).max() > 1e-3
        status, out, err = interrupted(process)
        assert (status, [line for line in err.splitlines() if "compiling" not in line]) == (0, [])
        assert out.rstrip().splitlines()[-1].startswith("passed: ")
        page.until(ENDED)
