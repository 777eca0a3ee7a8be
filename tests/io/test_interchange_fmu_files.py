"""Functional mock-up units as files: their descriptions, sources, binaries and refusals; and a host without Python."""

import importlib.util
import re
import shutil
import subprocess
import zipfile
from pathlib import Path

import numpy as np
import pytest
from support.collecting import OnDemand
from support.fmu_hosts import VERSIONS, Host, fmpy, library_model, unpacked
from support.patience import PATIENCE

import torsionnet as tn
from torsionnet.base.errors import MissingExtraError, UsageError
from torsionnet.io import write_fmu
from torsionnet.io.fmu import c_source as compiling
from torsionnet.io.fmu.c_source import universal_binary
from torsionnet.signals.formats import extras

validation = OnDemand("fmpy.validation")
compiler = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
needs_compiler = pytest.mark.skipif(compiler is None, reason="no C compiler")
LATEST_FIRST = ["3.0", pytest.param("2.0", marks=pytest.mark.slow)]
STRICT = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-Wno-unused-parameter"]


def one_mass(**changes):
    parts = [
        tn.Inertia("i", node="a", inertia="J"), tn.Spring("s", nodes=("a", "ground"), stiffness="k", damping="c"),
    ]  # fmt: skip
    parameters = {"J": "2 kg*m^2", "k": 800, "c": 12} | changes
    return tn.Drivetrain("one mass", parts, parameters, inputs={"T": {"torque": "a"}}, sensors={"phi": {"angle": "a"}})


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize(("name", "configuration"), [("drill_string", ""), ("amt_rig", "V"), ("planetary_set", "")])
def test_fmpy_finds_no_fault_in_it(version, name, configuration):
    path, _ = unpacked(library_model(name, configuration), version)
    assert validation.validate_fmu(str(path)) == []


@pytest.mark.parametrize("version", VERSIONS)
def test_description(version):
    path, _ = unpacked(library_model("drill_string"), version)
    about = fmpy.read_model_description(str(path))
    assert (about.fmiVersion, about.modelName) == (version, "Drill string")
    assert about.coSimulation.modelIdentifier == about.modelExchange.modelIdentifier == "Drill_string"
    assert float(about.defaultExperiment.stepSize) == 1e-3
    units = {v.name: v.unit for v in about.modelVariables if v.causality in ("input", "output")}
    assert units == {
        "T_T": "N.m", "T_B": "N.m", "table_speed": "rad/s", "bit_speed": "rad/s", "pipe_torque": "N.m",
        "pipe_twist": "rad",
    }  # fmt: skip
    rig = library_model("drill_string")
    values = {v.name: float(v.start) for v in about.modelVariables if v.causality == "parameter" and v.start != "true"}
    assert values == {name: rig.parameters[name] for name in values}
    derived = {v.name for v in about.modelVariables if v.causality == "calculatedParameter"}
    assert values.keys() | derived == set(rig.parameters)


def test_direct_ways_from_inputs_to_outputs_are_named():
    """Hosts read from the structure which outputs jump with which inputs: here the two torques at the fixed end."""
    parts = [
        tn.Inertia("i", node="a", inertia=2), tn.Spring("s", nodes=("a", "b"), stiffness=5, damping=1),
        tn.Lock("wall", node="b"), tn.Inertia("end", node="b", inertia=1),
    ]  # fmt: skip
    sensors = {
        "angle": {"angle": "a"}, "speed": {"velocity": "a"}, "acceleration": {"acceleration": "a"},
        "spring": {"torque": "s"},
    }  # fmt: skip
    model = tn.Drivetrain("ways", parts, inputs={"T": {"torque": "a"}}, sensors=sensors)
    about = fmpy.read_model_description(str(unpacked(model)[0]))
    takes = {entry.variable.name: {v.name for v in entry.dependencies} for entry in about.outputs}
    assert takes == {
        "angle": {"angle(a)"},
        "speed": {"speed(a)"},
        "acceleration": {"T", "angle(a)", "speed(a)"},
        "spring": {"angle(a)", "speed(a)"},
    }


def test_what_the_structure_rests_on_cannot_be_changed():
    """A gear loop closes for these ratios only, and a damper of zero is none; the stiffness stays open."""
    parts = [
        tn.Inertia("i", node="a", inertia=1), tn.Gear("g1", nodes=("a", "b"), ratio="t_1"),
        tn.Gear("g2", nodes=("b", "c"), ratio="t_2"), tn.Gear("g3", nodes=("a", "c"), ratio="t_3"),
        tn.Spring("s", nodes=("c", "ground"), stiffness="k"), tn.Damper("d", nodes=("b", "ground"), damping="c"),
    ]  # fmt: skip
    parameters = {"t_1": 2, "t_2": 3, "t_3": 6, "k": 50, "c": 0}
    model = tn.Drivetrain("loop", parts, parameters, inputs={"T": {"torque": "a"}}, sensors={"phi": {"angle": "a"}})
    about = fmpy.read_model_description(str(unpacked(model)[0]))
    found = {v.name: v.variability for v in about.modelVariables if v.name in parameters}
    assert found == {"t_1": "constant", "t_2": "constant", "t_3": "constant", "c": "constant", "k": "fixed"}


def test_parallel_paths_of_one_ratio_leave_it_open():
    """Two gear stages of one parameter close their loop whatever its value."""
    parts = [
        tn.Inertia("i", node="a", inertia=1), tn.Gear("g1", nodes=("a", "b"), ratio="t"),
        tn.Gear("g2", nodes=("a", "c"), ratio="t"), tn.RigidCoupling("r", nodes=("b", "c")),
        tn.Spring("s", nodes=("c", "ground"), stiffness="k"),
    ]  # fmt: skip
    model = tn.Drivetrain(
        "two", parts, {"t": 2, "k": 50}, inputs={"T": {"torque": "a"}}, sensors={"phi": {"angle": "a"}}
    )
    host = Host(model).start(t=3.0, T=1.0)
    for number in range(400):
        host.step(number * 0.05, 0.05)
    record = model.configured(t=3).simulate("phi", {"T": np.ones(401)}, 20)
    assert host.get()[0] == pytest.approx(record["phi"].values[-1], rel=1e-9)


@pytest.mark.parametrize("version", VERSIONS)
def test_faults_are_told_and_nothing_ends(version):
    rig = library_model("dmf_rig")
    host = Host(rig, version)
    with pytest.raises(Exception, match=r"(?i)error|failed|status"):
        host.step(0.0, 1e-3)
    assert host.messages[-1] == (3, "a step is not allowed at this point")
    host.start()
    for values, text in (
        ({"k_1": 1.0}, "cannot be set after the initialization"),
        ({"theta_1": 1.0}, "cannot be set"),
        ({"T_M": float("nan")}, "not finite"),
        ({"extrapolate_inputs": False}, "fixed parameter is not allowed"),
    ):
        with pytest.raises(Exception, match=r"(?i)error|failed|status"):
            host.set(values)
        assert text in host.messages[-1][1]
    with pytest.raises(Exception, match=r"(?i)error|failed|status"):
        host.step(0.0, -1e-3)
    assert "a size of at least 0" in host.messages[-1][1]
    host.step(0.0, 1e-3)


@pytest.mark.parametrize("version", VERSIONS)
def test_impossible_parameters_are_told(version):
    host = Host(library_model("dmf_rig"), version)
    with pytest.raises(Exception, match=r"(?i)error|failed|status"):
        host.start(I_1=0.0)
    assert host.messages[-1] == (3, "these parameters leave a node without inertia")


@pytest.mark.parametrize("version", VERSIONS)
def test_another_token_is_refused(version):
    with pytest.raises(Exception, match="instantiate"):
        Host(library_model("dmf_rig"), version, token="{0}")


def test_states_beyond_numbers_are_told():
    model = one_mass(c=12)
    host = Host(model).start(c=-1e6)
    host.set({"T": 1.0})
    with pytest.raises(Exception, match="error"):
        host.run(np.arange(100.0), np.ones((100, 1)))
    assert re.search("beyond numbers|no matrix exponential", host.messages[-1][1])


@pytest.mark.slow
@pytest.mark.parametrize("version", LATEST_FIRST)
def test_equal_models_give_equal_bytes_and_others_do_not(tmp_path, version):
    for name, value in (("a", 460), ("b", 460), ("c", 461)):
        write_fmu(tn.load("dmf_rig").configured(k_2=value), tmp_path / f"{name}.fmu", version=version)
    a, b, c = ((tmp_path / f"{name}.fmu").read_bytes() for name in "abc")
    assert a == b
    guids = {fmpy.read_model_description(str(tmp_path / f"{name}.fmu")).guid for name in "abc"}
    assert len(guids) == 2
    assert c != a
    with zipfile.ZipFile(tmp_path / "a.fmu") as archive:
        assert {entry.date_time[0] for entry in archive.infolist()} == {1980}
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.fmu", "b.fmu", "c.fmu"]


@needs_compiler
@pytest.mark.parametrize("version", VERSIONS)
def test_sources_have_no_warnings(version, tmp_path):
    _, folder = unpacked(library_model("planetary_set"), version)
    call = [compiler, *STRICT, "-c", "all.c", "-o", str(tmp_path / "all.o")]
    done = subprocess.run(call, cwd=f"{folder}/sources", capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


@needs_compiler
@pytest.mark.parametrize("version", VERSIONS)
def test_functions_are_those_of_the_standard(version, tmp_path):
    """Compiled against its own headers, which FMPy brings along, instead of the types written here."""
    _, folder = unpacked(library_model("dmf_rig"), version)
    number = version[0]
    unit = Path(folder, "sources", "all.c").read_text(encoding="utf-8")
    official = unit.replace(f'"fmi{number}.h"', f'"fmi{number}Functions.h"')
    assert official != unit
    (tmp_path / "official.c").write_text(official)
    headers = Path(importlib.util.find_spec("fmpy").origin).parent / "c-code"
    call = [compiler, "-std=c99", "-Wall", "-Werror", f"-I{headers}", f"-I{folder}/sources", "-c", "official.c"]
    done = subprocess.run(call, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


@needs_compiler
@pytest.mark.skipif(shutil.which("nm") is None, reason="no nm")
@pytest.mark.parametrize("version", VERSIONS)
def test_nothing_but_the_interface_is_visible_and_all_of_it(version):
    _, folder = unpacked(library_model("dmf_rig"), version)
    here = fmpy.platform if version[0] == "2" else fmpy.platform_tuple
    library = next(Path(folder, "binaries", here).iterdir())
    listed = subprocess.run(["nm", "-D", "--defined-only", library], capture_output=True, text=True, check=True).stdout
    header = Path(importlib.util.find_spec("fmpy").origin).parent / "c-code" / f"fmi{version[0]}Functions.h"
    expected = set(re.findall(rf"FMI{version[0]}_Export +\w+ +(fmi\w+);", header.read_text()))
    assert {line.split()[-1] for line in listed.splitlines()} == expected


HOST = """
#include <dlfcn.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include "fmi2.h"
static void log_(void *e, fmi2String n, fmi2Status s, fmi2String c, fmi2String m, ...) { (void)e, (void)n, (void)c; printf("%d %s\\n", s, m); }
int main(int count, char **words)
{
    void *library = dlopen(words[1], RTLD_NOW | RTLD_LOCAL);
    if (count < 4 || !library) return puts(dlerror()), 2;
#define GET(type, name, ...) type (*name)(__VA_ARGS__) = (type (*)(__VA_ARGS__))dlsym(library, "fmi2" #name)
    GET(void *, Instantiate, fmi2String, fmi2Type, fmi2String, fmi2String, const fmi2CallbackFunctions *, int, int);
    GET(int, SetupExperiment, void *, int, double, double, int, double);
    GET(int, EnterInitializationMode, void *);
    GET(int, ExitInitializationMode, void *);
    GET(int, SetReal, void *, const unsigned *, size_t, const double *);
    GET(int, GetReal, void *, const unsigned *, size_t, double *);
    GET(int, DoStep, void *, double, double, int);
    GET(void, FreeInstance, void *);
    fmi2CallbackFunctions functions = {log_, calloc, free, NULL, NULL};
    void *unit = Instantiate("c", fmi2CoSimulation, words[2], "", &functions, 0, 0);
    const unsigned input = 1, output = 2;
    double torque = 10, angle, h = atof(words[3]);
    SetupExperiment(unit, 0, 0, 0, 0, 0);
    EnterInitializationMode(unit);
    SetReal(unit, &input, 1, &torque);
    ExitInitializationMode(unit);
    for (int i = 0; i < 500; i++) {
        DoStep(unit, i * h, h, 1);
        GetReal(unit, &output, 1, &angle);
        printf("%.17g\\n", angle);
    }
    DoStep(unit, 0, -1, 1);
    FreeInstance(unit);
    return 0;
}
"""


@needs_compiler
@pytest.mark.skipif(importlib.util.find_spec("fcntl") is None, reason="dlopen")
def test_a_host_in_c_needs_no_python(tmp_path):
    rig = library_model("dmf_rig")
    path, folder = unpacked(rig)
    (tmp_path / "host.c").write_text(HOST)
    subprocess.run(
        [compiler, "-w", f"-I{folder}/sources", "host.c", "-o", "host", "-ldl"],
        cwd=tmp_path,
        check=True,
        timeout=PATIENCE,
    )
    library = next(Path(folder, "binaries").glob("*/*"))
    token = fmpy.read_model_description(str(path)).guid
    said = subprocess.run(
        [tmp_path / "host", library, token, "1e-3"],
        capture_output=True,
        text=True,
        check=True,
        env={},
        timeout=PATIENCE,
    ).stdout.splitlines()
    expected = rig.simulate("theta_1", {"T_M": np.full(501, 10.0)}, 1e3)["theta_1"].values[1:]
    np.testing.assert_allclose([float(line) for line in said[:500]], expected, rtol=1e-10)
    assert said[500] == "3 a step goes from a time by a size of at least 0, not from 0 by -1"


@pytest.mark.slow
@needs_compiler
def test_sources_of_two_units_in_one_program(tmp_path):
    """Static builds define a prefix for each; nothing else has a name outside its own unit."""
    call = [compiler, "-w", "-o", "both", "main.c"]
    calls = []
    for number, name in enumerate(("dmf_rig", "drill_string")):
        _, folder = unpacked(library_model(name))
        subprocess.run(
            [compiler, "-w", "-c", f"-DFMI2_FUNCTION_PREFIX=unit{number}_", f"{folder}/sources/all.c", "-o", f"{number}.o"],
            cwd=tmp_path, check=True, timeout=PATIENCE,
        )  # fmt: skip
        calls.append(f"extern const char *unit{number}_fmi2GetVersion(void);")
    (tmp_path / "main.c").write_text(
        "#include <stdio.h>\n" + "\n".join(calls)
        + '\nint main(void) { return printf("%s %s", unit0_fmi2GetVersion(), unit1_fmi2GetVersion()) < 0; }\n'
    )  # fmt: skip
    subprocess.run([*call, "0.o", "1.o", "-lm"], cwd=tmp_path, check=True, timeout=PATIENCE)
    said = subprocess.run([tmp_path / "both"], capture_output=True, text=True, check=True, timeout=PATIENCE).stdout
    assert said == "2.0 2.0"


@pytest.mark.parametrize(
    ("rig", "name", "options", "text"),
    [
        (one_mass, "rig.zip", {}, "ending in .fmu"),
        (one_mass, "rig.fmu", {"step": 0}, "positive time in s"),
        (one_mass, "rig.fmu", {"step": float("nan")}, "positive time in s"),
        (one_mass, "rig.fmu", {"version": "1.0"}, r"(?s)2\.0.*3\.0.*unknown-word"),
        (lambda: tn.Drivetrain("x", [tn.Inertia("i", node="a", inertia=2)]), "rig.fmu", {}, "missing-entry"),
        (
            lambda: tn.load("six_cylinder_diesel").configured("viscous_and_hysteretic"),
            "rig.fmu", {}, "depends on frequency",
        ),
        (
            lambda: tn.Drivetrain(
                "driven", [tn.Inertia("i", node="b", inertia=1), tn.Spring("s", nodes=("a", "b"), stiffness=5)],
                inputs={"phi": {"angle": "a"}}, sensors={"b": {"angle": "b"}},
            ),
            "rig.fmu", {}, "no-counterpart",
        ),
        (
            lambda: tn.Drivetrain(
                "loose", [tn.Damper("d", nodes=("a", "ground"), damping=3), tn.Spring("s", nodes=("a", "b"), stiffness=5)],
                inputs={"T": {"torque": "b"}}, sensors={"rate": {"velocity": "b"}},
            ),
            "rig.fmu", {}, "unsupported-law",
        ),
        (
            lambda: tn.Drivetrain(
                "long", [
                    tn.Shaft("s", nodes=("a", "b"), outer_diameter=0.05, length=1, segments=500),
                    tn.Inertia("i", node="a", inertia=1),
                ],
                inputs={"T": {"torque": "a"}}, sensors={"b": {"angle": "b"}},
            ),
            "rig.fmu", {}, "501 coordinates",
        ),
    ],
)  # fmt: skip
def test_refusals(tmp_path, rig, name, options, text):
    with pytest.raises(UsageError, match=text):
        write_fmu(rig(), tmp_path / name, **options)
    assert list(tmp_path.iterdir()) == []


def test_without_any_compiler_the_command_is_named(tmp_path, monkeypatch):
    monkeypatch.setitem(extras.EXTRA_PACKAGES, "fmu", ("no_such_module", "ziglang", "FMU"))
    monkeypatch.setattr(compiling, "COMPILERS", ())
    monkeypatch.delenv("CC", raising=False)
    with pytest.raises(MissingExtraError, match="missing-package"):
        write_fmu(one_mass(), tmp_path / "rig.fmu")
    assert list(tmp_path.iterdir()) == []


@needs_compiler
def test_a_compiler_that_fails_is_quoted(tmp_path, monkeypatch):
    monkeypatch.setitem(extras.EXTRA_PACKAGES, "fmu", ("no_such_module", "ziglang", "FMU"))
    monkeypatch.setattr(compiling, "FLAGS", ("-no-such-flag",))
    with pytest.raises(compiling.CompilerError, match="no-such-flag"):
        write_fmu(one_mass(), tmp_path / "rig.fmu")
    assert list(tmp_path.iterdir()) == []


def test_one_library_for_all_macs():
    """The header of such a file: 0xcafebabe, a count, then processor, offset and size of each."""
    made = universal_binary({"x86_64": b"first", "aarch64": b"the second"})
    words = np.frombuffer(made[:48], ">u4")
    assert words[:2].tolist() == [0xCAFEBABE, 2]
    assert words[2::5][:2].tolist() == [0x01000007, 0x0100000C]
    for name, (start, size) in zip(
        (b"first", b"the second"), ((words[4], words[5]), (words[9], words[10])), strict=True
    ):
        assert start % 0x4000 == 0
        assert made[start : start + size] == name


@pytest.mark.slow
@pytest.mark.skipif(importlib.util.find_spec("ziglang") is None, reason="ziglang is not installed")
@pytest.mark.parametrize("version", VERSIONS)
def test_binaries_for_every_platform(tmp_path, version):
    platforms = write_fmu(one_mass(), tmp_path / "rig.fmu", version=version)
    assert len(platforms) == (4 if version == "2.0" else 5)
    with zipfile.ZipFile(tmp_path / "rig.fmu") as archive:
        heads = {name.split("/")[1]: archive.read(name)[:20] for name in archive.namelist() if "binaries" in name}
    magic = {
        "linux64": b"\x7fELF", "x86_64-linux": b"\x7fELF", "aarch64-linux": b"\x7fELF", "win64": b"MZ",
        "x86_64-windows": b"MZ", "darwin64": b"\xca\xfe\xba\xbe", "x86_64-darwin": b"\xcf\xfa\xed\xfe",
        "aarch64-darwin": b"\xcf\xfa\xed\xfe",
    }  # fmt: skip
    assert all(head.startswith(magic[folder]) for folder, head in heads.items())
    assert heads["aarch64-linux"][18] == 183  # EM_AARCH64
    result = fmpy.simulate_fmu(str(tmp_path / "rig.fmu"), stop_time=1.0, output_interval=0.01, start_values={"T": 8.0})
    record = one_mass().simulate("phi", {"T": np.full(len(result), 8.0)}, 100)
    np.testing.assert_allclose(result["phi"], record["phi"].values, atol=1e-12)
