"""The report of a check says what its JSON says, draws what there is to draw, and takes no name for more than text."""

from __future__ import annotations

import base64
import gzip
import json
import re
import struct

import numpy as np
import pytest
import umsgpack
from lxml import html
from urdf.corpus import VARIANTS

import ospace
from ospace.cli.main import main
from ospace.exceptions import printable
from ospace.urdf.lint.rules import RULES
from ospace.visual.marked_robot import COLOURS

INERTIAL = (
    '<inertial><origin xyz="0.1 0 0.2"/><mass value="2"/>'
    '<inertia ixx="1" iyy="1.2" izz="0.9" ixy="0.1" ixz="0" iyz="0"/></inertial>'
)
BOX = '<visual><geometry><box size="0.4 0.3 0.2"/></geometry></visual>'
MESH = '<visual><geometry><mesh filename="nowhere.stl"/></geometry></visual>'
NAMES = ["<script>alert(1)</script>", "</script><!--", "constructor", "__proto__", "a/b", "{{ 7 * 7 }}", "\"'&amp;"]


def link(name, inertial=INERTIAL, shape=BOX):
    return f"<link name={quoted(name)}>{inertial}{shape}</link>"


def joint(name, child, parent="base", kind="revolute"):
    return (
        f"<joint name={quoted(name)} type='{kind}'><parent link={quoted(parent)}/><child link={quoted(child)}/>"
        '<origin xyz="0.3 0 0.1"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>'
    )


def quoted(name):
    for letter, entity in (("&", "&amp;"), ("<", "&lt;"), ('"', "&quot;")):
        name = name.replace(letter, entity)
    return f'"{name}"'


class Page:
    """What a browser would read of a report."""

    def __init__(self, text):
        self.text = text
        self.tree = html.document_fromstring(text)

    def rows(self, table):
        """Texts of the cells of a table, row by row."""
        return [[text_of(cell) for cell in row] for row in self.tree.xpath(f"//table[@id='{table}']/tbody/tr")]

    def data(self, name):
        """What a script finds in the page."""
        return json.loads(self.tree.get_element_by_id(name).text)

    def commands(self):
        """What makes the scene."""
        content = gzip.decompress(base64.b64decode(self.data("scene-data")["commands"]))
        start = 0
        while start < len(content):
            (length,) = struct.unpack_from("<I", content, start)
            yield umsgpack.unpackb(content[start + 4 : start + 4 + length])
            start += 4 + length

    def colours(self):
        """Colours of all that stands below each path."""
        return {
            one["path"]: one["object"]["materials"][0]["color"]
            for one in self.commands()
            if one["type"] == "set_object" and one["object"]["materials"]
        }


def text_of(element):
    return " ".join(element.text_content().split())


def hexadecimal(severity):
    red, green, blue, _ = (round(255 * part) for part in COLOURS[severity])
    return red << 16 | green << 8 | blue


@pytest.fixture
def check(tmp_path, capsys):
    """Check a robot twice; exit status, the document of ``--json``, and the page."""

    def call(given, *options):
        if given not in ospace.models.names():
            file = tmp_path / "robot.urdf"
            file.write_bytes(given if isinstance(given, bytes) else f'<robot name="made">{given}</robot>'.encode())
            given = str(file)
        page = tmp_path / "report.html"
        page.unlink(missing_ok=True)
        status = main(["check", given, "--samples", "2", "--json", "--html", str(page), *options])
        document = json.loads(capsys.readouterr().out)
        return status, document, Page(page.read_text(encoding="utf-8"))

    return call


def agree(document, page):
    """Compare a page with the document of the same check."""
    assert page.rows("findings-table") == [
        [
            one["severity"],
            one["code"],
            " ".join(one["subject"].split()),
            str(one["line"] or ""),
            " ".join(printable(one["value"] or "").split()),
            " ".join(one["message"].split()),
            " ".join(one["remedy"].split()),
        ]
        for one in document["findings"]
    ]
    rows = page.rows("agreement-table")
    assert [row[:4] for row in rows] == [
        [one["quantity"], one["equation"], one["computed_by"], one["checked_against"]] for one in document["agreement"]
    ]
    for row, one in zip(rows, document["agreement"], strict=True):
        assert row[4:6] == [f"{one[key]:.1e}" if one[key] is not None else "not finite" for key in ("error", "bound")]
        assert row[6].startswith(one["verdict"])
    assert text_of(page.tree.xpath("//span[starts-with(@class, 'verdict')]")[0]) == document["verdict"]
    codes = {one["code"] for one in document["findings"]}
    details = {one.get("id").removeprefix("code-"): text_of(one) for one in page.tree.xpath("//details[@id!='notes']")}
    assert details.keys() == codes
    assert all(" ".join(RULES[code].reason.split()) in details[code] for code in codes)


# -- content -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["chaser_24dof", "planar_2r"])
def test_the_page_says_what_the_document_says(check, name):
    status, document, page = check(name)
    assert status == 0
    agree(document, page)
    facts = dict(page.rows("model-table"))
    assert facts["total mass"] == f"{document['model']['total_mass']:.6g} kg"
    assert len(page.rows("agreement-table")) > 30
    assert page.tree.xpath("//h1")[0].text == name


def test_hands_are_mapped(check):
    """Of the published arm, whose workspaces tests/analysis/test_workspaces.py derives."""
    _, _, page = check("planar_2r")
    ((hand, rows, reach, free, singular, sigma, turn, wheels),) = page.rows("reach-table")
    assert (hand, rows, reach) == ("end_effector", "position", "0 to 2.2872 m")
    assert (free, singular) == ("0 to 1.4436 m", "1.4436 to 2.2872 m")
    assert 0.0 < float(sigma) < 1e-3
    assert 80.0 < float(turn.removesuffix(" deg")) < 88.0
    assert wheels.startswith("0, 0, 13")


def test_a_hand_that_cannot_be_mapped_says_why(check):
    planar = joint("slide", "arm", kind="planar")
    _, _, page = check(f"{link('base')}{link('arm')}{planar}")
    ((hand, why),) = page.rows("reach-table")
    assert hand == "arm"
    assert why.startswith("not mapped: joint 'slide' is of type Planar: name joints that turn or slide")


def test_masses_sum_to_the_total(check):
    _, document, page = check("chaser_24dof")
    rows = page.rows("mass-table")
    masses = [float(row[1]) for row in rows]
    assert sum(masses) == pytest.approx(document["model"]["total_mass"], rel=1e-5)
    assert masses == sorted(masses, reverse=True)
    assert sum(float(row[2].removesuffix(" %")) for row in rows) == pytest.approx(100.0, abs=0.05 * len(rows))
    (total,) = page.tree.xpath("//table[@id='mass-table']/tfoot/tr")
    assert [text_of(cell) for cell in total][:3] == ["total", "483", "100 %"]
    of_base = [float(row[1]) for row in rows if row[0] == "base" or row[6] == "base"]
    assert sum(of_base) == pytest.approx(document["model"]["base_mass"])


def test_a_row_of_the_masses_is_the_file_s(check):
    _, _, page = check(link("base") + link("arm", INERTIAL.replace('"2"', '"6"')) + joint("weld", "arm", kind="fixed"))
    moments = ", ".join(f"{one:.4g}" for one in np.linalg.eigvalsh([[1, 0.1, 0], [0.1, 1.2, 0], [0, 0, 0.9]]))
    assert page.rows("mass-table") == [
        ["arm", "6", "75.0 %", "", "0.1, 0, 0.2", moments, "base"],
        ["base", "2", "25.0 %", "", "0.1, 0, 0.2", moments, "itself"],
    ]


def test_the_page_asks_for_nothing_and_is_well_made(check):
    _, _, page = check("chaser_24dof")
    assert "default-src 'none'" in page.tree.xpath("//meta[@http-equiv]")[0].get("content")
    assert not page.tree.xpath("//script[@src] | //link[@href != 'data:,'] | //img | //iframe")
    assert len(page.tree.xpath("//h1")) == 1
    for table in page.tree.xpath("//table"):
        assert text_of(table.find("caption"))
        assert page.tree.get_element_by_id(table.get("aria-labelledby")).tag == "h2"
        assert all(one.get("scope") in ("col", "row") for one in table.iter("th"))
    names = [one.get("id") for one in page.tree.xpath("//*[@id]")]
    assert len(names) == len(set(names))
    for one in page.tree.xpath("//a"):
        assert page.tree.get_element_by_id(one.get("href").removeprefix("#")).tag == "details"


# -- the scene ---------------------------------------------------------------------------------------------------

RED_BOX = BOX.replace("</visual>", '<material name="paint"><color rgba="1 0 0 1"/></material></visual>')
TWO_FAULTS = (
    link("base", shape=RED_BOX)
    + link("arm", INERTIAL.replace('"2"', '"-2"'))
    + link("hand")
    + joint("shoulder", "arm")
    + joint("wrist", "hand", "arm").replace('effort="1"', 'effort="-2"')
)


def test_links_with_findings_are_coloured(check):
    status, document, page = check(TWO_FAULTS)
    assert (status, document["model"]) == (1, None)
    agree(document, page)
    severities = {one["subject"]: one["severity"] for one in document["findings"]}
    assert severities["link 'arm'"] == "error"
    assert severities["joint 'wrist'"] == "error"
    colours = page.colours()
    of_link = {
        name: next(colour for path, colour in colours.items() if f"/link {name}/" in path)
        for name in ("base", "arm", "hand")
    }
    assert of_link["arm"] == of_link["hand"] == hexadecimal("error")
    assert of_link["base"] == 0xB8BDC7
    labels = [one["text"] for one in page.data("scene-data")["labels"]]
    assert sorted(labels) == ["arm: error", "hand: error"]
    legends = [one["legend"] for one in page.data("scene-data")["layers"]]
    assert any("joint colours the link" in legend for legend in legends)


def test_an_error_goes_before_a_warning_and_infos_colour_nothing(check):
    heavy = INERTIAL.replace('"2"', '"2e6"')
    _, document, page = check(
        link("base") + link("arm", heavy) + link("hand", "") + joint("a", "arm") + joint("b", "hand", "arm")
    )
    severities = {(one["subject"], one["severity"]) for one in document["findings"]}
    assert {("joint 'b'", "error"), ("link 'arm'", "warning")} <= severities
    colours = page.colours()
    assert {colour for path, colour in colours.items() if "/link hand/" in path} == {hexadecimal("error")}
    assert {colour for path, colour in colours.items() if "/robot/link arm/" in path} == {hexadecimal("warning")}
    _, document, page = check("chaser_24dof")
    assert {one["severity"] for one in document["findings"]} == {"info"}
    assert not {hexadecimal("error"), hexadecimal("warning")} & set(page.colours().values())
    assert page.data("scene-data")["labels"] == []
    _, _, page = check(link("base", shape=RED_BOX))
    assert next(colour for path, colour in page.colours().items() if "/link base/" in path) == 0xFF0000


def test_a_link_with_an_error_and_a_warning_is_red(check):
    wrong = INERTIAL.replace('"2"', '"-2"').replace('xyz="0.1 0 0.2"', 'xyz="0.1 0 0.2" rpy="90 0 0"')
    _, document, page = check(link("base") + link("arm", wrong) + joint("a", "arm"))
    assert {one["severity"] for one in document["findings"] if one["subject"] == "link 'arm'"} == {"error", "warning"}
    assert [one["text"] for one in page.data("scene-data")["labels"]] == ["arm: error"]


def test_a_link_with_a_shape_is_drawn_by_it_alone(check):
    _, _, page = check(link("base") + link("arm", shape="") + joint("a", "arm"))
    assert [path for path in page.colours() if "inertia box" in path] == []


def test_a_negative_mass_leaves_no_shares(check):
    _, _, page = check(TWO_FAULTS)
    assert [row[:3] for row in page.rows("mass-table")] == [["base", "2", ""], ["hand", "2", ""], ["arm", "-2", ""]]


def test_a_button_shows_the_links_of_its_finding(check):
    _, document, page = check(TWO_FAULTS)
    buttons = page.tree.xpath("//button[@data-shown]")
    assert [text_of(one) for one in buttons] == [one["subject"] for one in document["findings"]]
    shown = page.data("shown-data")
    paths = {text_of(one): shown[int(one.get("data-shown"))]["paths"] for one in buttons}
    assert any(path.endswith("/robot/link hand") for path in paths["joint 'wrist'"])
    drawn = set(page.colours())
    for some in paths.values():
        assert any(one.startswith(f"{path}/") for path in some for one in drawn)
    at = {text_of(one): shown[int(one.get("data-shown"))]["at"] for one in buttons}
    assert at["joint 'wrist'"][12:15] == pytest.approx([0.6, 0.0, 0.2])


def test_a_finding_on_a_merged_body_shows_all_its_links(check):
    light = INERTIAL.replace('"2"', '"1e-12"')
    _, document, page = check(
        link("base")
        + link("arm", light.replace('ixx="1"', 'ixx="-1"'))
        + link("tool", light)
        + joint("a", "arm")
        + joint("weld", "tool", "arm", kind="fixed")
    )
    (merged,) = [one["subject"] for one in document["findings"] if "fixed to it" in one["subject"]]
    (button,) = [one for one in page.tree.xpath("//button[@data-shown]") if text_of(one) == merged]
    paths = page.data("shown-data")[int(button.get("data-shown"))]["paths"]
    assert {path.rpartition("/link ")[2] for path in paths} == {"arm", "tool"}


def test_only_some_names_are_shown_and_all_links_are_coloured(check):
    _, _, page = check("".join([link("base"), *(link(f"a{k}", "") + joint(f"j{k}", f"a{k}") for k in range(20))]))
    assert len(page.data("scene-data")["labels"]) == 12
    assert "20 links are coloured; the names of 12 are shown" in text_of(page.tree.get_element_by_id("notes"))
    assert sum(colour == hexadecimal("error") for colour in page.colours().values()) == 20


def test_a_robot_without_shapes_is_drawn_by_its_inertias(check):
    status, document, page = check(link("base", shape="") + link("arm", "", "") + joint("shoulder", "arm"))
    assert status == 1
    agree(document, page)
    drawn = page.colours()
    assert any("/link base/inertia box" in path for path in drawn)
    assert [path for path, colour in drawn.items() if colour == hexadecimal("error")] == [
        "/robot/body arm/robot/link arm/dot"
    ]


def test_a_robot_with_collision_shapes_alone_shows_them(check):
    shape = BOX.replace("visual", "collision")
    _, _, page = check(link("base", shape=shape) + link("arm", "", shape) + joint("shoulder", "arm"))
    shown = {one["name"]: one["shown"] for one in page.data("scene-data")["layers"]}
    assert shown == {"robot": True, "collision": True, "inertia": False, "names": True}
    assert [path for path, colour in page.colours().items() if colour == hexadecimal("error")] == [
        "/robot/body arm/robot/link arm/dot"
    ]


def test_a_missing_mesh_is_reported_and_its_inertia_stands_in(check):
    _, document, page = check(link("base", shape=MESH) + link("arm") + joint("shoulder", "arm"))
    assert "mesh-missing" in {one["code"] for one in document["findings"]}
    agree(document, page)
    assert any("/link base/inertia box" in path for path in page.colours())
    assert "a box of the link's inertia" in text_of(page.tree.get_element_by_id("notes"))


FAR = '<visual><origin xyz="9e11 0 0"/><geometry><box size="1e12 1 1"/></geometry></visual>'
VAST = '<visual><geometry><mesh filename="vast.obj" scale="1e12 1 1"/></geometry></visual>'


@pytest.mark.parametrize("shape", [FAR, VAST], ids=["far", "overflow"])
def test_a_robot_that_cannot_be_drawn_is_reported(check, tmp_path, shape):
    (tmp_path / "vast.obj").write_text("v 0 0 0\nv 1e300 0 0\nv 0 1 0\nf 1 2 3\n")
    status, document, page = check(link("base", INERTIAL.replace('"2"', '"-2"'), shape))
    assert status == 1
    agree(document, page)
    assert "cannot be drawn" in text_of(page.tree.get_element_by_id("notes"))
    assert page.tree.xpath("//button[@data-shown]") == []
    assert not [path for path in page.colours() if path.startswith("/robot")]
    assert page.rows("mass-table")[0][:3] == ["base", "-2", ""]


def test_a_base_without_anything_is_a_dot(check):
    status, document, page = check(link("base", "", ""))
    assert status == 1
    agree(document, page)
    assert set(page.colours().values()) >= {hexadecimal("error")}
    assert "No link of this robot has mass." in text_of(page.tree.get_element_by_id("report"))


def test_a_check_that_breaks_off_is_reported(check):
    """The model is sound by itself, and singular in any state: no dynamics to draw by."""
    ring = joint("inner", "arm", "ring").replace('<origin xyz="0.3 0 0.1"/>', "")
    status, document, page = check(link("base") + link("ring", "") + link("arm") + joint("outer", "ring") + ring)
    assert status == 1
    assert "singular-inertia" in {one["code"] for one in document["findings"]}
    agree(document, page)
    assert "Nothing was compared" in text_of(page.tree.get_element_by_id("report"))


# -- hostile files -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", NAMES)
def test_names_of_links_and_joints_are_text(check, name):
    parts = link("base") + link(name, "", shape="") + joint(f"{name}!", name)
    status, document, page = check(parts)
    assert status == 1
    agree(document, page)
    assert len(page.tree.xpath("//script")) == 5
    assert page.tree.xpath("//script[contains(text(), 'alert(1)')][not(@type)]") == []
    subjects = [text_of(one) for one in page.tree.xpath("//button[@data-shown]")]
    assert f"joint '{name}!'" in subjects
    assert [one["text"] for one in page.data("scene-data")["labels"]] == [f"{name}: error"]
    dots = [path for path in page.colours() if path.endswith("/dot")]
    assert [path.count("/") for path in dots] == [5]


@pytest.mark.parametrize("name", NAMES)
def test_names_within_messages_are_text(check, name):
    follows = joint("follow", "b").replace("</joint>", f"<mimic joint={quoted(name)}/></joint>")
    _, document, page = check(link("base") + link("a") + link("b") + joint(name, "a") + follows)
    assert any(name in one["message"] for one in document["findings"])
    agree(document, page)


def test_the_whole_robot_s_name_is_text(check):
    name = "<script>alert(1)</script>"
    _, _, page = check(f"<robot name={quoted(name)}>{link('base')}</robot>".encode())
    assert text_of(page.tree.xpath("//h1")[0]) == name
    assert "<script>alert" not in page.text


@pytest.mark.parametrize("variant", [one for one in VARIANTS if one.status == 1], ids=lambda variant: variant.name)
def test_every_unsound_file_has_its_report(check, variant):
    status, document, page = check(variant.content, *variant.options)
    assert status == 1
    agree(document, page)
    for table in ("model-table", "agreement-table", "mass-table"):  # findings say what the file says
        assert not re.search(r"\b(nan|inf)\b", str(page.rows(table)), re.IGNORECASE)
    for one in page.commands():
        if one["type"] == "set_transform":
            assert np.isfinite(one["matrix"]).all(), one["path"]
