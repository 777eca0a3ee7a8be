"""What users of other programs try first gets an answer that names what there is."""

import inspect
import re
from importlib import import_module

import pytest

import torsionnet as tn
from torsionnet.app.cli.app import COMMANDS, same_command
from torsionnet.base import familiar_words
from torsionnet.model.elements import ELEMENT_TYPES
from torsionnet.study.study_result import StudyResult
from torsionnet.symbolic.symbolic_system import SymbolicSystem
from torsionnet.symbolic.transfer_function import TransferFunction

SPRING = "elements: {{s: {{type: {kind}, nodes: [a, b], {entries}}}, j: {{type: inertia, node: a, inertia: 1}}}}"


def message(text):
    with pytest.raises(tn.ModelError) as caught:
        tn.loads("torsionnet: 1\n" + text)
    return str(caught.value)


@pytest.mark.parametrize(
    ("kind", "entries", "said"),
    [
        ("shaft", "length: 1 m, outer_diameter: 5 cm, material: steel", "leave it out for steel; for another material"),
        ("shaft", "length: 1 m, diameter: 5 cm", 'did you mean "outer_diameter"?'),
        ("shaft", "length: 1 m, outer_diameter: 5 cm, E: 210 GPa", "give shear_modulus, E/(2 (1 + nu))"),
        ("spring", "stiffness: 1e4, damping: 2 %", "write {zeta: 2 %, at: ... Hz}"),
        ("spring", "stiffness: 1e4, zeta: 2 %", "write damping: {zeta: 2 %, at: 12 Hz}"),
        ("spring", "k: 1e4", 'unknown key "k"; did you mean "stiffness"?'),
        ("spring", "stiffness: 1e4, backlash: 1 deg", "type: clearance with gap and stiffness; teeth have a backlash"),
        ("spring", "stiffness: 1e4, gap: 1 deg", "type: clearance with gap and stiffness"),
        ("clearance", "stiffness: 1e4, backlash: 1 deg", 'did you mean "gap"?'),
        ("friction", "coefficient: 0.3", "dry friction is given by the torque at which it slips"),
        ("hard_stop", "gap: 1 deg", 'did you mean "clearance"? known:'),
        ("disc_friction_clutch", "gap: 1 deg", 'did you mean "clutch"? known:'),
        (
            "spring",
            "torque_over_twist: {0 rad: 0 N*m, 0.1 rad: 5 N*m, 1 rad: 9 N*m}",
            "expected rows [twist, torque], at least 2, as [[0 rad, 0 N*m], [0.1 rad, 5 N*m], ...]; got {",
        ),
        ("torsional_spring", "stiffness: 1e4", 'did you mean "spring"? known:'),
        ("Dashpot", "damping: 1e4", 'did you mean "damper"? known:'),
        ("torque_source", "torque: 3", "inputs: {T: {torque: node}}"),
        ("rotary_load", "inertia: 3", 'did you mean "inertia"? known:'),
        ("freewheel", "stiffness: 3", "a freewheel is a coupling that a configuration switches off"),
    ],
)
def test_model_files(kind, entries, said):
    assert said in message(SPRING.format(kind=kind, entries=entries))


@pytest.mark.parametrize("key", ["damping", "modal_damping"])
def test_damping_of_a_whole_model_belongs_to_its_springs(key):
    said = message(f"{key}: 2 %\n{SPRING.format(kind='spring', entries='stiffness: 1e4')}")
    assert "write damping: {zeta: 2 %, at: 12 Hz} in the springs" in said


@pytest.mark.parametrize(
    ("key", "said"),
    [
        ("units", "a number has its unit with it"),
        ("masses", "all of them are elements:"),
        ("outputs", "what is read is a sensor"),
        ("M", "matrices are an element, type: lumped_matrices"),
        ("simulation", "a model says nothing of calculations"),
    ],
)
def test_sections_of_other_programs(key, said):
    assert said in message(f"{key}: {{a: 1}}\n{SPRING.format(kind='spring', entries='stiffness: 1e4')}")


def test_a_damper_is_not_told_of_damping_ratios():
    assert "zeta" not in message(SPRING.format(kind="damper", entries="damping: 2 m"))


def test_constructors():
    with pytest.raises(TypeError, match=r'diameter.; did you mean "outer_diameter"[?]$'):
        tn.Shaft("s", ("a", "b"), length="1 m", diameter="50 mm")
    with pytest.raises(TypeError, match=r"'material'; leave it out for steel"):
        tn.Shaft("s", ("a", "b"), length="1 m", outer_diameter="50 mm", material="steel")
    with pytest.raises(TypeError, match=r"required positional argument: 'node'$"):
        tn.Inertia("j", inertia=2)
    with pytest.raises(TypeError, match=r"unexpected keyword argument 'xyz'$"):
        tn.Inertia("j", "a", 2, xyz=1)
    with pytest.raises(TypeError, match=r"^Drivetrain.__init__\(\) .*'damping'; damping belongs to the elements"):
        tn.Drivetrain("rig", [tn.Inertia("j", "a", 2)], damping=0.02)


def test_arguments_of_methods():
    rig = tn.load("dmf_rig")
    with pytest.raises(TypeError, match=r"^modes\(\) .*'damping'; write damping=\{\"zeta\""):
        rig.modes(damping=0.02)
    with pytest.raises(TypeError, match=r"'excitation'; did you mean \"driven_by\"[?]"):
        rig.frequency_response("theta_1", "T_T", [1], excitation="T_M")
    with pytest.raises(
        TypeError, match=r"^simulate\(\) .*'method'; .* of frequency_response\(\), frequency_responses\(\)$"
    ):
        rig.simulate("theta_1", "T_T", 100, method="fast")
    with pytest.raises(TypeError, match=r"'freqs'; .* .frequencies.[?]$"):
        rig.frequency_response("theta_1", "T_T", freqs=[1.0])
    with pytest.raises(TypeError, match=r"'rpm'; .* measured_input, driven_by, lowest, up_to$"):
        rig.modes(rpm=100)


def test_methods_keep_their_signatures():
    of_class, of_object = inspect.signature(tn.Drivetrain.modes), inspect.signature(tn.load("dmf_rig").modes)
    assert [*of_object.parameters.values()] == [*of_class.parameters.values()][1:]


def test_names_of_packages():
    with pytest.raises(AttributeError, match=r"'Model'; write tn.Drivetrain"):
        tn.Model  # noqa: B018
    with pytest.raises(AttributeError, match=r"'TorsionalSpring'; write tn.Spring"):
        tn.TorsionalSpring  # noqa: B018
    with pytest.raises(AttributeError, match=r"'Sprig'; did you mean .Spring."):
        tn.Sprig  # noqa: B018
    with pytest.raises(AttributeError, match=r"'modes'; write plot.mode_shapes"):
        tn.plot.modes  # noqa: B018
    with pytest.raises(AttributeError, match=r"'bode'; write plot\.bode\("):
        tn.report.bode  # noqa: B018
    with pytest.raises(AttributeError, match=r"'ode45'; write tn.Drivetrain.simulate"):
        tn.ode45  # noqa: B018


ELSEWHERE = (
    "c2d fft ifft psd rms kurtosis unwrap resample detrend hann butter filtfilt hilbert envelope diff cumtrapz "
    "interp1 xcorr mac modalfit modalfrf modalsd n4sid tachorpm rpmtrack ordertrack orderspectrum rpmfreqmap tsa "
    "rainflow goodman miner pole damp eigs pzmap zero rlocus margin sigma bodemag freqresp zpk frd minreal balreal "
    "guyan craig_bampton impulse step initial solve_ivp linmod campbell db mag2db deg2rad lsqcurvefit fmincon "
    "montecarlo sobol loadmat savemat simulink simscape animate cpsd mscohere tfestimate coherence eigenvalues "
    "stiffness_matrix assemble holzer linspace lookup figure "
)


def test_words_of_matlab_simscape_and_numpy_are_known_to_packages_objects_and_the_command_line():
    """Each is told where it is done: in torsionnet itself, by a method, or in numpy, scipy or control."""
    rig = tn.load("dmf_rig")
    for word in ELSEWHERE.split():
        for tried in (tn, rig):
            with pytest.raises(AttributeError, match=rf"'{word}'; write "):
                getattr(tried, word)
        assert same_command(word) or word in {*COMMANDS} or word in familiar_words.ANYWHERE


def test_attributes():
    rig = tn.load("dmf_rig")
    with pytest.raises(AttributeError, match=r"^'Drivetrain' .*'frf'; write model.frequency_response"):
        rig.frf  # noqa: B018
    with pytest.raises(AttributeError, match=r"'modess'; did you mean .modes.[?]$"):
        rig.modess  # noqa: B018
    with pytest.raises(AttributeError, match=r"^'Modes' .*'zeta'; write modes.damping_ratios"):
        rig.modes().zeta  # noqa: B018
    assert not hasattr(rig, "_ipython_canary_method_should_not_exist_")


def test_a_property_that_fails_says_its_own_error():
    class Failing(type(tn.load("dmf_rig").modes())):
        @property
        def wrong(self):
            return self.names.nothing_there

    failing = object.__new__(Failing)
    object.__setattr__(failing, "kinds", ())
    with pytest.raises(AttributeError, match=r"^'tuple' .*'nothing_there'"):
        failing.wrong  # noqa: B018


CLASSES = {"Recording": tn.signals.Recording, "StudyResult": StudyResult, "TransferFunction": TransferFunction}


def there(place, of):
    """Whether an attribute exists, also as a field of a dataclass, which its class has no attribute of."""
    return hasattr(of, place) or place in getattr(of, "__dataclass_fields__", {})


def test_what_is_named_exists():
    """Every name in every hint is one that there is."""
    starts = {"tn": tn, "plot": tn.plot, "signals": tn.signals, "io": tn.io, "model": tn.Drivetrain, "modes": tn.Modes}
    starts |= {"response": tn.FrequencyResponse, "symbolic": SymbolicSystem, "record": tn.signals.Recording}
    starts |= {"modal": tn.modal}
    found = [familiar_words.ANYWHERE, *familiar_words.PYTHON.values(), *familiar_words.METHODS.values()]
    named = [
        one
        for table in found
        for text in table.values()
        for one in re.findall(r"\b([a-z]+)[.](\w+)(?:\(\))?[.]?(\w+)?", text)
    ]
    assert len(named) > 60
    for start, name, then in named:
        if start in {"np", "scipy", "control", "linalg", "signal", "integrate", "fft"}:
            continue
        assert there(name, starts[start]), (start, name)
        if start == "tn" and then:
            assert there(then, getattr(tn, name)), (name, then)
        if (start, name) == ("model", "modes") and then:
            assert there(then, tn.Modes), then


def test_arguments_in_hints_are_those_of_the_methods():
    tables = (familiar_words.ANYWHERE, *familiar_words.PYTHON.values(), *familiar_words.METHODS.values())
    texts = [text for table in tables for text in table.values()]
    calls = [call for text in texts for call in re.findall(r"(?:model|tn\.Drivetrain)\.(\w+)\(([a-z_, ]+)\)", text)]
    assert len(calls) > 10
    for method, arguments in calls:
        assert {*arguments.split(", ")} <= {*inspect.signature(getattr(tn.Drivetrain, method)).parameters}, method


def test_no_word_hides_something_that_exists():
    for package, table in familiar_words.PYTHON.items():
        assert not {*table} & {*dir(import_module(package))}
    for name, table in familiar_words.METHODS.items():
        assert not [word for word in table if there(word, CLASSES.get(name) or getattr(tn, name))]
    assert not {*familiar_words.ELEMENT_TYPES} & {*ELEMENT_TYPES}
    assert {*familiar_words.ELEMENT_TYPES.values()} <= {*ELEMENT_TYPES}
