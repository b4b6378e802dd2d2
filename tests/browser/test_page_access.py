"""Without a mouse and without a screen: keys, names, headings, tables, and words for what is drawn."""

import itertools
from pathlib import Path

import missions
import numpy as np
import pytest

import ospace
from ospace import SpaceRobot
from ospace.simulation.zero_momentum import FloatingMotion
from ospace.visual import Scene, run_report

pytestmark = pytest.mark.browser
MODELS = Path(ospace.__file__).parents[1] / "models"
ARM = """() => {
  const { camera, controls } = ospace.viewer, arm = camera.position.clone().sub(controls.target);
  return [arm.length(), Math.atan2(arm.x, arm.z), Math.acos(arm.y / arm.length())];
}"""


@pytest.fixture(scope="module")
def moving():
    """Return the page of a scene with an animation."""
    robot = SpaceRobot.from_urdf(MODELS / "planar_2r.urdf")
    scene = Scene(robot)
    q = np.array([robot.configuration({"joint_1": angle}) for angle in (0.0, 1e-3)])
    scene.animate(FloatingMotion(np.array([0.0, 60.0]), q, np.zeros((2, robot.nv))))
    return scene.html()


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    return run_report.render(missions.flown(tmp_path_factory.mktemp("mission")))


def focused(page):
    return page.evaluate(
        "[document.activeElement.id || document.activeElement.dataset.layer || document.activeElement.tagName][0]"
    )


def test_tab_reaches_all_controls(open_page, moving):
    page = open_page(moving)
    reached = []
    for _ in range(20):
        page.keyboard.press("Tab")
        reached.append(focused(page))
        if reached[-1] == "time":
            break
    layers = page.locator("#layers input").evaluate_all("(all) => all.map((one) => one.dataset.layer)")
    assert reached == ["pane", *layers, "play", "time"]
    assert page.evaluate("getComputedStyle(document.activeElement).outlineStyle") == "solid"


def test_keys_turn_the_view_and_play_the_motion(open_page, moving):
    page = open_page(moving)
    pane = page.locator("#pane")
    pane.focus()
    for key, which, sign in (
        ("ArrowLeft", 1, -1), ("ArrowRight", 1, 1), ("ArrowUp", 2, -1), ("ArrowDown", 2, 1), ("+", 0, -1), ("-", 0, 1),
    ):  # fmt: skip
        before = np.array(page.evaluate(ARM))
        page.keyboard.press(key)
        after = np.array(page.evaluate(ARM))
        change = after - before
        assert change[which] * sign > 0.01, key
        assert np.abs(np.delete(change, which)).max() < 1e-9, key
    page.keyboard.press("Space")
    page.until("() => document.getElementById('play').textContent === 'Pause' && Number(time.value) > 0")
    page.keyboard.press("Space")
    assert page.locator("#play").inner_text() == "Play"
    page.locator("#time").press("ArrowRight")  # of the slider's own
    page.locator("[data-layer='inertia']").press("Space")
    assert page.locator("[data-layer='inertia']").is_checked()
    assert page.locator("#play").inner_text() == "Play"


UNNAMED = """() => [...document.querySelectorAll("button, input, select, a[href], summary, [tabindex='0'], [role=img]")]
  .filter((one) => {
    const label = one.getAttribute("aria-label") || (one.getAttribute("aria-labelledby") || "").split(" ")
      .map((id) => document.getElementById(id)?.textContent || "").join("").trim()
      || [...(one.labels || [])].map((label) => label.textContent).join("").trim()
      || (one.matches("button, a, summary") ? one.textContent.trim() : "");
    return !label && one.checkVisibility();
  }).map((one) => one.outerHTML.slice(0, 200))"""
HEADINGS = "(all) => all.map((one) => Number(one.tagName[1]))"


def said(page):
    """Check what any page of ours says."""
    assert page.locator("html").get_attribute("lang") == "en"
    assert page.locator("title").count() >= 1
    assert page.evaluate("document.querySelectorAll('head title').length") == 1
    assert page.title().strip()
    assert page.locator("h1").count() == 1
    assert page.locator("main").count() == 1
    levels = page.locator("h1, h2, h3, h4, h5, h6").evaluate_all(HEADINGS)
    assert levels[0] == 1
    assert all(after <= before + 1 for before, after in itertools.pairwise(levels))
    assert page.evaluate(UNNAMED) == []
    pane = page.locator("#pane")
    assert pane.get_attribute("role") == "img"
    assert "three dimensions" in pane.get_attribute("aria-label")
    assert page.locator("#layers legend").inner_text() == "Layers"
    assert page.get_by_role("checkbox", name="momentum").count() == 1
    assert page.locator("#status").get_attribute("role") == "status"


def test_a_scene_is_readable_to_a_screen_reader(open_page, moving):
    page = open_page(moving)
    said(page)
    assert page.get_by_role("button", name="Play").count() == 1
    assert page.get_by_role("slider", name="time in seconds").count() == 1


def test_a_report_is_readable_to_a_screen_reader(open_page, report):
    page = open_page(report)
    said(page)
    tables = page.locator("table")
    assert tables.count() == 3  # origin, phases, certificate
    for k in range(tables.count()):
        table = tables.nth(k)
        assert table.locator("caption").inner_text().strip()
        assert table.locator("thead th[scope=col]").count() == table.locator("thead th").count() > 4
        assert table.locator("tbody th").count() == table.locator("tbody th[scope^=row]").count() > 0
    pictures = page.locator("svg[role=img]")
    assert pictures.count() == page.locator("figure").count() > 8
    unsaid = pictures.evaluate_all(
        """(all) => all.filter((one) => {
          const said = one.getAttribute("aria-labelledby").split(" ").map((id) => document.getElementById(id));
          return said.length !== 2 || said.some((part) => !part?.textContent.trim() || !one.contains(part));
        }).length"""
    )
    assert unsaid == 0
    assert page.locator("figure figcaption").count() == pictures.count()
    assert page.get_by_role("group", name="go to a phase").get_by_role("button").count() == 3
