"""Blocks of variants for tests of quantities: with their coefficients where that is possible, and without."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache

import numpy as np

import torsionnet as tn
from torsionnet.machinery.excitations.speed_range import SpeedRange
from torsionnet.study.quantities.quantity import VariantBlock


def spread(model: tn.Drivetrain, names: tuple[str, ...], count: int = 5, width: float = 0.2) -> dict[str, np.ndarray]:
    """Values around those of the model, different ones in every variant."""
    rng = np.random.default_rng(7)
    return {name: model.parameters[name] * rng.uniform(1 - width, 1 + width, count) for name in names}


def singly(model: tn.Drivetrain, values: Mapping[str, np.ndarray], **quantities: object) -> VariantBlock:
    """A block whose variants are models of their own."""
    return VariantBlock(model, values, quantities, None)


def together(model: tn.Drivetrain, values: Mapping[str, np.ndarray], **quantities: object) -> VariantBlock:
    """A block whose variants are solved together."""
    from torsionnet.linear.batch.batch_plan import batch_plan

    plan = batch_plan(model, tuple(values))
    assert plan is not None
    return VariantBlock(model, values, quantities, plan.batch(values))


def columns(values: Mapping[str, np.ndarray]) -> list[dict[str, float]]:
    """The values of every variant."""
    return [dict(zip(values, map(float, row), strict=True)) for row in zip(*values.values(), strict=True)]


THREE = SpeedRange(of="fly", list=["400 rpm", "600 rpm", "750 rpm"], rated="750 rpm")


@cache
def amt_rig() -> tn.Drivetrain:
    return tn.load("amt_rig").configured("II")


@cache
def dmf_rig() -> tn.Drivetrain:
    return tn.load("dmf_rig")


@cache
def ship() -> tn.Drivetrain:
    return tn.load("marine_medium_speed")


@cache
def ship_at_three_speeds() -> tn.Drivetrain:
    return ship().with_definition(replace(ship().definition, speeds=THREE))


@cache
def held_ship() -> tn.Drivetrain:
    """With the propeller's damping of full power at all speeds: one set of modes instead of one for each crossing."""
    return ship_at_three_speeds().configured(Q_prop="188.7 kN*m", n_prop="151.8 rpm")


@cache
def misfiring_ship() -> tn.Drivetrain:
    return ship_at_three_speeds().configured("firing=misfire")


@cache
def turbine_generator() -> tn.Drivetrain:
    return tn.load("turbine_generator_ssr")
