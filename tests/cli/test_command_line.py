"""What all verbs have in common: help, corrections, ``-`` for standard input and output, completion."""

import io
import json
import os
import subprocess
import sys
from pathlib import Path

import missions
import numpy as np
import pytest

import ospace
from ospace import models
from ospace.cli import plot
from ospace.cli.main import main, parser, verbs_of
from ospace.scenario import series

VERBS = verbs_of(parser())
DOCS = Path(ospace.__file__).parents[1] / "docs"
XACRO = b"""<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arg name="m" default="1"/>
  <link name="b"><inertial><mass value="$(arg m)"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>
  </inertial></link></robot>"""
VISUAL = b"<visual><geometry><mesh filename='a.stl'/></geometry></visual></link>"


@pytest.fixture
def call(capfdbinary, monkeypatch):
    """Return what a command leaves: its status, standard output, standard error."""

    def run(*arguments, given=None):
        if given is not None:
            monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(given)))
        try:
            status = main([*map(str, arguments)])
        except SystemExit as end:
            status = end.code
        out, err = capfdbinary.readouterr()
        kept = [line for line in err.decode().splitlines(True) if "compiling" not in line]
        return status, out, "".join(kept)

    return run


def urdf(name):
    return models.path(name).read_bytes()


# -- help ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("verb", VERBS)
def test_help_has_examples_and_the_address_of_a_page_that_is_there(call, verb, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    status, out, _ = call(verb, "--help")
    lines = out.decode().splitlines()
    assert status == 0
    assert max(map(len, lines)) <= 80
    assert f"  ospace {verb}" in "\n".join(lines[lines.index("examples:") :])
    address = lines[-1].removeprefix("More: ")
    assert address.startswith(ospace.DOCUMENTATION)
    assert (DOCS / Path(address).name).with_suffix(".md").is_file()


def test_without_a_word_the_help_is_printed(call):
    status, out, err = call()
    assert (status, err) == (0, "")
    assert out.startswith(b"usage: ospace")
    assert call("--help")[1] == out


def test_the_package_is_the_command():
    done = subprocess.run([sys.executable, "-m", "ospace", "-V"], capture_output=True, text=True, check=True)
    assert done.stdout == f"ospace {ospace.__version__}\n"


def test_help_loads_neither_numpy_nor_pinocchio():
    """They take seconds where plot's help takes a tenth of one."""
    program = "import sys; from ospace.cli.main import main\ntry: main(['plot', '--help'])\nexcept SystemExit: pass\n"
    program += "print(*{'numpy', 'pinocchio', 'numba', 'rich'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == ""


def test_quantities_of_the_help_are_those_that_are_plotted():
    assert tuple(series.TITLES) == plot.QUANTITIES


# -- corrections ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["chek"], "no verb 'chek'; did you mean 'check'?"),
        (["\x1b[2J"], "no verb '\\x1b[2J'"),
        (["check", "planar_2r", "--sample", "3"], "unrecognized arguments: --sample 3; did you mean '--samples'"),
        (["run", "grasp", "--head"], "unrecognized arguments: --head"),
        (["compose", "planar_2r", "--o", "x.urdf"], "required: --out"),
        (["bench", "planar_2r", "target"], "unrecognized arguments: target"),
    ],
)
def test_what_is_unknown_or_abbreviated_is_refused_and_corrected(call, words, said):
    status, out, err = call(*words)
    assert (status, out) == (2, b"")
    assert said in err
    assert "\x1b" not in err


# -- standard input and output -----------------------------------------------------------------------------------


def test_a_urdf_is_read_from_standard_input(call):
    status, out, err = call("check", "-", "--frames", given=urdf("ets_vii"))
    assert (status, err) == (0, "")
    assert out.decode().splitlines()[-1] == "read: standard input: 0 errors, 0 warnings"


def test_a_xacro_is_known_by_its_content(call):
    assert b"b (7), the base" in call("check", "-", "--frames", "m:=7", given=XACRO)[1]


def test_faults_of_standard_input_are_called_so(call):
    status, out, err = call("check", "-", given=b"<robot")
    assert (status, out) == (2, b"")
    assert err.startswith("ospace: error: standard input: line 1:")
    assert "given twice" in call("check", "-", "-", "--frames", given=urdf("target"))[2]
    assert "given twice" in call("view", "planar_2r", "--html", "-", "--screenshot", "-")[2]


def test_a_composed_robot_goes_to_standard_output_with_paths_from_here(call, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("meshes").mkdir()
    Path("meshes/a.stl").write_bytes(b"")
    Path("meshes/arm.urdf").write_bytes(urdf("planar_2r").replace(b"</link>", VISUAL, 1))
    status, out, err = call("compose", "-", "meshes/arm.urdf", "--prefix", "a_", "--out", "-", given=urdf("ets_vii"))
    assert status == 0
    assert b'filename="meshes/a.stl"' in out
    assert out.startswith(b"<?xml")
    assert "wrote standard output: 0 errors" in err
    assert [file.name for file in tmp_path.iterdir()] == ["meshes"]


def test_a_log_goes_through_a_pipe(call, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    status, npz, err = call("run", "-", "--log", "-", "--headless", given=missions.SHORT.encode())
    assert status == 0
    assert "passed: standard input" in err
    assert "torque" in str(list(np.load(io.BytesIO(npz), allow_pickle=False).files))
    status, svg, err = call("plot", "-", "--out", "-", "--quantity", "torque", given=npz)
    assert (status, err) == (0, "standard output: torque\n")
    assert svg.startswith(b"<?xml")
    assert list(tmp_path.iterdir()) == []


def test_a_repaired_file_goes_to_standard_output(call, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    broken = urdf("planar_2r").replace(b'<limit lower="-2.9671" upper="2.9671" effort="20" velocity="1"/>', b"", 1)
    assert broken != urdf("planar_2r")
    status, out, err = call("check", "-", "--fix", "-", given=broken)
    assert status == 0
    assert b"<limit" in out
    assert "wrote standard output: 1 change" in err
    assert list(tmp_path.iterdir()) == []


# -- several files ---------------------------------------------------------------------------------------------------


def test_several_files_are_checked_and_the_worst_status_is_that_of_all(call):
    status, out, err = call("check", "planar_2r", "nowhere.urdf", "target", "--frames")
    assert status == 2
    assert "nowhere.urdf" in err
    lines = out.decode().splitlines()
    assert [line for line in lines if line.startswith("read: ")] == [
        "read: planar_2r: 0 errors, 0 warnings",
        "read: target: 0 errors, 0 warnings",
    ]
    assert lines[-1] == "2 of 3 files without errors"


def test_several_files_are_a_list_in_json(call):
    status, out, _ = call("check", "planar_2r", "target", "--frames", "--json")
    assert status == 0
    assert [one["robot"] for one in json.loads(out)] == ["planar_2r", "target"]


@pytest.mark.parametrize("option", ["--html", "--fix"])
def test_one_output_is_not_for_several_files(call, option):
    status, _, err = call("check", "planar_2r", "target", option, "x.html")
    assert status == 2
    assert f"{option} writes one file" in err


# -- completion ------------------------------------------------------------------------------------------------------


def completed(script, words):
    """Return what bash offers for the last of the words."""
    program = f"""source {script}; COMP_WORDS=({words}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)); COMP_TYPE=9
    $(complete -p ospace | sed 's/.*-F \\([^ ]*\\) .*/\\1/') ospace "${{COMP_WORDS[-1]}}" ospace
    echo "${{COMPREPLY[@]}}" """
    done = subprocess.run(["bash", "-c", program], capture_output=True, text=True, env=os.environ, check=False)
    return done.stdout.split()


def test_bash_completes_verbs_and_options(call, tmp_path):
    script = tmp_path / "ospace.bash"
    script.write_bytes(call("completion", "bash")[1])
    assert completed(script, "ospace che") == ["check"]
    assert completed(script, "ospace check --sam") == ["--samples"]


@pytest.mark.parametrize("shell", ["zsh", "tcsh"])
def test_other_shells_get_a_script(call, shell):
    status, out, _ = call("completion", shell)
    assert status == 0
    assert b"samples" in out
