"""One state: from q and v, or from links that stand in the workspace, to every quantity of it.

The entries are what Python calls; each takes the one array of `ospace.kernels.workspace` and leaves its results there.
What is to be computed is a sum of the bits below.
"""

from __future__ import annotations

from ospace.kernels import composite_body, coupled_joints, points, pv_osimr, response, spd_inverse
from ospace.kernels.articulated_body import NO_INERTIA
from ospace.kernels.jit.compile import Number, Row, Table, entry, inlined
from ospace.kernels.jit.load_store import load7, load21, store21, unowned
from ospace.kernels.jit.simd import absolute, full_like, maximum, minimum, sqrt, zeros
from ospace.kernels.kinematics import move_links, place_followers, place_links, sines_cosines
from ospace.kernels.tree import (
    CONTINUOUS,
    FLOATING,
    PLANAR,
    SPHERICAL,
    Floats,
    Joints,
)
from ospace.kernels.workspace import Robot, Wide, Work, open_robot, open_wide, open_work

OK, BAD_INPUT, SINGULAR, DEPENDENT, FAR = range(5)
"""Status of a state; `FAR`: an angle is too large for `sine_cosine`."""

MOBILITY, INERTIA, BIAS, JACOBIAN = 1, 2, 4, 8
"""Γ_e⁻¹; Γ_e of it; μ of it; J_e."""
FLOATING_BASE, MANIPULATOR_INERTIA, JOINT_BIAS, GENERALIZED_INERTIA, GENERALIZED_BIAS = 16, 32, 64, 128, 256
"""Composite bodies, M_0, J_b* and J_m*; and of these H_m, [c_b; c_m], H_m*, c_m* with drifts."""
LINKS_STAND = 512
"""The links' tables are filled already: q and v do not count."""
NORMALIZED = 1024
"""Quaternions are at unit length to the last digit, as they are the second time."""
COMPOSITE = FLOATING_BASE | MANIPULATOR_INERTIA | JOINT_BIAS | GENERALIZED_INERTIA | GENERALIZED_BIAS
COUPLED_MOBILITY = FLOATING_BASE | GENERALIZED_INERTIA
"""Bits of Γ_e⁻¹ where joints mimic others; of μ, GENERALIZED_BIAS."""
MOTION = BIAS | JOINT_BIAS | GENERALIZED_BIAS
"""Bits that take the links' twists and accelerations."""
PLACED_BEFORE = MOBILITY | INERTIA | BIAS | JACOBIAN | LINKS_STAND
"""With any of these, links stand by when it comes to composite bodies."""

NONFINITE_INPUT, NORM_ERROR, FARTHEST, PIVOT, RANGE_PIVOT, NONFINITE_INVERSE, NONFINITE = range(7)
"""Columns of the diagnostics: zero, or not a number where the input is not finite; how far the squares of quaternions
are from unit length; the largest joint coordinate; the smallest relative pivot; the smallest pivot of Γ_e⁻¹ or Λ⁻¹;
zero, or not a number where Γ_e or μ_e, or another result is not finite."""

SMALLEST_PIVOT = 1e-10
"""Of Γ_e⁻¹ at unit diagonal: below it, rows of the points may depend on each other."""
UNIT_LENGTH = 2e-6
"""Tolerance of the square of a quaternion's length beside one: twice the tolerance of a state."""
FAR_ANGLE = 1e5
"""Largest joint coordinate for which sine and cosine hold to the last digits, if it is an angle."""


@inlined
def normalize4(q: Table, k: int, norm_error: Number) -> Number:
    """Bring the quaternion from row `k` on to unit length; return the larger of `norm_error` and its own."""
    x, y, z, u = q[k, 0], q[k + 1, 0], q[k + 2, 0], q[k + 3, 0]
    square = x * x + y * y + z * z + u * u
    scale = 1.0 / sqrt(square)
    q[k, 0], q[k + 1, 0], q[k + 2, 0], q[k + 3, 0] = x * scale, y * scale, z * scale, u * scale
    return maximum(norm_error, absolute(square - 1.0))


@inlined
def normalize2(q: Table, k: int, norm_error: Number) -> Number:
    """The same of a pair of cosine and sine."""
    x, y = q[k, 0], q[k + 1, 0]
    square = x * x + y * y
    scale = 1.0 / sqrt(square)
    q[k, 0], q[k + 1, 0] = x * scale, y * scale
    return maximum(norm_error, absolute(square - 1.0))


@inlined
def normalize_input(joints: Joints, w: Work) -> None:
    """Bring quaternions and (cos, sin) pairs in `w.q` to unit length; note what the input is like."""
    nonfinite, norm_error, far = full_like(0.0, w.q[0, 0]), full_like(0.0, w.q[0, 0]), full_like(0.0, w.q[0, 0])
    for k in range(w.q.shape[0]):
        nonfinite = nonfinite + 0.0 * w.q[k, 0]  # not zero for what is not finite
    for k in range(7, w.q.shape[0]):
        far = maximum(far, absolute(w.q[k, 0]))
    for k in range(w.velocity.shape[0]):
        nonfinite = nonfinite + 0.0 * w.velocity[k, 0]
    norm_error = normalize4(w.q, 3, norm_error)
    for i in range(1, joints.parent.size):
        k, kind = joints.first[i], joints.kind[i]
        if kind == CONTINUOUS:
            norm_error = normalize2(w.q, k, norm_error)
        elif kind == PLANAR:
            norm_error = normalize2(w.q, k + 2, norm_error)
        elif kind == SPHERICAL:
            norm_error = normalize4(w.q, k, norm_error)
        elif kind == FLOATING:
            norm_error = normalize4(w.q, k + 3, norm_error)
    w.diagnostics[0, NONFINITE_INPUT] = nonfinite
    w.diagnostics[0, NORM_ERROR] = norm_error
    w.diagnostics[0, FARTHEST] = far


@inlined
def clear_input_diagnostics(w: Work) -> None:
    """Note that nothing is wrong with the input, where links stand already."""
    for k in range(FARTHEST + 1):
        w.diagnostics[0, k] = 0.0


@inlined
def place(robot: Robot, w: Work, wide: Wide, I: Table) -> None:
    """From `w.q` and `w.velocity` to the links; their inertias go to the table `I`."""
    if robot.want[0] & NORMALIZED == 0:
        normalize_input(robot.joints, w)
    sines_cosines(wide.q, wide.sine, wide.cosine)
    place_links(robot.joints, w, I)
    if robot.want[0] & MOTION:
        move_links(robot.joints, w)


@inlined
def place_both(robot: Robot, w: Work, wide: Wide) -> None:
    """Place links whose inertias are to become articulated ones, and composite ones where these are wanted."""
    place(robot, w, wide, w.IA)
    if robot.want[0] & COMPOSITE:
        copy21(w.IA, w.I)


@inlined
def copy21(rows: Table, to: Table) -> None:
    """Copy all rows."""
    for i in range(rows.shape[0]):
        store21(to, i, load21(rows, i))


@inlined
def operational_space(robot: Robot, w: Work, wide: Wide) -> None:
    """From the links to Γ_e⁻¹, Γ_e, μ, μ_e and J_e."""
    want = robot.want[0]
    o, one = full_like(0.0, w.R[0, 0]), full_like(1.0, w.R[0, 0])
    w.diagnostics[0, PIVOT] = w.diagnostics[0, RANGE_PIVOT] = one
    w.diagnostics[0, NONFINITE_INVERSE] = w.diagnostics[0, NONFINITE] = o
    points.place_points(robot.nodes, w)
    if want & JACOBIAN:
        points.point_jacobians(robot, w)
    if want & MOBILITY and robot.joints.followers.size == 0:
        mobility(robot, w, want & BIAS != 0)
        invert(w, wide, want)


@inlined
def coupled_operational_space(robot: Robot, w: Work, wide: Wide) -> None:
    """The same where joints mimic others, after the composite bodies."""
    want, nonfinite = robot.want[0], w.diagnostics[0, NONFINITE]
    w.diagnostics[0, PIVOT] = coupled_joints.mobility(robot, w, want & BIAS != 0)
    for i in range(robot.rows.size):
        nonfinite = nonfinite + 0.0 * w.inertia_inverse[i, i]
        if want & BIAS:
            nonfinite = nonfinite + 0.0 * w.bias_acceleration[i, 0]
    w.diagnostics[0, NONFINITE] = nonfinite
    invert(w, wide, want)


@inlined
def invert(w: Work, wide: Wide, want: int) -> None:
    """From Γ_e⁻¹ and μ to Γ_e and μ_e, where they are wanted."""
    if want & INERTIA:
        inertia(w, wide)
        if want & BIAS:
            bias_force(w)


@inlined
def mobility(robot: Robot, w: Work, biased: bool) -> None:
    """Γ_e⁻¹ by the sweeps of `pv_osimr`, and μ where it is wanted."""
    nodes, rows = robot.nodes, robot.rows
    pv_osimr.begin(nodes, w)
    if biased:
        pv_osimr.initial_bias_forces(w, w.IA)
    smallest = pv_osimr.sweep_inward(robot.joints, nodes, w, biased)
    w.diagnostics[0, PIVOT] = minimum(smallest, pv_osimr.invert_base(w))
    nonfinite = full_like(0.0, w.R[0, 0])
    if biased:
        pv_osimr.spread_bias(nodes, w)
        for i in range(rows.size):
            acceleration = w.acceleration[rows[i] // 6, rows[i] % 6]
            w.bias_acceleration[i, 0] = -acceleration
            nonfinite = nonfinite + 0.0 * acceleration
    pv_osimr.sweep_outward(nodes, w)
    if rows.size == w.all_rows.shape[0]:
        pv_osimr.collect(nodes, w, w.inertia_inverse)
    else:
        pv_osimr.collect(nodes, w, w.all_rows)
        for i in range(rows.size):
            for j in range(rows.size):
                w.inertia_inverse[i, j] = w.all_rows[rows[i], rows[j]]
    for i in range(rows.size):
        nonfinite = nonfinite + 0.0 * w.inertia_inverse[i, i]
    w.diagnostics[0, NONFINITE] = nonfinite


@inlined
def inertia(w: Work, wide: Wide) -> None:
    """Γ_e, and the smallest pivot of its inverse."""
    rows = spd_inverse.Rows(w.scratch, wide.scratch, wide.unit, w.scale)
    w.diagnostics[0, RANGE_PIVOT] = spd_inverse.inverse(w.inertia_inverse, rows, w.inertia)
    nonfinite = full_like(0.0, w.R[0, 0])
    for i in range(w.inertia.shape[0]):
        nonfinite = nonfinite + 0.0 * w.inertia[i, i]
    w.diagnostics[0, NONFINITE_INVERSE] = nonfinite


@inlined
def bias_force(w: Work) -> None:
    """μ_e = Γ_e μ (10)."""
    nonfinite = w.diagnostics[0, NONFINITE_INVERSE]
    for i in range(w.bias_force.shape[0]):
        force = full_like(0.0, w.R[0, 0])
        for j in range(w.bias_force.shape[0]):
            force = force + w.inertia[i, j] * w.bias_acceleration[j, 0]
        w.bias_force[i, 0] = force
        nonfinite = nonfinite + 0.0 * force
    w.diagnostics[0, NONFINITE_INVERSE] = nonfinite


@inlined
def composite_bodies(robot: Robot, w: Work) -> None:
    """From the links to the quantities of §2 and §5."""
    joints, want = robot.joints, robot.want[0]
    if want & COMPOSITE == 0:
        return
    composite_body.compose(joints, w)
    pivot = composite_body.base_generalized_jacobian(w)
    composite_body.momentum(joints, w)
    composite_body.generalized_jacobian(robot, w)
    if want & MANIPULATOR_INERTIA:
        composite_body.manipulator_inertia(joints, w)
    if want & GENERALIZED_INERTIA:
        pivot = minimum(pivot, composite_body.generalized_inertia(joints, w))
    if want & (JOINT_BIAS | GENERALIZED_BIAS):
        composite_body.bias(joints, w)
        if want & GENERALIZED_BIAS:
            composite_body.generalized_bias(robot.nodes, w)
    w.diagnostics[0, PIVOT] = minimum(w.diagnostics[0, PIVOT], pivot)
    note_composite(w, want)


@inlined
def note_composite(w: Work, want: int) -> None:
    """Note where a quantity of composite bodies is not finite."""
    nonfinite = w.diagnostics[0, NONFINITE]
    for k in range(6):
        nonfinite = nonfinite + 0.0 * (w.momentum[0, k] + w.base_momentum_velocity[0, k])
    for k in range(w.J_m_star.shape[0]):
        for i in range(6):
            nonfinite = nonfinite + 0.0 * w.J_b_star[k + 1, i]
        for i in range(w.J_m_star.shape[1]):
            nonfinite = nonfinite + 0.0 * w.J_m_star[k, i]
        if want & MANIPULATOR_INERTIA:
            nonfinite = nonfinite + 0.0 * w.manipulator_inertia[k, k]
        if want & GENERALIZED_INERTIA:
            nonfinite = nonfinite + 0.0 * w.generalized_inertia[k, k]
        if want & (JOINT_BIAS | GENERALIZED_BIAS):
            nonfinite = nonfinite + 0.0 * w.joint_force[k, 0]
            if want & GENERALIZED_BIAS:
                nonfinite = nonfinite + 0.0 * w.generalized_bias[k, 0]
    w.diagnostics[0, NONFINITE] = nonfinite


@inlined
def status(d: Row) -> int:
    """Map diagnostics to a status code."""
    if not (d[NONFINITE_INPUT] == 0.0 and d[NORM_ERROR] <= UNIT_LENGTH):
        return BAD_INPUT
    if d[FARTHEST] > FAR_ANGLE:
        return FAR
    if d[PIVOT] <= NO_INERTIA:
        return SINGULAR
    if not (d[NONFINITE] == 0.0 and d[PIVOT] > NO_INERTIA):
        return BAD_INPUT
    if not d[RANGE_PIVOT] > SMALLEST_PIVOT:
        return DEPENDENT
    return OK if d[NONFINITE_INVERSE] == 0.0 else BAD_INPUT


@inlined
def load_input(q: Floats, v: Floats, joints: Joints, w: Work) -> bool:
    """Copy q and v to the workspace, and followers to where their leaders place them; return whether they fit."""
    if q.size + joints.followers.size != w.q.shape[0] or v.size != w.velocity.shape[0]:
        return False
    for k in range(q.size):
        w.q[k, 0] = q[k]
    for k in range(v.size):
        w.velocity[k, 0] = v[k]
    place_followers(joints, w)
    return True


@entry
def evaluate(q: Floats, v: Floats, memory: Floats) -> int:
    """Evaluate one state but for its composite bodies; return OK, or what is wrong."""
    here = unowned(memory)
    robot, w, wide = open_robot(here), open_work(here, zeros(1)), open_wide(here)
    if robot.want[0] & LINKS_STAND:
        clear_input_diagnostics(w)
        copy21(w.I, w.IA)
    else:
        if not load_input(unowned(q), unowned(v), robot.joints, w):
            return BAD_INPUT
        place_both(robot, w, wide)
    operational_space(robot, w, wide)
    return status(load7(w.diagnostics, 0))


@entry
def normalize(q: Floats, v: Floats, memory: Floats) -> int:
    """Take a state that Pinocchio is to place: normalized, and as seen from beside the base."""
    here = unowned(memory)
    robot, w = open_robot(here), open_work(here, zeros(1))
    if not load_input(unowned(q), unowned(v), robot.joints, w):
        return BAD_INPUT
    normalize_input(robot.joints, w)
    for k in range(w.q.shape[0]):
        w.q_beside_base[k, 0] = 0.0 if k < 3 else w.q[k, 0]
    for k in range(6):
        w.v_beside_base[k, 0] = 0.0 if k < 3 else w.velocity[k, 0]
    for i in range(1, robot.joints.parent.size):
        w.v_beside_base[i + 5, 0] = robot.joints.ratio[i, 0] * w.velocity[robot.joints.column[i] + 5, 0]
    d = load7(w.diagnostics, 0)
    return OK if d[NONFINITE_INPUT] == 0.0 and d[NORM_ERROR] <= UNIT_LENGTH else BAD_INPUT


@entry
def compose(q: Floats, v: Floats, memory: Floats) -> int:
    """Compute composite bodies, and the points on them; return OK, or what is wrong.

    Links are placed here where nothing else is wanted; else `evaluate` has done so, and q and v do not count.
    """
    here = unowned(memory)
    robot, w = open_robot(here), open_work(here, zeros(1))
    if robot.want[0] & PLACED_BEFORE:
        clear_input_diagnostics(w)
    else:
        if not load_input(unowned(q), unowned(v), robot.joints, w):
            return BAD_INPUT
        place(robot, w, open_wide(here), w.I)
    w.diagnostics[0, PIVOT] = w.diagnostics[0, RANGE_PIVOT] = 1.0
    w.diagnostics[0, NONFINITE] = w.diagnostics[0, NONFINITE_INVERSE] = 0.0
    points.place_points(robot.nodes, w)
    composite_bodies(robot, w)
    return status(load7(w.diagnostics, 0))


@entry
def couple(memory: Floats) -> int:
    """Γ_e⁻¹ and what is wanted with it where joints mimic others, after `compose` with the bits `COUPLED_MOBILITY`."""
    here = unowned(memory)
    robot, w = open_robot(here), open_work(here, zeros(1))
    coupled_operational_space(robot, w, open_wide(here))
    return status(load7(w.diagnostics, 0))


@entry
def respond(memory: Floats) -> int:
    """Responses to forces at the points, after `evaluate` or `couple`; and Λ, after `compose` with all of its bits."""
    here = unowned(memory)
    robot, w = open_robot(here), open_work(here, zeros(1))
    if robot.joints.followers.size > 0:
        coupled_joints.respond(robot, w)
    else:
        response.respond(robot, w)
    nonfinite, d = 0.0, w.diagnostics
    if robot.want[0] & GENERALIZED_BIAS:
        response.free_floating(robot, w)
        response.base_inertia_inverse(robot, w)
        wide = open_wide(here)
        rows = spd_inverse.Rows(w.scratch, wide.scratch, wide.unit, w.scale)
        pivot = spd_inverse.inverse(w.floating_inertia_inverse, rows, w.floating_inertia)
        smallest = 1.0  # of what joint torques do in a row, beside all that a force there does
        for i in range(robot.rows.size):
            smallest = min(smallest, w.floating_inertia_inverse[i, i] / w.inertia_inverse[i, i])
        d[0, RANGE_PIVOT] = pivot * smallest if smallest > 0.0 else 0.0
        for i in range(robot.rows.size):
            nonfinite += 0.0 * (w.floating_inertia_inverse[i, i] + w.base_inertia_inverse[i, i] + w.floating_bias[i, 0])
    for k in range(w.response.shape[0]):
        for i in range(w.response.shape[1]):
            nonfinite += 0.0 * w.response[k, i]
    if nonfinite != 0.0:
        return BAD_INPUT
    return OK if d[0, RANGE_PIVOT] > SMALLEST_PIVOT else DEPENDENT


@entry
def inverse_dynamics(acceleration: Floats, memory: Floats) -> int:
    """Forces that make base and joints accelerate so, of links that stand."""
    here = unowned(memory)
    w = open_work(here, zeros(1))
    for k in range(acceleration.size):
        w.given[k, 0] = acceleration[k]
    composite_body.inverse_dynamics(open_robot(here).joints, w)
    nonfinite = 0.0
    for k in range(6):
        nonfinite += 0.0 * w.base_force[0, k]
    for k in range(w.joint_force.shape[0]):
        nonfinite += 0.0 * w.joint_force[k, 0]
    return OK if nonfinite == 0.0 else BAD_INPUT
