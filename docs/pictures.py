"""Draws the pictures of README and docs anew: ``python docs/pictures.py``; needs Chromium."""

from __future__ import annotations

import tempfile
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

import ospace
from ospace.scenario import load, run
from ospace.visual import Scene, browser, run_report

IMAGES = Path(__file__).with_name("images")
STRIP = {"wait": 1.0, "approach": 7.5, "grasp": 14.7}  # s
SIZE = (620, 470)


def main() -> None:
    report = run_report.render(run(load(ospace.models.scenario("grasp"))))
    browser.screenshot(report, IMAGES / "grasp.png", (1000, 640), "bare&t=14.7")
    browser.screenshot(report, IMAGES / "report.png", (1000, 1500), "t=9")
    strip(report, IMAGES / "strip.png")

    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof"))
    hands = [robot.point("right_hand"), robot.point("left_hand")]
    scene = Scene(robot, hands, show=("robot", "points", "mass-centre", "operational-inertia", "manipulability"))
    scene.display(robot.configuration({"right_arm_2": -0.6, "right_arm_4": 1.4, "left_arm_2": 0.6, "left_arm_4": 1.4}))
    browser.screenshot(scene.html(), IMAGES / "view.png")
    for name in ("grasp", "report", "strip", "view"):
        picture = Image.open(IMAGES / f"{name}.png").convert("RGB").quantize(256, dither=Image.Dither.NONE)
        picture.save(IMAGES / f"{name}.png", optimize=True)
        print(f"{name}.png: {(IMAGES / f'{name}.png').stat().st_size / 1e3:.0f} kB")


def strip(report: str, path: Path) -> None:
    """Draw the run at several times, side by side."""
    width, height = SIZE
    whole = Image.new("RGB", (width * len(STRIP) + 8 * (len(STRIP) - 1), height), "white")
    draw = ImageDraw.Draw(whole)
    with tempfile.TemporaryDirectory() as folder:
        for k, (name, time) in enumerate(STRIP.items()):
            part = Path(folder) / f"{name}.png"
            browser.screenshot(report, part, SIZE, f"bare&t={time}")
            left = k * (width + 8)
            whole.paste(Image.open(part), (left, 0))
            draw.text((left + 16, height - 40), f"{name}, {time:g} s", "white", ImageFont.load_default(22))
    whole.save(path)


if __name__ == "__main__":
    main()
