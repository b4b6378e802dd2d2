"""Numbers that can be computed with and are hardly meant."""

from ospace.urdf.lint.rules.rule import Rule

MAGNITUDES = (
    Rule(
        name="gyration-large",
        severity="warning",
        summary="The radius of gyration of a link is more than twice the farthest reach of its shape.",
        reason="Mass cannot lie outside the link. The arm seems heavier to turn than it is, and the base reacts too "
        "much.",
        remedy="Compute the tensor from the shape, in kg m²; one in kg mm² is a million times too large.",
        example='<inertia ixx="9" iyy="9" izz="9" …/> on a sphere of 0.1 m and 1 kg',
    ),
    Rule(
        name="gyration-small",
        severity="warning",
        summary="The radius of gyration of a link is less than a fiftieth of the reach of its shape; or a body has "
        "more than 25,000 kg/m³ even as a ball of its mass and tensor, the largest that has them (an info for less "
        "than 5 % of the robot's mass).",
        reason="The link turns as if its mass were in one point; H comes near to singular at the last joints.",
        remedy="Compute the tensor from the shape, in kg m²; one in t mm² is a thousand times too small.",
        example='<inertia ixx="1e-9" iyy="1e-9" izz="1e-9" …/> on a sphere of 0.1 m and 1 kg',
    ),
    Rule(
        name="density",
        severity="warning",
        summary="A link has more than 25,000 kg/m³ in the box around its shape, or less than 0.1 kg/m³ in its shape.",
        reason="Osmium has 22,600. Masses in grams or shapes in millimetres change the ratio of arm to base, and "
        "with it "
        "everything that is particular to a floating base.",
        remedy="Write masses in kg and lengths in m.",
        example='<mass value="4000"/> on a sphere of 0.1 m',
    ),
    Rule(
        name="centre-outside",
        severity="warning",
        summary="The centre of mass lies outside the box around the link's shape, by more than half its diagonal.",
        reason="A wrong lever changes the coupling between arm and base.",
        remedy="Give the <origin> of the <inertial> in the link's frame, in m.",
        example='<inertial><origin xyz="100 0 0"/>…</inertial> on a sphere of 0.1 m',
    ),
    Rule(
        name="units-length",
        severity="warning",
        summary="A joint or a centre of mass lies more than 100 m from the origin of its link, or a shape is that "
        "large, or the limit of a prismatic joint is that far from zero; or the distance of a joint or of a centre of "
        "mass is more than 20 times all lengths of other kinds: distances of joints, of centres, radii of gyration.",
        reason="The file may be in millimetres: distances enter inertias by their square.",
        remedy="Write lengths in m.",
        example='<origin xyz="300 0 0"/>',
    ),
    Rule(
        name="units-inertia",
        severity="warning",
        summary="The radius of gyration of a link is more than 100 m, or more than 20 times all other lengths of the "
        "robot, that of the base included.",
        reason="The tensor may be in g mm² or kg mm², a million to a billion times too large.",
        remedy="Write tensors in kg m².",
        example='<mass value="2"/><inertia ixx="1e6" iyy="1e6" izz="1e6" …/>',
    ),
    Rule(
        name="units-angle",
        severity="warning",
        summary="The limits of a revolute joint are round numbers of degrees, ten turns at most, and more than two "
        "turns (4π) from zero; or the rpy of a joint or an inertial is more than one turn (2π).",
        reason="The file may be in degrees. Random states and limits of a controller would mean nothing.",
        remedy="Write angles in rad.",
        example='<limit lower="-180" upper="180" …/>',
    ),
    Rule(
        name="mass-ratio",
        severity="warning",
        summary="All other bodies together have more than 100 times the mass of the base, or less than a millionth "
        "of it; or one of them has more than five times the mass of all others and the base.",
        reason="Coupling between arm and base is what free-floating dynamics are about; here it is nearly a fixed "
        "base, "
        "or a base that is a mere tail of the arm. Mixed units do that.",
        remedy="Compare the masses; choose the heaviest body as the root link.",
        example='<mass value="0.001"/> in the root link, 10 kg in the arm',
    ),
    Rule(
        name="overlap-at-zero",
        severity="info",
        summary="Links overlap with all joints at zero, those of one body and adjacent ones left out: the pairs, the "
        "deepest first. Shapes are the <collision> ones, or the <visual> ones of links without any, meshes by their "
        "convex hulls. Beyond 200 shapes or 25 MB of meshes it is said that nothing was looked at.",
        reason="A clearance takes such links as allowed to touch and does not watch them, in any configuration: "
        "shapes that are too large, or stand in the wrong place, take a true collision out of sight.",
        remedy="A clearance does not watch these pairs. Where the links do not touch in truth, mend their shapes, or "
        "the origins or zero positions of the joints; else leave them.",
        example="two fingers whose boxes are as wide as the hand",
    ),
)
