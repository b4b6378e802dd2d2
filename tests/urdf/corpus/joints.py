"""Joints, and how the base is held."""

from __future__ import annotations

from urdf.corpus.parts import ARM, AXIS, HAND, LIMIT, inertial, joint, link, robot, variant

for kind in ("ball", "Revolute", "", "hinge", "spherical"):
    variant(f"type {kind!r}", ARM.replace('"revolute"', f'"{kind}"'), 1, "joint-type")
variant("no type", ARM.replace(' type="revolute"', ""), 1, "joint-type")
for kind in ("revolute", "continuous", "prismatic"):
    of_kind = ARM.replace('"revolute"', f'"{kind}"')
    if kind == "continuous":
        of_kind = of_kind.replace('lower="-1" upper="1" ', "")
    variant(f"{kind}: no axis given", of_kind.replace(AXIS, ""), 0)
    for text in ("0 0 0", "-0 0 0", "1e-9 0 0"):
        odd = of_kind.replace("0 1 0", text)
        variant(f"{kind}: axis {text}", odd, 1, "axis-zero")
    for text in ("0 2 0", "1 1 1", "0 1e-3 0", "0 -1000 0"):
        odd = of_kind.replace("0 1 0", text)
        variant(f"{kind}: axis {text}", odd, 0, "axis-not-unit")
    rounded = of_kind.replace("0 1 0", "0 0.707 0.707")
    variant(f"{kind}: axis of three digits", rounded, 0)
FLAT, FREED = (ARM.replace('"revolute"', f'"{kind}"').replace(LIMIT, "") for kind in ("planar", "floating"))
variant("planar about z", FLAT.replace("0 1 0", "0 0 1"), 0)
variant("planar about z, rounded", FLAT.replace("0 1 0", "1e-12 0 1"), 0)
variant("planar about y", FLAT, 0, infos=["planar-axis"])
variant("planar without axis", FLAT.replace(AXIS, ""), 0, infos=["planar-axis"])
variant("planar about -z", FLAT.replace("0 1 0", "0 0 -1"), 0, infos=["planar-axis"])
variant("planar about no direction", FLAT.replace("0 1 0", "0 0 0"), 1, "axis-zero")
variant("planar about a long axis", FLAT.replace("0 1 0", "1 2 2"), 0, "axis-not-unit", infos=["planar-axis"])
variant("floating between bodies", FREED, 0)
for name, content in {"planar": FLAT.replace("0 1 0", "0 0 1"), "floating": FREED}.items():
    variant(f"{name} with limits", content.replace("</joint>", LIMIT + "</joint>"), 0, "value-not-used")
    for damping, codes in (("0.5", ["value-not-used"]), ("0", [])):
        damped = content.replace("</joint>", f'<dynamics damping="{damping}" friction="0"/></joint>')
        variant(f"{name} with damping {damping}", damped, 0, *codes)
for key in ("acceleration", "deceleration", "jerk"):
    variant(f"{key} limited", ARM.replace('velocity="1"', f'velocity="1" {key}="2"'), 0, "value-not-used")
TURNING = ARM.replace('"revolute"', '"continuous"')
variant("continuous with limits", TURNING, 0, "value-not-used")
variant("continuous with one limit", TURNING.replace('lower="-1" ', ""), 0, "value-not-used")
for end in ("inf", "999999", "1e9"):
    without = TURNING.replace('lower="-1" upper="1"', f'lower="-{end}" upper="{end}"')
    variant(f"continuous with limits of {end}", without, 0, *(["limits-none"] if end != "1e9" else []))
variant("continuous with limits of zero", TURNING.replace('"-1" upper="1"', '"0" upper="0"'), 0)
variant("damping and friction", ARM.replace("</joint>", '<dynamics damping="1" friction="2"/></joint>'), 0)
for element in ('safety_controller k_velocity="nan"', 'calibration rising="0x1"', 'safety_controller k_velocity=""'):
    variant(f"{element} in a joint", ARM.replace("</joint>", f"<{element}/></joint>"), 0, "number-unreadable")
variant("safety controller", ARM.replace("</joint>", '<safety_controller k_velocity="1"/></joint>'), 0)
for lower, upper in (("0.5", "1"), ("-2", "-0.001"), ("1e-6", "1")):
    ranged = ARM.replace('lower="-1" upper="1"', f'lower="{lower}" upper="{upper}"')
    variant(f"{lower} to {upper} rad", ranged, 0, "zero-outside-limits")
    variant(f"{lower} to {upper} m", ranged.replace('"revolute"', '"prismatic"'), 0, "zero-outside-limits")
variant("zero at the end of the range", ARM.replace('lower="-1"', 'lower="0"'), 0)
variant("zero next to the range", ARM.replace('lower="-1"', 'lower="1e-10"'), 0)
for kind in ("revolute", "prismatic"):
    variant(f"{kind} without limits", ARM.replace('"revolute"', f'"{kind}"').replace(LIMIT, ""), 0, "limits-missing")
variant(
    "continuous without limits",
    ARM.replace('"revolute"', '"continuous"').replace(LIMIT, ""),
    0,
    infos=["limits-missing"],
)
variant("reversed limits", ARM.replace('lower="-1" upper="1"', 'lower="1" upper="-1"'), 0, "limits-reversed")
variant("no room", ARM.replace('lower="-1" upper="1"', 'lower="0" upper="0"'), 0, "limits-zero")
variant("no lower and upper", ARM.replace('lower="-1" upper="1" ', ""), 0, "limits-zero")
variant("no effort", ARM.replace(' effort="10"', ""), 0, "effort-missing")
variant("no velocity", ARM.replace(' velocity="1"', ""), 0, "effort-missing")
variant("zero effort", ARM.replace('effort="10"', 'effort="0"'), 0, infos=["effort-zero"])
for key, now in (("effort", "10"), ("velocity", "1")):
    for text in ("-10", "-1.5", "-1e-3", "-9999"):
        variant(f"{key} {text}", ARM.replace(f'{key}="{now}"', f'{key}="{text}"'), 1, "effort-negative")
    for text in ("-1", "-1.0", "inf", "+INF", "Infinity", ".inf", "1.#INF", "9999", "99999.9", "1e16", "1.79769e+308"):
        variant(f"{key} {text}", ARM.replace(f'{key}="{now}"', f'{key}="{text}"'), 0, "limits-none")
    for text in ("999", "1e9", "9998", "99991", "1.7976931348623157e+308"):
        variant(f"{key} {text}", ARM.replace(f'{key}="{now}"', f'{key}="{text}"'), 0)
    for text in ("-inf", "nan", "infinite"):
        variant(f"{key} {text}", ARM.replace(f'{key}="{now}"', f'{key}="{text}"'), 1, "number-unreadable")
variant("negative damping", ARM.replace("</joint>", '<dynamics damping="-1"/></joint>'), 1, "damping-negative")
variant("negative friction", ARM.replace("</joint>", '<dynamics friction="-1"/></joint>'), 1, "friction-negative")
for lower, upper, codes in (
    ("-180", "180", ["units-angle"]),
    ("-172.5", "0", ["units-angle"]),
    ("-3600", "3600", ["units-angle"]),
    ("-31.4159", "31.4159", []),
    ("-180.3", "180", []),
    ("-4000", "4000", []),
    ("-12", "12", []),
    ("-1e6", "1e6", []),
    ("-10000", "10000", ["limits-none"]),
    ("-999999", "999999", ["limits-none"]),
    ("-inf", "inf", ["limits-none"]),
    ("-.inf", "1", ["limits-none"]),
    ("-3.40282e+38", "1", ["limits-none"]),
    ("999999", "-999999", ["limits-reversed"]),
):
    variant(f"from {lower} to {upper}", ARM.replace('"-1" upper="1"', f'"{lower}" upper="{upper}"'), 0, *codes)
variant("lower limit inf", ARM.replace('lower="-1"', 'lower="inf"'), 1, "number-unreadable")
variant("upper limit -inf", ARM.replace('upper="1"', 'upper="-inf"'), 1, "number-unreadable")
MIMIC = robot(
    link("base"),
    link("arm"),
    link("hand"),
    joint(),
    joint("follow", child="hand", more=AXIS + LIMIT + '<mimic joint="hinge" multiplier="-1"/>'),
)
variant("mimic", MIMIC, 0, infos=["mimic"])
variant("mimic of a leader in another branch that comes later", MIMIC.replace('"hinge"', '"zinge"'), 0, infos=["mimic"])
variant("mimic by nothing", MIMIC.replace('multiplier="-1"', 'multiplier="0" offset="0.2"'), 0, infos=["mimic"])
variant("mimic that is freed", MIMIC, 0, "mimic-freed", options=["--free-mimic"])
variant(
    "mimic of a joint that is not there", MIMIC.replace('mimic joint="hinge"', 'mimic joint="hnge"'), 1, "mimic-unknown"
)
variant("mimic of itself", MIMIC.replace('mimic joint="hinge"', 'mimic joint="follow"'), 1, "mimic-unknown")
CHAIN = robot(
    link("base"),
    link("arm"),
    link("hand"),
    link("finger"),
    joint(),
    joint("wrist", parent="arm", child="hand", more=AXIS + LIMIT + '<mimic joint="hinge" multiplier="0.5"/>'),
    joint("grip", parent="hand", child="finger", more=AXIS + LIMIT + '<mimic joint="wrist" offset="0.1"/>'),
)
variant("mimic of a follower", CHAIN, 0, infos=["mimic"])
variant("mimic beyond its limits", CHAIN.replace('offset="0.1"', 'offset="0.6"'), 0, "mimic-limits", infos=["mimic"])
variant("mimic just within its limits", CHAIN.replace('offset="0.1"', 'offset="0.5"'), 0, infos=["mimic"])
variant("mimic of each other", CHAIN.replace('mimic joint="hinge"', 'mimic joint="grip"'), 1, "mimic-unknown")
variant(
    "mimic of a joint that hangs from it",
    robot(link("base"), link("arm"), link("hand"), joint(more=AXIS + LIMIT + '<mimic joint="wrist"/>'), HAND),
    1,
    "mimic-unfit",
)
LIGHT = MIMIC.replace(link("hand"), '<link name="hand"/>')
variant("mimic that moves no mass of its own", LIGHT, 0, infos=["massless-link", "mimic"])
variant(
    "mimic that moves no mass, and neither does its leader",
    LIGHT.replace(link("arm"), '<link name="arm"/>'),
    1,
    "massless-subtree",
    infos=["mimic"],
)
FLOATING = MIMIC.replace('"follow" type="revolute"', '"follow" type="floating"')
variant("floating joint that mimics", FLOATING, 1, "mimic-unfit", "value-not-used")
CONTINUOUS = MIMIC.replace('"hinge" type="revolute"', '"hinge" type="continuous"')
CONTINUOUS = CONTINUOUS.replace('lower="-1" upper="1" ', "", 1)
variant("mimic of a continuous joint", CONTINUOUS, 0, infos=["mimic"])
HALF = CONTINUOUS.replace('"-1"/></joint>', '"0.5"/></joint>')
variant("mimic of half a continuous joint", HALF, 0, "mimic-jump", infos=["mimic"])
SLIDER = CONTINUOUS.replace('"follow" type="revolute"', '"follow" type="prismatic"')
variant("slider that mimics a continuous joint", SLIDER, 1, "mimic-unfit")
variant(
    "mimic without number", MIMIC.replace('"-1"/></joint>', '"x"/></joint>'), 1, "number-unreadable", infos=["mimic"]
)
variant(
    "world with a fixed base",
    robot('<link name="world"/>', link("base"), joint("weld", "fixed", "world", "base", "")),
    0,
    "fixed-base",
)
variant(
    "world with a fixed base and a fixed table",
    robot(
        '<link name="world"/>',
        link("base"),
        link("table"),
        joint("weld", "fixed", "world", "base", ""),
        joint("bolt", "fixed", "world", "table", ""),
    ),
    0,
    "fixed-base",
)
variant(
    "world with a floating base",
    robot('<link name="world"/>', link("base"), joint("free", "floating", "world", "base", "")),
    0,
    infos=["floating-root"],
)
for root in ("world", "dummy"):
    for mass, codes, infos in (("0", [], ["floating-root"]), ("1e-3", ["mass-ratio"], [])):
        variant(
            f"{root} of {mass} kg with a floating base",
            robot(
                link(root, inertial(mass, (mass, mass, mass))),
                link("base"),
                link("arm"),
                joint("free", "floating", root, "base", ""),
                joint(),
            ),
            0,
            *codes,
            infos=infos,
        )
variant("world with a hinge", robot('<link name="world"/>', link("arm"), joint(parent="world")), 1, "massless-base")
variant(
    "world with two floating robots",
    robot(
        '<link name="world"/>',
        link("a"),
        link("b"),
        joint("fa", "floating", "world", "a", ""),
        joint("fb", "floating", "world", "b", ""),
    ),
    2,
    "several-bodies",
)
variant("heavy root on a floating joint", robot(link("base"), link("arm"), joint(kind="floating", more="")), 0)

FREE = joint("free", "floating", "{}", "base", "")
HINGED = link("base") + link("arm") + joint()
variant(
    "floating behind a frame of the world",
    robot(link("world", ""), link("fp", ""), joint("w", "fixed", "world", "fp", ""), FREE.format("fp"), HINGED),
    0,
    infos=["floating-root"],
)
variant(
    "camera beside a floating base",
    robot(
        link("world", ""), link("camera", ""), joint("w", "fixed", "world", "camera", ""), FREE.format("world"), HINGED
    ),
    0,
    infos=["floating-root"],
)

ROD = ARM.replace('"revolute"', '"prismatic"')
variant("slide in mm", ROD.replace('upper="1"', 'upper="500"'), 0, "units-length")
variant("slide of 20 m in mm", ROD.replace('upper="1"', 'upper="20000"'), 0, "units-length")
variant("slide of nines", ROD.replace('upper="1"', 'upper="99999"'), 0, "limits-none")
variant("slide without end", ROD.replace('upper="1"', 'upper="1e9"'), 0)
for turn, codes in (("0 0 90", ["units-angle"]), ("0 0 -6.2832", [])):
    variant(f"joint turned by {turn}", ARM.replace('"0.3 0 0"', f'"0.3 0 0" rpy="{turn}"'), 0, *codes)
    variant(f"inertial turned by {turn}", ARM.replace('"0.1 0 0.05"', f'"0.1 0 0.05" rpy="{turn}"', 1), 0, *codes)
