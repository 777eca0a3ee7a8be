"""Matlab scripts and MAT files: against matrices by hand, the model's own responses, and Octave where it is installed."""

import re
import shutil
import subprocess

import numpy as np
import pytest
import scipy
from support.models import geared_line
from support.patience import PATIENCE

import torsionnet as tn
from torsionnet.base.errors import TorsionnetWarning, UsageError
from torsionnet.io import to_matlab, write_matlab

FREQUENCIES = np.array([1.3, 7.7, 33.0])
MODELS = ["amt_rig", "dmf_rig", "drill_string", "oil_engine", "planetary_set", "wind_turbine_5mw"]


def read_script(text):
    """Variables of a script: matrices and cell arrays of texts, by the grammar of Matlab as far as it is needed."""
    code = "\n".join(re.sub(r"%(?=(?:[^']*'[^']*')*[^']*$).*", "", line) for line in text.splitlines())
    code = code.replace("...\n", " ").split("if exist")[0]
    found = {}
    for name, value in re.findall(
        r"^([\w.]+) = ((?:[^;']|;(?!\s*$)|'(?:[^']|'')*')*?);\s*$", code, re.MULTILINE | re.DOTALL
    ):
        if value.startswith("{"):
            found[name] = [item.replace("''", "'") for item in re.findall(r"'((?:[^']|'')*)'", value)]
        elif value.startswith("'"):
            found[name] = value[1:-1].replace("''", "'")
        elif value.startswith("zeros"):
            found[name] = np.zeros([int(size) for size in re.findall(r"\d+", value)])
        elif value.startswith("full"):
            lists = [[float(cell) for cell in part.split()] for part in re.findall(r"\[([^\]]*)\]", value)]
            rows, columns = (int(size) for size in re.findall(r"(\d+), (\d+)\)\)$", value)[0])
            found[name] = np.zeros((rows, columns))
            for i, j, cell in zip(*lists, strict=True):
                found[name][int(i) - 1, int(j) - 1] = cell
        else:
            found[name] = np.array([[float(cell) for cell in row.split()] for row in value.strip("[]").split("\n")])
    return found


def responses(v, frequency):
    """Outputs over inputs from the equations of second order, and from the state space."""
    s = 2j * np.pi * frequency
    q = np.linalg.solve(v["M"] * s**2 + v["C"] * s + v["K"], v["F"])
    second = (v["Y0"] + v["Y1"] * s + v["Y2"] * s**2) @ q + v["Yu"]
    A, B, C, D = (v[f"state_space.{name}"] for name in "ABCD")
    return second, C @ np.linalg.solve(s * np.eye(len(A)) - A, B) + D


def test_matrices_of_the_dmf_rig_by_hand():
    v = read_script(to_matlab(tn.load("dmf_rig")))
    np.testing.assert_allclose(v["M"], np.diag([0.078, 0.152]))
    np.testing.assert_allclose(v["C"], [[0.1 + 0.3, -0.1], [-0.1, 0.1 + 4 + 0.3]])
    np.testing.assert_allclose(v["K"], [[13300, -13300], [-13300, 13300 + 460]])
    np.testing.assert_allclose(v["T"], [[1, 0], [0, 1], [0, 0]])
    np.testing.assert_allclose(v["F"], [[1], [0]])
    np.testing.assert_allclose(np.hstack([v["Y0"], v["Y1"]]), [[1, 0, 0, 0], [13300, -13300, 0.1, -0.1]])
    assert (v["coordinates"], v["inputs"], v["outputs"]) == (["motor", "primary"], ["T_M"], ["theta_1", "T_T"])
    assert (v["nodes"], v["output_units"]) == (["motor", "primary", "secondary"], ["rad", "N*m"])


def test_gear_reflects_what_is_behind_it():
    v = read_script(to_matlab(tn.load("amt_rig").configured("V")))
    tau = 3.26
    np.testing.assert_allclose(v["K"], [[460, -460], [-460, 460 + 12300 / tau**2]], rtol=1e-14)
    np.testing.assert_allclose(v["C"], [[4.3, -4], [-4, 4 + 1.5 + 170 / tau**2]], rtol=1e-14)
    np.testing.assert_allclose(v["T"][:, 1], [0, 0, 1, 1 / tau, 0], rtol=1e-14)


@pytest.mark.parametrize("name", MODELS)
def test_responses_are_those_of_the_model(name):
    rig = tn.load(name)
    v = read_script(to_matlab(rig))
    expected = rig.frequency_response(v["outputs"], v["inputs"], FREQUENCIES).values
    for frequency, values in zip(FREQUENCIES, expected, strict=True):
        for found in responses(v, frequency):
            np.testing.assert_allclose(found, values, rtol=1e-9, atol=1e-12 * np.abs(values).max())


@pytest.mark.parametrize("name", MODELS)
def test_mat_file_has_the_same_variables(tmp_path, name):
    write_matlab(tn.load(name), tmp_path / "m.mat")
    script, content = read_script(to_matlab(tn.load(name))), scipy.io.loadmat(tmp_path / "m.mat", simplify_cells=True)
    states = content.pop("state_space")
    content |= {f"state_space.{key}": value for key, value in states.items()}
    for key, value in script.items():
        if isinstance(value, np.ndarray):
            np.testing.assert_array_equal(np.asarray(content[key]).reshape(value.shape), value)
        elif isinstance(value, str):
            assert content[key] == value
        else:
            assert list(np.atleast_1d(content[key])) == value
    assert set(script) == {key for key in content if not key.startswith("__")}


def test_large_matrices_are_written_sparse():
    parts = [tn.Inertia(f"j{i}", node=f"n{i}", inertia=0.1 * (i + 1)) for i in range(40)]
    parts += [tn.Spring(f"k{i}", nodes=(f"n{i}", f"n{i + 1}"), stiffness=1e3 + i / 3) for i in range(39)]
    chain = tn.Drivetrain("chain", parts, inputs={"T": {"torque": "n0"}}, sensors={"y": {"angle": "n39"}})
    text = to_matlab(chain)
    assert max(len(line) for line in text.splitlines()) < 3000
    v = read_script(text)
    np.testing.assert_allclose(np.diag(v["M"]), 0.1 * np.arange(1, 41))
    np.testing.assert_array_equal(v["K"], chain.assembly.system.K)


def test_model_without_inputs_and_sensors():
    v = read_script(to_matlab(tn.Drivetrain("x", [tn.Inertia("i", node="a", inertia=2)])))
    assert (v["inputs"], v["outputs"], v["F"].shape, v["Y0"].shape) == ([], [], (1, 0), (0, 1))
    np.testing.assert_array_equal(v["state_space.A"], [[0, 1], [0, 0]])


def test_texts_are_quoted():
    parts = [tn.Inertia("i", node="a", inertia=2)]
    rig = tn.Drivetrain("it's\n1 % more", parts, source="a\nb", description="x\ny")
    text = to_matlab(rig)
    assert read_script(text)["title"] == "it's 1 % more"
    assert text.splitlines()[:3] == ["% it's 1 % more", "% source: a b", "% x y"]


def test_same_model_same_bytes(tmp_path):
    for name in ("a.mat", "b.mat"):
        write_matlab(tn.load("amt_rig"), tmp_path / name)
    content = (tmp_path / "a.mat").read_bytes()
    assert content == (tmp_path / "b.mat").read_bytes()
    assert content[:116].strip() == b"MATLAB 5.0 MAT-file, torsionnet"  # and not the date


def test_a_reading_with_the_rate_of_an_input_has_no_state_space():
    rig = tn.Drivetrain(
        "x", [tn.Damper("d", nodes=("a", "ground"), damping=2), tn.Spring("s", nodes=("a", "b"), stiffness=5),
              tn.Inertia("i", node="b", inertia=1)],
        inputs={"T": {"torque": "a"}}, sensors={"acc": {"acceleration": "a"}},
    )  # fmt: skip
    with pytest.warns(TorsionnetWarning, match="state space: acc"):
        text = to_matlab(rig)
    assert "% no state space: acc contains the rate of change" in text
    v = read_script(text)
    s = 2j * np.pi * 3
    found = (v["Y2"] * s**2) @ np.linalg.solve(v["M"] * s**2 + v["C"] * s + v["K"], v["F"])
    np.testing.assert_allclose(found, rig.frequency_response("acc", "T", [3.0]).values[0], rtol=1e-12)


@pytest.mark.parametrize(
    ("rig", "text"),
    [
        (lambda: tn.load("six_cylinder_diesel").configured("viscous_and_hysteretic"), "depends on frequency"),
        (
            lambda: tn.Drivetrain("x", [tn.Inertia("i", node="a", inertia=2)], inputs={"phi": {"angle": "a"}}),
            "phi imposes an angle",
        ),
    ],
)
def test_refusals(rig, text):
    with pytest.raises(UsageError, match=text):
        to_matlab(rig())


@pytest.mark.parametrize("name", ["2nd.m", "a-b.m", "x.txt", "x"])
def test_names_of_files(tmp_path, name):
    with pytest.raises(UsageError):
        write_matlab(tn.load("dmf_rig"), tmp_path / name)
    assert list(tmp_path.iterdir()) == []


OCTAVE = """
cd {folder};
rig
f = [{frequencies}];
H = zeros(numel(f), numel(outputs), numel(inputs));
G = H;
for n = 1:numel(f)
    s = 2i*pi*f(n);
    H(n, :, :) = (Y0 + Y1*s + Y2*s^2)*((M*s^2 + C*s + K)\\F) + Yu;
    G(n, :, :) = state_space.C*((s*eye(size(state_space.A)) - state_space.A)\\state_space.B) + state_space.D;
end
w = load('rig.mat');
same = isequal(w.M, M) && isequal(w.C, C) && isequal(w.K, K) && isequal(w.T, T) && isequal(w.outputs(:), outputs(:)) ...
    && isequal(w.nodes(:), nodes(:)) && isequal(w.state_space.A, state_space.A) && isequal(w.title, title);
save('-v6', 'out.mat', 'H', 'G', 'same');
"""


@pytest.mark.skipif(not shutil.which("octave-cli"), reason="Octave is not installed")
@pytest.mark.parametrize("name", ["amt_rig", "planetary_set", "drill_string"])
def test_octave_runs_the_script(tmp_path, name):
    rig = tn.load(name)
    write_matlab(rig, tmp_path / "rig.m")
    write_matlab(rig, tmp_path / "rig.mat")
    frequencies = " ".join(map(str, FREQUENCIES))
    (tmp_path / "run.m").write_text(OCTAVE.format(folder=tmp_path, frequencies=frequencies))
    subprocess.run(
        ["octave-cli", "--quiet", str(tmp_path / "run.m")], check=False, capture_output=True, timeout=PATIENCE
    )
    out = scipy.io.loadmat(tmp_path / "out.mat")
    expected = rig.frequency_response(list(rig.sensors), list(rig.inputs), FREQUENCIES).values
    assert out["same"].all()
    for found in (out["H"], out["G"]):
        np.testing.assert_allclose(found.reshape(expected.shape), expected, atol=1e-10 * np.abs(expected).max())


def test_one_example_of_the_whole():
    text = to_matlab(geared_line())
    assert "coordinates = {'m', 'g'};  % q" in text
    assert "    sys = ss(state_space.A, state_space.B, state_space.C, state_space.D, 'InputName', inputs, " in text


@pytest.mark.parametrize(("name", "why"), [("for", "a word of Matlab"), ("K", "a variable that the script sets")])
def test_names_that_a_script_cannot_have(tmp_path, name, why):
    with pytest.raises(UsageError, match=f"{name} is {why}.*; e.g. {name}_model.m"):
        write_matlab(tn.load("dmf_rig"), tmp_path / f"{name}.m")
    assert not list(tmp_path.iterdir())
