"""Plots of a map are drawn of its cells, for a page and for a file."""

import numpy as np
import pytest
from lxml import etree

import ospace
from ospace import analysis
from ospace.analysis.map_result import MapResult
from ospace.cli.main import main
from ospace.visual import map_plots, map_report


@pytest.fixture(scope="module")
def result():
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))
    arm = analysis.Arm(robot, robot.point("end_effector", "linear"))
    found = analysis.map_arm(arm, ["reach", "singularity", "base-turn"], grid=30)
    return MapResult(found, analysis.workspaces(arm, starts=40), None, found.count, "grid")


def axes_of(figure):
    """Return the axes of each plot below each other, but for colour bars."""
    return [[one for one in part.axes if one.get_label() != "<colorbar>"] for part in figure.subfigs]


def test_pictures_hold_the_cells(result):
    figure = map_plots.figure(result)
    over_reach, over_joints, sides = axes_of(figure)[:3]
    found = result.arm_map
    (picture,) = over_joints[0].get_images()
    assert picture.get_array().shape == (30, 30)
    np.testing.assert_allclose(picture.get_extent(), np.rad2deg([-2.9671, 2.9671, -2.9671, 2.9671]))
    row = found.plane.index.tolist().index([4, 9])
    assert picture.get_array()[9, 4] == found.plane.low[row, 1]
    (seen,) = (one.get_images()[0].get_array() for one in sides)  # from above alone: from the sides it is a line
    assert np.nanmax(seen) == found.voxels.high[:, 1].max()
    assert (~np.isnan(np.ma.filled(seen, np.nan))).sum() == len(found.voxels.index)
    (band,) = over_reach[0].collections
    low, high = (float(extreme(band.get_paths()[0].vertices[:, 1])) for extreme in (np.min, np.max))
    assert (low, high) == (found.shells.low[:, 1].min(), found.shells.high[:, 1].max())
    names = [one.get_text() for one in over_reach[0].get_legend().get_texts()]
    assert names == ["in a shell", "path-independent", "path-dependent"]


def test_turns_are_in_degrees(result):
    (axes,) = axes_of(map_plots.figure(result))[6]
    assert axes.get_ylabel() == "deg"
    assert axes.get_ylim()[1] > 60.0


def test_panels_have_names_of_their_own_and_are_described(result):
    panels = map_plots.panels(result, dark=True)
    assert len({one.name for one in panels}) == len(panels) == 9
    ids = [one.get("id") for panel in panels for one in etree.fromstring(panel.svg).iter() if one.get("id")]
    assert len(ids) == len(set(ids))
    assert panels[0].description.startswith("smallest singular value of J*: smallest and largest in each of")


def test_plots_are_the_same_each_time(result):
    one, again = (map_plots.panels(result, dark=True) for _ in range(2))
    assert one == again


def test_the_page_has_all_sections(result):
    page = map_report.render(result, name="planar_2r")
    for one in ("field", "facts", "extremes", "plots"):
        assert f'<h2 id="{one}">' in page
    assert "path-dependent" in page


def test_names_are_text_in_page_and_plots(result, tmp_path):
    text = ospace.models.path("planar_2r").read_text().replace('"joint_1"', '"&lt;b&gt;$x$ &amp; y"')
    file = tmp_path / "named.urdf"
    file.write_text(text)
    robot = ospace.SpaceRobot.from_urdf(file)
    arm = analysis.Arm(robot, robot.point("end_effector", "linear"))
    named = MapResult(analysis.map_arm(arm, ["disturbance"], grid=5), None, None, 25, "grid")
    page = map_report.render(named, name="named.urdf")
    assert "<b>$x$" not in page
    assert "&lt;b&gt;$x$ &amp; y" in page


@pytest.mark.parametrize("suffix", ["svg", "png", "pdf"])
def test_the_command_writes_plots(tmp_path, monkeypatch, capsys, suffix):
    monkeypatch.chdir(tmp_path)
    words = ["map", "planar_2r", "--what", "disturbance", "--grid", "12", "--plot", f"a.{suffix}"]
    assert main(words) == 0
    first = (tmp_path / f"a.{suffix}").read_bytes()
    assert len(first) > 5000
    assert capsys.readouterr().out.endswith(f"wrote a.{suffix}\n")
    assert main(words) == 0
    assert (tmp_path / f"a.{suffix}").read_bytes() == first


def test_a_picture_of_another_kind_is_refused(capsys):
    with pytest.raises(SystemExit):
        main(["map", "planar_2r", "--plot", "a.bmp"])
    assert "'a.bmp' ends neither in .svg" in capsys.readouterr().err
