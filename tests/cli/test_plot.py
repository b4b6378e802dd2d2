"""`ospace plot` as its users meet it."""

import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import missions
import numpy as np
import pytest

import ospace
from ospace.cli.main import main
from ospace.scenario import log, series

ROOT = Path(ospace.__file__).parents[1]
NAMES = "position-error, angle-error, joint-error, orientation, path, torque, momentum, energy, sigma-min, cycle-time"


@pytest.fixture(scope="module")
def logged(tmp_path_factory):
    """Return files of two runs of different tasks."""
    folder = tmp_path_factory.mktemp("logs")
    first = log.save(missions.flown(folder), folder / "first.npz")
    text = missions.MISSION.split('[[phase]]\nname = "carry"')[0].replace('"tip"', '"hand"')
    second = log.save(missions.flown(folder, text), folder / "second.npz")
    return first, second


@pytest.fixture
def plot(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def call(*arguments):
        try:
            status = main(["plot", *map(str, arguments)])
        except SystemExit as leaving:
            status = leaving.code
        return status, *capsys.readouterr()

    return call


def texts(file):
    return {"".join(one.itertext()) for one in ElementTree.parse(file).iter("{http://www.w3.org/2000/svg}text")}


def test_all_quantities_by_default(plot, logged, tmp_path):
    assert plot(logged[0]) == (0, f"first.svg: {NAMES}\n", "")
    shown = texts(tmp_path / "first.svg")
    curves = series.of(log.load(logged[0]))
    assert {one.title for one in curves.values()} <= shown
    assert {"reach", "carry", "leave", "joint_1", "tip", "look", "linear momentum"} <= shown
    assert [file.name for file in tmp_path.iterdir()] == ["first.svg"]


@pytest.mark.parametrize(("suffix", "begin"), [(".svg", b"<?xml"), (".png", b"\x89PNG"), (".pdf", b"%PDF")])
def test_a_plot_has_the_format_of_its_suffix(plot, logged, tmp_path, suffix, begin):
    out = tmp_path / f"out{suffix}"
    assert plot(logged[0], "--quantity", "torque", "--out", out) == (0, f"{out}: torque\n", "")
    assert out.read_bytes().startswith(begin)


def test_the_same_log_gives_the_same_file(plot, logged, tmp_path):
    for name in ("a.svg", "b.svg"):
        plot(logged[0], "--out", name)
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()


def test_given_quantities_alone_are_plotted(plot, logged, tmp_path):
    status, out, _ = plot(logged[0], "--quantity", "sigma-min", "--quantity", "path", "--quantity", "sigma-min")
    assert (status, out) == (0, "first.svg: sigma-min, path\n")
    shown = texts(tmp_path / "first.svg")
    assert {"σ_min of each task's generalized Jacobian", "end_effector x"} <= shown
    assert not any("Torque" in text for text in shown)


def test_two_runs_of_different_tasks(plot, logged, tmp_path):
    assert plot(*logged) == (0, f"first.svg: {NAMES}\n", "")
    assert {"first", "second", "tip", "hand", "base", "rest"} <= texts(tmp_path / "first.svg")
    plot(logged[1], logged[0], "--quantity", "joint-error", "--out", "one.svg")
    assert {"first", "rest"} & texts(tmp_path / "one.svg")


def test_two_runs_of_one_name(plot, logged, tmp_path):
    (tmp_path / "first.npz").write_bytes(logged[0].read_bytes())
    assert plot(logged[0], "first.npz", "--quantity", "torque")[0] == 0
    assert any(text.startswith("2: ") for text in texts(tmp_path / "first.svg"))


def test_an_existing_file_is_written_anew(plot, logged, tmp_path):
    (tmp_path / "out.svg").write_text("before")
    assert plot(logged[0], "--quantity", "path", "--out", "out.svg")[0] == 0
    assert "before" not in (tmp_path / "out.svg").read_text()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "required: LOG.npz"),
        (["nothing.npz"], "nothing.npz: no run can be read from it"),
        (["broken.npz"], "broken.npz: no run can be read from it"),
        (["other.npz"], "run the scenario again"),
        (["first.npz", "nothing.npz"], "nothing.npz"),
        (["first.npz", "first.npz", "first.npz"], "unrecognized arguments"),
        (["first.npz", "--quantity", "torqe"], "no quantity 'torqe'; did you mean 'torque'? There are position-error"),
        (["first.npz", "--quantity", "everything"], "no quantity 'everything'; there are position-error, angle-error"),
        (["first.npz", "--quantity", "momentum-error"], f"no momentum-error in first: there are {NAMES}"),
        (["first.npz", "--out", "x.doc"], "ends neither in .svg nor .png nor .pdf"),
        (["first.npz", "--out", "nowhere/x.svg"], "no such folder 'nowhere'"),
        (["first.npz", "--out", "folder.svg"], "is a folder"),
        (["log.svg"], "log.svg: is what is read, log.svg; give another file"),
        (["first.npz", "log.svg", "--out", "log.svg"], "log.svg: is what is read, log.svg"),
        (["first.npz", "--out", "link.svg"], "link.svg: is what is read, first.npz"),
    ],
)
def test_plot_refuses_wrong_usage(plot, logged, tmp_path, arguments, words):
    (tmp_path / "first.npz").write_bytes(logged[0].read_bytes())
    (tmp_path / "log.svg").write_bytes(logged[0].read_bytes())
    (tmp_path / "link.svg").symlink_to("first.npz")
    (tmp_path / "broken.npz").write_bytes(b"broken")
    np.savez(tmp_path / "other.npz", scenario="")
    (tmp_path / "folder.svg").mkdir()
    before = {file.name: file.stat().st_size for file in tmp_path.iterdir()}
    status, out, err = plot(*arguments)
    assert (status, out) == (2, "")
    assert words in err
    assert "Traceback" not in err
    assert {file.name: file.stat().st_size for file in tmp_path.iterdir()} == before


def test_a_log_with_an_array_that_fits_nothing(plot, logged, tmp_path):
    with np.load(logged[0]) as read:
        stored = {name: read[name] for name in read.files}
    for name, value, words in (
        ("segments/0/trajectory/time", stored["segments/0/trajectory/time"] * np.nan, "not finite, or decrease"),
        ("segments/0/trajectory/q", stored["segments/0/trajectory/q"][:, :5], "× 5, not"),
        ("phases/0/sigma_min/tip", stored["phases/0/sigma_min/tip"].reshape(-1, 1), "× 1, not"),
    ):
        np.savez(tmp_path / "odd.npz", **stored | {name: value})
        status, out, err = plot("odd.npz")
        assert (status, out) == (2, "")
        assert err.startswith(f"ospace: error: odd.npz: array '{name}' ")
        assert words in err
        assert [file.name for file in tmp_path.iterdir()] == ["odd.npz"]


def test_a_plot_that_fails_leaves_what_was_there(plot, logged, monkeypatch, tmp_path):
    """Also where it fails half way."""
    (tmp_path / "first.svg").write_text("before")

    def half(self, path, **options):
        Path(path).write_text("half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("matplotlib.figure.Figure.savefig", half)
    assert plot(logged[0])[0] == 2
    assert [file.name for file in tmp_path.iterdir()] == ["first.svg"]
    assert (tmp_path / "first.svg").read_text() == "before"


def test_a_run_that_ended_at_once(plot, logged, tmp_path):
    whole = log.load(logged[0])
    log.save(ospace.scenario.log.Log(**vars(whole) | {"phases": (), "segments": ()}), "empty.npz")
    status, _, err = plot("empty.npz")
    assert status == 2
    assert "empty: the run ended before anything could be plotted" in err


def test_without_matplotlib_the_message_says_what_to_install(plot, logged, monkeypatch, tmp_path):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    status, _, err = plot(logged[0])
    assert (status, err) == (2, "ospace: error: a plot needs Matplotlib: pip install -e '.[visual]'\n")
    assert list(tmp_path.iterdir()) == []


def test_an_interrupt_leaves_no_file(plot, logged, monkeypatch, tmp_path):
    def interrupted(*arguments, **more):
        raise KeyboardInterrupt

    monkeypatch.setattr("ospace.visual.plots.figure", interrupted)
    assert plot(logged[0])[0] == 130
    assert list(tmp_path.iterdir()) == []


def test_help_lists_the_quantities(plot, monkeypatch):
    monkeypatch.setenv("COLUMNS", "1000")
    assert ", ".join(series.TITLES) in plot("--help")[1]


def test_plot_runs_in_a_process_of_its_own(logged, tmp_path):
    done = subprocess.run(
        [sys.executable, "-W", "error", "-m", "ospace.cli", "plot", logged[0], "--out", tmp_path / "out.png"],
        cwd=ROOT, capture_output=True, text=True, timeout=120, check=False,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == f"{tmp_path / 'out.png'}: {NAMES}\n"
