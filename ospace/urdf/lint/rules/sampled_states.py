"""Findings of the sampled states of `ospace check`."""

from ospace.urdf.lint.rules.rule import Rule

SAMPLED_STATES = (
    Rule(
        name="singular-inertia",
        severity="error",
        summary="A joint carries no inertia in a sampled state, or the base has none about some axis, beside that of "
        "what it carries.",
        reason="H is singular to working precision: a body without inertia about its joint, such as a point mass on "
        "the axis, two joints about one axis with nothing between, all masses on one line as with planar tensors, or a "
        "base of grams under tonnes.",
        remedy="Give the links beyond the joint mass and inertia, or make it fixed. Give the base three moments (--fix "
        "does so for planar tensors), and choose the heaviest body as the root link.",
        example="two coaxial joints with a massless link between them",
    ),
    Rule(
        name="not-computable",
        severity="error",
        summary="A quantity of a sampled state cannot be computed for another reason than one joint.",
        reason="As with a robot whose masses all lie on one line.",
        remedy="Look for links without inertia about an axis, and for masses or lengths in other units than kg and m.",
        example="two point masses on a prismatic joint",
    ),
    Rule(
        name="second-reader",
        severity="warning",
        summary="yourdfpy, the second reader of the file, rejects it.",
        reason="Placements were then not compared.",
        remedy="Compare the file with the URDF specification: another reader may fail where yourdfpy does.",
        example="an element that yourdfpy cannot parse",
    ),
    Rule(
        name="smallest-inertia",
        severity="info",
        summary="Smallest eigenvalue of H over the sampled states, its diagonal scaled to one. A warning below 1e-9.",
        reason="Near zero some motion costs next to no energy, and accelerations amplify every error.",
        remedy="Look for last links of next to no inertia behind long arms.",
        example="a finger of a milligram at the end of an arm",
    ),
    Rule(
        name="base-condition",
        severity="info",
        summary="Condition of H_b over the sampled states, with lengths in units of the robot's radius of gyration. A "
        "warning above 1e6.",
        reason="Every quantity of the free-floating robot goes through the inverse of H_b.",
        remedy="Look for a base that is nearly a line, or masses in different units.",
        example="a thin rod as the only massive body",
    ),
    Rule(
        name="point-rank",
        severity="info",
        summary="The generalized Jacobian of an operational point has fewer independent rows than the point takes.",
        reason="With a free-floating base, the joints alone cannot move the point in all the directions requested.",
        remedy="Take fewer rows of the point, or actuate the base too.",
        example="six rows of a hand on an arm of two joints",
    ),
    Rule(
        name="dynamic-singularity",
        severity="info",
        summary="How near J* of an operational point comes to a dynamic singularity over the sampled states, and "
        "where: its smallest singular value over the largest. Metres are divided by a characteristic length L, the "
        "robot's radius of gyration about its mass centre with joints at zero, to stand beside radians. The positions "
        "shown are of the joints between base and point; `pose` of --json has all, as `ospace view --pose` takes them. "
        "A warning below 1e-6.",
        reason="There the joints cannot move the point in some direction, though the arm alone could: where that is "
        "depends on masses, not only on geometry.",
        remedy="Keep away from such states, or take fewer rows.",
        example="a planar arm whose links the base's reaction cancels",
    ),
)
