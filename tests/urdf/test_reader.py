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
from hypothesis import given, settings
from hypothesis import strategies as st
from urdf import fuzz
from urdf.corpus import parts as made

import ospace
from ospace.exceptions import printable
from ospace.urdf import source, structure

INERTIAL = (
    '<inertial><origin xyz="0 0 0.1"/><mass value="2"/>'
    '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
)
LIMIT = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'
SECONDS = 20
repeatable = settings(derandomize=True, deadline=None, max_examples=50)


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


@pytest.fixture(autouse=True)
def no_hang():
    """Fail a test that waits for a file, a network or an expansion for ever."""

    def give_up(number, frame):
        raise TimeoutError(f"no answer in {SECONDS} s")

    before = signal.signal(signal.SIGALRM, give_up)
    signal.alarm(SECONDS)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


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


def test_a_missing_file(file, capfd):
    refuse(file, capfd, "no such file")


def test_a_missing_folder(file, capfd):
    refuse(file / "robot.urdf", capfd, "no such file|cannot be read")


def test_a_folder(tmp_path, capfd):
    refuse(tmp_path, capfd, "not a regular file")


def test_no_path_at_all(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ospace.UrdfError):
        ospace.SpaceRobot.from_urdf("")


def test_a_fifo_that_nobody_writes_to(file, capfd):
    os.mkfifo(file)
    refuse(file, capfd, "not a regular file")


@pytest.mark.parametrize("device", ["/dev/null", "/dev/zero", "/dev/tty"])
def test_a_device(device, capfd):
    refuse(Path(device), capfd, "not a regular file")


def test_a_link_to_nothing(file, capfd):
    file.symlink_to("nowhere")
    refuse(file, capfd, "no such file")


def test_a_link_to_itself(file, capfd):
    file.symlink_to(file.name)
    refuse(file, capfd, "cannot be read")


def test_a_file_that_may_not_be_read(file, capfd):
    if os.geteuid() == 0:
        pytest.skip("root may read every file")
    file.write_text(ONE_ARM)
    file.chmod(0)
    refuse(file, capfd, "cannot be read")


def test_a_file_that_no_one_may_read(file, capfd, monkeypatch):
    """As above, for root too."""
    file.write_text(ONE_ARM)

    def refuse_to_open(path, flags):
        raise PermissionError(13, "Permission denied", str(path))

    monkeypatch.setattr(source, "os", SimpleNamespace(**{**vars(os), "open": refuse_to_open}))
    refuse(file, capfd, "cannot be read.*Permission denied.*unreadable-file")


def test_a_path_with_a_zero_byte(tmp_path, capfd):
    refuse(tmp_path / "a\0b.urdf", capfd, "cannot be read|no such file")


def test_a_name_that_is_too_long(tmp_path, capfd):
    refuse(tmp_path / ("x" * 300), capfd, "cannot be read")


def test_a_file_that_is_too_large(file, capfd):
    with file.open("w") as sparse:
        sparse.truncate(ospace.Limits().bytes + 1)
    refuse(file, capfd, rf"has {ospace.Limits().bytes + 1} bytes; at most {ospace.Limits().bytes}")


def test_a_large_file_that_is_not_too_large(file):
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
def test_what_is_no_xml(file, capfd, content):
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
        (b"\xff\xfe" + ONE_ARM.encode(), "UTF-16"),
        (ONE_ARM.encode("utf-16"), "UTF-16"),
        (ONE_ARM.encode("utf-16-le"), "UTF-16"),
        (ONE_ARM.encode("utf-16-be"), "UTF-16"),
        (ONE_ARM.encode("utf-32-be"), "NUL"),
    ],
    ids=lambda content: repr(content[:12]),
)
def test_what_is_no_text(file, capfd, content, reason):
    file.write_bytes(content)
    refuse(file, capfd, reason)


@pytest.mark.parametrize("close", [b"", b"</a>" * 100_000 + b"</robot>"])
def test_elements_too_deep(file, capfd, close):
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
def test_what_is_no_urdf(file, capfd, content, reason):
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
def test_what_is_no_tree(file, capfd, parts, reason):
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
        (joint(kind="planar", more=AXIS), "planar-axis"),
    ],
)
def test_joints_that_move_in_no_known_way(file, capfd, part, code):
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
        (
            (
                link("base"),
                link("arm"),
                link("hand"),
                joint(),
                joint("k", child="hand"),
                joint("l", "fixed", "hand", more=""),
            ),
            "arm",
        ),
    ],
    ids=["its own parent", "two links that hang from each other", "two joints to one link", "closed loop"],
)
def test_links_that_are_no_tree_with_the_base(file, capfd, parts, subject):
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


def test_a_name_that_is_no_unicode(tmp_path):
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


# -- anything at all ---------------------------------------------------------------------------------------------


def answer(folder, content):
    """Any content gives a robot whose H is finite and not indefinite, or an OspaceError that says why there is none."""
    file = folder / "any.urdf"
    file.write_bytes(content)
    assert fuzz.verdict(file, np.random.default_rng(0)) in ("robot", "refused", "unsound")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("any")


@repeatable
@given(content=st.binary(max_size=200))
def test_any_bytes(folder, content):
    answer(folder, content)


@repeatable
@given(content=st.text(max_size=100))
def test_any_text_in_a_link(folder, content):
    answer(folder, robot(link("base"), content).encode("utf-8", "replace"))


TOKENS = [
    "0",
    "-1",
    "1e400",
    "nan",
    "",
    '"',
    "<",
    ">",
    "/>",
    "<link/>",
    "&amp;",
    "&x;",
    "base",
    "arm",
    "fixed",
    "<joint/>",
]


@repeatable
@given(data=st.data())
def test_any_cut_and_paste(folder, data):
    """A sound file, a piece taken out, and something put in its place."""
    start = data.draw(st.integers(0, len(ONE_ARM)))
    stop = data.draw(st.integers(start, min(len(ONE_ARM), start + 40)))
    answer(folder, (ONE_ARM[:start] + data.draw(st.sampled_from(TOKENS)) + ONE_ARM[stop:]).encode())


names = st.sampled_from(["base", "arm", "hand", "hinge"])
kinds = st.sampled_from(["revolute", "continuous", "prismatic", "fixed", "floating", "planar"])
any_joint = st.builds(joint, names, kinds, names, names)
any_link = st.builds(link, names, st.sampled_from([INERTIAL, "", "<inertial/>"]))


@repeatable
@given(links=st.lists(any_link, max_size=4), joints=st.lists(any_joint, max_size=4))
def test_any_graph_of_links_and_joints(folder, links, joints):
    answer(folder, robot(*links, *joints).encode())


numbers = (
    st.floats().map(repr) | st.integers(-3, 3).map(str) | st.sampled_from(["1e-300", "1e300", " 1 ", "1,5", "0x1"])
)
triples = st.tuples(numbers, numbers, numbers)
any_inertial = st.builds(
    lambda mass, moments, products, origin: made.inertial(mass, moments, products, " ".join(origin)),
    numbers,
    triples,
    triples,
    triples,
)


@settings(repeatable, max_examples=200)
@given(base=any_inertial, arm=any_inertial, axis=triples, origin=triples, kind=kinds)
def test_any_numbers(folder, base, arm, axis, origin, kind):
    more = f'<axis xyz="{" ".join(axis)}"/>' + LIMIT
    parts = link("base", base), link("arm", arm), made.joint(kind=kind, more=more, origin=" ".join(origin))
    answer(folder, robot(*parts).encode())


small = st.floats(-2.0, 2.0).map(repr)
moments = st.tuples(*[st.floats(-1e-9, 1.0).map(repr)] * 3)


@settings(repeatable, max_examples=200)
@given(
    inertials=st.lists(
        st.tuples(st.floats(0.0, 10.0).map(repr), moments, st.tuples(small, small, small)), min_size=3, max_size=3
    ),
    joints=st.tuples(kinds, kinds),
    axes=st.lists(st.tuples(small, small, small), min_size=2, max_size=2),
)
def test_any_numbers_of_a_usual_size(folder, inertials, joints, axes):
    zero = ("0", "0", "0")
    links = [link(f"l{k}", made.inertial(m, i, zero, " ".join(c))) for k, (m, i, c) in enumerate(inertials)]
    hinges = [
        made.joint(f"j{k}", kind, f"l{k}", f"l{k + 1}", f'<axis xyz="{" ".join(axis)}"/>' + LIMIT)
        for k, (kind, axis) in enumerate(zip(joints, axes, strict=True))
    ]
    answer(folder, robot(*links, *hinges).encode())
