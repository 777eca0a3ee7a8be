"""Limits of flexible couplings and torsional dampers on torque, heat and twist as makers state them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar, TypeVar

import numpy as np

from torsionnet.base.entries.composite import one_at_most
from torsionnet.base.entries.scalars import Value, read_scalar
from torsionnet.base.entries.spec import EntryError, OneOf, entry, not_none
from torsionnet.base.errors import Fault
from torsionnet.base.expressions import Number
from torsionnet.base.phrases import joined, phrase
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.machinery.limits.element_limit import ElementLimit, constant_over_speed
from torsionnet.machinery.limits.evidence import Evidence, LimitSubject
from torsionnet.machinery.limits.limit import LimitLine, line_without_data, register_rule
from torsionnet.machinery.verdicts.limit_verdict import RuleText
from torsionnet.model.channels import Sensor

# Steady temperature of a part that vibration heats, by the balance of the heat it takes up and gives off.

ICE_POINT = 273.15
"""Temperature of 0 degC in K."""
Heat = TypeVar("Heat", float, FloatArray)
COLDEST = 200.0
"""Number without a unit from which on it is a temperature in K; smaller ones are refused, as they may be degC: no
machinery is as cold."""


class TemperatureValue(Value):
    """Entry of a fixed temperature with its unit, stored in K."""

    def coerce(self, raw: object) -> float:
        number = read_scalar(raw, self.dimension)
        if isinstance(number, Number) and number.unit_dimension is None and number.value < COLDEST:
            raise EntryError(f"a temperature has its unit: write {raw} degC, or {raw} K", kind="missing-unit")
        return super().coerce(raw)

    def plain(self, value: float) -> str:
        return f"{value!r} K"


def temperature_words(hottest: float) -> str:
    """Remark on the highest steady temperature, given in K."""
    return f"steady temperature by balance of heat at most {hottest - ICE_POINT:.3g} degC"


def steady_temperature(power: Heat, heat_transfer: float, ambient: float) -> Heat:
    """Steady temperature in K of a part that turns ``power`` into heat, in the shape of ``power``.

    The heat that the part takes up by damping leaves it by its surface: P = Lambda (t - t_a). It is the temperature
    reached after many time constants C/Lambda, with C the heat capacity, as a mean over the part; its core is warmer.

    Parameters
    ----------
    power : float or array
        Mean power dissipated, W.
    heat_transfer : float
        Lambda, heat given off per degree above ambient, W/K: surface times heat transfer coefficient, from the maker.
    ambient : float
        Temperature of the air around the part, K. IACS UR M40 (1986) has 45 degC in engine rooms.

    References
    ----------
    F. P. Incropera, D. P. DeWitt et al., Fundamentals of Heat and Mass Transfer, 6th ed. (2007), section 5.1: lumped
    capacitance.

    Examples
    --------
    >>> round(steady_temperature(800.0, 20.0, 45 + 273.15) - 273.15, 6)
    85.0
    """
    return (
        np.asarray(ambient + power / heat_transfer)
        if isinstance(power, np.ndarray)
        else ambient + power / heat_transfer
    )


# Limits of flexible couplings on torque, heat and twist as makers state them.

REFERENCE_HZ = 10.0
"""Frequency in Hz up to which DIN 740-2 takes the permissible vibratory torque of a coupling for constant."""
TORQUES = ("T_mean S_theta <= T_KN", "(T_mean + T_v) S_theta <= T_Kmax, also in passing")
VIBRATORY_BY_DIN = "T_v S_theta, orders times sqrt(f/10 Hz) above 10 Hz (DIN 740-2:1986), <= T_KW"
HEAT_ALLOWED = "P <= P_KV times the factor for temperature"
HEAT = "P = sum over frequencies of Re(T conj(dgamma/dt))/2 with T the whole torque, elastic and damping"
"""Clauses of the rule for couplings as reports print it; heat is that of dampers, too."""


@register_rule
@dataclass(frozen=True, kw_only=True)
class CouplingLimit(ElementLimit):
    """A flexible coupling: T_KN, T_Kmax, T_KW, P_KV and twist.

    Vibratory torque and heat hold in continuous operation, T_Kmax and twist also while a speed is passed. With
    ``frequency_factor: din_740_2`` every order is multiplied with sqrt(f/10 Hz) above 10 Hz before the orders are
    added up: for couplings whose T_KW is stated by that standard, and for no others. In a generating set
    ``speed_band`` says at which speeds it runs. With ``ambient_temperature`` and
    ``largest_temperature`` the steady temperature is judged, too, by the balance of heat t = t_a + P/Lambda.

    Examples
    --------
    >>> CouplingLimit(element="rubber", T_KN="50 kN*m", T_KW="15 kN*m", P_KV="1.2 kW").T_KW
    15000.0
    """

    kind: ClassVar[str] = "coupling"
    criteria: ClassVar[tuple[str, ...]] = (
        "T_KN",
        "T_Kmax",
        "T_KW",
        "P_KV",
        "twist",
        "vibratory_twist",
        "largest_temperature",
    )

    T_KN: float | None = entry(Value("nominal torque, for the mean torque", "torque", exclusive=True), None)
    T_Kmax: float | None = entry(Value("maximum torque, for mean and vibratory torque", "torque", exclusive=True), None)
    T_KW: float | None = entry(
        Value("vibratory torque in continuous operation, peak value", "torque", exclusive=True), None
    )
    P_KV: float | None = entry(
        Value("power it may turn into heat in continuous operation", "power", exclusive=True), None
    )
    twist: float | None = entry(Value("twist, mean and vibratory", "angle", exclusive=True), None)
    vibratory_twist: float | None = entry(Value("vibratory twist, peak value", "angle", exclusive=True), None)
    frequency_factor: str = entry(
        OneOf("whether T_KW falls above 10 Hz, as data by DIN 740-2 do", ("none", "din_740_2")), "none"
    )
    torque_temperature_factor: float = entry(Value("S_theta, multiplies torques that act", "1", lower=1), 1)
    power_temperature_factor: float = entry(Value("multiplies P_KV", "1", exclusive=True, below=1 + 1e-9), 1)

    ambient_temperature: float | None = entry(
        TemperatureValue("of the air around it, as 45 degC", "temperature", exclusive=True), None
    )
    largest_temperature: float | None = entry(
        TemperatureValue("that its rubber may have in continuous operation", "temperature", exclusive=True), None
    )
    heat_transfer: float | None = entry(
        Value(
            "heat it gives off per degree above ambient; default: P_KV at largest_temperature",
            "heat transfer",
            exclusive=True,
        ),
        None,
    )

    def contradictions(self) -> list[Fault]:
        faults = super().contradictions()
        ambient, largest = self.ambient_temperature, self.largest_temperature
        if (ambient is None) != (largest is None) or (self.heat_transfer is not None and ambient is None):
            text = "a balance of heat needs both ambient_temperature and largest_temperature, as 45 degC and 90 degC"
            faults.append(Fault(text, on_key=True, kind="missing-entry"))
        elif ambient is not None and largest is not None and largest <= ambient:
            faults.append(
                Fault(
                    "largest_temperature must be above ambient_temperature",
                    ("largest_temperature",),
                    kind="contradicting-values",
                )
            )
        return faults

    @property
    def given_off(self) -> float | None:
        """Heat in W/K that the coupling gives off per degree above ambient; None where nothing says it.

        Not given, it is P_KV over the rise at which makers state it, largest less ambient temperature.
        """
        if self.heat_transfer is not None or self.P_KV is None or self.largest_temperature is None:
            return self.heat_transfer
        return self.allowed_power / (self.largest_temperature - not_none(self.ambient_temperature))

    @property
    def allowed_power(self) -> float:
        """Power in W that the coupling may turn into heat at its temperature, NaN where it is not limited."""
        return math.nan if self.P_KV is None else self.P_KV * self.power_temperature_factor

    def order_sensors(self, subject: LimitSubject) -> list[Sensor]:
        del subject
        return [self.torque, self.twisting]

    def mean_sensors(self, subject: LimitSubject) -> list[Sensor]:
        del subject
        sensors = [self.torque] if self.T_KN is not None or self.T_Kmax is not None else []
        return sensors + ([self.twisting] if self.twist is not None else [])

    def power_elements(self) -> list[str]:
        return [self.element] if self.P_KV is not None or self.given_off is not None else []

    def vibratory_sensors(self, criterion: str, subject: LimitSubject) -> tuple[list[Sensor], float] | None:
        del subject
        return ([self.torque], 1.0) if criterion == "T_KW" and self.frequency_factor == "none" else None

    def passing_sensors(self, criterion: str, subject: LimitSubject) -> tuple[list[Sensor], float] | None:
        del subject
        sensor = {"T_Kmax": self.torque, "twist": self.twisting}.get(criterion)
        return None if sensor is None else ([sensor], 1.0)

    def rule_text(self, evidence: Evidence) -> RuleText:
        del evidence
        by_din = self.frequency_factor == "din_740_2"
        vibratory = phrase(VIBRATORY_BY_DIN if by_din else "T_v S_theta <= T_KW")
        theta = f"S_theta = {self.torque_temperature_factor:g}"
        half_range = phrase("T_v: half range of the sum of all orders")
        parts = [
            *map(phrase, TORQUES),
            vibratory,
            phrase(HEAT_ALLOWED),
            phrase(HEAT),
            half_range,
            theta,
            *self._balance(),
        ]
        formula = joined("; ", parts)
        missing = "starts, short circuits and other transients; radial and axial loads; heat of a steady slip"
        return RuleText(self.source, formula, missing)

    def lines(self, evidence: Evidence) -> Iterator[LimitLine]:
        # S_theta multiplies torques that act: the allowed ones are divided by it.
        factor, size = self.torque_temperature_factor, evidence.size([self.torque])
        nothing = np.zeros(len(evidence.speeds))
        if self.T_KN is not None:
            allowed = constant_over_speed(self.T_KN / factor, evidence)
            mean = LimitLine("T_KN", "mean torque", "N*m", nothing, allowed, vibratory=False)
            yield self.total(mean, self.torque, evidence)
        if self.T_Kmax is not None:
            line = LimitLine(
                "T_Kmax", "mean torque and half range", "N*m", size, constant_over_speed(self.T_Kmax / factor, evidence)
            )
            yield self.total(line, self.torque, evidence)
        if self.T_KW is not None:
            yield self._vibratory(evidence)
        if self.P_KV is not None:
            allowed = constant_over_speed(self.allowed_power, evidence)
            yield LimitLine("P_KV", "dissipated power", "W", evidence.power(self.element), allowed)
        yield from self._heating(evidence)
        yield from self._twists(evidence)

    def _heating(self, evidence: Evidence) -> Iterator[LimitLine]:
        """Rise of the steady temperature above ambient, against the rise up to the largest temperature."""
        if self.ambient_temperature is None or self.largest_temperature is None:
            return
        if self.given_off is None:
            yield line_without_data("temperature", "nothing says what heat it gives off; give heat_transfer or P_KV")
            return
        # P = Lambda (t - t_a), judged as a rise, so that a utilisation of 1 means the largest temperature.
        rise = steady_temperature(evidence.power(self.element), self.given_off, self.ambient_temperature)
        allowed = constant_over_speed(self.largest_temperature - self.ambient_temperature, evidence)
        hottest = float(np.max(rise))
        yield LimitLine(
            "temperature", "rise of steady temperature", "K", rise - self.ambient_temperature, allowed,
            (temperature_words(hottest),), steady_temperature=hottest,
        )  # fmt: skip

    def _balance(self) -> list[str]:
        if self.given_off is None or self.ambient_temperature is None or self.largest_temperature is None:
            return []
        ambient, largest = self.ambient_temperature - ICE_POINT, self.largest_temperature - ICE_POINT
        template = (
            "t = t_a + P/Lambda <= {largest:g} degC in steady operation, t_a = {ambient:g} degC, Lambda = {off:.4g} W/K"
        )
        return [phrase(template, largest=largest, ambient=ambient, off=self.given_off)]

    def _vibratory(self, evidence: Evidence) -> LimitLine:
        if self.frequency_factor == "din_740_2":
            # DIN 740-2: T_KW falls with sqrt(10 Hz/f) above 10 Hz, so that each order counts sqrt(f/10 Hz) times.
            weights = np.sqrt(np.maximum(evidence.run.frequencies, REFERENCE_HZ) / REFERENCE_HZ)
            values, orders = evidence.weighted(self.torque, weights)
        else:
            values, orders = evidence.size([self.torque]), evidence.orders([self.torque])
        allowed = constant_over_speed(not_none(self.T_KW) / self.torque_temperature_factor, evidence)
        return LimitLine("T_KW", "vibratory torque, half range", "N*m", values, allowed, (), orders)

    def _twists(self, evidence: Evidence) -> Iterator[LimitLine]:
        if self.twist is self.vibratory_twist is None:
            return
        size = evidence.size([self.twisting])
        if self.twist is not None:
            line = LimitLine(
                "twist", "mean twist and half range", "rad", size, constant_over_speed(self.twist, evidence)
            )
            yield self.total(line, self.twisting, evidence)
        if self.vibratory_twist is not None:
            allowed = constant_over_speed(self.vibratory_twist, evidence)
            yield LimitLine("vibratory twist", "twist, half range", "rad", size, allowed)


# Limits of torsional vibration dampers, viscous or with springs, on heat and twist.


@register_rule
@dataclass(frozen=True, kw_only=True)
class DamperLimit(ElementLimit):
    """A damper at the free end of a crankshaft: power it may turn into heat, also per area, and twist.

    Examples
    --------
    >>> DamperLimit(element="damper", power_per_area="5 kW/m^2", area="1.4 m^2").allowed_power
    7000.0
    """

    kind: ClassVar[str] = "damper"
    criteria: ClassVar[tuple[str, ...]] = ("power", "power_per_area", "vibratory_twist")
    alternatives: ClassVar[tuple[tuple[str, ...], ...]] = (("power",), ("power_per_area", "area"))

    power: float | None = entry(Value("power it may turn into heat", "power", exclusive=True), None)
    power_per_area: float | None = entry(Value("instead: per cooling area", "heat flux", exclusive=True), None)
    area: float | None = entry(Value("cooling area", "area", exclusive=True), None)
    vibratory_twist: float | None = entry(Value("twist of ring against hub, peak value", "angle", exclusive=True), None)

    def contradictions(self) -> list[Fault]:
        faults = super().contradictions() + one_at_most(self, "power", "power_per_area")
        if (self.power_per_area is None) != (self.area is None):
            faults.append(Fault("power_per_area and area go together", on_key=True, kind="missing-entry"))
        return faults

    @property
    def allowed_power(self) -> float | None:
        """Power in W that the damper may turn into heat, None where it is not limited."""
        per_area = None if self.power_per_area is None else float(self.power_per_area * not_none(self.area))
        return float(self.power) if self.power is not None else per_area

    def order_sensors(self, subject: LimitSubject) -> list[Sensor]:
        del subject
        return [self.twisting]

    def power_elements(self) -> list[str]:
        return [self.element] if self.allowed_power is not None else []

    def rule_text(self, evidence: Evidence) -> RuleText:
        del evidence
        parts = [phrase(HEAT)]
        if self.power_per_area is not None:
            parts.append(f"P <= {self.power_per_area / 1000:g} kW/m^2 x {self.area:g} m^2")
        elif self.power is not None:
            parts.append(f"P <= {self.power / 1000:g} kW")
        if self.vibratory_twist is not None:
            parts.append(phrase("half range of twist <= vibratory_twist"))
        return RuleText(
            self.source, joined("; ", parts), "ageing of the fluid, temperature of the film, wear of springs"
        )

    def lines(self, evidence: Evidence) -> Iterator[LimitLine]:
        if self.allowed_power is not None:
            allowed = constant_over_speed(self.allowed_power, evidence)
            yield LimitLine("P", "dissipated power", "W", evidence.power(self.element), allowed)
        if self.vibratory_twist is not None:
            allowed, twist = constant_over_speed(self.vibratory_twist, evidence), [self.twisting]
            orders = evidence.orders(twist)
            yield LimitLine("vibratory twist", "twist, half range", "rad", evidence.size(twist), allowed, (), orders)
