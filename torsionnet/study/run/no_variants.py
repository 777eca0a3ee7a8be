"""Why a study has no variants of its own, and what gives it some."""

from __future__ import annotations

from torsionnet.study.space.space import Space

SAMPLING = "sampling: {count: 1000}"


def no_variants(space: Space) -> str:
    """What to give a study that has none.

    Examples
    --------
    >>> import torsionnet as tn
    >>> from torsionnet.study.space.variations.normal import Normal
    >>> from torsionnet.study.space.variations.value_list import ListOfValues
    >>> rig, drawn = tn.load("amt_rig"), {"k_2": Normal(deviation="5 %")}
    >>> no_variants(Space(rig, drawn))
    'the study has no variants of its own: give sampling: {count: 1000}, or lists or ranges of values'
    >>> no_variants(Space(rig, {**drawn, "c_O": ListOfValues(values=[170, 360])}))
    'k_2 has a distribution and is not drawn: give sampling: {count: 1000}, or a list or range of values like c_O'
    """
    if not space.grid:
        return f"the study has no variants of its own: give {SAMPLING}, or lists or ranges of values"
    drawn = space.random_names
    has = "has a distribution and is" if len(drawn) == 1 else "have distributions and are"
    like = "a list or range" if len(drawn) == 1 else "lists or ranges"
    return f"{', '.join(drawn)} {has} not drawn: give {SAMPLING}, or {like} of values like {', '.join(space.grid)}"
