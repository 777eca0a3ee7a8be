"""Outputs that cannot be written: the message names the file that was asked for, and nothing is left behind."""

import errno
import os
from pathlib import Path

import pytest
from click.testing import CliRunner

import torsionnet as tn
from torsionnet.app.cli.app import app
from torsionnet.base import atomic

MODES = ["modes", "dmf_rig", "--csv"]
links = pytest.mark.skipif(os.name == "nt", reason="links need rights that Windows users do not have")


def full(*_args, **_more):
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def told(*command):
    result = CliRunner().invoke(app, list(map(str, command)))
    assert result.exit_code == 74, result.output
    assert "bug" not in result.output
    return result.output


@links
@pytest.mark.parametrize("length", [1, 2, 3])
def test_links_that_lead_to_each_other(tmp_path, length):
    names = [tmp_path / f"{number}.csv" for number in range(length)]
    for number, name in enumerate(names):
        name.symlink_to(names[(number + 1) % length])
    assert f"{names[0]}: a link that" in told(*MODES, names[0])
    assert sorted(tmp_path.iterdir()) == sorted(names)


@links
def test_a_link_to_nowhere_names_both_ends(tmp_path):
    link, target = tmp_path / "out.csv", tmp_path / "gone" / "there.csv"
    link.symlink_to(target)
    output = told(*MODES, link)
    assert f"{link} (a link to {target}): {os.strerror(errno.ENOENT)}" in output


def test_a_full_disk_names_the_file(tmp_path, monkeypatch):
    monkeypatch.setattr(Path, "write_bytes", full)
    path = tmp_path / "out.csv"
    assert f"error: {path}: {os.strerror(errno.ENOSPC)}" in told(*MODES, path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.few(1)
@pytest.mark.parametrize("after", [0, 2])
def test_a_full_disk_leaves_no_figures(tmp_path, monkeypatch, after):
    """A report with its figures beside it: all of its files, or none and no folder."""
    written = []
    real = Path.write_bytes

    def until_full(self, data):
        written.append(self)
        return full() if len(written) > after else real(self, data)

    monkeypatch.setattr(Path, "write_bytes", until_full)
    assert os.strerror(errno.ENOSPC) in told("report", "dmf_rig", "--write", tmp_path / "rig.md")
    assert len(written) == after + 1
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="the system has no named pipes")
def test_a_pipe_that_nobody_reads(tmp_path, monkeypatch):
    monkeypatch.setattr(atomic, "PIPE_TIMEOUT", 0.2)
    pipe = tmp_path / "pipe.csv"
    os.mkfifo(pipe)
    assert f"{pipe}: nobody has opened" in told(*MODES, pipe)
    assert list(tmp_path.iterdir()) == [pipe]


def test_other_errors_keep_their_own_file(tmp_path):
    with pytest.raises(FileNotFoundError) as caught, atomic.atomic_replacement(tmp_path / "out.csv"):
        (tmp_path / "input.csv").read_text()
    assert caught.value.filename == str(tmp_path / "input.csv")


@pytest.mark.parametrize("ratio", ["5e-324", "1e-41", "2e300", "1:1e300", "1e41"])
def test_a_speed_ratio_of_no_size(tmp_path, ratio):
    path = tmp_path / "sheet.csv"
    path.write_text(f"mass;J [kg*m^2];k [kN*m/rad];speed ratio\na;1.5;40;1\nb;2;;{ratio}\n", encoding="utf-8")
    with pytest.raises(tn.ModelError, match=r":3:6: .*implausible-size"):
        tn.io.read_mass_elastic(path)


@pytest.mark.parametrize("exponent", ["1e9", "-11", "10.5"])
def test_a_torque_exponent_of_no_load(exponent):
    text = f"""torsionnet: 1
elements: {{a: {{type: inertia, node: a, inertia: 1}}}}
load: {{absorbed_at: a, power: 3 kW, rated: 100 rpm, torque_exponent: {exponent}, driven_by: {{a: 1}}}}
"""
    with pytest.raises(tn.ModelError, match=r":3:70: .*-10.*out-of-range"):
        tn.loads(text)
