"""`ospace view` as its users meet it: what it writes, and what it says to mistakes."""

import contextlib
import csv
import html
import math
import re
import select
import signal
import socket
import subprocess
import sys
from pathlib import Path

import pytest

import ospace
from ospace.cli.main import main

ROOT = Path(ospace.__file__).parents[1]
SECONDS = 60


@pytest.fixture
def view(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def call(*arguments):
        try:
            status = main(["view", *map(str, arguments)])
        except SystemExit as leaving:
            status = leaving.code
        return status, *capsys.readouterr()

    return call


def test_a_view_is_written_to_one_file(view, tmp_path):
    status, out, err = view("planar_2r", "--html", "out.html")
    assert (status, err) == (0, "")
    assert re.fullmatch(r"wrote out\.html: \d\.\d MB, opened by any browser\n", out)
    assert "<h1>planar_2r</h1>" in (tmp_path / "out.html").read_text(encoding="utf-8")
    assert [file.name for file in tmp_path.iterdir()] == ["out.html"]


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        (["--point", "end_effector"], '"text": "end_effector"'),
        (["--point", "link_1", "--point", "link_2"], '"text": "link_2"'),
        (["--pose", "joint_1=0.5, joint_2 = -1e-1"], "planar_2r"),
        (["--pose", "joint_1=0.5,"], "planar_2r"),
        (["--layers", "collision, momentum,"], "momentum"),
        (["--layers", ""], "momentum"),
        (["--collision"], "collision"),
        (["--background", "paper"], 'data-background="paper"'),
        (["--free-mimic", "--package-dir", "."], "planar_2r"),
        (["--sweep"], "planar_2r"),
    ],
)
def test_view_options_change_the_page(view, tmp_path, options, expected):
    status, _, err = view("planar_2r", *options, "--html", "out.html")
    assert (status, err) == (0, "")
    assert expected in (tmp_path / "out.html").read_text(encoding="utf-8")


def test_the_default_pose_is_inside_limits_and_another_is_warned_of(view, tmp_path):
    text = ospace.models.path("planar_2r").read_text(encoding="utf-8")
    Path("bent.urdf").write_text(re.sub('lower="[^"]*" upper="[^"]*"', 'lower="1" upper="2"', text, count=1))
    assert view("bent.urdf", "--html", "out.html")[::2] == (0, "")
    status, _, err = view("bent.urdf", "--pose", "joint_1=2.5", "--html", "beyond.html")
    assert (status, err) == (0, "ospace: warning: --pose is outside limits: 'joint_1' by 0.5 rad (28.6 deg)\n")


def test_layers_shown_at_first(view, tmp_path):
    view("planar_2r", "--layers", "robot,momentum", "--collision", "--html", "out.html")
    boxes = re.findall(r'data-layer="([\w-]+)"( checked)?', (tmp_path / "out.html").read_text(encoding="utf-8"))
    assert {name for name, checked in boxes if checked} == {"collision", "momentum"}


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "required: URDF"),
        (["nothing.urdf"], "nothing.urdf"),
        (["planar_3r"], "did you mean 'planar_2r'?"),
        (["planar_2r", "--point", "hand"], "hand"),
        (["planar_2r", "--pose", "joint_3=1"], "no joint 'joint_3'; did you mean"),
        (
            ["planar_2r", "--pose", "joint_1=one"],
            "'joint_1=one': position of joint 'joint_1': 'one' is not an angle",
        ),
        (["planar_2r", "--pose", "joint_1=nan"], "joint_1"),
        (["planar_2r", "--pose", "joint_1=inf"], "joint_1"),
        (["planar_2r", "--pose", "joint_1"], "--pose 'joint_1': write joint=value, such as joint_1=0.5"),
        (["planar_2r", "--pose", "=1"], "--pose '=1': write joint=value"),
        (["target", "--pose", "joint_1"], "has no joint"),
        (["target", "--sweep"], "has no joint to move"),
        (["planar_2r", "--layers", "robots"], "layer 'robots' is unknown; did you mean 'robot'"),
        (["planar_2r", "--background", "white"], "invalid choice: 'white'"),
        (["planar_2r", "--html", "nowhere/out.html"], "no such folder 'nowhere'"),
        (["planar_2r", "--html", "folder"], "'folder' is a folder"),
        (["planar_2r", "--screenshot", "nowhere/out.png"], "no such folder 'nowhere'"),
        (["planar_2r", "--screenshot", "out.jpg"], "'out.jpg' does not end in .png"),
        (["planar_2r", "--package-dir", "nowhere"], "--package-dir nowhere: no such folder"),
        (["planar_2r", "--port", "0"], "'0' is not a port from 1 to 65535"),
        (["planar_2r", "--port", "65536"], "'65536' is not a port"),
        (["planar_2r", "--port", "http"], "'http' is not a port"),
        (["planar_2r", "--host", "192.0.2.1"], "cannot listen on 192.0.2.1"),
        (["planar_2r", "target"], "unrecognized arguments"),
    ],
)
def test_view_refuses_wrong_arguments(view, tmp_path, arguments, words):
    (tmp_path / "folder").mkdir()
    output = [] if {"--html", "--screenshot", "--host", "--port"} & set(arguments) else ["--html", "out.html"]
    status, out, err = view(*arguments, *output)
    assert (status, out) == (2, "")
    assert words in err
    assert "Traceback" not in err
    assert [file.name for file in tmp_path.iterdir()] == ["folder"]


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--csv", "out.csv"], "--csv writes the motion of --sweep: give both"),
        (["--sweep", "--screenshot", "out.png"], "--screenshot is a still picture: give --html too"),
        (["--html", "out.html", "--host", "127.0.0.1"], "--host selects where to serve: give it without --html"),
        (["--screenshot", "out.png", "--port", "7000"], "--port selects where to serve: give it without --html"),
        (
            ["--html", "out.html", "--pose", "joint_1=1, joint_1=2"],
            "--pose 'joint_1=2': joint 'joint_1' is given twice",
        ),
        (["--html", "robot.urdf"], "robot.urdf: is what is read, robot.urdf; give another file"),
        (["--html", "link.html"], "link.html: is what is read, robot.urdf; give another file"),
        (["--html", "a.png", "--screenshot", "a.png"], "a.png: is to be written twice, as a.png too"),
    ],
)
def test_view_ignores_no_option_and_overwrites_no_input(view, tmp_path, monkeypatch, options, words):
    monkeypatch.setattr("ospace.visual.browser.find", lambda: "chromium")
    file, link = tmp_path / "robot.urdf", tmp_path / "link.html"
    file.write_bytes(ospace.models.path("planar_2r").read_bytes())
    link.symlink_to("robot.urdf")
    before = file.read_bytes()
    status, out, err = view("robot.urdf", *options)
    assert (status, out) == (2, "")
    assert words in err
    assert sorted(one.name for one in tmp_path.iterdir()) == ["link.html", "robot.urdf"]
    assert file.read_bytes() == before


def test_a_sweep_reports_its_progress(view, monkeypatch):
    from ospace.cli import progress

    honest, reported = progress.bar, []

    @contextlib.contextmanager
    def bar(given, what, total):
        with honest(given, what, total) as advance:
            yield lambda done: (reported.append((done, total)), advance(done))

    monkeypatch.setattr(progress, "bar", bar)
    assert view("planar_2r", "--sweep", "--html", "out.html")[0] == 0
    assert {total for _, total in reported} == {100}
    assert [reported[0][0], reported[-1][0]] == [0, 100]


def test_a_sweep_is_printed_and_exported(view, tmp_path):
    status, out, err = view("planar_2r", "--sweep", "--html", "out.html", "--csv", "out.csv")
    assert (status, err) == (0, "")
    rows = re.findall(r"^(joint_\d) +(\S+) deg +(\S+) deg +(\S+) deg +(\S+) mm$", out, re.MULTILINE)
    assert [row[:3] for row in rows] == [("joint_1", "-170.0", "170.0"), ("joint_2", "-170.0", "170.0")]
    with (tmp_path / "out.csv").open(newline="") as file:
        heading, *lines = csv.reader(file)
    assert heading[:5] == ["time [s]", "joint", "base shift [m]", "base turn [rad]", "q[0]"]
    for joint, _, _, turn, shift in rows:
        mine = [line for line in lines if line[1] == joint]
        assert math.degrees(max(float(line[3]) for line in mine)) == pytest.approx(float(turn), rel=5e-3)
        assert 1e3 * max(float(line[2]) for line in mine) == pytest.approx(float(shift), rel=5e-3)
    assert len(lines[0]) == len(heading)


def test_no_picture_without_chromium(view, tmp_path, monkeypatch):
    monkeypatch.setattr("shutil.which", lambda name: None)
    status, out, err = view("planar_2r", "--screenshot", "out.png", "--html", "out.html")
    assert (status, out) == (2, "")
    assert "a picture or PDF needs Chromium, which was not found: install it" in err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("options", [["--html", "out.html"], ["--screenshot", "out.png"]])
def test_without_meshcat_the_message_says_what_to_install(view, tmp_path, monkeypatch, options):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    status, out, err = view("planar_2r", *options)
    assert (status, out) == (2, "")
    assert err == "ospace: error: a scene needs MeshCat: pip install -e '.[visual]'\n"
    assert list(tmp_path.iterdir()) == []


def test_an_output_that_cannot_be_written(view, tmp_path):
    (tmp_path / "full.html").symlink_to("/dev/full")
    status, _, err = view("planar_2r", "--html", "full.html")
    assert status == 2
    assert "No space left on device" in err


def test_a_port_in_use_is_refused(view):
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        status, out, err = view("planar_2r", "--port", port)
    assert (status, out) == (2, "")
    assert f"cannot listen on 127.0.0.1, port {port}: Address already in use" in err


def test_a_missing_mesh_is_reported(view, tmp_path):
    body = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    shape = '<visual><geometry><mesh filename="nowhere.stl"/></geometry></visual>'
    (tmp_path / "r.urdf").write_text(f'<robot name="r"><link name="base">{body}{shape}</link></robot>')
    status, _, err = view("r.urdf", "--html", "out.html")
    assert status == 0
    assert "nowhere.stl" in err
    assert (tmp_path / "out.html").exists()


INERTIA = '<inertia ixx="1" iyy="1" izz="1.5" ixy="0" ixz="0" iyz="0"/>'
UNSOUND = f"""<robot name="faulty">
<link name="base"><inertial><mass value="9"/>{INERTIA}</inertial>
  <visual><geometry><box size="1 1 1"/></geometry></visual></link>
<link name="arm"><inertial><mass value="-1"/>{INERTIA}</inertial>
  <visual><geometry><box size="1 .1 .1"/></geometry></visual></link>
<link name="hand"><inertial><mass value="1"/>{INERTIA}</inertial>
  <visual><geometry><mesh filename="nowhere.stl"/></geometry></visual></link>
<link name="finger"/>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="1 0 0"/>
  <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<joint name="wrist" type="revolute"><parent link="arm"/><child link="hand"/><origin xyz="1 0 ?"/>
  <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<joint name="weld" type="fixed"><parent link="hand"/><child link="finger"/></joint>
</robot>"""


def test_an_unsound_robot_is_drawn_and_its_faults_are_reported(view, tmp_path):
    (tmp_path / "faulty.urdf").write_text(UNSOUND)
    status, out, err = view("faulty.urdf", "--html", "out.html")
    assert status == 1
    assert out.startswith("wrote out.html")
    page = (tmp_path / "out.html").read_text(encoding="utf-8")
    assert "unsound: 2 errors, 1 warning; all joints at zero" in page
    for text in (
        "error negative-mass: link 'arm', line 4",
        "error number-unreadable: joint 'wrist', line 11",
        "warning mesh-missing: link 'hand', line 7",
        "link 'hand' and 1 beyond it cannot be placed: the <origin> of joint 'wrist' cannot be read",
    ):
        assert f"ospace: {text}" in err
        assert text in html.unescape(page)
    assert "cannot be placed: the <origin> of joint 'shoulder'" not in err
    assert "not used" not in err


def test_options_that_an_unsound_robot_has_no_use_for_are_named(view, tmp_path):
    (tmp_path / "faulty.urdf").write_text(UNSOUND)
    options = ["--pose", "shoulder=1", "--point", "hand", "--sweep", "--layers", "inertia,momentum"]
    status, _, err = view("faulty.urdf", *options, "--html", "out.html")
    assert status == 1
    assert "warning: not used, as no dynamics can be computed: --point, --pose, --sweep, layer momentum\n" in err
    boxes = re.findall(r'data-layer="([\w-]+)"( checked)?', (tmp_path / "out.html").read_text(encoding="utf-8"))
    assert {name for name, checked in boxes if checked} == {"inertia", "names"}
    status, _, err = view("faulty.urdf", "--layers", "robots", "--html", "other.html")
    assert (status, (tmp_path / "other.html").exists()) == (2, False)
    assert "layer 'robots' is unknown" in err


def test_an_interrupt_before_anything_is_shown(view, tmp_path, monkeypatch):
    def interrupted(*arguments, **more):
        raise KeyboardInterrupt

    monkeypatch.setattr("ospace.visual.scene.Scene.__init__", interrupted)
    assert view("planar_2r", "--html", "out.html") == (130, "", "ospace: interrupted\n")
    assert list(tmp_path.iterdir()) == []


def test_help_names_the_layers(view, monkeypatch):
    from ospace.visual.scene import LAYERS, SHOWN

    monkeypatch.setenv("COLUMNS", "1000")
    text = view("--help")[1]
    assert ", ".join(LAYERS) in text
    assert f"default: {','.join(SHOWN)}" in text


def test_view_serves_at_host_and_port_until_ctrl_c(tmp_path):
    """Served where it is asked for, and nowhere else; Ctrl-C is how it ends well."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.2", 0))
        port = probe.getsockname()[1]
    process = subprocess.Popen(
        [sys.executable, "-m", "ospace.cli", "view", "planar_2r", "--host", "127.0.0.2", "--port", str(port)],
        cwd=ROOT, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    try:
        assert select.select([process.stdout], [], [], SECONDS)[0]
        assert process.stdout.readline() == f"planar_2r at http://127.0.0.2:{port}/ (Ctrl-C ends)\n"
        with contextlib.closing(socket.create_connection(("127.0.0.2", port), timeout=SECONDS)) as caller:
            caller.sendall(f"GET / HTTP/1.1\r\nHost: 127.0.0.2:{port}\r\nConnection: close\r\n\r\n".encode())
            assert caller.recv(12).startswith(b"HTTP/1.1 200")
        with pytest.raises(OSError, match="refused"):
            socket.create_connection(("127.0.0.1", port), timeout=SECONDS)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=SECONDS)
    finally:
        if process.poll() is None:
            process.kill()
            process.communicate()
    assert (process.returncode, out, err) == (0, "", "")
