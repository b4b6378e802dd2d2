"""Links and joints that do not form a tree, or one with odd names."""

from __future__ import annotations

from urdf.corpus.parts import ARM, AXIS, joint, link, robot, variant

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
