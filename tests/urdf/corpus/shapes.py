"""Numbers that are hardly meant, and meshes."""

from __future__ import annotations

from urdf.corpus.parts import ARM, BOX, inertial, joint, link, robot, variant, with_arm

SHAPE = BOX.format("collision")
variant("box that fits", with_arm(None, SHAPE), 0)
variant(
    "tensor in kg mm²",
    with_arm(inertial(moments=("2e4", "3e4", "4e4"), origin="0 0 0"), SHAPE),
    0,
    "gyration-large",
    "units-inertia",
)
variant(
    "tensor too large for its box",
    with_arm(inertial(moments=("2", "3", "4"), origin="0 0 0"), SHAPE),
    0,
    "gyration-large",
)
variant(
    "tensor too small for its box",
    with_arm(inertial(moments=("2e-6", "3e-6", "4e-6"), origin="0 0 0"), SHAPE),
    0,
    "gyration-small",
)
variant(
    "mass in grams",
    with_arm(inertial("2000", ("20", "30", "40"), origin="0 0 0"), SHAPE),
    0,
    *("density", "mass-ratio", "gyration-small"),
)
variant("mass of nothing", with_arm(inertial("0.001", ("1e-5", "1e-5", "1e-5"), origin="0 0 0"), SHAPE), 0, "density")
variant("centre of mass in mm", robot(link("base", inertial(origin="110 0 0"))), 0, "units-length", "base-condition")
variant("centre of mass outside", with_arm(inertial(origin="2 0 0"), SHAPE), 0, "centre-outside")
variant("joint in mm", ARM.replace("0.3 0 0", "300 0 0"), 0, "units-length", "base-condition")
variant(
    "box in mm",
    with_arm(None, BOX.format("visual").replace("0.4 0.3 0.2", "400 300 200")),
    0,
    "units-length",
    "density",
    "gyration-small",
)
variant("tensor in g mm²", with_arm(inertial(moments=("2e5", "3e5", "4e5"))), 0, "units-inertia")
variant(
    "light base",
    robot(link("base", inertial("0.001", ("1e-5", "1e-5", "1e-5"))), link("arm"), joint()),
    0,
    "mass-ratio",
)
variant(
    "heavy base",
    robot(
        link("base", inertial("3e6", ("3e7", "3e7", "3e7"))),
        link("arm", inertial("0.2", ("2e-3", "3e-3", "4e-3"))),
        joint(),
    ),
    0,
    "mass-ratio",
)


def boxes(reach):
    """Write a base with a box, an arm with one, and a hand with one at this distance from the base's."""
    return robot(
        *(link(name, more=SHAPE) for name in ("base", "arm", "hand")),
        joint(),
        joint("wrist", "revolute", "arm", "hand", origin=f"{reach - 0.3} 0 0"),
    )


variant("links that overlap at zero", boxes(0.39), 0, infos=["overlap-at-zero"])
variant("links that just do not overlap at zero", boxes(0.41), 0)
variant("adjacent links alone overlap", boxes(0.6), 0)
variant(
    "too many shapes to look for overlaps", with_arm(None, 201 * BOX.format("collision")), 0, infos=["overlap-at-zero"]
)


def mesh(filename, more=""):
    shape = f'<visual><geometry><mesh filename="{filename}"{more}/></geometry></visual>'
    return with_arm(None, shape)


variant("mesh that is missing", mesh("no_such.stl"), 0, "mesh-missing")
variant("mesh without a name", mesh(""), 0, "mesh-missing")
variant("mesh outside", mesh("/etc/hostname"), 0, "mesh-outside")
variant("mesh above", mesh("../../../../../../etc/hostname"), 0, "mesh-outside")
variant("mesh by a URI of a file", mesh("file:///etc/hostname"), 0, "mesh-outside")
variant("mesh in a package", mesh("package://arm/arm.stl"), 0, infos=["mesh-not-looked-up"])
variant("mesh that climbs out of a package", mesh("package://p/../../../../../etc/hostname"), 0, "mesh-outside")
variant("mesh that turns back within a package", mesh("package://p/a/../arm.stl"), 0, infos=["mesh-not-looked-up"])
variant(
    "mesh in a package that goes up",
    mesh("package://../../etc/hostname"),
    0,
    "mesh-outside",
    options=["--package-dir", "."],
)
variant(
    "mesh in a package that is missing",
    mesh("package://arm/arm.stl"),
    0,
    "mesh-missing",
    options=["--package-dir", "."],
)
for scheme in ("http", "https", "ftp", "data"):
    variant(f"mesh by {scheme}", mesh(f"{scheme}://192.0.2.1/arm.stl"), 0, "mesh-remote")
variant("mesh that is a folder", mesh("."), 0, "mesh-unreadable")
for scale in ("0 0 0", "0 1 1", "0 -1 1"):
    variant(f"scale {scale}", mesh("no_such.stl", f' scale="{scale}"'), 0, "mesh-missing", "mesh-scale")
variant("mirrored", mesh("no_such.stl", ' scale="1 1 -1"'), 0, "mesh-missing", infos=["mesh-scale"])
variant("scale in words", mesh("no_such.stl", ' scale="big"'), 0, "visual-unreadable")
