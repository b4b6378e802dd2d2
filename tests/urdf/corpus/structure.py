"""Links and joints that do not form a tree, or one with odd names."""

from __future__ import annotations

from urdf.corpus.parts import ARM, AXIS, LIMIT, inertial, joint, link, robot, variant

variant("no link", robot(), 2, "no-links")
variant("joint alone", robot(joint()), 2, "no-links")
variant("link without name", robot(link("base"), "<link/>"), 2, "unnamed")
variant("joint without name", ARM.replace('name="hinge" ', ""), 2, "unnamed")
variant("two links of a name", robot(link("base"), link("base")), 2, "duplicate-name")
variant(
    "two joints of a name",
    robot(link("base"), link("arm"), link("hand"), joint(), joint(child="hand")),
    2,
    "duplicate-name",
)
variant("no parent", ARM.replace('<parent link="base"/>', ""), 2, "joint-ends")
variant("no child", ARM.replace('<child link="arm"/>', ""), 2, "joint-ends")
variant("blank child", ARM.replace('<child link="arm"/>', '<child link=""/>'), 2, "joint-ends")
variant("unknown child", ARM.replace('<child link="arm"/>', '<child link="amr"/>'), 2, "unknown-link")
variant("unknown parent", ARM.replace('<parent link="base"/>', '<parent link="bus"/>'), 2, "unknown-link")
variant("two roots", robot(link("base"), link("arm")), 2, "two-roots")
variant("island", robot(link("base"), link("a"), link("b"), joint(parent="a", child="b")), 2, "two-roots")
variant("second parent", robot(link("base"), link("arm"), joint(), joint("second")), 2, "second-parent")
variant("own parent", robot(link("base"), link("arm"), joint(parent="arm")), 2, "loop")
variant(
    "two links that hang from each other",
    robot(link("a"), link("b"), joint("ab", "fixed", "a", "b", ""), joint("ba", "fixed", "b", "a", "")),
    2,
    "loop",
)
variant(
    "loop beside the base",
    robot(link("base"), link("a"), link("b"), joint("ab", "fixed", "a", "b", ""), joint("ba", "fixed", "b", "a", "")),
    2,
    "loop",
)
for reserved in ("root_joint", "universe", "world_joint", "base"):
    variant(f"joint called {reserved}", ARM.replace("hinge", reserved), 0)
for reserved in ("root_joint", "universe", "world"):
    variant(f"link called {reserved}", ARM.replace('"arm"', f'"{reserved}"'), 0)
    variant(f"base called {reserved}", ARM.replace('"base"', f'"{reserved}"'), 0)
ODD_NAMES = (
    "an arm",
    "arm/left",
    "ärm",
    "机器人",
    "😀",
    "&lt;arm&gt;",
    "&quot;",
    "&#10;arm",
    "arm\u202e",
    "..",
    "%s{}",
)
for odd in ODD_NAMES:
    variant(f"link called {odd!r}", ARM.replace('"arm"', f'"{odd}"'), 0)
    variant(f"joint called {odd!r}", ARM.replace('"hinge"', f'"{odd}"'), 0)
CHAIN = [
    link("l0"),
    *(
        part
        for k in range(1, 150)
        for part in (link(f"l{k}"), joint(f"j{k}", "continuous", f"l{k - 1}", f"l{k}", AXIS, "0.01 0 0"))
    ),
]
variant("155 degrees of freedom", robot(*CHAIN), 2, "too-many-dof")
variant("2001 links", robot(*(link(f"l{k}", "") for k in range(2001))), 2, "too-many-links")
variant(
    "3 links where 2 are allowed",
    robot(link("a"), link("b"), link("c")),
    2,
    "too-many-links",
    options=("--max-links", "2"),
)
variant("7 degrees where 6 are allowed", ARM, 2, "too-many-dof", options=("--max-dof", "6"))
variant("bytes", ARM, 2, "too-large", options=("--max-bytes", str(len(ARM) - 1)))
variant("bytes that are just allowed", ARM, 0, options=("--max-bytes", str(len(ARM))))

LOOP = (link("base"), link("crank"), link("rocker"), link("coupler"))
BARS = (
    joint("a", child="crank"),
    joint("b", child="rocker", origin="0.6 0 0"),
    joint("c", parent="crank", child="coupler"),
    joint("d", parent="rocker", child="coupler", origin="0 0 0.2"),
)
variant("four-bar linkage", robot(*LOOP, *BARS), 0, "loop-open")
variant("four-bar linkage, joints the other way round", robot(*LOOP, *BARS[::-1]), 0, "loop-open")
variant(
    "loop closed by a ball", robot(*LOOP, *BARS[:3], joint("d", "spherical", "rocker", "coupler", "")), 0, "loop-open"
)
variant(
    "loop closed by a fixed joint",
    robot(*LOOP, *BARS[:3], joint("d", "fixed", "rocker", "coupler", "")),
    0,
    "loop-open",
)
variant(
    "loop back to an inner link", robot(*LOOP, *BARS[:3], joint("d", parent="coupler", child="crank")), 0, "loop-open"
)
variant(
    "loop back to an inner link, named first",
    robot(*LOOP, joint("d", parent="coupler", child="crank"), *BARS[:3]),
    0,
    "loop-open",
)
variant("loop back to the base", robot(*LOOP, *BARS[:3], joint("d", parent="coupler", child="base")), 2, "loop")
variant("its own parent as well", robot(*LOOP, *BARS[:3], joint("d", parent="crank", child="crank")), 2, "loop")
variant("two trees that meet", robot(*LOOP, BARS[0], BARS[2], BARS[3]), 2, "two-roots")
for kind in ("screw", "universal"):
    variant(f"joint of type {kind}", robot(link("base"), link("arm"), joint(kind=kind)), 1, "joint-type")
DRAKE = (
    "<drake:joint xmlns:drake='http://drake.mit.edu' name='wrist' type='ball'>"
    "<parent link='arm'/><child link='hand'/></drake:joint>"
)
variant("joint of Drake", robot(link("base"), link("arm"), link("hand"), joint(), DRAKE), 2, "two-roots")
variant(
    "joint of Drake to an arm",
    robot(link("base"), link("arm"), joint(), DRAKE.replace("'hand'", "'base'")),
    1,
    "unknown-element",
)
WORLD = ('<link name="world"/>', link("base"), link("arm"), joint(), link("target"))
variant("robot on a plane", robot(*WORLD[:4], joint("table", "planar", "world", "base", "")), 2, "planar-base")
FREE = [joint("f1", "floating", "world", "base", ""), joint("f2", "floating", "world", "target", "")]
variant("two free bodies", robot(*WORLD, *FREE), 2, "several-bodies")
variant(
    "two free bodies on zeros",
    robot(*WORLD, *FREE).replace('"world"/>', f'"world">{inertial("0", ("0",) * 3)}</link>', 1),
    2,
    "several-bodies",
)
for name, parts, root in (
    ("two free bodies", (*WORLD, *FREE), "base"),
    ("two free bodies, the other", (*WORLD, *FREE), "target"),
    ("robot on a plane", (*WORLD[:4], joint("table", "planar", "world", "base", "")), "base"),
    ("two roots", (link("base"), link("arm")), "arm"),
    ("link within a loop", (*LOOP, *BARS), "crank"),
    (
        "robot on a stand",
        (link("stand"), link("base"), link("arm"), joint(), joint("j", "fixed", "stand", "base", "")),
        "base",
    ),
):
    variant(f"root: {name}, {root}", robot(*parts), 0, infos=["root-given"], options=["--root", root])
variant(
    "root: errors of what stays",
    robot(link("base"), link("arm", "<inertial/>"), joint()),
    1,
    "inertial-unreadable",
    infos=["root-given"],
    options=["--root", "arm"],
)
variant(
    "root: errors of what is left out",
    robot(link("base", "<inertial/>"), link("arm"), joint(more=AXIS + LIMIT.replace("1", "x"))),
    0,
    infos=["root-given"],
    options=["--root", "arm"],
)
variant("root: the root that it has", ARM, 0, options=["--root", "base"])
