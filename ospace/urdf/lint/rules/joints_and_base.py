"""Joints, their axes and limits, and how the base is held."""

from ospace.urdf.lint.rules.rule import Rule

JOINTS_AND_BASE = (
    Rule(
        name="joint-type",
        severity="error",
        summary="The type of a joint is missing or unknown, or one that URDF does not have, as ball or screw.",
        reason="How the links move is not known.",
        remedy="One of revolute, continuous, prismatic, fixed, floating, planar; several of them make any other.",
        example='<joint name="hinge" type="ball">',
    ),
    Rule(
        name="loop-open",
        severity="warning",
        summary="A joint leads to a link that another joint carries: it closes a loop. It is left out, and the robot "
        "is read as the tree that is left: of the joints to a link the first in the file stays.",
        reason="URDF and ospace know trees. A loop that is open has more degrees of freedom, and its links fall apart.",
        remedy="Keep to positions in which the loop is closed, or remove the joint; a passive side of a linkage that "
        "weighs little can be left out.",
        example='two joints with <child link="coupler"/>, of different parents',
    ),
    Rule(
        name="root-given",
        severity="info",
        summary="The root was chosen; links and joints that do not hang from it are left out.",
        reason="The robot is a part of what the file describes.",
        remedy="Nothing, if it is meant so.",
        example="ospace check two_bodies.urdf --root chaser",
    ),
    Rule(
        name="axis-zero",
        severity="error",
        summary="The axis of a joint has no length, or less than 1e-6.",
        reason="It has no direction: the joint's column of every Jacobian would be zero or noise.",
        remedy="Give it a direction of unit length.",
        example='<axis xyz="0 0 0"/>',
    ),
    Rule(
        name="axis-not-unit",
        severity="warning",
        summary="The length of a joint's axis differs from one by more than 1e-3. It is read as a direction.",
        reason="A reader that does not normalise it scales the joint's rate.",
        remedy="Divide it by its length.",
        example='<axis xyz="0 0 2"/>',
        fixable=True,
    ),
    Rule(
        name="planar-axis",
        severity="info",
        summary="The axis of a planar joint, the normal of its plane, is not 0 0 1; without <axis> it is 1 0 0.",
        reason="ospace moves the joint in that plane, as URDF says. Its coordinates x and y are then along the "
        "directions that the message gives, in the joint's frame. Other readers, Pinocchio's parser and MoveIt among "
        "them, ignore the axis, and take the x-y plane.",
        remedy='Nothing, if it is meant; else give the normal: <axis xyz="0 0 1"/> for the x-y plane.',
        example='<joint name="table" type="planar">…<axis xyz="0 1 0"/></joint>',
    ),
    Rule(
        name="limits-missing",
        severity="warning",
        summary="A revolute or prismatic joint has no <limit>. It is read as unlimited, with one coordinate. An info "
        "of a continuous joint, of which URDF demands none.",
        reason="URDF demands it, and Pinocchio's parser rejects the file. A controller has no limit to respect, and no "
        "bound on the torque.",
        remedy='Give it its limits; a joint that turns for ever is of type "continuous".',
        example='<joint name="hinge" type="revolute"> without <limit>',
        fixable=True,
    ),
    Rule(
        name="limits-none",
        severity="warning",
        summary="A limit is written as one that means none: inf, a number beyond 1e12, nines as in 999999, an effort "
        "or velocity of -1, an angle from 1e4 to 1e6 rad. It is read as unlimited.",
        reason="Pinocchio's parser rejects inf and negative efforts; others take them, and 999999, for numbers.",
        remedy="Give the limit of the joint, or a number that is never reached, such as 1e9.",
        example='<limit lower="-inf" upper="inf" effort="-1" velocity="-1"/>',
        fixable=True,
    ),
    Rule(
        name="limits-reversed",
        severity="warning",
        summary="The lower limit of a joint exceeds the upper.",
        reason="No position is allowed. Dynamics do not depend on it; random states ignore such limits.",
        remedy="Swap them, if that is what was meant.",
        example='<limit lower="1" upper="-1" …/>',
    ),
    Rule(
        name="limits-zero",
        severity="warning",
        summary="Lower and upper limit of a joint are equal, or both missing, which URDF reads as zero.",
        reason="The joint cannot move; its degree of freedom remains in H and is sampled at one place only.",
        remedy="Give it its limits, or make it fixed.",
        example='<limit effort="10" velocity="1"/>',
    ),
    Rule(
        name="effort-missing",
        severity="warning",
        summary="<limit> has no effort or no velocity. It is read as unlimited.",
        reason="URDF demands both, and Pinocchio's parser rejects the file.",
        remedy="Give both: N m and rad/s, or N and m/s.",
        example='<limit lower="-1" upper="1"/>',
        fixable=True,
    ),
    Rule(
        name="effort-zero",
        severity="info",
        summary="The limit of a joint's effort or velocity is zero.",
        reason="It is taken literally: a joint of zero effort has no drive and its torque is zero, one of zero "
        "velocity is held still. Exporters also write zero for unknown.",
        remedy="Give the limit of the actuator, if there is one.",
        example='<limit lower="-1" upper="1" effort="0" velocity="0"/>',
    ),
    Rule(
        name="effort-negative",
        severity="error",
        summary="The limit of a joint's effort or velocity is negative, and not -1, which stands for none.",
        reason="No effort is allowed, and Pinocchio's parser rejects the file.",
        remedy="Give its size.",
        example='<limit lower="-1" upper="1" effort="-10" velocity="1"/>',
    ),
    Rule(
        name="zero-outside-limits",
        severity="warning",
        summary="Position zero lies outside the limits of a joint, by the angle or length that the message gives.",
        reason="A configuration with all joints at zero, with which many programs start, is one that the robot cannot "
        "take. `robot.configuration()` has it at zero, `robot.neutral()` inside its limits.",
        remedy="Start from robot.neutral(), or give the joint a position.",
        example='<limit lower="0.5" upper="2" …/>',
    ),
    Rule(
        name="value-not-used",
        severity="warning",
        summary="A part of <limit> or <dynamics> is not used: acceleration, deceleration and jerk; lower and upper of "
        "a continuous joint, unless they are zero or mean none; <limit> and <dynamics> of a planar or floating one.",
        reason="The joint is freer in ospace than the file says.",
        remedy="Give bounds on accelerations to JointLimits.of(robot, acceleration=…); make a joint with positions to "
        'keep "revolute".',
        example='<joint type="continuous">…<limit lower="-1" upper="1" …/>',
    ),
    Rule(
        name="damping-negative",
        severity="error",
        summary="The damping of a joint is negative.",
        reason="The joint would drive itself: neither controllers nor simulations take it.",
        remedy="Give a positive coefficient.",
        example='<dynamics damping="-0.1"/>',
    ),
    Rule(
        name="friction-negative",
        severity="error",
        summary="The friction of a joint is negative.",
        reason="The joint would drive itself, and Pinocchio's parser rejects the file.",
        remedy="Give a positive coefficient.",
        example='<dynamics friction="-0.1"/>',
    ),
    Rule(
        name="mimic",
        severity="info",
        summary="A joint follows another.",
        reason="The coupling is kept: both are one degree of freedom, which has the inertia of all that it moves, and "
        "whose torque is that of the leader. Ratio and offset are those to a leader that follows none itself.",
        remedy="Nothing; to take it as independent: free_mimic=True.",
        example='<mimic joint="left_finger" multiplier="-1"/>',
    ),
    Rule(
        name="mimic-unfit",
        severity="error",
        summary="A joint mimics another that it cannot follow.",
        reason="A follower needs one position, of a leader with one position. Pinocchio takes it only where the leader "
        "can be numbered before it, which a leader that hangs from its follower cannot.",
        remedy="Turn the coupling round: let the other joint mimic this one, by 1/multiplier and −offset/multiplier. "
        "Or take all as independent: free_mimic=True.",
        example='<joint name="wheel" type="planar"> with <mimic joint="motor"/>',
    ),
    Rule(
        name="mimic-limits",
        severity="warning",
        summary="A joint is beyond its limits while the one that it mimics is within its own.",
        reason="Position limits of followers are not kept: those of the leader are.",
        remedy="Narrow the limits of the leader, or widen those of the follower.",
        example='<limit lower="0" upper="0.02" …/> with <mimic joint="left_finger"/>, which has 0 to 0.04',
    ),
    Rule(
        name="mimic-jump",
        severity="warning",
        summary="A joint mimics a continuous one by a multiplier that is not whole.",
        reason="The angle of a continuous joint is known but for full turns, from −180 to 180 deg: where it passes "
        "180 deg, the follower jumps.",
        remedy='Make the leader "revolute", with limits that are never reached.',
        example='<mimic joint="a_continuous_joint" multiplier="0.5"/>',
    ),
    Rule(
        name="mimic-freed",
        severity="warning",
        summary="A joint mimics another, known or not, and was made independent on request.",
        reason="The coupling is not enforced: inertias are those of joints that move each for itself.",
        remedy="Keep to positions in which it follows the other, or make the joint fixed.",
        example='<mimic joint="left_finger" multiplier="-1"/> with free_mimic=True',
    ),
    Rule(
        name="mimic-unknown",
        severity="error",
        summary="A joint mimics one that does not exist, or itself, by way of others or not.",
        reason="Where it belongs is not known.",
        remedy="Correct the name, or remove the <mimic>.",
        example='<mimic joint="no_such_joint"/>',
    ),
    Rule(
        name="fixed-base",
        severity="warning",
        summary="The root link is called 'world' and the robot is fixed to it: the file describes a robot on the "
        "ground.",
        reason="ospace lets it float: what is bolted down in the file reacts freely here.",
        remedy="Nothing, if it is to fly; remove the link 'world' and its joint to say so.",
        example='<link name="world"/> and a fixed joint to the base',
    ),
    Rule(
        name="floating-root",
        severity="info",
        summary="The file has a floating joint of its own between a massless root link and the base.",
        reason="It is taken as the base's six degrees of freedom. Doubled, H would be singular. The root link and the "
        "origin of the joint are left out.",
        remedy="Nothing.",
        example='<link name="world"/> and a floating joint to the base',
    ),
)
