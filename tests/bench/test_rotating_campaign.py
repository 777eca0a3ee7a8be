"""Campaigns of rotating tests: orders of several records beside the model, repeatability, fit, and what is kept."""

import json
import shutil

import numpy as np
import pytest
from click.testing import CliRunner
from support import campaigns
from support.steady_campaign import CAMPAIGN, SPEED, STEADY_FAN, torque, write_steady_record

import torsionnet as tn
from torsionnet.app.cli.app import app
from torsionnet.base.errors import ModelError
from torsionnet.bench.campaign import running_campaign
from torsionnet.signals.records import recording_files as large_records


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "fan.yaml").write_text(STEADY_FAN, encoding="utf-8")
    (tmp_path / "test.yaml").write_text(CAMPAIGN, encoding="utf-8")
    for seed, name in enumerate(("first", "again")):
        write_steady_record(tmp_path / f"{name}.npz", seed, torque(SPEED))
    return tmp_path


def run(folder):
    return tn.run_campaign(tn.load_campaign(folder / "test.yaml"))


@pytest.fixture
def tracked(monkeypatch):
    """Names of the records that are tracked while a test runs."""
    names, original = [], running_campaign.record_orders

    def counted(campaign, name):
        names.append(name)
        return original(campaign, name)

    monkeypatch.setattr(running_campaign, "record_orders", counted)
    return names


def test_orders_of_each_record_are_those_of_the_written_torque(folder):
    result = run(folder)
    for found in result.records.values():
        measured = next(one for one in found.orders if one.name == "T").along(3)
        np.testing.assert_allclose(measured, torque(SPEED), atol=0.02 * abs(torque(SPEED)))
    assert {one.verdict for one in result.verdicts if one.output == "T" and one.order == 3} == {"agrees"}


def test_a_torque_of_another_sign_does_not_agree(folder):
    write_steady_record(folder / "first.npz", 5, -torque(SPEED))
    by_record = {one.record: one.verdict for one in run(folder).verdicts if one.output == "T" and one.order == 3}
    assert by_record["again"] == "agrees" != by_record["first"]


def test_spread_between_repeats_is_what_their_intervals_state(folder):
    (spread,) = (one for one in run(folder).spreads if one.channel == "T" and one.order == 3)
    assert spread.records == 2
    assert spread.amplitude == pytest.approx(abs(torque(SPEED)), rel=0.02)
    assert 0.3 < spread.ratio < 3


def test_only_the_record_that_changed_is_tracked_again(folder, tracked):
    run(folder)
    run(folder)
    assert tracked == ["first", "again"]
    write_steady_record(folder / "again.npz", 7, torque(SPEED))
    run(folder)
    assert tracked == ["first", "again", "again"]
    assert len(list((folder / "test.orders").glob("[fa]*-*"))) == 4  # orders and checks of either


def test_another_order_is_tracked_in_all_records_and_another_fit_in_none(folder, tracked):
    run(folder)
    file = folder / "test.yaml"
    file.write_text(CAMPAIGN + "fit: {parameters: [shaft.stiffness]}\n", encoding="utf-8")
    assert run(folder).fit.values["shaft.stiffness"] == pytest.approx(20e3, rel=0.05)
    assert len(tracked) == 2
    file.write_text(CAMPAIGN.replace("1:4:1", "1:5:1"), encoding="utf-8")
    run(folder)
    assert tracked == ["first", "again"] * 2


def test_records_done_before_a_campaign_is_killed_are_kept(folder, tracked, monkeypatch):
    counted = running_campaign.record_orders

    def killed(campaign, name):
        if name == "again":
            raise KeyboardInterrupt
        return counted(campaign, name)

    monkeypatch.setattr(running_campaign, "record_orders", killed)
    with pytest.raises(KeyboardInterrupt):
        run(folder)
    monkeypatch.setattr(running_campaign, "record_orders", counted)
    assert len(run(folder).records) == 2
    assert tracked == ["first", "again"]


def test_large_records_are_read_in_blocks_with_the_same_orders(folder, monkeypatch):
    text = CAMPAIGN.replace("gain: 2", "gain: 2, delay: 1.3 ms").replace("clean}\norders", "clean, start: 1 s}\norders")
    (folder / "test.yaml").write_text(text, encoding="utf-8")
    whole = run(folder)
    shutil.rmtree(folder / "test.orders")
    monkeypatch.setattr(large_records, "LARGE_FILE", 1000)
    monkeypatch.setattr(large_records, "BLOCK_SECONDS", 0.7)
    for name, found in run(folder).records.items():
        for one, other in zip(found.orders, whole.records[name].orders, strict=True):
            np.testing.assert_allclose(one.values, other.values, rtol=1e-9, atol=1e-9 * abs(one.values).max())


def test_a_delay_shifts_the_signal_to_earlier_times(folder):
    """Order 3 of a torque that comes late by 1.3 ms is that of the model turned back by 3 omega times the delay."""
    (folder / "test.yaml").write_text(CAMPAIGN.replace("gain: 2", "gain: 2, delay: 1.3 ms"), encoding="utf-8")
    (measured,) = (one for one in run(folder).records["first"].orders if one.name == "T")
    expected = torque(SPEED) * np.exp(3j * SPEED * 1.3e-3)
    np.testing.assert_allclose(measured.along(3), expected, atol=0.02 * abs(expected))


def test_a_folder_that_was_half_written_is_not_taken_for_a_result(folder, monkeypatch):
    write_orders, count = running_campaign.write_tracked_orders, []

    def killed(orders, path):
        count.append(path)
        if len(count) == 2:
            raise KeyboardInterrupt
        write_orders(orders, path)

    monkeypatch.setattr(running_campaign, "write_tracked_orders", killed)
    with pytest.raises(KeyboardInterrupt):
        run(folder)
    assert not list((folder / "test.orders").glob("first-*"))
    assert len(run(folder).records["first"].orders) == 2


def test_every_fault_of_a_campaign_file_has_its_place(folder):
    text = (
        CAMPAIGN.replace("clean}\norders", "rusty}\norders")
        .replace("teeth: 60", "teeth: 60, sensor: angel")
        .replace("first.npz", "frist.npz")
    )
    (folder / "test.yaml").write_text(text, encoding="utf-8")
    with pytest.raises(ModelError) as caught:
        tn.load_campaign(folder / "test.yaml")
    assert [(fault.position.line, fault.position.column, fault.kind) for fault in caught.value.faults] == [
        (5, 37, "unknown-channel"),
        (9, 17, "missing-file"),
        (10, 43, "unknown-configuration"),
    ]


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        (", configuration: clean", "", "missing-entry"),
        ("{T: {gain: 2}}", "{wheel: {}}", "repeated-name"),
        ("records:", "twists: {twist: {first: wheel, second: whee}}\nrecords:", r":8:40: .*unknown-name"),
        ("cycles: 10", "bandwidth: 1 Hz", r":11:38: .*needless-entry"),
        ("cycles: 10", "cycles: 10}\nfit: {rank: false", r":12:1: .*missing-entry"),
        ("cycles: 10", "cycles: 10}\nfit: {parameters: {c_9: {}}", r":12:25: .*unknown-parameter"),
        ("wheels:", "reference: weel\nwheels:", r":5:12: .*unknown-name"),
        ("{T: {gain: 2}}", "{T: {sensor: torque(shfat)}}", r":7:24: .*unknown-element"),
        ("{T: {gain: 2}}", "{T: {sensor: angle(dics)}}", r":7:24: .*unknown-node"),
        ("teeth: 60", "teeth: 60, start: 3", "unknown-entry"),
    ],
)
def test_what_contradicts_itself_is_refused(folder, before, after, words):
    (folder / "test.yaml").write_text(CAMPAIGN.replace(before, after), encoding="utf-8")
    with pytest.raises(ModelError, match=words):
        tn.load_campaign(folder / "test.yaml")


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ("channels: {T:", "channels: {T_2:", "record first: .*T_2"),
        ("index: mark", "index: marks", "record first: .*marks"),
        ("phase: {index: mark, tdc: 0 deg}", "phase: {tdc: 0 deg}", r"records\.first: .*ambiguous-tooth"),
        ("teeth: 60", "teeth: 6", "record first: "),
    ],
)
def test_what_a_record_lacks_is_said_with_its_name(folder, before, after, words):
    (folder / "test.yaml").write_text(CAMPAIGN.replace(before, after), encoding="utf-8")
    with pytest.raises(ModelError, match=words):
        run(folder)


def test_command_prints_json_and_writes_a_picture(folder, monkeypatch):
    monkeypatch.chdir(folder)
    found = CliRunner().invoke(app, ["campaign", "test.yaml", "--json", "--plot", "orders.png"])
    assert found.exit_code == 0, found.output
    data = json.loads(found.stdout)
    assert [one["name"] for one in data["records"]] == ["first", "again"]
    assert all((folder / file).is_file() for one in data["records"] for file in one["files"])
    assert {one["order"] for one in data["orders"]} == {3}
    assert list(folder.glob("orders*.png"))


@pytest.mark.slow
def test_virtual_run_up_of_a_ship_becomes_orders_with_verdicts_and_a_report(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    report = campaigns.examples("", "-o report.html ")  # a report of the ship runs up again in its plan of a test
    for command in ("bench marine_run_up -o run_up.npz", f"campaign marine_campaign {report}--json"):
        found = CliRunner().invoke(app, command.split())
        assert found.exit_code == 0, found.output
    orders = json.loads(found.stdout)["orders"]
    free = {one["order"]: one for one in orders if one["output"] == "phi_free"}
    # Half orders do not depend on the pitch errors of the wheel; two thirds of a percent are left by the run-up.
    for order in (1.5, 2.5, 3.5, 4.5):
        assert abs(free[order]["difference_of_peaks_percent"]) < 1
    assert not report or "measured" in (tmp_path / "report.html").read_text(encoding="utf-8")
    shutil.rmtree(tmp_path / "marine_campaign.orders")
