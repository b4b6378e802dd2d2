"""Masses and inertias, of links and of the bodies that fixed joints make of them."""

from ospace.urdf.lint.rules.rule import Rule

INERTIAS = (
    Rule(
        name="massless-base",
        severity="error",
        summary="The base, with all that is fixed to it, has no mass; or the robot is one body that nothing keeps from "
        "turning about some axis.",
        reason="Forces on a floating base without inertia have no answer: H_b is singular.",
        remedy="Give the root link, or a link fixed to it, an <inertial> with mass and three positive moments. A root "
        "link that stands for the world belongs out of the file, or on a floating joint.",
        example='<link name="base"/>',
    ),
    Rule(
        name="massless-subtree",
        severity="error",
        summary="A joint moves links that have no mass at all, and no tensor of theirs resists it either.",
        reason="No inertia resists the joint, so H is singular and accelerations are not defined. A tensor without "
        "mass resists a joint that turns it, as a wheel's; it does not resist being moved, or turned about an axis "
        "about which its moment is zero.",
        remedy="Give one of the links beyond it an <inertial>, or make the joint fixed.",
        example='<joint name="hinge" type="revolute">…<child link="hand"/></joint><link name="hand"/>',
    ),
    Rule(
        name="massless-link",
        severity="info",
        summary="A moving body has no mass of its own, though what hangs from it has.",
        reason="As between the two axes of a universal joint. H is singular where those axes line up.",
        remedy="Nothing, if it is meant; else give it an <inertial>.",
        example='<link name="ring"/> between two joints',
    ),
    Rule(
        name="negative-mass",
        severity="error",
        summary="The mass of a link is negative.",
        reason="H is indefinite: kinetic energy could be gained without end.",
        remedy="Give it a positive mass.",
        example='<mass value="-1"/>',
    ),
    Rule(
        name="inertial-unreadable",
        severity="error",
        summary="A part or number of <inertial> is missing or cannot be read.",
        reason="Pinocchio's parser drops the whole element with a line on standard error, and the link is massless.",
        remedy="Give <mass value=…>, and <inertia> with ixx, ixy, ixz, iyy, iyz, izz, as plain finite numbers.",
        example='<mass value="12 kg"/>',
    ),
    Rule(
        name="inertia-asymmetric",
        severity="error",
        summary="<inertia> has iyx, izx or izy, and it is not ixy, ixz or iyz, beyond 1e-6 of the largest number.",
        reason="A tensor is symmetric: which of the two products is right is not known.",
        remedy="Keep ixy, ixz and iyz alone.",
        example='<inertia ixy="0" iyx="3" …/>',
    ),
    Rule(
        name="inertia-not-finite",
        severity="error",
        summary="Mass, centre of mass or tensor of a model built in code is NaN or infinite.",
        reason="So is every result.",
        remedy="Give finite numbers.",
        example="model.inertias[1].lever[0] = nan",
    ),
    Rule(
        name="inertia-indefinite",
        severity="error",
        summary="The tensor about the centre of mass has a negative principal moment, beyond rounding (1e-13 of the "
        "middle one). A "
        "warning where a fixed joint merges the link into a body that is sound.",
        reason="H is indefinite in some configuration: kinetic energy could be negative.",
        remedy="Correct the tensor: it belongs about the centre of mass, in the axes of the <inertial> origin, with "
        "products of inertia of the right sign. A violation of less than 1e-4 can be repaired by --fix.",
        example='<inertia ixx="-0.1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>',
        fixable=True,
    ),
    Rule(
        name="inertia-triangle",
        severity="warning",
        summary="One principal moment exceeds the sum of the other two by more than 1e-4 of it. An error where it is "
        "more than a million times that sum, in which the digits of the others are lost.",
        reason="No distribution of mass has such a tensor. The equations can be solved, for a body that cannot exist.",
        remedy="Correct the tensor: look for a swapped row, a wrong unit, or a tensor about another point.",
        example='<inertia ixx="1" iyy="1" izz="3" ixy="0" ixz="0" iyz="0"/>',
    ),
    Rule(
        name="planar-tensor",
        severity="warning",
        summary="One moment is given, as izz of a planar model, and the other two are zero, or equal and less than a "
        "hundredth of it.",
        reason="In the plane no other moment matters. A base that floats in space turns about all axes: where all "
        "centres of mass lie on one line nothing resists a turn about it, and H is singular; with one joint that is "
        "always so. No distribution of mass has such a tensor.",
        remedy="Give all three moments, or let --fix write half of the one given for the other two, as of a flat "
        "plate.",
        example='<inertia ixx="0" iyy="0" izz="0.3" ixy="0" ixz="0" iyz="0"/>',
        fixable=True,
    ),
    Rule(
        name="inertia-rounding",
        severity="warning",
        summary="One principal moment exceeds the sum of the other two by 1e-9 to 1e-4 of it.",
        reason="Digits were lost when the file was written; the body comes out slightly impossible.",
        remedy="Write more digits, or let --fix take the nearest tensor that some body has.",
        example='<inertia ixx="1" iyy="1" izz="2.00001" ixy="0" ixz="0" iyz="0"/>',
        fixable=True,
    ),
    Rule(
        name="inertia-identity",
        severity="warning",
        summary="The tensor is the unit matrix.",
        reason="It is the default of exporters. 1 kg m² is the inertia of a 40 kg wheel of half a metre; on a finger "
        "it "
        "swamps the arm, and the base hardly seems to react.",
        remedy="Compute the tensor from the shape.",
        example='<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>',
    ),
    Rule(
        name="inertia-without-mass",
        severity="warning",
        summary="A link has a tensor and no mass.",
        reason="No body has: it resists being turned and not being moved. So reaction wheels are written whose mass is "
        "counted with the bus; on a joint that moves them H is singular (massless-subtree).",
        remedy="Nothing for a wheel or gyro on its axis, whose mass the bus has; else give it its mass.",
        example='<mass value="0"/><inertia ixx="1" …/>',
    ),
    Rule(
        name="inertia-about-origin",
        severity="info",
        summary="The tensor looks like one about the link's origin instead of the centre of mass.",
        reason="The part that belongs to the distance between the two is then counted twice.",
        remedy="Compare with the program that computed it: URDF wants the tensor about the centre of mass.",
        example='<origin xyz="0.5 0 0"/><mass value="1"/><inertia ixx="0.01" iyy="0.26" izz="0.26" …/>',
    ),
    Rule(
        name="point-mass",
        severity="info",
        summary="A link has mass and a tensor of zero.",
        reason="It resists no rotation: H is singular where it is alone on its joint's axis.",
        remedy="Nothing, if it is meant; else give it its tensor.",
        example='<mass value="1"/><inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/>',
    ),
)
