"""`ospace check --fix`: what has one right repair is repaired, every other byte stays, nothing is overwritten."""

from __future__ import annotations

import difflib
import re
import resource
import signal

import numpy as np
import pytest
from urdf.corpus import VARIANTS
from urdf.corpus.parts import ARM, AXIS, LIMIT, inertial, joint, link, robot

import ospace
from ospace.cli.main import main
from ospace.urdf import reader, repair
from ospace.urdf.lint.rules import RULES

FIXABLE = {code.name for code in RULES.values() if code.fixable}
ODD = (
    "<?xml version='1.0'?>\r\n<!-- <mass value=' 2 '/> stays -->\r\n<robot name = 'r'  >\n"
    "<link name='base'  ><inertial ><mass\n value=' 2\t' /><inertia ixx=\"0.010 \" ixy='0' ixz='0' iyy='0.01' iyz='0'"
    " izz='0.02000001'/></inertial><!-- c --></link>\n<gazebo><mass value=' 2 '/></gazebo>\n"
    '<link name="ärm&amp;"><inertial><mass value="1"/><inertia ixx="1" ixy="0.5" ixz="0" iyy="1" iyz="0" izz="1"/>'
    "</inertial></link>\t<joint name='j' type='revolute'><axis   xyz = ' 0 3 4 '  /><parent link='base'/>"
    "<child link='ärm&amp;'/>\n  </joint>\n</robot>\n<?end?>"
)


def fixed(tmp_path, content, name="in.urdf"):
    """Content of the repaired copy, changes, and what is found in it."""
    file, out = tmp_path / name, tmp_path / "out.urdf"
    file.write_bytes(content if isinstance(content, bytes) else content.encode())
    changes = repair.write(file, out)
    if not changes:
        assert not out.exists()
        return file.read_bytes(), changes, reader.read(file)
    return out.read_bytes(), changes, reader.read(out)


def test_all_repairs_at_once_and_not_a_byte_more(tmp_path):
    content, changes, reading = fixed(tmp_path, ODD)
    assert [change.code for change in changes] == [
        *["number-spaces"] * 3, "axis-not-unit", "limits-missing", "inertia-rounding"]  # fmt: skip
    assert not FIXABLE & {finding.code for finding in reading.findings}
    expected = ODD.encode()
    for old, new in (
        (b"mass\n value=' 2\t' ", b"mass\n value='2' "),
        (b"xyz = ' 0 3 4 '", b"xyz = '0 0.6 0.8'"),
        (b"\n  </joint>", b'\n  <limit lower="-1e9" upper="1e9" effort="1e9" velocity="1e9"/></joint>'),
    ):
        assert expected.count(old) == 1
        expected = expected.replace(old, new)
    tensor = rb"ixx=\S+ ?\S* ixy='0' ixz='0' iyy=\S+ iyz='0' izz=[^/]*"
    (moments,) = re.findall(tensor, content)
    assert content == re.sub(tensor, moments, expected)


def test_a_tensor_becomes_the_nearest_of_a_body(tmp_path):
    _, _, reading = fixed(tmp_path, robot(link("base", inertial(moments=("0.02", "0.03", "0.0500004")))))
    moments = np.array(reading.description.links[0].inertial.tensor)[[0, 3, 5]]
    np.testing.assert_allclose(moments, [0.02 + 4e-7 / 3, 0.03 + 4e-7 / 3, 0.0500004 - 4e-7 / 3], atol=2e-7)
    assert moments[2] <= (moments[0] + moments[1]) * (1 + 1e-12)


def test_a_slightly_negative_moment_is_repaired(tmp_path):
    content = robot(link("base"), link("arm", inertial(moments=("-1e-7", "0.04", "0.04"))), joint())
    _, changes, reading = fixed(tmp_path, content)
    assert [change.code for change in changes] == ["inertia-indefinite"]
    assert reading.model is not None


@pytest.mark.parametrize(
    "variant",
    [v for v in VARIANTS if v.status < 2 and not v.options and v.file.endswith(".urdf")],
    ids=lambda v: v.name,
)
def test_what_is_repaired_is_clean_and_keeps_its_meaning(tmp_path, variant):
    before_content = variant.content
    content, changes, reading = fixed(tmp_path, before_content)
    codes = {finding.code for finding in reading.findings}
    told = {change.code for change in changes}
    assert not told & codes
    assert codes & FIXABLE <= {"inertia-indefinite"}  # beyond what rounding does, there is no one right repair
    assert bool(changes) == (content != before_content)
    before, after = (re.findall(rb"""[^\s"'<>=]+""", text) for text in (before_content, content))
    kept = sum(
        block.size for block in difflib.SequenceMatcher(None, before, after, autojunk=False).get_matching_blocks()
    )
    assert kept >= len(before) - 10
    assert repair.repair_content(tmp_path / "out.urdf", content)[1] == []


@pytest.mark.parametrize("number", ["", "x", "1,5", "nan", " "])
def test_what_cannot_be_read_is_left(tmp_path, number):
    content = ARM.replace('value="2"', f'value="{number}"', 1)
    assert fixed(tmp_path, content)[1] == []


def test_limits_keep_one_coordinate(tmp_path):
    content = robot(
        link("base"), link("arm"), link("rod"), joint(more=AXIS), joint("r", "prismatic", child="rod", more=AXIS)
    )
    file, out = tmp_path / "in.urdf", tmp_path / "out.urdf"
    file.write_text(content)
    repair.write(file, out)
    made = ospace.SpaceRobot.from_urdf(out)
    assert (made.nq, made.nv) == (9, 8)
    assert made.findings == ()


def test_missing_effort_and_velocity_are_added(tmp_path):
    content = ARM.replace(' effort="10" velocity="1"/>', "  />")
    content, changes, _ = fixed(tmp_path, content)
    assert [change.code for change in changes] == ["effort-missing"]
    assert b'<limit lower="-1" upper="1" effort="1e9" velocity="1e9"  />' in content


def test_limits_that_mean_none_become_numbers_that_are_never_reached(tmp_path):
    content = ARM.replace(LIMIT, '<limit lower="-inf" upper="1" effort=" -1" velocity="999999"/>')
    content, changes, reading = fixed(tmp_path, content)
    assert [change.code for change in changes][-1] == "limits-none"
    assert b'<limit lower="-1e9" upper="1" effort="1e9" velocity="1e9"/>' in content
    assert reading.findings == ()


def test_a_byte_order_mark_shifts_nothing(tmp_path):
    plain = fixed(tmp_path, ODD)[0]
    (tmp_path / "out.urdf").unlink()
    assert fixed(tmp_path, b"\xef\xbb\xbf" + ODD.encode())[0] == b"\xef\xbb\xbf" + plain


def test_what_is_not_of_urdf_is_left(tmp_path):
    """Attributes of other namespaces and of foreign elements are nobody's numbers."""
    content = ARM.replace("<robot", '<robot xmlns:u="http://example.org/u"')
    content = content.replace('<mass value="2"', '<mass u:w=" 1 " w=" 1 " value=" 2 "', 1)
    content = content.replace("</joint>", '<rotor value=" 3 "/><u:rotor value=" 3 "/></joint>')
    repaired, changes, _ = fixed(tmp_path, content)
    assert [change.code for change in changes] == ["number-spaces"]
    assert repaired.decode() == content.replace('value=" 2 "', 'value="2"')


def test_no_break_spaces_are_no_white_space(tmp_path):
    assert fixed(tmp_path, ARM.replace("0.3 0 0", "0.3\u00a00 0 "))[1] == []


@pytest.mark.parametrize(
    ("content", "code"),
    [
        (robot(link("base"), link("other")), "two-roots"),
        (robot(link("base"), '<joint name="hinge" type="revolute"/>'), "joint-ends"),
    ],
)
def test_what_is_refused_is_not_repaired(tmp_path, content, code):
    file, out = tmp_path / "in.urdf", tmp_path / "out.urdf"
    file.write_text(content.replace('value="2"', 'value=" 2"'))
    with pytest.raises(ospace.UrdfError) as caught:
        repair.write(file, out)
    assert caught.value.code == code
    assert not out.exists()


def test_half_a_file_does_not_stay(tmp_path):
    file, out = tmp_path / "in.urdf", tmp_path / "out.urdf"
    file.write_text(ARM.replace("0 1 0", "0 2 0") + " " * 100_000)
    limit = resource.getrlimit(resource.RLIMIT_FSIZE)
    before = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (10_000, limit[1]))
    try:
        with pytest.raises(ospace.OspaceError, match="cannot be written: File too large"):
            repair.write(file, out)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limit)
        signal.signal(signal.SIGXFSZ, before)
    assert not out.exists()


# -- the command -------------------------------------------------------------------------------------------------


@pytest.fixture
def run(capsys):
    def call(*arguments):
        try:
            status = main(["check", *map(str, arguments)])
        except SystemExit as leaving:
            status = leaving.code
        return (status, *capsys.readouterr())

    return call


def test_the_command_lists_each_change(run, tmp_path):
    file, out = tmp_path / "in.urdf", tmp_path / "out.urdf"
    file.write_text(ARM.replace("0 1 0", "0 2 0").replace(LIMIT, ""))
    status, text, err = run(file, "--fix", out)
    assert (status, err) == (0, "")
    assert text.splitlines() == [
        "axis-not-unit: joint 'hinge', line 3: its axis '0 2 0' becomes '0 1 0'",
        'limits-missing: joint \'hinge\', line 3: gets <limit lower="-1e9" upper="1e9" effort="1e9" velocity="1e9"/>',
        f"wrote {out}: 2 changes, 0 errors left",
    ]
    assert run(out, "--samples", 1)[0] == 0


def test_errors_that_are_left_are_reported(run, tmp_path):
    file, out = tmp_path / "in.urdf", tmp_path / "out.urdf"
    file.write_text(ARM.replace("0 1 0", "0 2 0").replace('value="2"', 'value="-2"', 1))
    status, text, _ = run(file, "--fix", out)
    assert (status, text.splitlines()[-1]) == (1, f"wrote {out}: 1 change, 1 error left")


def test_a_sound_file_is_not_written_again(run, tmp_path):
    file, out = tmp_path / "in.urdf", tmp_path / "out.urdf"
    file.write_text(ARM)
    assert run(file, "--fix", out) == (0, f"nothing to repair: {out} was not written\n", "")
    assert not out.exists()


def test_nothing_is_overwritten(run, tmp_path):
    file, other = tmp_path / "in.urdf", tmp_path / "other.urdf"
    odd = ARM.replace("0 1 0", "0 2 0")
    file.write_text(odd)
    other.write_text("mine")
    (tmp_path / "link.urdf").symlink_to("nowhere.urdf")
    for out in (file, other, tmp_path, tmp_path / "link.urdf", tmp_path / "no" / "such" / "folder.urdf"):
        status, text, err = run(file, "--fix", out)
        assert (status, text) == (2, "")
        assert err.startswith(f"ospace: error: {out}: ")
    assert (file.read_text(), other.read_text()) == (odd, "mine")
    assert sorted(one.name for one in tmp_path.iterdir()) == ["in.urdf", "link.urdf", "other.urdf"]


def test_a_file_that_cannot_be_read_is_not_repaired(run, tmp_path):
    file, out = tmp_path / "in.urdf", tmp_path / "out.urdf"
    file.write_text("<robot>")
    status, _, err = run(file, "--fix", out)
    assert status == 2
    assert "[not-xml]" in err
    assert not out.exists()


@pytest.mark.parametrize("arguments", [[], ["x", "--fix", "y", "--explain", "loop"], ["x", "--json", "--fix", "y"]])
def test_wrong_usage_is_refused(run, arguments):
    status, text, err = run(*arguments)
    assert (status, text) == (2, "")
    assert err.startswith("usage: ")


def test_quaternions_stay_what_they_are(tmp_path):
    """One that is of unit length is not touched, one that is not points the same way."""
    content = robot(
        link("base"),
        link("arm", inertial().replace('0.05"', '0.05" quat_xyzw=" 0 0.6 0 0.8 "')),
        joint(more='<axis xyz="0 0 2"/>').replace('"0.3 0 0"', '"0.3 0 0" quat_xyzw="1 0 0 1"'),
    ).replace("<robot", "<robot version='1.2'")
    before = reader.read_content(tmp_path / "in.urdf", content.encode())
    text, changes, after = fixed(tmp_path, content)
    assert {change.code for change in changes} == {
        "number-spaces", "quaternion-not-unit", "axis-not-unit", "limits-missing"}  # fmt: skip
    assert b'quat_xyzw="0 0.6 0 0.8"' in text
    assert {finding.code for finding in after.findings} == set()
    for one, other in zip(before.model.jointPlacements, after.model.jointPlacements, strict=True):
        assert one.isApprox(other, 1e-14)
    assert all(
        one.isApprox(other, 1e-14) for one, other in zip(before.model.inertias, after.model.inertias, strict=True)
    )


LATIN = '<?xml version="1.0" encoding="ISO-8859-1"?>\r\n' + ODD.partition("\n")[2].replace("<?end?>", "<!-- é -->")


@pytest.mark.parametrize("encoding", ["iso-8859-1", "utf-16"])
def test_a_copy_keeps_the_encoding_of_the_file(tmp_path, encoding):
    """It reads as the same file in UTF-8 does, repaired; bytes that are not repaired stay."""
    text = LATIN.replace("ISO-8859-1", encoding)
    content, changes, reading = fixed(tmp_path, text.encode(encoding))
    (tmp_path / "out.urdf").unlink()
    plain, same_changes, same = fixed(tmp_path, text.replace(encoding, "utf-8").encode())
    assert content.decode(encoding) == plain.decode().replace("utf-8", encoding)
    assert (changes, reading.description) == (same_changes, same.description)
    assert "ärm&" in reading.description.link


def test_blank_lines_before_the_declaration_go(tmp_path):
    content, changes, reading = fixed(tmp_path, "\n \n" + ARM)
    assert content == ARM.encode()
    assert [str(change) for change in changes] == [
        "declaration-late: file, line 1: the blank lines before <?xml …?> go"
    ]
    assert reading.findings == ()
