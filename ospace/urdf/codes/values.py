"""Elements and numbers that do not say what they seem to."""

from ospace.urdf.codes.code import Code

VALUES = (
    Code(
        name="number-unreadable",
        severity="error",
        summary="A number of a joint is missing or none: nan, 1e400, 0x10, '12 kg', a decimal comma, too few or too "
        "many.",
        reason="A reader that guesses puts the joint, and all that hangs from it, somewhere else.",
        remedy="Write plain finite decimal numbers, as many as are due, with a point and without units.",
        example='<origin xyz="0,3 0 0"/>',
    ),
    Code(
        name="number-spaces",
        severity="warning",
        summary="White space surrounds a number; it is read as meant. For lists of numbers an info only.",
        reason="Pinocchio's parser takes such a number for zero, or drops the element around it: a tensor or a mass "
        "disappears with nothing but a line on standard error.",
        remedy="Remove the white space.",
        example='<inertia ixx="0.010 " …/>',
        fixable=True,
    ),
    Code(
        name="number-range",
        severity="error",
        summary="A mass, length or inertia has a size of more than 1e12, or an inertia is not zero and smaller than "
        "1e-100, or a mass than 1e-15, or a number is too small for floating point.",
        reason="Products of such numbers leave the range of floating point: inertias become infinite or lose all "
        "digits.",
        remedy="Use kg, m and kg m², and write 0 for nothing. 1e12 kg is a mountain, 1e-15 kg a bacterium.",
        example='<mass value="1e300"/>',
    ),
    Code(
        name="duplicate-element",
        severity="error",
        summary="An element that may stand once stands twice, as <inertial> in a link or <origin> in a joint.",
        reason="Readers take the first or the last: half the mass, or another placement.",
        remedy="Keep one.",
        example="<link><inertial/><inertial/></link>",
    ),
    Code(
        name="unknown-element",
        severity="warning",
        summary="An element of the robot has in it one that URDF does not know there; an info where its name is far "
        "from any that URDF has, an error where it is or holds a link, joint or inertial, or includes another file.",
        reason="Readers pass over it: a misspelt <inertail> leaves a link without mass, a <Link>, or one in a "
        "<group>, is no part of the robot.",
        remedy="Correct its name or its place. <gazebo>, <sensor>, <contact>, <transmission>, <ros2_control> and "
        "elements of a namespace of their own are left alone.",
        example="<inertail>…</inertail>",
    ),
    Code(
        name="unknown-attribute",
        severity="warning",
        summary="An element has an attribute that URDF does not know there; an info where its name is far from any "
        "that URDF has.",
        reason="Readers pass over it and take the default: a misspelt xyz leaves a link at its parent's origin.",
        remedy="Correct its name or its place.",
        example='<origin xzy="0 0 1"/>',
    ),
    Code(
        name="stray-text",
        severity="warning",
        summary="Text stands in an element; URDF has all that it says in attributes.",
        reason="Readers pass over it and take the default: <origin>0 0 1</origin> moves nothing.",
        remedy="Write it as an attribute, as in <origin xyz='0 0 1'/>, or as a comment.",
        example="<origin>0 0 1</origin>",
    ),
    Code(
        name="visual-unreadable",
        severity="warning",
        summary="A <visual>, <collision> or <material> cannot be read.",
        reason="It is left out. Dynamics do not need it, but inertias are then not compared with the shape.",
        remedy="Write plain finite numbers.",
        example='<color rgba="red"/>',
    ),
    Code(
        name="no-robot-name",
        severity="warning",
        summary="<robot> has no name; the robot is called as its file.",
        reason="URDF demands it, and Pinocchio's parser rejects the file.",
        remedy='Give it one: <robot name="chaser">.',
        example="<robot>",
    ),
    Code(
        name="parser-error",
        severity="error",
        summary="Pinocchio's parser complained on standard error and built a model all the same.",
        reason="It may not have read what it complained of.",
        remedy="Correct the element.",
        example="none is known: ospace gives the parser only what it has read itself",
    ),
)
