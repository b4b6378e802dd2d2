"""Coordinates of other programs, converted both ways: MuJoCo, Drake, SPART; and MuJoCo as the plant of a controller.

Each has a module, and a class `Coordinates` there. No module is imported here, and none needs its program but
`ospace.bridge.mujoco`.
"""
