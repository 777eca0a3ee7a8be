"""Tables of a simulated motion against energies written here."""

import numpy as np
import pytest

from torsionnet.motion.motion_record import energy_table
from torsionnet.signals.recording import EnergyBalance, Recording, Signal


@pytest.mark.parametrize(
    ("energy", "words"),
    [
        (EnergyBalance(10.0, 7.5, {"clutch": 2.5}), "supplied 10 J, stored 7.5 J, nothing left over"),
        (EnergyBalance(10.0, 7.5, {"clutch": 2.5 - 1e-9}), "supplied 10 J, stored 7.5 J, nothing left over"),
        (EnergyBalance(10.0, 7.5, {"clutch": 2.4}), "supplied 10 J, stored 7.5 J, 0.1 J left over"),
        (EnergyBalance(0.0, -2.0, {"clutch": 2.0 + 1e-8}), "supplied 0 J, stored -2 J, -1e-08 J left over"),
        (EnergyBalance(0.0, 0.0), "supplied 0 J, stored 0 J, nothing left over"),
    ],
)
def test_energies_that_do_not_add_up_are_told(energy, words):
    signal = Signal("T", "torque", np.zeros(2))
    assert energy_table(Recording((signal,), 10.0, energy=energy)).notes[-1] == words


def test_record_without_an_energy_balance_has_no_table_of_it():
    assert energy_table(Recording((Signal("T", "torque", np.zeros(2)),), 10.0)) is None
