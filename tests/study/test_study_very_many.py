"""Studies of more variants than values are kept of: counts of all of them, and an even part; limits on curves."""

import csv
import json
import shutil

import numpy as np
import pytest
import scipy
from click.testing import CliRunner
from support.study_runs import contents

import torsionnet as tn
from torsionnet.app.cli.app import app
from torsionnet.base.errors import ModelError, UsageError
from torsionnet.study import define, run_study, study_result
from torsionnet.study.reductions.limit_counts import MOST_LIMITS, LimitCounts, LimitFlags
from torsionnet.study.run import chunk_values as chunks
from torsionnet.study.run import run_chunks as workload
from torsionnet.study.run.chunk_values import kept_every
from torsionnet.study.run.process_pool import ProcessExecutor

DRAWS, CHUNK = 301, 37
J, K = 0.2, 8000.0
F = np.sqrt(K / J) / (2 * np.pi)
CASES = ("soft", "stiff")
WEIGHTS = {"soft": 1, "stiff": 3}
VARY = {
    "k": {"type": "lognormal", "deviation": "5 %"},
    "c": {"type": "uniform", "low": 10, "high": 45},
    "J": {"type": "list", "values": [0.9 * J, J, 1.1 * J]},
}
LIMITS = {"f": {"below": 1.08 * F}, "H": {"below": 2.2e-4, "above": 7e-5}, "zeta": {"below": 0.5}}
"""Limits of which no two are exceeded by the same variants; a soft, heavily damped variant has no frequency."""
ANSWERS = {
    "all": {"type": "yield", "weights": WEIGHTS},
    "two": {"type": "yield", "limits": ["H", "f"]},
    "points": {"type": "scatter", "quantities": ["f"]},
    "lines": {"type": "parallel_coordinates"},
}


def oscillator():
    return tn.Drivetrain(
        "oscillator",
        elements=[
            tn.Inertia("disc", node="a", inertia="J"),
            tn.Spring("shaft", nodes=("a", "ground"), stiffness="k"),
            tn.Damper("oil", nodes=("a", "ground"), damping="c"),
        ],
        parameters={"J": J, "k": K, "c": 20.0},
        inputs={"T": {"torque": "a"}},
        sensors={"theta": {"angle": "a"}},
        configurations={"soft": {"k": K / 8}, "stiff": {"k": K}},
    )


def curve(band=("10 Hz", "40 Hz"), points=7):
    return {"type": "response", "output": "theta", "input": "T", "band": list(band), "points": points}


def study(**changes):
    quantities = {
        "f": {"type": "natural_frequency", "mode": 1},
        "zeta": {"type": "damping_ratio", "mode": 1},
        "H": curve(),
    }
    given = {
        "configurations": CASES,
        "sampling": {"count": DRAWS, "seed": 5},
        "limits": LIMITS,
        "answers": ANSWERS,
        **changes,
    }
    vary, asked = given.pop("vary", VARY), given.pop("quantities", quantities)
    return define(oscillator(), vary, asked, **given)


def found(one, name, result):
    return one.answers[name].conclude(one, result)


@pytest.fixture(autouse=True)
def many_chunks(monkeypatch):
    monkeypatch.setattr(workload, "CHUNK_POINTS", 1)
    monkeypatch.setattr(workload, "LEAST_CHUNK_SIZE", CHUNK)


@pytest.fixture
def few_kept(monkeypatch):
    """Of a study with more than 2000 values a part is kept."""
    monkeypatch.setattr(chunks, "KEPT_VALUES", 2000)


@pytest.fixture(scope="module")
def whole():
    """All values of the study, kept."""
    return run_study(study())


@pytest.fixture
def part(few_kept):  # noqa: ARG001
    return run_study(study())


def beyond_by_hand(one):
    """Which variants (n_grid, n_draws) are beyond, by configuration and quantity, of values without any chunks."""
    beyond = {}
    for case in one.configurations:
        model = one.model_in(case)
        values = one.evaluator(case)(one.space.at(model).values(0, one.space.count))
        for name, limit in one.limits.items():
            each = values[name].reshape(one.space.count, -1)
            low, high = (-np.inf if limit.above is None else limit.above, limit.below or np.inf)
            outside = [not all(low <= value <= high for value in row) for row in each]
            beyond[case, name] = np.array(outside).reshape(-1, one.space.draws)
    return beyond


class TestYield:
    @pytest.mark.slow
    @pytest.mark.parametrize(("name", "limits"), [("all", ("f", "H", "zeta")), ("two", ("H", "f"))])
    def test_against_direct_counting(self, part, name, limits):
        one = part.study
        counted, beyond = found(one, name, part), beyond_by_hand(one)
        words = [next(share.limit for share in counted.shares if f"{limit} " in share.limit) for limit in limits]
        asked = [*zip(words, [(limit,) for limit in limits], strict=True), ("any limit", limits)]
        shares = set()
        for text, names in asked:
            any_of = {case: np.any([beyond[case, limit] for limit in names], axis=0) for case in CASES}
            for case in CASES:
                assert counted.of(case, text).value == pytest.approx(any_of[case].mean(), rel=1e-12)
                shares.add(round(any_of[case].mean(), 6))
            either = any_of["soft"] | any_of["stiff"]
            assert counted.of("in any of them", text).value == pytest.approx(either.mean(), rel=1e-12)
            assert counted.of("in any of them", text).count == DRAWS
            if name == "all":
                mean = 0.25 * any_of["soft"].mean() + 0.75 * any_of["stiff"].mean()
                assert counted.of("weighted mean", text).value == pytest.approx(mean, rel=1e-12)
        assert len(shares - {0.0, 1.0}) >= 4  # the limits tell variants apart

    @pytest.mark.slow
    @pytest.mark.parametrize("name", ["all", "two"])
    def test_is_that_of_values_that_are_kept(self, whole, part, name):
        kept, counted = found(whole.study, name, whole), found(part.study, name, part)
        assert [(one.configuration, one.limit) for one in counted.shares] == [
            (one.configuration, one.limit) for one in kept.shares
        ]
        for ours, theirs in zip(counted.shares, kept.shares, strict=True):
            assert (ours.share.value, ours.share.low, ours.share.high) == pytest.approx(
                (theirs.share.value, theirs.share.low, theirs.share.high), rel=1e-9
            )
        assert counted.missing == kept.missing > 0

    @pytest.mark.slow
    def test_missing_values_are_counted(self, part):
        """The soft oscillator does not vibrate where it is damped critically: c >= 2 sqrt(J k)."""
        one = part.study
        drawn = one.space.at(one.model_in("soft")).values(0, one.space.count)
        still = int((drawn["c"] >= 2 * np.sqrt(drawn["J"] * drawn["k"])).sum())
        assert 0 < still < one.space.count
        assert part.beyond.missing(["f"]) == still
        assert part.beyond.cases["soft"].beyond([sorted(LIMITS).index("f")]) >= still

    @pytest.mark.slow
    def test_what_is_drawn_is_said(self, part, whole):
        text = (
            f"all variants are counted; the values of one in {part.kept.every} of {part.study.count} variants are drawn"
        )
        counted = found(part.study, "all", part)
        assert text in counted.sentences
        assert text in counted.table().notes
        assert not any("are drawn" in one for one in found(whole.study, "all", whole).sentences)
        drawn = [one for one in counted.distributions if one.configuration == "stiff"]
        assert [one.quantity for one in drawn] == ["f", "smallest H", "largest H", "zeta"]
        low, high = part.kept_values("H", "stiff").T
        for one, values in zip(drawn[1:3], (low, high), strict=True):
            assert values.min() <= one.edges[0] < one.edges[-1] <= values.max()
        assert sum(drawn[1].counts) == pytest.approx(len(part.kept_values("H", "stiff")), abs=2)
        counted.figure().draw_without_rendering()

    @pytest.mark.slow
    def test_other_limits_than_those_that_were_counted(self, part):
        with pytest.raises(UsageError, match="unlike-results"):
            found(study(limits={**LIMITS, "f": {"below": F}}), "all", part)

    @pytest.mark.usefixtures("few_kept")
    def test_more_limits_than_there_are_bits_for(self):
        names = [f"z_{place}" for place in range(MOST_LIMITS + 1)]
        asked = {name: {"type": "damping_ratio", "mode": 1} for name in names}
        with pytest.raises(UsageError, match=f"at most {MOST_LIMITS} limits, not {MOST_LIMITS + 1}"):
            run_study(study(quantities=asked, limits={name: {"below": 1} for name in names}, answers={}))


def test_counts_of_as_many_limits_as_there_may_be():
    rng = np.random.default_rng(2)
    beyond = rng.random((MOST_LIMITS, 500)) < rng.uniform(0, 0.05, MOST_LIMITS)[:, None]
    counts = LimitCounts()
    for start in range(0, 500, 33):
        each = beyond[:, start : start + 33]
        counts.add(LimitFlags(each, np.zeros(MOST_LIMITS, dtype=np.int64)))
    for wanted in ([0], [MOST_LIMITS - 1], [3, 17, 40], range(MOST_LIMITS)):
        assert counts.beyond(wanted) == beyond[list(wanted)].any(axis=0).sum()
    assert sum(counts.sets.values()) == beyond.any(axis=0).sum()


@pytest.mark.usefixtures("few_kept")
class TestSameBytes:
    @pytest.fixture
    def folder(self, tmp_path):
        run_study(study(), tmp_path / "whole")
        assert len(contents(tmp_path / "whole")) == 2 * -(-3 * DRAWS // CHUNK) + 1
        return tmp_path / "whole"

    @pytest.mark.slow
    def test_processes(self, folder, tmp_path):
        run_study(study(), tmp_path / "other", executor=ProcessExecutor(2))
        assert contents(tmp_path / "other") == contents(folder)

    @pytest.mark.slow
    def test_resumed_after_chunks_were_lost(self, folder, tmp_path):
        other = tmp_path / "other"
        shutil.copytree(folder, other)
        files = sorted((other / "chunks").iterdir())
        for file in files[3::4]:
            file.unlink()
        files[1].write_bytes(files[1].read_bytes()[:-50])
        result = run_study(study(), other)
        assert contents(other) == contents(folder)
        first, again, free = (run_study(study(), folder), result, run_study(study()))
        texts = {
            json.dumps([one.to_data(), *(found(one.study, name, one).to_data() for name in ANSWERS)])
            for one in (first, again, free)
        }
        assert len(texts) == 1

    @pytest.mark.slow
    def test_limits_belong_to_the_folder(self, folder):
        before = contents(folder)
        for limits in ({**LIMITS, "f": {"below": F}}, {"H": LIMITS["H"], "zeta": LIMITS["zeta"]}):
            changed = study(limits=limits, answers={})
            with pytest.raises(UsageError, match=r"limits .*\(f\), "):
                run_study(changed, folder)
        assert contents(folder) == before

    @pytest.mark.slow
    def test_answers_and_the_order_of_limits_may_change(self, folder):
        turned = dict(reversed(LIMITS.items()))
        answers = {"one": {"type": "yield", "limits": ["zeta"], "confidence": 0.9}}
        one = study(limits=turned, answers=answers)
        share = found(one, "one", run_study(one, folder)).of("stiff")
        assert share.value == pytest.approx(beyond_by_hand(one)["stiff", "zeta"].mean(), rel=1e-12)


class TestPart:
    @pytest.mark.slow
    def test_is_every_so_many_of_all(self, whole, part):
        every = part.kept.every
        assert every > 1
        for case in CASES:
            assert part.kept_values("f", case).tobytes() == whole.values("f", case)[::every].tobytes()
            assert part.kept_values("H", case).tobytes() == whole.kept_values("H", case)[::every].tobytes()
            of_all = whole.parameters(case)
            for name, column in part.kept_parameters(case).items():
                assert column.tobytes() == of_all[name][::every].tobytes()

    @pytest.mark.slow
    def test_has_no_more_values_than_may_be_kept(self, part):
        assert 1000 < sum(column.size for column in part.kept.values.values()) <= 2000 + 7 * len(CASES)

    def test_extremes_of_curves(self, whole):
        one = whole.study
        curves = one.evaluator("stiff")(one.space.at(one.model_in("stiff")).values(0, one.space.count))["H"]
        np.testing.assert_array_equal(whole.kept_values("H", "stiff"), np.sort(curves, axis=1)[:, [0, -1]])

    @pytest.mark.slow
    def test_sums_and_the_worst_variant_are_of_all(self, whole, part):
        for key, one in whole.summaries.items():
            other = part.summaries[key]
            np.testing.assert_allclose(other.moments.mean, one.moments.mean, rtol=1e-13)
            assert one.moments.largest.tobytes() == other.moments.largest.tobytes()
            assert one.moments.largest_at.tolist() == other.moments.largest_at.tolist()
        exact = whole.percentiles("f", [5, 50, 95], "stiff")
        np.testing.assert_allclose(part.percentiles("f", [5, 50, 95], "stiff"), exact, rtol=0.002)

    @pytest.mark.parametrize("limit", [*range(5_000_000, 11_000_000, 1_000_000)])
    def test_no_step_goes_along_with_an_axis_or_a_sobol_sequence(self, monkeypatch, limit):
        """Every value of a list, and both halves of every parameter, come about equally often in the part."""
        monkeypatch.setattr(chunks, "KEPT_VALUES", limit)
        values = [(0.9 + 0.01 * n) * J for n in range(15)]
        vary = {"k": VARY["k"], "J": {"type": "list", "values": values}, "c": VARY["c"]}
        one = study(vary=vary, sampling={"method": "sobol", "count": 2**20})
        every = kept_every(one)
        assert one.count * 7 / limit <= every < one.count * 7 / limit + 10
        indices = np.arange(0, one.space.count, every)
        assert np.bincount(indices // one.space.draws, minlength=15).min() > 0.9 * len(indices) / 15
        first = [one.space.values(int(n), int(n) + 1)["c"][0] for n in indices[:100]]
        assert 0.4 < np.mean(np.array(first) < 27.5) < 0.6

    def test_a_list_that_changes_from_variant_to_variant(self, monkeypatch):
        monkeypatch.setattr(chunks, "KEPT_VALUES", 54)
        vary = {
            "J": {"type": "range", "low": 0.1, "high": 0.3, "count": 9},
            "c": {"type": "range", "low": 1, "high": 9, "count": 15},
        }
        one = run_study(study(vary=vary, sampling=None, configurations=(), limits={}, answers={}))
        assert one.kept.every == 17  # 15 and 16 have factors in common with 15 values, and with two
        assert len(set(one.kept_parameters()["c"])) == len(one.kept_parameters()["c"]) == 8

    @pytest.mark.slow
    def test_correlations_say_what_they_are_of(self, part, whole):
        ours, theirs = (found(one.study, "points", one) for one in (part, whole))
        text = f"one in {part.kept.every} of {part.study.count} variants"
        assert ours.sentences[-1] == f"correlations and points are of {text}"
        assert ours.sentences[-1] in ours.table().notes
        one, all_of_them = (each.correlations["stiff", "f"] for each in (ours, theirs))
        wide = 1.5 * (one.high - one.low) / 2  # three standard errors
        assert (abs(one.coefficients - all_of_them.coefficients) < wide).all()
        assert one.count == len(part.kept_values("f", "stiff"))
        ours.figure().draw_without_rendering()

    @pytest.mark.slow
    def test_lines_say_what_they_are_of(self, part):
        lines = found(part.study, "lines", part)
        assert lines.sentences[-1].endswith(f"are of one in {part.kept.every} of {part.study.count} variants")
        beyond = beyond_by_hand(part.study)
        any_limit = np.any([beyond["stiff", name] for name in LIMITS], axis=0).ravel()[:: part.kept.every]
        assert lines.beyond["stiff"].tolist() == any_limit.tolist()

    @pytest.mark.slow
    def test_all_values_are_refused_by_name(self, part):
        with pytest.raises(UsageError, match=rf"(?s)f .* one in {part.kept.every} variants.*too-large"):
            part.values("f", "stiff")
        with pytest.raises(UsageError, match="H is a curve"):
            part.values("H", "stiff")

    @pytest.mark.slow
    def test_files_have_the_part_and_its_indices(self, part, whole, tmp_path):
        part.to_csv(tmp_path / "part.csv")
        lines = (tmp_path / "part.csv").read_text().splitlines()
        text = f"one in {part.kept.every} of {part.study.count} variants"
        assert any(text in line for line in lines if line.startswith("#"))
        rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
        stiff = [row for row in rows if row["configuration"] == "stiff"]
        assert [int(row["variant"]) for row in stiff] == list(range(0, 3 * DRAWS, part.kept.every))
        values = whole.values("zeta", "stiff")
        assert [float(row["zeta"]) for row in stiff] == [values[int(row["variant"])] for row in stiff]
        assert "variant" not in whole.columns()
        assert part.to_data()["kept_every"] == part.kept.every
        assert "kept_every" not in whole.to_data()

    @pytest.mark.slow
    def test_lines_are_written_in_pieces_that_do_not_show(self, part, tmp_path, monkeypatch):
        part.to_csv(tmp_path / "at_once.csv")
        monkeypatch.setattr(study_result, "CSV_BLOCK_LINES", 7)
        part.to_csv(tmp_path / "in_pieces.csv")
        assert (tmp_path / "in_pieces.csv").read_bytes() == (tmp_path / "at_once.csv").read_bytes()

    @pytest.mark.slow
    def test_labelled_arrays_have_the_indices(self, part):
        pytest.importorskip("xarray")
        arrays = part.to_xarray()
        assert arrays["variant"].values.tolist() == list(range(0, 3 * DRAWS, part.kept.every))
        assert arrays["f"].dims == arrays["k"].dims == ("configuration", "variant")


@pytest.mark.usefixtures("few_kept")
def test_the_command_says_what_it_writes_and_draws(tmp_path):
    file, variants = tmp_path / "plan.yaml", tmp_path / "part.csv"
    file.write_text(
        "torsionnet: 1\nmodel: dmf_rig\nvary: {k_2: {type: normal, deviation: 5 %}}\nsampling: {count: 2100}\n"
        "quantities: {H: {type: response, output: theta_1, input: T_M, at: 5 Hz}}\n"
    )
    shown = CliRunner().invoke(
        app, ["study", str(file), "--variants", str(variants), "--plot", str(tmp_path / "picture.png")]
    )
    assert shown.exit_code == 0, shown.output
    assert "part.csv has one in 11 of 2100 variants" in " ".join(shown.stderr.split())
    assert "values of single variants are kept of one in 11 of 2100 variants" in " ".join(shown.stdout.split())
    assert (tmp_path / "picture.png").exists()
    assert sum(not line.startswith("#") for line in variants.read_text().splitlines()) == 1 + 191


class TestLimitsOnCurves:
    def test_failure_probability(self):
        """Below resonance H rises with the frequency and falls with k: the last point says when it is too large."""
        spread, omega = np.sqrt(np.log1p(0.05**2)), 2 * np.pi * 10
        weak = K / np.sqrt(1 + 0.05**2) * np.exp(-3 * spread)
        limit = 1 / abs(weak - J * omega**2 + 20j * omega)
        one = study(
            vary={"k": VARY["k"]}, quantities={"H": curve(("1 Hz", "10 Hz"), 3)}, configurations=(), sampling=None,
            limits={"H": {"below": limit}}, answers={"rare": {"type": "failure_probability", "count": 20_000}},
        )  # fmt: skip
        rare = one.answers["rare"].conclude(one)
        assert rare.events["as given"].probability == pytest.approx(scipy.stats.norm.sf(3), rel=0.05)
        assert "largest H above" in rare.sentences[0]

    def test_yield_says_which_value_counts(self, whole):
        words = {one.limit for one in found(whole.study, "all", whole).shares}
        assert "largest H above 0.00022 rad/(N*m) or smallest H below 7e-05 rad/(N*m)" in words

    @pytest.mark.slow
    def test_a_limit_of_a_curve_may_come_later_where_all_is_kept(self, tmp_path):
        run_study(study(limits={}, answers={}), tmp_path)
        one = study(limits={"H": LIMITS["H"]}, answers={"y": {"type": "yield"}})
        share = found(one, "y", run_study(one, tmp_path)).of("stiff")
        assert share.value == pytest.approx(beyond_by_hand(one)["stiff", "H"].mean(), rel=1e-12)

    def test_a_curve_with_a_gap_is_beyond(self):
        limit = study().limits["H"]
        assert limit.beyond(np.array([[1e-4, 1e-4], [1e-4, np.nan]])).tolist() == [False, True]

    def test_weights_of_nothing(self):
        with pytest.raises(ModelError, match=r"answers\.a\.weights: .*out-of-range"):
            study(answers={"a": {"type": "yield", "weights": {"soft": 0}}})
