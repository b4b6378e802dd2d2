"""Files that are not URDFs, and URDFs that are not robots: each is refused by name and reason, silently and soon."""

from __future__ import annotations

import bz2
import gzip
import lzma
import os
import signal
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import ospace
from ospace import files
from ospace.exceptions import printable
from ospace.urdf import structure

INERTIAL = (
    '<inertial><origin xyz="0 0 0.1"/><mass value="2"/>'
    '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
)
LIMIT = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'
pytestmark = pytest.mark.usefixtures("no_hang")


def link(name, inertial=INERTIAL):
    return f'<link name="{name}">{inertial}</link>'


def joint(name="hinge", kind="revolute", parent="base", child="arm", more='<axis xyz="0 1 0"/>' + LIMIT):
    return f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>{more}</joint>'


def robot(*parts, name="made"):
    return f'<robot name="{name}">{"".join(parts)}</robot>'


ONE_ARM = robot(link("base"), link("arm"), joint())
EXPANDING = "<!DOCTYPE robot [<!ENTITY a0 'aaaaaaaaaa'>" + "".join(
    f"<!ENTITY a{k + 1} '{f'&a{k};' * 10}'>" for k in range(12)
)


@pytest.fixture
def file(tmp_path):
    return tmp_path / "some robot.urdf"


def refuse(path, capfd, reason):
    """The file is refused with its name and `reason`, and nothing else is said."""
    with pytest.raises(ospace.UrdfError, match=reason) as caught:
        ospace.SpaceRobot.from_urdf(path)
    assert isinstance(caught.value, ospace.OspaceError)
    assert str(caught.value.path) == str(path)
    assert str(caught.value).startswith(printable(str(path)))
    assert capfd.readouterr() == ("", "")


# -- no file to read ---------------------------------------------------------------------------------------------


def test_a_missing_file_is_refused(file, capfd):
    refuse(file, capfd, "no such file")


def test_a_missing_folder_is_refused(file, capfd):
    refuse(file / "robot.urdf", capfd, "no such file|cannot be read")


def test_a_folder_is_refused(tmp_path, capfd):
    refuse(tmp_path, capfd, "not a regular file")


def test_no_path_at_all_is_refused(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ospace.UrdfError):
        ospace.SpaceRobot.from_urdf("")


def test_a_fifo_that_nobody_writes_to_is_refused(file, capfd):
    os.mkfifo(file)
    refuse(file, capfd, "not a regular file")


@pytest.mark.parametrize("device", ["/dev/null", "/dev/zero", "/dev/tty"])
def test_a_device_is_refused(device, capfd):
    refuse(Path(device), capfd, "not a regular file")


def test_a_link_to_nothing_is_refused(file, capfd):
    file.symlink_to("nowhere")
    refuse(file, capfd, "no such file")


def test_a_link_to_itself_is_refused(file, capfd):
    file.symlink_to(file.name)
    refuse(file, capfd, "cannot be read")


def test_a_file_that_may_not_be_read_is_refused(file, capfd):
    if os.geteuid() == 0:
        pytest.skip("root may read every file")
    file.write_text(ONE_ARM)
    file.chmod(0)
    refuse(file, capfd, "cannot be read")


def test_a_file_that_no_one_may_read_is_refused(file, capfd, monkeypatch):
    """As above, for root too."""
    file.write_text(ONE_ARM)

    def refuse_to_open(path, flags):
        raise PermissionError(13, "Permission denied", str(path))

    monkeypatch.setattr(files, "os", SimpleNamespace(**{**vars(os), "open": refuse_to_open}))
    refuse(file, capfd, "cannot be read.*Permission denied.*unreadable-file")


def test_a_path_with_a_zero_byte_is_refused(tmp_path, capfd):
    refuse(tmp_path / "a\0b.urdf", capfd, "cannot be read|no such file")


def test_a_name_that_is_too_long_is_refused(tmp_path, capfd):
    refuse(tmp_path / ("x" * 300), capfd, "cannot be read")


def test_a_file_that_is_too_large_is_refused(file, capfd):
    with file.open("w") as sparse:
        sparse.truncate(ospace.Limits().bytes + 1)
    refuse(file, capfd, rf"has {ospace.Limits().bytes + 1} bytes; at most {ospace.Limits().bytes}")


def test_a_large_file_that_is_not_too_large_is_read(file):
    file.write_text(ONE_ARM.replace("</robot>", "<gazebo/>" * 190_000 + "</robot>"))
    assert 1_700_000 < file.stat().st_size < ospace.Limits().bytes
    assert ospace.SpaceRobot.from_urdf(file).n_joints == 1


# -- no XML ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b" \n\t\n",
        b"solid ascii\n facet normal 0 0 1\n",
        b"hello",
        b"robot: {name: made}",
        ONE_ARM[: len(ONE_ARM) // 2].encode(),
        ONE_ARM[:-1].encode(),
        (ONE_ARM + ONE_ARM).encode(),
        (ONE_ARM + "x").encode(),
        ONE_ARM.replace('"2"', "2").encode(),
        b"<" * 1000,
        b"<robot name='r'>" + b"<a>" * 90,
        b"<robot name='r'>&undefined;</robot>",
    ],
    ids=lambda content: repr(content[:12]),
)
def test_what_is_not_xml_is_refused(file, capfd, content):
    file.write_bytes(content)
    refuse(file, capfd, "not well-formed XML")


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (np.random.default_rng(0).bytes(4096), "NUL|not UTF-8"),
        (b"\0" * 64, "NUL"),
        (b"\x7fELF\x02\x01\x01" + b"\0" * 57, "NUL"),
        (ONE_ARM.replace("base", "ba\0se").encode(), "line 1: has a NUL byte"),
        (b"PK\x03\x04 a zip archive", "zip"),
        (gzip.compress(ONE_ARM.encode(), mtime=0), "gzip"),
        (bz2.compress(ONE_ARM.encode()), "bzip2"),
        (lzma.compress(ONE_ARM.encode()), "xz"),
        (robot(link("base"), name="caf\xe9").encode("latin-1"), "line 1: .*0xe9.*not UTF-8"),
        (b"\xff\xfe" + ONE_ARM.encode() + b"x", "UTF-16-LE|not well-formed"),
        (ONE_ARM.encode("utf-16")[:-1], "UTF-16-LE"),
        (ONE_ARM.encode("utf-32"), "UTF-32"),
        (ONE_ARM.encode("utf-16-le"), "UTF-16"),
        (ONE_ARM.encode("utf-16-be"), "UTF-16"),
        (ONE_ARM.encode("utf-32-be"), "NUL"),
    ],
    ids=lambda content: repr(content[:12]),
)
def test_what_is_not_text_is_refused(file, capfd, content, reason):
    file.write_bytes(content)
    refuse(file, capfd, reason)


@pytest.mark.parametrize("close", [b"", b"</a>" * 100_000 + b"</robot>"])
def test_elements_too_deep_are_refused(file, capfd, close):
    file.write_bytes(b"<robot name='r'>" + b"<a>" * 100_000 + close)
    refuse(file, capfd, "more than 100 deep")


@pytest.mark.parametrize(
    "doctype",
    [
        EXPANDING + "]>",
        "<!DOCTYPE robot>",
        '<!DOCTYPE robot [<!ENTITY out SYSTEM "file:///etc/hostname">]>',
        '<!DOCTYPE robot [<!ENTITY out SYSTEM "http://192.0.2.1/x">]>',
        '<!DOCTYPE robot SYSTEM "robot.dtd">',
    ],
)
def test_a_document_type_is_refused_before_anything_is_made_of_it(file, capfd, doctype):
    os.mkfifo(file.parent / "robot.dtd")
    file.write_text(doctype + ONE_ARM)
    signal.alarm(5)
    refuse(file, capfd, "document type")


def test_a_document_type_in_a_comment_is_a_comment(file):
    file.write_text(f"<!-- <!DOCTYPE robot> -->{ONE_ARM}")
    assert ospace.SpaceRobot.from_urdf(file).n_joints == 1


# -- not a URDF----------------------------------------------------------------------------------------------------

XACRO = '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="made">{}</robot>'


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        ("<!DOCTYPE html><html><head/><body><p>404 Not Found</p></body></html>", "<html>, not <robot>.*HTML"),
        ("<html><head><meta></head></html>", "HTML"),
        ('<sdf version="1.6"><model name="made"><link name="base"/></model></sdf>', "<sdf>, not <robot>.*SDF"),
        ('<mujoco model="made"><worldbody/></mujoco>', "<mujoco>, not <robot>.*MJCF"),
        (ONE_ARM.replace("robot", "Robot"), "<Robot>, not <robot>"),
        ('<robot name="made"/>', "no <link>"),
        (robot('<joint name="hinge" type="fixed"/>'), "no <link>"),
        (XACRO.format('<xacro:include filename="arm.xacro"/><xacro:arm prefix="left"/>'), "xacro"),
        (XACRO.format(link("base") + '<xacro:arm prefix="left"/>'), "xacro"),
        (
            XACRO.format('<xacro:property name="m" value="2"/>' + link("base", INERTIAL.replace('"2"', '"${m}"'))),
            "xacro",
        ),
        (
            XACRO.format('<xacro:macro name="arm" params="p"><link name="${p}_arm"/></xacro:macro>' + link("base")),
            "xacro",
        ),
    ],
)
def test_what_is_not_a_urdf_is_refused(file, capfd, content, reason):
    file.write_text(content)
    refuse(file, capfd, reason)


def test_what_xacro_leaves_behind_is_no_xacro(file):
    """A namespace alone, as in files that xacro has expanded, is no reason."""
    file.write_text(XACRO.format(link("base")))
    assert ospace.SpaceRobot.from_urdf(file).n_joints == 0


# -- no robot ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("parts", "reason"),
    [
        ((link("base"), link("base")), "'base' is not unique"),
        ((link("base"), link("arm"), link("hand"), joint(), joint(child="hand")), "'hinge' is not unique"),
        ((link("base"), link("arm")), "2 root links.*base.*arm"),
        ((link("base"), link("arm"), joint(), joint("back", parent="arm", child="base")), "(?i)root link|loop"),
        ((link("base"), joint()), "arm.*not found"),
        ((link("base"), link("arm"), joint(parent="trunk")), "trunk"),
        ((link("base"), link("arm"), joint().replace('name="hinge"', "")), "(?i)unnamed joint"),
        ((link("base"), link("")), "(?i)unnamed link"),
        ((link("base"), link("arm"), joint().replace('<parent link="base"/>', "")), "hinge.*<parent"),
        ((link("base"), robot(link("arm"))), "<robot> stands inside"),
    ],
)
def test_what_is_not_a_tree_is_refused(file, capfd, parts, reason):
    file.write_text(robot(*parts))
    refuse(file, capfd, reason)


AXIS = '<axis xyz="0 1 0"/>'


@pytest.mark.parametrize(
    ("part", "code"),
    [
        (joint(kind="ball"), "joint-type"),
        (joint().replace('type="revolute"', ""), "joint-type"),
        (joint(more='<axis xyz="0 one 0"/>' + LIMIT), "number-unreadable"),
        (joint(more='<axis xyz="nan 0 1"/>' + LIMIT), "number-unreadable"),
        (joint(more='<origin xyz="0 inf 0"/>' + AXIS + LIMIT), "number-unreadable"),
        (joint(more='<origin xyz="0 0"/>' + AXIS + LIMIT), "number-unreadable"),
        (joint(more=AXIS + LIMIT + "<mimic/>"), "mimic-unknown"),
        (joint(more='<axis xyz="0 0 0"/>' + LIMIT), "axis-zero"),
        (joint(kind="prismatic", more='<axis xyz="0 0 0"/>' + LIMIT), "axis-zero"),
        (joint(kind="continuous", more='<axis xyz="0 0 1e-9"/>'), "axis-zero"),
        (joint(kind="planar", more='<axis xyz="0 0 0"/>'), "axis-zero"),
    ],
)
def test_joints_of_unknown_motion_are_errors(file, capfd, part, code):
    file.write_text(robot(link("base"), link("arm"), part))
    with pytest.raises(ospace.UnsoundModelError) as caught:
        ospace.SpaceRobot.from_urdf(file)
    assert {(one.code, one.subject) for one in caught.value.findings if one.severity == "error"} == {
        (code, "joint 'hinge'")
    }
    assert capfd.readouterr() == ("", "")


def test_a_revolute_joint_without_limits_is_unlimited(file):
    file.write_text(robot(link("base"), link("arm"), joint(more=AXIS)))
    made = ospace.SpaceRobot.from_urdf(file)
    assert (made.nq, made.nv) == (8, 7)
    assert [one.code for one in made.findings if one.severity == "warning" and one.subject == "joint 'hinge'"] == [
        "limits-missing"
    ]
    assert made.model.lowerPositionLimit[7] == -np.inf
    assert made.model.upperPositionLimit[7] == made.model.effortLimit[6] == made.model.velocityLimit[6] == np.inf


@pytest.mark.parametrize(
    ("parts", "subject"),
    [
        ((link("base"), link("arm"), joint(parent="arm")), "arm"),
        (
            (link("base"), link("arm"), link("hand"), joint(parent="hand"), joint("k", parent="arm", child="hand")),
            "arm",
        ),
        ((link("base"), link("arm"), joint(), joint("second")), "arm"),
    ],
    ids=["its own parent", "two links that hang from each other", "two joints to one link"],
)
def test_links_that_do_not_form_a_tree_with_the_base_are_refused(file, capfd, parts, subject):
    """Pinocchio leaves such links out, or out of one of their places, and says nothing: mass would be lost."""
    file.write_text(robot(*parts))
    refuse(file, capfd, subject)


@pytest.mark.parametrize(
    "broken",
    [
        INERTIAL.replace('"2"', '"2 kg"'),
        INERTIAL.replace('"2"', '"2,5"'),
        INERTIAL.replace('"2"', '"nan"'),
        INERTIAL.replace('"2"', '"inf"'),
        INERTIAL.replace('"2"', '""'),
        INERTIAL.replace('"2"', '"${mass}"'),
        INERTIAL.replace('<mass value="2"/>', ""),
        INERTIAL.replace('<mass value="2"/>', "<mass>2</mass>"),
        INERTIAL.replace('ixx="1"', 'ixx="nan"'),
        INERTIAL.replace('ixx="1"', 'ixx="one"'),
        INERTIAL.replace('izz="1"', ""),
        INERTIAL.replace('xyz="0 0 0.1"', 'xyz="0 0"'),
        INERTIAL.replace('xyz="0 0 0.1"', 'xyz="0 0 nan"'),
    ],
)
def test_an_inertial_that_cannot_be_read_is_no_inertial_left_out(file, capfd, broken):
    """Pinocchio drops it with a word on standard error: a link without mass, or without inertia, would remain."""
    file.write_text(
        robot(link("base"), link("arm"), link("hand", broken), joint(), joint("k", "fixed", "arm", "hand", ""))
    )
    with pytest.raises(ospace.OspaceError, match=r"\bhand\b|xacro"):
        ospace.SpaceRobot.from_urdf(file)
    assert capfd.readouterr() == ("", "")


def test_limits_can_be_raised(file):
    parts = [link("l0"), *(link(f"l{k}", "") + joint(f"j{k}", "fixed", "l0", f"l{k}", "") for k in range(1, 2100))]
    file.write_text(robot(*parts))
    with pytest.raises(ospace.UrdfError, match="more than 2000 links"):
        ospace.SpaceRobot.from_urdf(file)
    assert ospace.SpaceRobot.from_urdf(file, limits=ospace.Limits(links=2100)).nv == 6


def test_a_chain_is_never_longer_than_the_stack(file):
    parts = [
        link("l0"),
        *(link(f"l{k}", "") + joint(f"j{k}", "fixed", f"l{k - 1}", f"l{k}", "") for k in range(1, 9000)),
    ]
    file.write_text(robot(*parts))
    with pytest.raises(ospace.UrdfError, match="chain of more than 2000 joints"):
        ospace.SpaceRobot.from_urdf(file, limits=ospace.Limits(links=10_000))


def test_memory_is_never_taken_that_is_not_there(file, monkeypatch):
    file.write_text(ONE_ARM)
    monkeypatch.setattr(structure, "os", SimpleNamespace(sysconf=lambda name: 100))
    with pytest.raises(ospace.UrdfError, match=r"7 degrees of freedom: Pinocchio takes 2.2e.04 bytes") as caught:
        ospace.SpaceRobot.from_urdf(file, limits=ospace.Limits(dof=1000))
    assert caught.value.code == "too-many-dof"


# -- what is read all the same -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "name", ["a b.urdf", "spät.urdf", "机器人.urdf", "100% [bold] 'n \" so.urdf", "no_ending", ".urdf"]
)
def test_names_of_files_do_not_matter(tmp_path, capfd, name):
    file = tmp_path / "a folder" / name
    file.parent.mkdir()
    file.write_text(ONE_ARM)
    assert ospace.SpaceRobot.from_urdf(file).source == file
    assert ospace.SpaceRobot.from_urdf(str(file)).nv == 7
    assert capfd.readouterr() == ("", "")


def test_a_file_name_that_is_not_unicode_is_read(tmp_path):
    file = os.path.join(os.fsencode(tmp_path), b"\xff\xfe.urdf")
    with open(file, "w") as out:
        out.write(ONE_ARM)
    assert ospace.SpaceRobot.from_urdf(os.fsdecode(file)).nv == 7


DECLARED = '<?xml version="1.0" encoding="{}"?>' + robot(link("base"), name="café")


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig"])
@pytest.mark.parametrize("declared", ["utf-8", "ISO-8859-1", "UTF-16", "UTF-7"])
def test_the_encoding_is_utf_8_whatever_is_declared(file, encoding, declared):
    file.write_bytes(DECLARED.format(declared).encode(encoding))
    assert ospace.SpaceRobot.from_urdf(file).name == "café"


@pytest.mark.parametrize("before", ["\ufeff", "\n", "<!-- a comment: ü -->", "<?xml-model href='x'?>"])
@pytest.mark.parametrize("ends", ["\n", "\r\n"])
def test_what_may_stand_around_a_robot(file, before, ends):
    text = before + "\n" + ONE_ARM.replace("><", ">\n<!-- <link/> --><") + "\n<!-- end -->\n"
    file.write_bytes(text.replace("\n", ends).encode())
    assert ospace.SpaceRobot.from_urdf(file).n_joints == 1


def test_elements_that_are_not_urdf_do_not_matter(file):
    file.write_text(ONE_ARM.replace("</robot>", "<gazebo><plugin name='p'/></gazebo><transmission name='t'/></robot>"))
    assert ospace.SpaceRobot.from_urdf(file).total_mass == 4.0


def test_meshes_need_not_exist(file, capfd):
    mesh = '<visual><geometry><mesh filename="package://nowhere/arm.stl"/></geometry></visual>'
    file.write_text(ONE_ARM.replace("</link>", mesh + "</link>"))
    assert ospace.SpaceRobot.from_urdf(file, package_dirs=["/nowhere"]).package_dirs == (Path("/nowhere"),)
    assert capfd.readouterr() == ("", "")


def test_standard_error_is_given_back(file, capfd):
    file.write_text(robot(link("base"), link("base")))
    for _ in range(3):
        with pytest.raises(ospace.UrdfError):
            ospace.SpaceRobot.from_urdf(file)
    os.write(2, b"still there")
    assert capfd.readouterr().err == "still there"


def test_no_descriptor_leaks(file):
    file.write_text(ONE_ARM)
    bad = file.with_name("bad.urdf")
    bad.write_text(robot(link("base"), link("base")))
    ospace.SpaceRobot.from_urdf(file)
    before = len(os.listdir("/proc/self/fd"))
    for _ in range(5):
        ospace.SpaceRobot.from_urdf(file)
        with pytest.raises(ospace.UrdfError):
            ospace.SpaceRobot.from_urdf(bad)
    assert len(os.listdir("/proc/self/fd")) == before
