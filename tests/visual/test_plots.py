"""Plots: nothing of a curve is lost that can be seen, and panels stand beside each other in a page."""

import re
from xml.etree import ElementTree

import missions
import numpy as np
import pytest
from matplotlib.figure import Figure

from ospace.exceptions import OspaceError
from ospace.scenario import log, series
from ospace.scenario.series import Series
from ospace.visual import plots

SVG = "{http://www.w3.org/2000/svg}"
N = 20_000


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    return log.of(missions.flown(tmp_path_factory.mktemp("mission")))


@pytest.fixture(scope="module")
def panels(flown):
    return [plots.svg(one, flown.phases, dark=dark) for one in series.of(flown).values() for dark in (True, False)]


def made(values, *, labels=None, **more):
    values = np.atleast_2d(values.T).T
    labels = labels or tuple(f"curve {k}" for k in range(values.shape[1]))
    return Series("made", "A title", "mm", np.linspace(0.0, 20.0, len(values)), values, labels, **more)


def texts(svg):
    return ["".join(one.itertext()) for one in ElementTree.fromstring(svg).iter(f"{SVG}text")]


def curves(svg, colour="#56b4e9"):
    """Return points (M, 2) of the curve of a colour, in the SVG's coordinates; those of the legend are not clipped."""
    paths = ElementTree.fromstring(svg).iter(f"{SVG}path")
    (found,) = (path for path in paths if colour in path.get("style", "") and path.get("clip-path"))
    return np.array(re.findall(r"[ML] (\S+) (\S+)", found.get("d")), dtype=float)


# -- thinning ----------------------------------------------------------------------------------------------------


def test_thinning_keeps_spikes_ends_and_gaps():
    time = np.linspace(0.0, 20.0, N)
    values = np.sin(time)
    values[[777, 12_345]] = 50.0, -60.0
    values[5000:7000] = np.nan
    values[9001] = np.nan  # a gap of one point
    kept = plots.thinned(time, values, 500)
    assert len(kept) < 2000
    assert (np.diff(kept) > 0).all()
    assert {0, 777, 9001, 12_345, N - 1} <= set(kept)
    assert np.nanmin(values[kept]) == -60.0
    inside = kept[(kept > 5010) & (kept < 6990)]
    assert len(inside)
    assert np.isnan(values[inside]).all()


def test_every_column_keeps_its_smallest_and_largest():
    rng = np.random.default_rng(0)
    time, values = np.linspace(3.0, 5.0, N), rng.normal(size=N)
    kept = set(plots.thinned(time, values, 100))
    column = np.minimum((100 * (time - 3.0) / 2.0).astype(int), 99)
    for k in range(1, 99):
        own = np.flatnonzero(column == k)[2:-2]  # at the edges rounding may put a point to either side
        inside = [one for one in kept if column[one] == k]
        assert values[inside].min() <= values[own].min()
        assert values[inside].max() >= values[own].max()


def test_a_curve_of_few_points_keeps_them():
    np.testing.assert_array_equal(plots.thinned(np.arange(10.0), np.ones(10), 100), np.arange(10))


def test_a_spike_is_in_the_panel():
    values = np.sin(np.linspace(0.0, 20.0, N))
    values[12_345] = 100.0
    points = curves(plots.svg(made(values), dark=True).svg)
    heights = np.sort(points[:, 1])  # downwards
    assert heights[1] - heights[0] > 100.0
    assert len(points) < 2500


@pytest.mark.parametrize("count", [1, 24, 60])
def test_noise_does_not_make_a_panel_large(count):
    noise = np.random.default_rng(1).normal(size=(N, count))
    assert len(plots.svg(made(noise), dark=False).svg.encode()) < 150_000


# -- panels ------------------------------------------------------------------------------------------------------


def test_panels_are_elements_of_a_page(panels):
    for panel in panels:
        root = ElementTree.fromstring(panel.svg)
        assert panel.svg.startswith("<svg")
        assert root.get("width") == "100%"
        assert root.get("height") is None
        assert root.get("role") == "img"
        assert re.fullmatch(r"0 0 720 216", root.get("viewBox"))
        assert root.find(f"{SVG}title").text == panel.title
        assert root.find(f"{SVG}desc").text == panel.description
        assert not list(root.iter(f"{SVG}style"))  # it would hold for the page
        assert not re.search(r"<!|<\?|<metadata|<script|<image", panel.svg)
        assert set(re.findall(r"https?://[^\s\"<]*", panel.svg)) <= {
            "http://www.w3.org/2000/svg",
            "http://www.w3.org/1999/xlink",
        }
        assert len(panel.svg.encode()) < 150_000


def test_ids_are_a_panels_own_and_references_find_them(panels):
    seen = set()
    for panel in panels:
        ids = re.findall(r'\bid="([^"]*)"', panel.svg)
        assert len(ids) == len(set(ids))
        assert not seen & set(ids)
        seen |= set(ids)
        references = re.findall(r'url\(#([^)]*)\)|href="#([^"]*)"', panel.svg)
        assert references
        assert {url or href for url, href in references} <= set(ids)


def test_text_of_a_plot_stays_text(panels, flown):
    torque = next(panel for panel in panels if panel.name == "torque")
    assert {"joint_1", "joint_2", "Torque of joints, share of its limit", "%", "time, s"} <= set(texts(torque.svg))
    assert {phase.name for phase in flown.phases} <= set(texts(torque.svg))
    assert "limit" in texts(next(panel for panel in panels if panel.name == "momentum").svg)


def test_the_same_series_gives_the_same_panel(flown):
    one = series.of(flown)["torque"]
    assert plots.svg(one, flown.phases, dark=True) == plots.svg(one, flown.phases, dark=True)


def test_left_and_right_are_where_the_times_are():
    """By the coordinates of a curve's ends."""
    one = made(np.linspace(1.0, 2.0, N))
    panel = plots.svg(one, dark=True)
    points = curves(panel.svg)
    assert (panel.start, panel.end) == (0.0, 20.0)
    assert points[0, 0] / 720.0 == pytest.approx(panel.left, abs=1e-4)
    assert points[-1, 0] / 720.0 == pytest.approx(panel.right, abs=1e-4)


def test_names_are_no_markup_and_no_mathematics():
    names = ("a $x^2$ b", "_hidden", "<b>&amp;", "bell\a", "手")
    shown = texts(plots.svg(made(np.ones((5, 5)), labels=names), dark=True).svg)
    assert {"a $x^2$ b", " _hidden", "<b>&amp;", "bell\\x07", "手"} <= set(shown)


def test_long_names_and_many_are_cut_to_their_room():
    labels = tuple(f"a_very_long_name_of_a_joint_of_the_right_arm_{k:02d}" for k in range(40))
    shown = texts(plots.svg(made(np.ones((5, 40)), labels=labels), dark=True).svg)
    assert "… and 13 more" in shown
    named = [text for text in shown if text.startswith("a_v")]
    assert len(named) == len(set(named)) == 27
    assert all("…" in text and len(text) < 20 for text in named)


def test_the_description_tells_the_peak():
    values = np.zeros((5, 2))
    values[3, 1] = -7.0
    described = plots.svg(made(values, labels=("up", "down")), dark=True).description
    assert described == "A title, from 0 s to 20 s. Largest of 2 curves: down, -7 mm at 15 s."
    assert "No values." in plots.describe(made(np.full((2, 1), np.nan)))


@pytest.mark.parametrize("values", [np.zeros(1), np.full(3, np.nan), np.zeros(3)])
@pytest.mark.parametrize("logarithmic", [False, True])
def test_curves_of_next_to_nothing(values, logarithmic):
    panel = plots.svg(made(values, logarithmic=logarithmic), dark=True)
    assert panel.end > panel.start


# -- figures -----------------------------------------------------------------------------------------------------


def axes_of(*arguments, **more):
    axes = Figure(figsize=(plots.WIDTH, plots.HEIGHT)).subplots()
    plots.draw(axes, *arguments, **more)
    return axes


def test_two_runs_are_solid_and_dashed():
    both = {"one": made(np.zeros((9, 2))), "two": made(np.ones((9, 3)))}
    axes = axes_of(both)
    drawn = [line for line in axes.lines if len(line.get_xdata())]
    assert [line.get_linestyle() for line in drawn] == ["-"] * 2 + ["--"] * 3
    assert [line.get_color() for line in drawn[:2]] == [line.get_color() for line in drawn[2:4]]
    named = [text.get_text() for text in axes.get_legend().get_texts()]
    assert named == ["one", "two", "curve 0", "curve 1", "curve 2"]


def test_one_curve_of_two_runs_differs_in_colour():
    axes = axes_of({"one": made(np.zeros(9)), "two": made(np.ones(9))})
    first, second = axes.lines
    assert first.get_color() != second.get_color()
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["one", "two"]


def test_twenty_four_curves_look_different():
    axes = axes_of(made(np.zeros((9, 24))))
    assert len({(line.get_color(), str(line._dash_pattern)) for line in axes.lines}) == 24


@pytest.mark.parametrize(("peak", "shown"), [(90.0, True), (3.0, False)])
def test_limits_are_drawn_where_values_come_near(peak, shown):
    axes = axes_of(made(np.linspace(0.0, peak, 9), limits=(-100.0, 100.0)))
    assert ("limit" in [text.get_text() for text in axes.get_legend().get_texts()]) == shown
    assert (axes.get_ylim()[1] > 100.0) == shown


def test_phases_are_shaded_and_named(flown):
    axes = axes_of(series.of(flown)["torque"], flown.phases)
    first, second, third = flown.phases
    bands = [patch.get_extents().transformed(axes.transData.inverted()) for patch in axes.patches]
    np.testing.assert_allclose([(band.x0, band.x1) for band in bands], [(0.0, first.end), (third.start, third.end)])
    assert [text.get_text() for text in axes.texts] == ["reach", "carry", "leave"]
    assert axes.texts[1].get_position()[0] == pytest.approx(0.5 * (second.start + second.end))


def test_a_figure_has_all_times_below_each_other(flown):
    found = list(series.of(flown).values())
    drawn = plots.figure(found, flown.phases)
    edges = {tuple(np.round(axes.get_position().intervalx, 12)) for axes in drawn.axes}
    assert len(drawn.axes) == len(found)
    assert len(edges) == 1


def test_plots_name_matplotlib_where_it_is_missing(monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(OspaceError, match=r"a plot needs Matplotlib: pip install .*\[visual\]"):
        plots.require()
