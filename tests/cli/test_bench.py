"""`ospace bench` as its users meet it: tables, a plot, JSON, and what it refuses."""

import json
import subprocess
import sys

import pytest

from ospace.cli.main import main


def called(program, *arguments):
    return subprocess.run(
        [sys.executable, "-c", program, *arguments], check=True, stdout=subprocess.PIPE, text=True, timeout=300
    ).stdout


def test_bench_prints_its_table_and_writes_plot_and_json(tmp_path):
    program = "import ospace.benchmark.scaling as g; g.SIZES = (12, 24); from ospace.cli.main import main; "
    program += "raise SystemExit(main())"
    path = tmp_path / "plot.svg"
    arguments = ["bench", "planar_2r", "--points", "1", "--seconds", "0.001", "--plot", str(path)]
    done = called(program, *arguments)
    for words in ("planar_2r", "pinocchio", "Γ_e⁻¹", "computeDelassusMatrix", "8192", "slope"):
        assert words in done
    assert path.read_text().startswith("<?xml")
    assert json.loads(called(program, *arguments[:6], "--json"))["growth"][0]["sizes"] == [12, 24]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["bench", "nowhere.urdf"], "nowhere.urdf"),
        (["bench", "chaser_24dof", "--points", "0"], "1 to 100"),
        (["bench", "chaser_24dof", "--points", "99"], "18 moving links"),
        (["bench", "target"], "0 moving links"),
        (["bench", "chaser_24dof", "--seconds", "nan"], "seconds"),
        (["bench", "chaser_24dof", "--plot", "x.doc"], ".svg"),
        (["bench", "chaser_24dof", "--plot", "nowhere/x.svg"], "no such folder"),
    ],
)
def test_bench_refuses_wrong_usage(capsys, arguments, words):
    try:
        status = main(arguments)
    except SystemExit as end:
        status = end.code
    assert status == 2
    assert words in capsys.readouterr().err


def test_without_matplotlib_the_message_says_what_to_install(capsys, monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    assert main(["bench", "chaser_24dof", "--plot", "x.svg"]) == 2
    assert "pip install -e '.[visual]'" in capsys.readouterr().err


def test_an_interrupt_ends_the_bench(monkeypatch, capsys):
    def interrupted(*arguments, **more):
        raise KeyboardInterrupt

    monkeypatch.setattr("ospace.benchmark.report.window_times", interrupted)
    assert main(["bench", "chaser_24dof", "--points", "1"]) == 130
    assert "interrupted" in capsys.readouterr().err
