"""Fits of long records: what they hold in memory, and that the numbers are those of the plain definition."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import scipy
from support.command_line import run
from support.written_models import TWO_DISCS

import torsionnet as tn
from torsionnet.base.errors import UsageError
from torsionnet.identification.fit_file import load_fit_plan
from torsionnet.identification.residuals import windowed_estimate as segments
from torsionnet.identification.residuals.measurement_blocks import make_block
from torsionnet.identification.residuals.windowed_estimate import windowed_estimate
from torsionnet.signals import Recording, Signal, Welch, write_recording
from torsionnet.signals.resampling import usable_up_to

RATE, COUNT, BAND = 100.0, 330, (2.0, 30.0)
SETTINGS = [
    Welch("hamming", 0.8, 0.8),
    Welch("hann", 0.5, 0.5, detrend="linear"),
    Welch("boxcar", 1.0, 0.33, detrend="none"),
]


@pytest.fixture(params=SETTINGS, ids=lambda one: one.window)
def found(request):
    """An estimate of noise from noise, which begins at 0 as a rig at rest does."""
    x, y = np.random.default_rng(1).normal(size=(2, COUNT))
    x[0] = y[0] = 0.0
    record = Recording((Signal("T", "torque", x), Signal("phi", "angle", y)), RATE)
    return windowed_estimate(record, "phi", "T", request.param, BAND)


def scipys(x, y, settings):
    """H1 in the band by scipy, of one output or of many."""
    length = settings.samples(RATE)
    detrend = {"mean": "constant", "linear": "linear", "none": False}[settings.detrend]
    common = (RATE, settings.window, length, length - settings.step(RATE), None, detrend)
    f, cross = scipy.signal.csd(x, y, *common)
    kept = (f >= BAND[0]) & (f <= BAND[1])
    return (cross / scipy.signal.welch(x, *common)[1])[..., kept]


def lines_of_impulses(found, answer):
    """(n_b, n): H1 of the answers to a unit impulse at every sample."""
    x, settings = found.record["T"].values, found.rows.segments.settings
    return scipys(x, np.array([answer(impulse) for impulse in np.eye(COUNT)]), settings).T


def covariance_of(lines):
    parts = np.concatenate([lines.real, lines.imag])
    return parts @ parts.T


def drawn(found, seed=2):
    return np.random.default_rng(seed).normal(size=(2, len(found.fine))).T @ [1, 1j]


def filtered(found, G, values):
    """What G makes of a signal that zeros follow, from the discrete transform."""
    n = round(RATE / (found.fine[1] - found.fine[0]))
    assert n >= 2 * COUNT
    spectrum, first = np.fft.rfft(values, n), round(found.fine[0] * n / RATE)
    whole = np.zeros(len(spectrum), dtype=complex)
    whole[first : first + len(G)] = G
    return np.fft.irfft(whole * spectrum, n)[:COUNT]


def close(value, expected):
    np.testing.assert_allclose(value, expected, rtol=1e-9, atol=1e-11 * np.abs(expected).max())


class TestAgainstScipy:
    def test_measured_and_predicted(self, found):
        x, y, settings = found.record["T"].values, found.record["phi"].values, found.rows.segments.settings
        close(found.measured, scipys(x, y, settings))
        G = drawn(found)
        close(found.predicted(G), scipys(x, filtered(found, G, x), settings))
        both = np.column_stack([G, drawn(found, 3)])
        close(found.predicted(both)[:, 1], found.predicted(both[:, 1]))

    def test_noise_of_the_output(self, found):
        lines = lines_of_impulses(found, lambda impulse: impulse)
        close(found.rows.dense(), lines)
        close(found.output_covariance(), covariance_of(lines))

    def test_noise_of_the_input(self, found, monkeypatch):
        G = drawn(found)
        expected = covariance_of(lines_of_impulses(found, lambda impulse: filtered(found, G, impulse)))
        for held in (segments.MOST_ROW_BYTES, 0):
            monkeypatch.setattr(segments, "MOST_ROW_BYTES", held)
            close(found.input_covariance(G), expected)

    def test_some_of_the_lines(self, found):
        kept = np.arange(len(found.frequencies)) % 3 == 1
        close(found.rows.only(kept).covariance(), covariance_of(found.rows.dense()[kept]))
        close(found.rows.squares, (np.abs(found.rows.segments.pieces()) ** 2).sum(axis=1))


PROGRAM = """
from pathlib import Path
import numpy as np
import torsionnet as tn
from torsionnet.bench.plan import Acquisition, Plan, Transducer
from torsionnet.identification.residuals.measurement_blocks import memory_demand
from torsionnet.signals import LinearChirp, Welch

rig = tn.load("dmf_rig")
plan = Plan(
    excitation=LinearChirp(start=0.5, stop=60, duration=40, amplitude=15),
    channels={"T_T": Transducer(noise="0.1 N*m"), "theta_1": Transducer(noise="0.01 deg")},
    acquisition=Acquisition(rate="2 kHz"),
)
record = tn.Bench(rig, plan).run()


def highest():  # kB; what getrusage says begins with the size of the process that started this one
    return int(Path("/proc/self/status").read_text().partition("VmHWM:")[2].split()[0])


before = highest()
test = tn.Measurement(record, "theta_1", "T_T", settings=Welch(), band=(0.5, 110))
fit = tn.identify(rig.configured(c_2=5), test, ["c_2"])
assert abs(fit.values["c_2"] / 4 - 1) < 0.01, fit.values
told = memory_demand(record, test.settings, test.band)
print((highest() - before) / 1024, (told.kept + told.passing) / 1e6)
"""


@pytest.mark.nightly
@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="asks Linux for the memory a process took")
def test_a_fit_without_decimation_stays_small():
    """220 lines of 80 000 samples: rows and their transforms would be 280 MB and 560 MB, several times over."""
    done = subprocess.run([sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    taken, told = map(float, done.stdout.split())
    assert taken < 150  # MB; 56 on Linux
    assert taken < told < 5 * taken


def noise(rate, seconds):
    values = np.random.default_rng(3).normal(size=(2, round(rate * seconds)))
    return Recording((Signal("T_T", "torque", values[0]), Signal("theta_1", "angle", values[1])), rate)


def test_a_fit_that_takes_too_much_is_refused_before_it_starts():
    test = tn.Measurement(noise(5000, 12), "theta_1", "T_T", settings=Welch(), band=(0.5, 2400), name="fast")
    with pytest.raises(UsageError, match=r"(?s)4800.*0\.5.*too-large"):
        make_block(tn.load("dmf_rig"), test, ("c_2",), "complex")


def test_without_settings_the_band_is_not_cut_by_decimation():
    block = make_block(
        tn.load("dmf_rig"), tn.Measurement(noise(5000, 12), "theta_1", "T_T", band=(1, 150)), ("c_2",), ""
    )
    assert block.frequencies[-1] == pytest.approx(150, abs=0.5)
    assert usable_up_to(5000, round(5000 / block.windowed.record.sampling_rate)) >= 150


SOFT = "  soft: {record: run.npz, output: phi, input: T, configuration: soft, band: [1 Hz, 25 Hz]}\n"
WIDE = "  wide: {record: run.npz, output: phi, input: T, configuration: hard, band: [1 Hz, 200 Hz]}\n"
FREE = "  free: {record: run.npz, output: phi, input: T, configuration: hard}\n"
FIT = f"""\
torsionnet: 1
model: rig.yaml
parameters: {{k: 300}}
measurements:
{SOFT}{WIDE}{FREE}settings: {{seconds: 2 s}}
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rig.yaml").write_text(TWO_DISCS)
    torque, angle = np.random.default_rng(3).normal(size=(2, 40_000))
    write_recording(Recording((Signal("T", "torque", torque), Signal("phi", "angle", angle)), 4000.0), "run.npz")
    return tmp_path


@pytest.mark.parametrize(
    ("settings", "factors"),
    [
        ("settings: {seconds: 2 s}", [20, 8, 20]),
        ("settings: {preset: paper}", [20, 8, 20]),
        ("settings: {seconds: 2 s, decimation: 4}", [4, 4, 4]),
        ("", [20, 8, 20]),
    ],
)
def test_a_fit_file_decimates_as_the_bands_allow(folder, settings, factors):
    (folder / "fit.yaml").write_text(FIT.replace("settings: {seconds: 2 s}", settings))
    plan = load_fit_plan("fit.yaml", lambda path: path)
    assert [one.settings.decimation for one in plan.measurements] == factors


@pytest.mark.slow
def test_the_command_tells_decimation_and_memory(folder, monkeypatch):
    monkeypatch.setattr("torsionnet.app.cli.terminal.LARGE_MEMORY", 1e6)
    (folder / "fit.yaml").write_text(FIT.replace(FREE, ""))
    told = run("fit", "fit.yaml").stderr
    assert "note: soft: decimated by 20 to 200 Hz\n" in told
    assert "note: wide: decimated by 8 to 500 Hz\n" in told
    assert "GB of memory; narrower bands" in told


def test_nothing_is_told_of_little_memory(folder):
    (folder / "fit.yaml").write_text(FIT.replace(FREE, "").replace(WIDE, ""))
    assert "memory" not in run("fit", "fit.yaml").stderr
