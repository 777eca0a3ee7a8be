"""Formulas as MathML, which browsers draw without script and network."""

import re
from html import escape

from docutils import nodes
from latex2mathml.converter import convert


def visit_math(writer, node):
    writer.body.append(mathml(node.astext(), "inline"))
    raise nodes.SkipNode


def visit_displaymath(writer, node):
    latex, number = without_number(node.astext())
    shown = f'<span class="eqno">({escape(number)})</span>' if number else ""
    writer.body.append(f'<div class="math">{shown}{mathml(latex, "block")}</div>')
    raise nodes.SkipNode


def mathml(latex, display):
    """MathML of a formula, with its LaTeX source for copying."""
    text = convert(wrapped(latex).replace("{aligned}", "{align*}"), display=display)
    return text.replace("<math ", f'<math title="{escape(" ".join(latex.split()), quote=True)}" ', 1)


def without_number(latex):
    """LaTeX of a formula without its ``\\tag{3.2}``, and the number itself, empty if it has none."""
    found = re.search(r"\s*\\tag\{([^}]*)\}", latex)
    return (latex.replace(found[0], ""), found[1]) if found else (latex, "")


def wrapped(latex):
    """LaTeX of a displayed formula in the environment that its lines and columns need."""
    has_lines = (r"\\" in latex or "&" in latex) and r"\begin" not in latex
    return rf"\begin{{aligned}}{latex}\end{{aligned}}" if has_lines else latex


def setup(app):
    app.add_html_math_renderer("mathml", (visit_math, None), (visit_displaymath, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
