"""What is told of parts and catalogues of the library that are named as models."""

from itertools import count

import pytest

from torsionnet.model.files.library import library_parts, other_use
from torsionnet.model.files.reader import read_text


@pytest.mark.parametrize("name", library_parts())
def test_a_part_can_be_used_as_it_says(name):
    """Its words with names of nodes put in are a use without faults of its own."""
    use = other_use(name).split("with use: ")[1].split("}}}")[0] + "}}}"
    numbers = count()
    while "..." in use:
        use = use.replace("...", f"n{next(numbers)}", 1)
    definition, faults = read_text(f"torsionnet: 1\nuse: {use.replace('NAME', 'u')}\n", "")
    assert [fault.message for fault in faults if fault.path[:1] in {("use",), ()} and fault.severity == "error"] == []
    assert next(numbers) >= 1
    assert definition is None or all(name.startswith("u.") for name in definition.elements)


def test_a_model_of_the_library_is_none_of_them():
    assert other_use("dmf_rig") == ""
