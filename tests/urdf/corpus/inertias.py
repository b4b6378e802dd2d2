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
)


def wheeled(axis, moments, kind="continuous", products=("0", "0", "0"), mass="0"):
    """Put a wheel on a bus: its tensor alone, as its mass is counted with the bus."""
    wheel = inertial(mass, moments, products)
    limit = '<limit lower="-1" upper="1" effort="0.2" velocity="600"/>'
    limit = limit.replace('lower="-1" upper="1" ', "") if kind == "continuous" else limit if kind != "planar" else ""
    return robot(link("base"), link("wheel", wheel), joint("spin", kind, child="wheel", more=axis + limit))


UP = '<axis xyz="0 0 1"/>'
DISC, ALONE = ("0.01", "0.01", "0.02"), ("0", "0", "0.02")
for name, wheel, codes in (
    ("on its axis", wheeled(UP, DISC), []),
    ("on a revolute joint", wheeled(UP, DISC, "revolute"), []),
    ("across its axis", wheeled(AXIS, DISC), []),
    ("of one moment, on its axis", wheeled(UP, ALONE), []),
    ("of one moment, across its axis", wheeled(AXIS, ALONE), ["massless-subtree"]),
    ("of one moment, nearly across its axis", wheeled('<axis xyz="0 1 0.001"/>', ALONE), []),
    ("on a slider", wheeled(UP, DISC, "prismatic"), ["massless-subtree"]),
    ("a little heavy, on a slider", wheeled(UP, DISC, "prismatic", mass="0.01"), None),
    ("on a planar joint", wheeled(UP, DISC, "planar"), ["massless-subtree"]),
    ("of a negative moment", wheeled(UP, ("0.01", "0.01", "-0.02")), ["inertia-indefinite", "massless-subtree"]),
):  # fmt: skip
    expected = [] if codes is None else ["inertia-without-mass", *codes]
    variant(f"wheel without mass {name}", wheel, 1 if codes else 0, *expected)


def gimballed(ring, axis, rotor=DISC, place="0 0 0"):
    spin = joint("spin", "continuous", "ring", "rotor", axis + '<limit effort="1" velocity="9"/>', place)
    frame = link("ring", "" if ring is None else inertial("0", ring))
    return robot(link("base"), frame, link("rotor", inertial("0", rotor)), joint("tilt", child="ring"), spin)


SMALL = ("0.001", "0.001", "0.001")
variant("gyro without mass", gimballed(SMALL, UP), 0, "inertia-without-mass")
variant("gyro in a ring of nothing", gimballed(None, UP), 0, "inertia-without-mass", infos=["massless-link"])
variant("gyro of one axis twice", gimballed(None, AXIS), 1, "inertia-without-mass", "massless-subtree")
variant("gyro of one axis twice, with a ring", gimballed(SMALL, AXIS), 0, "inertia-without-mass")
variant(
    "gyro beside its ring", gimballed(None, UP, place="0.2 0 0"), 0, "inertia-without-mass", infos=["massless-link"]
)
variant("gyro of one moment", gimballed(SMALL, UP, ALONE), 0, "inertia-without-mass")
variant(
    "gyro of one moment in a ring of nothing", gimballed(None, UP, ALONE), 1, "inertia-without-mass", "massless-subtree"
)
variant("point mass", with_arm(inertial(moments=("0", "0", "0"))), 0, infos=["point-mass"])
for moments in (
    ("0", "0", "0.3"),
    ("0.3", "0", "0"),
    ("0", "0.3", "0"),
    ("1e-6", "1e-6", "0.3"),
    ("1e-9", "1e-9", "0.3"),
):
    variant(f"planar tensor {' '.join(moments)}", with_arm(inertial(moments=moments)), 0, "planar-tensor")
variant("nearly a planar tensor", with_arm(inertial(moments=("1e-4", "2e-4", "0.3"))), 0, "inertia-triangle")
variant("planar tensor alone", robot(link("base", inertial(moments=ALONE))), 1, "planar-tensor", "massless-base")
FLAT = inertial("2", ("0", "0", "0.3"), origin="{}")
LIMITED = UP + '<limit lower="-1" upper="1" effort="10" velocity="1"/>'
ONE = robot(link("base", FLAT.format("0 0 0")), link("arm", FLAT.format("0.4 0 0")), joint(more=LIMITED))
ELBOW = joint("elbow", "revolute", "arm", "fore", LIMITED, "0.8 0 0")
TWO = ONE.replace("</robot>", link("fore", FLAT.format("0.4 0 0")) + ELBOW + "</robot>")
variant("planar robot of one joint", ONE, 1, "planar-tensor", "singular-inertia")
variant(
    "planar robot of one joint, one link of it whole",
    ONE.replace('xx="0" ', 'xx="0.2" ', 1).replace('yy="0" ', 'yy="0.2" ', 1),
    0,
    "planar-tensor",
)
variant("planar robot of two joints, in line at zero", TWO, 0, "planar-tensor")
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

BUS = link("base", inertial("100", ("8", "9", "10")))


def on_bus(mass="5", moments=("0.1", "0.1", "0.1"), centre="0.1 0 0.05", origin="0.3 0 0"):
    """Put a link on a bus of 100 kg, whose lengths are below half a metre."""
    return robot(BUS, link("arm", inertial(mass, moments, origin=centre)), joint(origin=origin))


variant("hand of 2000 kg on a bus of 100 kg", on_bus("2000", ("90", "90", "90")), 0, "mass-ratio")
variant("hand of 400 kg on a bus of 100 kg", on_bus("400", ("12", "12", "12")), 0)
variant("centre of mass 50 m away", on_bus(centre="50 0 0"), 0, "units-length")
variant("centre of mass in inches", on_bus(centre="12 0 0"), 0, "units-length")
variant("centre of mass at the end of a boom", on_bus(centre="5 0 0"), 0)
variant("centre of mass on a long panel", on_bus(centre="50 0 0", moments=("1", "4000", "4000")), 0)
variant("joint 50 m away", on_bus(origin="0 50 0"), 0, "units-length")
variant("joint on a boom", on_bus(origin="0 5 0"), 0)
variant(
    "frame 50 m away",
    on_bus().replace("</robot>", link("mark", "") + joint("far", "fixed", "arm", "mark", "", "50 0 0") + "</robot>"),
    0,
)
variant("tensor of a body of 10 m among small ones", on_bus(moments=("500", "500", "500")), 0, "units-inertia")
variant("tensor of a body of 4 m among small ones", on_bus(moments=("80", "80", "80")), 0)
variant(
    "2000 kg within 3 mm",
    robot(
        link("base", inertial("2000", ("160", "180", "200"))),
        link("arm", inertial("2000", ("0.018", "0.018", "0.018"))),
        joint(),
    ),
    0,
    "gyration-small",
)
variant(
    "2000 kg within 30 cm",
    robot(
        link("base", inertial("2000", ("160", "180", "200"))),
        link("arm", inertial("2000", ("180", "180", "180"))),
        joint(),
    ),
    0,
)
variant("sensor of 1 kg within 1 mm", on_bus("1", ("1e-6", "1e-6", "1e-6")), 0, infos=["gyration-small"])
variant(
    "bus of the DEOS study with its arm",
    robot(
        link("base", inertial("696.2", ("18", "20", "22"), origin="0 0 0")),
        link("arm", inertial("3.3", ("0.0056", "0.0056", "0.0056"))),
        joint(origin="-0.42 0.47 -0.56"),
    ),
    0,
)
variant(
    "boom of Canadarm2 on its station",
    robot(
        link("base", inertial("420000", ("1e8", "6e7", "1.5e8"))),
        link("arm", inertial("314.88", ("15.41", "2094.71", "2103.19"), origin="3.55 0 0")),
        joint(origin="20 0 0"),
    ),
    0,
)


def followed(parent, ratio="-1"):
    """Let a finger without mass follow the arm."""
    follows = LIMITED + f'<mimic joint="hinge" multiplier="{ratio}"/>'
    finger = joint("follow", "revolute", parent, "finger", follows)
    return robot(link("base"), link("arm"), link("finger", ""), joint(), finger)


variant("finger without mass on the arm that it follows", followed("arm"), 0, infos=["massless-link", "mimic"])
variant("finger without mass that follows at no ratio", followed("base", "0"), 0, infos=["massless-link", "mimic"])
variant("finger without mass, freed", followed("base"), 1, "massless-subtree", "mimic-freed", options=["--free-mimic"])
