"""
A solver of your own
====================

An own solver: it tries the bounds that bound the last solution, and asks DAQP only where these have changed.
"""

import numpy as np
import pinocchio as pin

import ospace
from ospace.control import BaseAttitudeTask, JointLimits, MinimumJerk, PoseTask, PostureTask
from ospace.control.solvers import solver_named

TOLERANCE = 1e-9


class LastActiveSet:
    """minimize ½ zᵀ H z + fᵀ z subject to lower ≤ [z; C z] ≤ upper, from the active set of the program before.

    With the active rows A and their bounds b, stationarity and these rows give

        [ H  Aᵀ ] [ z ]   [ −f ]
        [ A  0  ] [ λ ] = [  b ]

    which is the solution if z keeps all bounds and every λ pulls towards its bound.
    """

    def __init__(self):
        self.solve, self.side, self.hits, self.calls = solver_named("daqp"), None, 0, 0

    def __call__(self, program):
        rows = np.vstack([np.eye(len(program.f)), program.C])
        self.calls += 1
        if self.side is not None and len(self.side) == len(rows):
            z = self._try(program, rows)
            if z is not None:
                self.hits += 1
                return z
        z = self.solve(program)
        if z is not None:
            value = rows @ z
            self.side = np.where(value > program.upper - 1e-7, 1, np.where(value < program.lower + 1e-7, -1, 0))
        return z

    def _try(self, program, rows):
        active = np.flatnonzero(self.side)
        A, side, n = rows[active], self.side[active], len(program.f)
        K = np.block([[program.H, A.T], [A, np.zeros((len(A), len(A)))]])
        b = np.where(side > 0, program.upper[active], program.lower[active])
        try:
            solution = np.linalg.solve(K, np.concatenate([-program.f, b]))
        except np.linalg.LinAlgError:
            return None
        z, value = solution[:n], rows @ solution[:n]
        room = TOLERANCE * np.maximum(1.0, np.abs(value))
        kept = (value <= program.upper + room).all() and (value >= program.lower - room).all()
        return z if kept and (side * solution[n:] >= -TOLERANCE).all() else None


def main() -> None:
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof"))
    hand = robot.point("right_hand")
    start = robot.state(robot.configuration())
    here = start.placement(hand)
    there = pin.SE3(here.rotation, here.translation + [0.1, 0.1, 0.1])
    tasks = [
        PoseTask(name="hand", point=hand, reference=MinimumJerk(here, there, 0.0, 2.0), stiffness=100.0),
        BaseAttitudeTask(name="base", robot=robot),
        PostureTask(name="posture"),
    ]
    limits = JointLimits.of(robot, share=0.1)  # so tight that some of them bind on the way
    own = LastActiveSet()
    runs = {}
    for name, solver in (("daqp", "daqp"), ("own", own)):
        controller = ospace.Controller(robot, tasks, limits=limits, solver=solver)
        runs[name] = ospace.simulate(robot, start.q, start.v, controller, duration=2.5)
    difference = np.abs(runs["own"].torque - runs["daqp"].torque).max()
    print(f"cycles: {len(runs['own']) - 1}")
    print(f"programs: {own.calls}, of which {own.hits} from the last active set")
    print(f"largest torque: {np.abs(runs['daqp'].torque).max():.3g} N m")
    print(f"largest difference from DAQP: {difference:.2g} N m")


if __name__ == "__main__":
    main()
