"""Limits on what elements can bear, one rule in each file of this package."""

import importlib
import pkgutil

from torsionnet.machinery.limits.limit import Limit, limit_rules

for _module in pkgutil.iter_modules(__path__):
    importlib.import_module(f"{__name__}.{_module.name}")

__all__ = ["Limit", "limit_rules"]
