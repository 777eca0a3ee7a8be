"""Excitations by orders of running machinery; every module of this package is imported here."""

import importlib
import pkgutil

from torsionnet.machinery.excitations.order_excitation import (
    OrderExcitation,
    OrderTorques,
    TorqueShares,
    excitation_kinds,
)

for _name in sorted(module.name for module in pkgutil.iter_modules(__path__)):
    importlib.import_module(f"{__name__}.{_name}")

__all__ = ["OrderExcitation", "OrderTorques", "TorqueShares", "excitation_kinds"]
