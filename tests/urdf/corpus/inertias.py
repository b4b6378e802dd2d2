"""Masses and tensors."""

from __future__ import annotations

from urdf.corpus.parts import AXIS, HAND, inertial, joint, link, robot, variant, with_arm

variant("massless base", robot(link("base", ""), link("arm"), joint()), 1, "massless-base")
variant("massless robot", robot(link("base", "")), 1, "massless-base")
variant("zero mass of the base", robot(link("base", inertial("0", ("0", "0", "0")))), 1, "massless-base")
variant(
    "base whose mass is fixed to it", robot(link("base", ""), link("bus"), joint("weld", "fixed", "base", "bus", "")), 0
)
variant("massless arm", robot(link("base"), link("arm", ""), joint()), 1, "massless-subtree")
variant("massless hand", robot(link("base"), link("arm"), link("hand", ""), joint(), HAND), 1, "massless-subtree")
variant(
    "massless arm with a hand",
    robot(link("base"), link("arm", ""), link("hand"), joint(), HAND.replace(AXIS, '<axis xyz="1 0 0"/>')),
    0,
    infos=["massless-link"],
)
for mass in ("-1", "-1e-9"):
    variant(f"mass {mass}", with_arm(inertial(mass)), 1, "negative-mass")
variant("negative mass of the base", robot(link("base", inertial("-1"))), 1, "negative-mass")
variant(
    "negative mass that is fixed to the base",
    robot(link("base"), link("arm", inertial("-1")), joint(kind="fixed", more="")),
    1,
    "negative-mass",
    "inertia-indefinite",
)
variant("negative moment", with_arm(inertial(moments=("-0.02", "0.03", "0.04"))), 1, "inertia-indefinite")
variant("large products", with_arm(inertial(products=("0.1", "0", "0"))), 1, "inertia-indefinite")
variant(
    "negative moment at rounding level", with_arm(inertial(moments=("-1e-7", "0.04", "0.04"))), 1, "inertia-indefinite"
)
variant(
    "negative moment that is fixed to a sound base",
    robot(link("base"), link("arm", inertial(moments=("-0.0001", "0.03", "0.03"))), joint(kind="fixed", more="")),
    0,
    "inertia-indefinite",
)
variant(
    "negative moment that spoils its body",
    robot(link("base"), link("arm", inertial("2e-9", ("-0.1", "0.03", "0.03"))), joint(kind="fixed", more="")),
    1,
    "inertia-indefinite",
)
variant("triangle", with_arm(inertial(moments=("0.02", "0.02", "0.05"))), 0, "inertia-triangle")
variant(
    "negative moment beside one that dwarfs it",
    with_arm(inertial(moments=("1e9", "0.03", "0.04"), products=("0", "0", "0.1"))),
    1,
    "inertia-indefinite",
    "units-inertia",
)
variant(
    "moment that dwarfs the others",
    with_arm(inertial(moments=("1e5", "0.03", "0.04"))),
    1,
    "inertia-triangle",
    "units-inertia",
)
variant("triangle at rounding level", with_arm(inertial(moments=("0.02", "0.02", "0.0400001"))), 0, "inertia-rounding")
variant("triangle to the last digit", with_arm(inertial(moments=("0.02", "0.02", "0.04"))), 0)
variant("identity", with_arm(inertial(moments=("1", "1", "1"))), 0, "inertia-identity")
variant(
    "tensor without mass",
    robot(link("base"), link("arm", inertial("0")), link("hand"), joint(), HAND),
    0,
    "inertia-without-mass",
    infos=["massless-link"],
)
variant("point mass", with_arm(inertial(moments=("0", "0", "0"))), 0, infos=["point-mass"])
variant("rod", with_arm(inertial(moments=("0", "0.1", "0.1"))), 0)
variant(
    "tensor about the origin",
    with_arm(inertial("1", ("0.01", "0.26", "0.26"), origin="0.5 0 0")),
    0,
    infos=["inertia-about-origin"],
)
variant(
    "point mass alone", robot(link("base", inertial(moments=("0", "0", "0")))), 1, "massless-base", infos=["point-mass"]
)
variant(
    "point mass on its axis",
    with_arm(inertial(moments=("0", "0", "0"), origin="0 0 0")),
    1,
    "singular-inertia",
    infos=["point-mass"],
)
variant(
    "two joints about one axis",
    robot(
        link("base"), link("arm", ""), link("hand"), joint(), joint("wrist", "continuous", "arm", "hand", AXIS, "0 0 0")
    ),
    1,
    "singular-inertia",
    infos=["limits-missing", "massless-link"],
)

variant("indefinite and alone", robot(link("base", inertial(moments=("-0.1", "0.1", "0.1")))), 1, "inertia-indefinite")
