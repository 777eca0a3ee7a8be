"""Pair of an output and an input, whose transfer function is asked for, and its entry."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from torsionnet.base.entries.spec import EntryError, Json, Renaming, Schema, Spec, reference
from torsionnet.base.errors import UsageError, got
from torsionnet.model.channels import ChannelName


@dataclass(frozen=True)
class Pair:
    """Transfer function of an output over an input for a report, with the excitation if the input is measured.

    Examples
    --------
    >>> Pair.parse("theta_1/T_T")
    Pair(output='theta_1', input='T_T', excitation='')
    >>> print(Pair.parse("torque(gearbox, output_shaft) / T_M"))
    torque(gearbox, output_shaft)/T_M
    """

    output: str
    input: str
    excitation: str = ""

    @classmethod
    def parse(cls, text: str) -> Pair:
        """Transfer function that the text ``OUTPUT/INPUT`` names.

        Raises
        ------
        UsageError
            There is not exactly one ``/`` with a name on either side.
        """
        parts = [part.strip() for part in text.split("/")]
        if len(parts) != 2 or not all(parts):
            raise UsageError(
                f'a transfer function is written OUTPUT/INPUT, as in theta_1/T_T; got "{text}"', kind="wrong-form"
            )
        return cls(*parts)

    def __str__(self) -> str:
        return f"{self.output}/{self.input}"

    def to_data(self) -> str | dict[str, str]:
        """Plain data of the transfer function for a file."""
        if not self.excitation:
            return str(self)
        return {"output": self.output, "input": self.input, "excitation": self.excitation}


_CHANNEL = ChannelName("sensor, input or node")


class PairEntry(Spec[Pair]):
    """Entry of a pair of output and input, whose transfer function the report of a model shows.

    Written as ``OUTPUT/INPUT``, or in parts by name.
    """

    def coerce(self, raw: object) -> Pair:
        if isinstance(raw, Pair):
            return raw
        try:
            return Pair.parse(raw) if isinstance(raw, str) else self._in_parts(raw)
        except UsageError as error:
            raise EntryError(error.fault) from None

    @staticmethod
    def _in_parts(raw: object) -> Pair:
        if isinstance(raw, Mapping) and {"output", "input"} <= set(raw) <= set(_PARTS):
            return Pair(**{str(key): str(value) for key, value in raw.items()})
        raise UsageError(
            f"expected OUTPUT/INPUT, or {{output: ..., input: ..., excitation: ...}}; {got(raw)}", kind="wrong-form"
        )

    def renamed(self, value: Any, names: Renaming) -> Any:
        ends = (_CHANNEL.renamed(channel, names) for channel in (value.output, value.input, value.excitation))
        return Pair(*ends)

    def plain(self, value: Any) -> Json:
        data: Json = value.to_data()
        return data

    def schema(self) -> Schema:
        return reference("report_transfer_function")

    def definitions(self) -> Schema:
        detailed: Schema = {
            "type": "object",
            "properties": {name: {"type": "string", "description": text} for name, text in _PARTS.items()},
            "required": ["output", "input"],
            "additionalProperties": False,
        }
        text = {"type": "string", "description": self.description}
        return {"report_transfer_function": {"anyOf": [text, detailed]}}


_PARTS = {
    "output": "sensor or node, or torque(element, port)",
    "input": "input or node, or a sensor: a measured input",
    "excitation": "what drives while the input is measured, if there are several inputs",
}
"""Description of each key of a transfer function that is written in parts."""


PAIR = PairEntry("OUTPUT/INPUT, as theta_1/T_T")
"""Specification of an entry with a transfer function."""
