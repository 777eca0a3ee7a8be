"""Plots drawn into axes that a user gives: the figure stays the user's, and the curves are those of the plot alone."""

import functools
import importlib
import inspect
import pkgutil
import re

import numpy as np
import pytest
from support.every_result import NEEDED, PLOTS, response

import torsionnet as tn
from torsionnet import plot


@functools.cache
def plot_functions():
    """Functions of all modules of ``torsionnet.plot``, by name."""
    names = [one.name for one in pkgutil.walk_packages(plot.__path__, "torsionnet.plot.")]
    members = [member for name in names for member in vars(importlib.import_module(name)).values()]
    return {member.__name__: member for member in members if inspect.isfunction(member)}


def draw(name, **look):
    """The plot of a function of ``torsionnet.plot``, or of a module of it, which a result calls."""
    return plot_functions()[name](*PLOTS[name](), **NEEDED.get(name, {}), **look)


def user_figure(count):
    """A figure with a title of its own and one axes more than is given away."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9, 4 * count + 4), layout="constrained")
    figure.suptitle("mine")
    FigureCanvasAgg(figure)
    *given, spare = figure.subplots(count + 1, 1, squeeze=False).ravel()
    return figure, given, spare


def drawn(panels):
    """All that panels show, whatever its scale: data of lines, numbers of bars, areas and pictures."""
    lines = [np.asarray(line.get_xydata(), dtype=float) for one in panels for line in one.lines]
    return lines, [(len(one.patches), len(one.collections), len(one.images), len(one.texts)) for one in panels]


def needed(name):
    """Number of panels, from the refusal of none at all."""
    with pytest.raises(tn.UsageError, match="one axes for each") as refusal:
        draw(name, ax=[])
    said = re.match(
        r"this plot has (?:one panel|(\d+) panels)(?: \((.+)\))?, one axes for each; ax= has 0", str(refusal.value)
    )
    assert said, str(refusal.value)
    count = int(said[1] or 1)
    assert count == 1 or all(what.strip() for what in said[2].split(", "))
    return count


@pytest.mark.few(12)
@pytest.mark.parametrize("name", sorted({*PLOTS, *plot.__all__} - {"STYLE", "save"}))
def test_a_plot_is_drawn_into_the_axes_it_is_given(name):
    figure, given, spare = user_figure(needed(name))
    size, layout = figure.get_size_inches().tolist(), figure.get_layout_engine()
    own = draw(name)
    assert draw(name, title="a title", ax=given) is figure
    assert figure.get_size_inches().tolist() == size
    assert figure.get_suptitle() == "mine"
    assert figure.get_layout_engine() is layout
    assert figure.legends == []
    assert any(given[0].get_title(side).startswith("a title") for side in ("left", "center", "right"))
    assert not spare.lines
    lines, others = drawn([one for one in figure.axes if one is not spare])
    own_lines, own_others = drawn(own.axes)
    assert [line.tolist() for line in map(np.nan_to_num, lines)] == [
        line.tolist() for line in map(np.nan_to_num, own_lines)
    ]
    if name != "schematic":  # whose title is a text of the drawing
        assert [one for one in others if any(one)] == [one for one in own_others if any(one)]
    figure.canvas.draw()
    for panel in (one for one in given if one.get_legend() is not None):
        box, room = panel.get_legend().get_window_extent(), panel.get_window_extent().padded(1.0)
        if box.width < room.width and box.height < room.height:
            assert room.x0 <= box.x0 <= box.x1 <= room.x1
            assert room.y0 <= box.y0 <= box.y1 <= room.y1


def test_a_user_s_legend_and_title_stay_where_a_plot_has_none():
    _figure, given, _ = user_figure(2)
    given[1].plot([1, 2], label="my curve")
    given[1].legend(loc="lower right")
    given[0].set_title("my title")
    plot.bode(response(), title="", ax=given)
    assert given[1].get_legend()._loc_real == 4  # lower right
    assert given[0].get_title() == "my title"


def test_panels_of_one_frequency_axis_share_it():
    _, given, _ = user_figure(2)
    plot.bode(response(), ax=np.array(given))
    plot.bode(response(), ax=given)
    assert [panel.get_xscale() for panel in given] == ["log", "log"]
    assert given[0].get_xlim() == given[1].get_xlim()
    assert given[0].get_title() == response().title


@pytest.mark.parametrize(
    ("ax", "said"),
    [
        (lambda given: given[:1], "wrong-count"),
        (lambda given: given[0], "ax= has 1"),
        (lambda given: [*given, given[0]], "ax= has 3"),
        (lambda given: given[0].figure, "wrong-form"),
        (lambda _: "magnitude", "not str"),
    ],
)
def test_what_is_no_axes_for_each_panel_is_refused(ax, said):
    _, given, _ = user_figure(2)
    with pytest.raises(tn.UsageError, match=said):
        plot.bode(response(), ax=ax(given))
    assert not any(panel.lines for panel in given)


def test_axes_that_share_theirs_with_others_are_refused():
    from matplotlib.figure import Figure

    panels = Figure().subplots(2, 2, sharex="row")
    with pytest.raises(tn.UsageError, match="contradicting-values"):
        plot.bode(response(), ax=panels[:, 1])
