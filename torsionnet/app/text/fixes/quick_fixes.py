"""Quick fixes of faults in a model text that is sound YAML: edits after which a fault is gone and no other has come."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from torsionnet.app.text.entry_edits import WrittenText
from torsionnet.app.text.fixes import entry_fixes, name_fixes, notation_fixes, value_fixes
from torsionnet.app.text.fixes.fault_place import FaultPlace
from torsionnet.app.text.text_edits import TextEdit, TextFix, TextSpan
from torsionnet.base.errors import Fault, UsageError

_RULES: tuple[Callable[[FaultPlace], Iterable[TextFix]], ...] = (
    notation_fixes.colon_for_equals,
    notation_fixes.nodes_in_brackets,
    notation_fixes.damper_to_ground,
    notation_fixes.entries_indented,
    name_fixes.name_meant,
    value_fixes.sign_of_product,
    value_fixes.number_meant,
    value_fixes.point_for_comma,
    value_fixes.as_said,
    value_fixes.without_zeros,
    value_fixes.expected_unit_written,
    value_fixes.value_missing,
    entry_fixes.missing_entry,
    entry_fixes.entry_to_add,
    entry_fixes.spring_for_shaft,
    entry_fixes.entry_without_value,
    entry_fixes.given_twice,
    name_fixes.text_with_comma,
    value_fixes.other_form,
    entry_fixes.left_out,
    name_fixes.valid_name,
    entry_fixes.unused_parameter,
)


def quick_fixes(
    fault: Fault, span: TextSpan, written: WrittenText, others: Sequence[Fault] = ()
) -> tuple[TextFix, ...]:
    """Fixes of a fault in a text that is sound YAML, the likeliest first; none where nobody can know what was meant.

    Each one names what it writes. ``others`` are all faults of the text.
    """
    place = FaultPlace(fault, span, written, others)
    found: dict[tuple[TextEdit, ...], TextFix] = {}
    for rule in _RULES:
        try:
            for fix in rule(place):
                found.setdefault(fix.edits, fix)
        except UsageError:  # the text has no such entry, as where a part or another file has it
            continue
    return tuple(found.values())
