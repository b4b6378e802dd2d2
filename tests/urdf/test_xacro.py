"""A xacro of several files is expanded in bounds, and findings name the file and line that they come from."""

from __future__ import annotations

import json
import os
import pickle
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import ospace
from ospace.cli.main import main
from ospace.scenario import load as load_scenario
from ospace.urdf import xacro
from ospace.urdf.errors import UrdfError
from ospace.urdf.lint.findings import make_finding
from ospace.urdf.source import Limits

XMLNS = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
ARM = f"""<?xml version="1.0"?>
<robot name="arm" {XMLNS}>
  <xacro:arg name="mass" default="2"/>
  <xacro:include filename="$(find arm_description)/urdf/segment.xacro"/>
  <xacro:property name="numbers" value="${{xacro.load_yaml('../config/numbers.yaml')}}"/>
  <link name="base"><inertial><mass value="${{numbers['base']}}"/>
    <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1.1"/></inertial></link>
  <xacro:segment name="upper" parent="base" mass="$(arg mass)"/>
  <xacro:segment name="fore" parent="upper" mass="${{numbers['fore']}}"/>
</robot>
"""
SEGMENT = f"""<robot {XMLNS}>
  <xacro:macro name="segment" params="name parent mass">
    <link name="${{name}}"><inertial><mass value="${{mass}}"/>
      <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.11" iyz="0" izz="0.12"/></inertial></link>
    <joint name="${{name}}_joint" type="continuous">
      <parent link="${{parent}}"/><child link="${{name}}"/>
      <axis xyz="0 0 2"/><limit effort="10" velocity="1"/>
    </joint>
  </xacro:macro>
</robot>
"""

SCENARIO = """
[robot]
model = "urdf/arm.urdf.xacro"
[[task]]
name = "rest"
type = "damping"
[[phase]]
name = "wait"
duration = "0.1 s"
timeout = "1 s"
"""


@pytest.fixture
def package(tmp_path):
    """A package with an arm of two segments, one folder above the working folder of nobody."""
    folder = tmp_path / "src" / "arm_description"
    for name in ("urdf", "config"):
        (folder / name).mkdir(parents=True)
    (folder / "package.xml").write_text("<package><name>arm_description</name></package>")
    (folder / "config" / "numbers.yaml").write_text("base: 10\nfore: 1.5\n")
    (folder / "urdf" / "segment.xacro").write_text(SEGMENT)
    (folder / "urdf" / "arm.urdf.xacro").write_text(ARM)
    return folder


@pytest.fixture
def arm(package):
    return package / "urdf" / "arm.urdf.xacro"


def refused(file, **given):
    with pytest.raises(UrdfError) as caught:
        xacro.read(file, **given)
    return caught.value


def test_a_xacro_of_several_files_is_the_robot_that_its_macros_make(arm):
    robot = ospace.SpaceRobot.from_urdf(arm)
    assert robot.joint_names == ["upper_joint", "fore_joint"]
    assert robot.total_mass == pytest.approx(13.5, abs=1e-12)
    assert ospace.SpaceRobot.from_urdf(arm, xacro_args={"mass": "7"}).total_mass == pytest.approx(18.5, abs=1e-12)


def test_findings_name_the_file_and_line_that_they_come_from(arm, capsys):
    robot = ospace.SpaceRobot.from_urdf(arm)
    assert [(one.code, one.line, one.file) for one in robot.findings] == [("axis-not-unit", 7, "segment.xacro")] * 2
    assert "joint 'upper_joint', line 7 of segment.xacro: its axis" in str(robot.findings[0])
    arm.write_text(ARM.replace('izz="1.1"', 'izz="1.1" iyx="0"'))
    assert main(["check", str(arm), "--samples", "1", "--json"]) == 0
    (own,) = [one for one in json.loads(capsys.readouterr().out)["findings"] if one["code"] == "unknown-attribute"]
    assert (own["line"], own["file"]) == (7, None)


def test_parts_of_the_robot_know_their_lines(arm):
    """What is found later, as meshes that cannot be drawn, has them from there; they cross processes."""
    described = pickle.loads(pickle.dumps(ospace.SpaceRobot.from_urdf(arm).description))
    lines = {part.name: (part.line, getattr(part.line, "file", None)) for part in described.links + described.joints}
    assert lines["base"] == (6, None)
    assert lines["upper"] == lines["fore"] == (3, "segment.xacro")
    assert lines["fore_joint"] == (5, "segment.xacro")
    assert {joint.limit.line for joint in described.joints} == {7}
    assert described.link["fore"].inertial.line == 3
    finding = make_finding("mesh-missing", "link 'fore'", "is not there", line=described.link["fore"].line)
    assert (finding.place, finding.line, finding.file) == ("link 'fore', line 3 of segment.xacro", 3, "segment.xacro")


def test_a_report_names_the_file(arm, tmp_path):
    pytest.importorskip("meshcat")
    assert main(["check", str(arm), "--samples", "1", "--html", str(tmp_path / "report.html")]) == 0
    assert ">7 of segment.xacro</td>" in (tmp_path / "report.html").read_text()


def test_a_refusal_names_file_line_and_macro(package, arm):
    arm.write_text(ARM.replace('mass="$(arg mass)"', ""))
    error = refused(arm)
    assert (error.path, error.line, error.code) == (arm, 8, "xacro-failed")
    assert str(error).endswith("line 8: Undefined parameters [mass], in macro 'segment' [xacro-failed]")
    arm.write_text(ARM)
    (package / "urdf" / "segment.xacro").write_text(SEGMENT.replace("0 0 2", "0 0 ${height}"))
    error = refused(arm)
    assert (error.path, error.line) == (package / "urdf" / "segment.xacro", 7)
    assert "name 'height' is not defined when evaluating expression 'height', in macro 'segment'" in str(error)
    (package / "urdf" / "segment.xacro").write_text(SEGMENT.replace("</joint>", ""))
    error = refused(arm)
    assert (error.path.name, error.line, error.reason) == (
        "segment.xacro",
        9,
        "is not well-formed XML: mismatched tag",
    )


def test_a_tree_that_is_refused_names_file_and_line(arm):
    arm.write_text(ARM.replace('parent="base"', 'parent="bus"'))
    with pytest.raises(
        UrdfError, match=r"segment.xacro: line 5: parent link 'bus' of joint 'upper_joint' is not found"
    ):
        ospace.SpaceRobot.from_urdf(arm)


def test_another_package_is_found_in_the_folders_given_alone(package, arm):
    other = package.parent / "hand" / "urdf"
    other.mkdir(parents=True)
    (other / "hand.xacro").write_text(f"<robot {XMLNS}><material name='red'/></robot>")
    arm.write_text(ARM.replace("</robot>", '<xacro:include filename="$(find hand)/urdf/hand.xacro"/></robot>'))
    error = refused(arm)
    assert (error.code, error.line) == ("xacro-package", 10)
    assert "package 'hand' is not found: give the folder that holds it with package_dirs=[DIR]" in str(error)
    for folder in (package.parent, package.parent / "hand"):
        assert b'<material name="red"/>' in xacro.read(arm, package_dirs=[folder]).content
    arm.write_text(ARM.replace("</robot>", '<xacro:include filename="../../hand/urdf/hand.xacro"/></robot>'))
    assert refused(arm).code == "xacro-outside"
    assert b'<material name="red"/>' in xacro.read(arm, package_dirs=[package.parent]).content


def test_a_link_that_leads_out_of_the_package_is_not_followed(package, arm, tmp_path):
    secret = tmp_path / "secret.yaml"
    secret.write_text("base: 3\nfore: 3\n")
    numbers = package / "config" / "numbers.yaml"
    numbers.unlink()
    numbers.symlink_to(secret)
    error = refused(arm)
    assert (error.code, f"reads '{secret}', outside" in str(error)) == ("xacro-outside", True)


ESCAPE = "[c for c in ().{0}class{0}.{0}base{0}.{0}subclasses{0}() if c.{0}name{0} == 'Popen']"


@pytest.mark.parametrize(
    "expression",
    [
        "open('{0}', 'w')",
        "[open(name, 'w') for name in ['{0}']]",
        "(lambda: ().__class__.__base__.__subclasses__())()",
        ESCAPE.format("_" * 2),
        "python.type(1).mro()[1].__subclasses__()",
        "xacro.load_yaml('/proc/self/environ')",
        "xacro.load_yaml('/etc/hostname')",
    ],
)
@pytest.mark.parametrize("form", ["${{{}}}", "$(eval {})"])
def test_an_expression_writes_starts_and_reads_nothing(arm, tmp_path, expression, form):
    """Whatever stops it, the file is refused, and nothing is written."""
    expression = form.format(expression.format(tmp_path / "written"))
    arm.write_text(ARM.replace('name="arm"', f'name="{expression}"'))
    assert refused(arm).code in ("xacro-outside", "xacro-failed")
    assert not (tmp_path / "written").exists()


HOSTILE = """
import sys
sys.argv = ["x"]
exec(open({child!r}).read().replace('if __name__ == "__main__":', "if False:"))
gate = _Gate([{inside!r}])
gate.close()
open({inside!r} + "/arm.urdf.xacro").close()
try:
    {action}
except _RefusedError as error:
    os._exit(7)
os._exit(0)
"""


@pytest.mark.parametrize(
    "action",
    [
        "open('/etc/passwd')",
        "open({inside!r} + '/new', 'w')",
        "os.open({inside!r} + '/new', os.O_WRONLY | os.O_CREAT)",
        "os.open({inside!r} + '/arm.urdf.xacro', os.O_RDWR)",
        "os.system('true')",
        "os.fork()",
        "os.execv('/bin/true', ['true'])",
        "os.posix_spawn('/bin/true', ['true'], {{}})",
        "os.remove({inside!r} + '/arm.urdf.xacro')",
        "os.rename({inside!r} + '/arm.urdf.xacro', '/tmp/x')",
        "os.listdir('/')",
        "os.kill(os.getppid(), 0)",
        "__import__('ctypes')",
        "__import__('socket')",
        "resource.setrlimit(resource.RLIMIT_CPU, (100, 100))",
    ],
)
def test_even_free_python_is_held_by_the_gate(arm, action):
    """The expressions never get this far; the audit hook does not rely on it."""
    inside = str(arm.parent)
    code = HOSTILE.format(child=str(xacro._CHILD), inside=inside, action=action.format(inside=inside))
    done = subprocess.run([sys.executable, "-I", "-S", "-c", code], capture_output=True, check=False)
    assert done.returncode == 7, done
    assert sorted(path.name for path in arm.parent.iterdir()) == ["arm.urdf.xacro", "segment.xacro"]


@pytest.mark.parametrize(
    ("part", "limits"),
    [
        ("${max(range(10**12))}", Limits(seconds=1)),
        ("${'x' * 10**10}", Limits()),
        ("${[['x'] * 10**6 for n in range(10**6)]}", Limits(memory=200_000_000)),
    ],
)
def test_time_memory_and_output_are_bounded(arm, part, limits):
    arm.write_text(ARM.replace('name="arm"', f'name="{part}"'))
    start = time.monotonic()
    assert refused(arm, limits=limits).code == "xacro-exhausted"
    assert time.monotonic() - start < 20.0  # of a process that would run for hours


def test_what_it_expands_to_is_bounded(arm):
    arm.write_text(ARM.replace('name="arm"', """name="${'x' * 10**6}\""""))
    error = refused(arm, limits=Limits(bytes=900_000))
    assert re.search(r"expands to 100\d{4} bytes; at most 900000 are read \(limits=Limits\(bytes=N\)\)", str(error))
    assert error.code == "too-large"


def test_macros_that_double_themselves_end(arm):
    doubling = (
        '<xacro:macro name="m" params="n"><link/><xacro:if value="${n}"><xacro:m n="${n-1}"/>'
        '<xacro:m n="${n-1}"/></xacro:if></xacro:macro><xacro:m n="40"/></robot>'
    )
    arm.write_text(ARM.replace("</robot>", doubling))
    assert refused(arm, limits=Limits(seconds=1)).code == "xacro-exhausted"


@pytest.mark.parametrize("name", ["pipe", "folder"])
def test_what_is_not_a_regular_file_is_not_waited_for(package, arm, name):
    os.mkfifo(package / "urdf" / "pipe")
    (package / "urdf" / "folder").mkdir()
    arm.write_text(ARM.replace("</robot>", f'<xacro:include filename="{name}"/></robot>'))
    assert re.search(
        "cannot be read: (is not a regular file|Is a directory)", str(refused(arm, limits=Limits(seconds=20)))
    )


def test_environment_variables_are_not_there(arm, monkeypatch):
    monkeypatch.setenv("OSPACE_SECRET", "17")
    arm.write_text(ARM.replace('name="arm"', 'name="$(env OSPACE_SECRET)"'))
    assert "environment variables are not read, give the value in an argument" in str(refused(arm))
    arm.write_text(ARM.replace('name="arm"', 'name="$(optenv OSPACE_SECRET none)"'))
    assert b'<robot name="none">' in xacro.read(arm).content


def test_arguments_are_those_of_a_xacro(arm, tmp_path, capsys):
    plain = tmp_path / "plain.urdf"
    plain.write_bytes(ospace.models.path("target").read_bytes())
    with pytest.raises(ospace.OspaceError, match="is not a xacro and takes no argument 'mass'"):
        ospace.SpaceRobot.from_urdf(plain, xacro_args={"mass": "1"})
    with pytest.raises(ospace.OspaceError, match=r"argument 'mass'=1.0 of a xacro: give names and values as text"):
        ospace.SpaceRobot.from_urdf(arm, xacro_args={"mass": 1.0})
    with pytest.raises(SystemExit):
        main(["run", "ets_vii_capture", "mass:=3"])
    assert "mass:=3 is an argument of a xacro, which ospace run does not read" in capsys.readouterr().err


def test_without_the_library_the_package_is_named(arm, monkeypatch):
    monkeypatch.setattr(xacro.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(ospace.OspaceError, match="to expand it needs the package xacro: pip install xacro"):
        xacro.read(arm)


@pytest.mark.parametrize("at", ["before", "behind"])
def test_the_command_takes_arguments_wherever_they_stand(arm, capsys, at):
    given = ["check", "mass:=7", str(arm)] if at == "before" else ["check", str(arm), "--samples", "1", "mass:=7"]
    assert main(given) == 0
    assert "total mass              18.5 kg" in capsys.readouterr().out


def test_fix_writes_what_was_read(arm, tmp_path, capsys):
    out = tmp_path / "arm.urdf"
    assert main(["check", str(arm), "mass:=7", "--fix", str(out)]) == 0
    assert capsys.readouterr().out.endswith("2 changes, 0 errors left\n")
    written, read = ospace.SpaceRobot.from_urdf(out), ospace.SpaceRobot.from_urdf(arm, xacro_args={"mass": "7"})
    assert written.findings == ()
    assert np.array_equal(written.model.inertias[2].toDynamicParameters(), read.model.inertias[2].toDynamicParameters())
    (arm.parent / "segment.xacro").write_text(SEGMENT.replace("0 0 2", "0 0 1"))
    out.unlink()
    assert main(["check", str(arm), "--fix", str(out)]) == 0
    assert capsys.readouterr().out == f"nothing to repair\nwrote {out}: 0 changes, 0 errors left\n"
    assert out.read_bytes() == xacro.read(arm).content


def test_a_scenario_takes_a_xacro(package, arm):
    scenario = package / "run.toml"
    scenario.write_text(SCENARIO)
    assert load_scenario(scenario).start.robot.joint_names == ["upper_joint", "fore_joint"]


def test_the_own_package_is_the_folder_with_a_package_xml(package, arm, tmp_path):
    assert xacro.own_package(arm) == package
    (package / "package.xml").unlink()
    assert xacro.own_package(arm) == package  # its folder of robots is called urdf
    assert xacro.own_package(package / "config" / "x.urdf") == package / "config"
    assert ospace.SpaceRobot.from_urdf(arm).nv == 8


def test_ctrl_c_ends_the_expansion(arm):
    arm.write_text(ARM.replace('name="arm"', 'name="${max(range(10**12))}"'))
    command = [sys.executable, "-m", "ospace.cli", "check", str(arm)]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
    deadline = time.monotonic() + 60.0
    while time.monotonic() < deadline and not children.read_text().split():
        time.sleep(0.05)
    (child,) = children.read_text().split()
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert (process.returncode, out, err) == (130, "", "ospace: interrupted\n")
    state = Path(f"/proc/{child}/stat")
    assert not state.exists() or state.read_text().split()[2] == "Z"  # dead, where nobody takes note of it


def test_a_xacro_can_be_a_part_of_a_composed_robot(arm):
    made = ospace.compose("box:1x1x1m,250kg", arm)
    assert made.total_mass == pytest.approx(263.5, abs=1e-9)
