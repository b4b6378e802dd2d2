"""Which part of a file is the robot: loops are opened and named, a root is chosen, what cannot be taken is named."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from urdf.corpus.parts import ARM, AXIS, LIMIT, joint, link, robot
from urdf.corpus.structure import BARS, DRAKE, FREE, LOOP, WORLD

import ospace
from ospace.cli.main import main
from ospace.urdf import tree
from ospace.urdf.description import Description


@pytest.fixture
def file(tmp_path):
    return tmp_path / "robot.urdf"


def read(file, *parts, **given):
    file.write_text(robot(*parts))
    return ospace.SpaceRobot.from_urdf(file, **given)


def refusal(file, *parts):
    with pytest.raises(ospace.UrdfError) as caught:
        read(file, *parts)
    return caught.value


def same(one, other):
    """The same bodies, joints and limits."""
    models = [made.model for made in (one, other)]
    names, placements, inertias, limits = (
        [list(model.names) for model in models],
        [[placement.homogeneous for placement in model.jointPlacements] for model in models],
        [[inertia.toDynamicParameters() for inertia in model.inertias] for model in models],
        [model.upperPositionLimit for model in models],
    )
    assert names[0] == names[1]
    for pair in (placements, inertias, limits):
        assert np.array_equal(*pair)


def test_a_loop_is_named_and_the_rest_is_the_tree(file):
    made = read(file, *LOOP, *BARS)
    (finding,) = made.findings
    assert (finding.code, finding.severity, finding.subject, finding.line) == ("loop-open", "warning", "joint 'd'", 3)
    assert finding.message.startswith("closes the loop 'rocker' – 'base' – 'crank' – 'coupler': it is left out")
    same(made, read(file, *LOOP, *BARS[:3]))


@pytest.mark.parametrize("order", list(itertools.permutations(range(4))))
def test_in_any_order_the_first_joint_to_a_link_stays(file, order):
    made = read(file, *LOOP, *(BARS[k] for k in order))
    kept = "c" if order.index(2) < order.index(3) else "d"
    assert sorted(made.joint_names) == sorted(["a", "b", kept])
    assert [finding.subject for finding in made.findings] == [f"joint '{'d' if kept == 'c' else 'c'}'"]


def test_each_loop_is_named(file):
    more = (link("pin"), joint("e", parent="coupler", child="pin"), joint("f", parent="rocker", child="pin"))
    assert [finding.subject for finding in read(file, *LOOP, *BARS, *more).findings] == ["joint 'd'", "joint 'f'"]


def test_a_long_loop_is_cut_short_in_words(file):
    links = [link(f"l{k}") for k in range(9)]
    joints = [joint(f"j{k}", parent=f"l{k - 1}" if k else "base", child=f"l{k}") for k in range(9)]
    (finding,) = read(file, link("base"), *links, *joints, joint("last", parent="l8", child="l0")).findings
    assert "closes the loop 'l8' – 'l7' – 'l6' – 'l5' – 'l4' – … (9 links): it is left out" in finding.message


def test_what_is_wrong_with_a_joint_that_is_left_out_does_not_count(file):
    closing = joint("d", "ball", "rocker", "coupler", "<axis xyz='x'/>")
    assert [finding.code for finding in read(file, *LOOP, *BARS[:3], closing).findings] == ["loop-open"]


def test_two_joints_of_the_same_links_are_refused(file):
    error = refusal(file, link("base"), link("arm"), joint(), joint("second"))
    assert error.code == "second-parent"
    assert "child of two joints of link 'base', joint 'hinge' and joint 'second': remove one" in error.reason


def test_random_graphs_become_trees_or_are_refused(tmp_path):
    """Every link of a tree is reached once, by a joint that stands behind the one before it."""
    rng, spanned, refused = np.random.default_rng(5), 0, set()
    arm = ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r")).description
    for _ in range(500):
        count = int(rng.integers(2, 8))
        links = tuple(arm.links[0].__class__(None, f"l{k}", None) for k in range(count))
        joints = []
        for k in range(int(rng.integers(1, 2 * count))):
            parent, child = rng.choice(count, 2)
            one = arm.joints[0]
            joints.append(
                type(one)(k, f"j{k}", "fixed", f"l{parent}", f"l{child}", one.pose, one.axis, None, 0, 0, None)
            )
        description = Description("random", links, tuple(joints))
        root = f"l{rng.integers(count)}" if rng.integers(2) else None
        try:
            found = tree.span(tmp_path, description, root=root)
        except ospace.UrdfError as error:
            refused.add(error.code)
            continue
        spanned += 1
        reached = {root or found.description.root}
        for one in found.description.joints:
            assert one.parent in reached
            assert one.child not in reached
            reached.add(one.child)
        assert reached == set(found.description.link)
        assert len(reached) == count or root is not None
    assert spanned > 100
    assert refused == {"two-roots", "loop", "second-parent"}


@pytest.mark.parametrize("name", ["base", "target"])
def test_one_of_two_free_bodies_is_read_by_its_root(file, name):
    error = refusal(file, *WORLD, *FREE)
    assert (error.code, error.line) == ("several-bodies", 3)
    assert "holds 2 free bodies, 'base', 'target', each on a floating joint of link 'world'" in error.reason
    assert "root='base'" in error.reason
    made = read(file, *WORLD, *FREE, root=name)
    (finding,) = made.findings
    assert (finding.code, finding.subject) == ("root-given", f"link '{name}'")
    alone = WORLD[1:4] if name == "base" else WORLD[4:5]
    same(made, read(file, *alone))


def test_a_root_that_is_not_there_is_answered_with_the_nearest(file, capsys):
    with pytest.raises(ospace.OspaceError, match="there is no link 'bus' to be the root; known: arm, base"):
        read(file, link("base"), link("arm"), joint(), root="bus")
    assert main(["check", str(file), "--root", "bsae"]) == 2
    assert "there is no link 'bsae' to be the root; did you mean 'base'?" in capsys.readouterr().err


@pytest.mark.parametrize("options", [["check", "--samples", "1"], ["bench", "--seconds", "0.001", "--points", "1"]])
def test_verbs_take_the_root(file, capsys, options):
    file.write_text(robot(*WORLD, *FREE))
    assert main([*options, str(file), "--root", "base"]) == 0
    assert "error" not in capsys.readouterr().err


def test_what_hangs_from_a_joint_of_another_format_is_named(file):
    error = refusal(file, link("base"), link("arm"), link("hand"), joint(), DRAKE)
    assert "link 'hand' hangs from <drake:joint> 'wrist' of type 'ball', which ospace does not know" in error.reason


@pytest.mark.parametrize(
    ("kind", "told"),
    [
        ("ball", "is a ball joint, which neither URDF nor ospace has: three revolute joints whose axes meet"),
        ("Screw", "is a Screw joint, which neither URDF nor ospace has: a prismatic joint that mimics a revolute one"),
        ("hinge", "type 'hinge' is unknown; did you mean 'revolute'?"),
        ("Prismatic", "type 'Prismatic' is unknown; did you mean 'prismatic'?"),
    ],
)
def test_a_type_that_urdf_does_not_have_is_told_what_makes_one(file, kind, told):
    with pytest.raises(ospace.UnsoundModelError) as caught:
        read(file, link("base"), link("arm"), joint(kind=kind, more=AXIS + LIMIT))
    (finding,) = caught.value.findings
    assert (finding.code, finding.message[: len(told)]) == ("joint-type", told)


def test_a_base_that_slides_is_told_to_float(file):
    error = refusal(file, *WORLD[:4], joint("table", "planar", "world", "base", ""))
    assert (error.code, "joint 'table' lets 'base' slide in a plane of link 'world'" in error.reason) == (
        "planar-base",
        True,
    )
    same(
        read(file, *WORLD[:4], joint("table", "planar", "world", "base", ""), root="base"),
        read(file, link("base"), link("arm"), joint()),
    )


def test_a_loop_that_another_program_closes_is_told_open(file):
    loop = '<loop_joint name="closing" type="spherical"><link1 link="base"/><link2 link="arm"/></loop_joint>'
    file.write_text(ARM.replace("</robot>", loop + "</robot>"))
    (finding,) = ospace.SpaceRobot.from_urdf(file).findings
    assert (finding.severity, finding.message) == (
        "warning",
        "<loop_joint> 'closing' is not used: its loop is open here",
    )
