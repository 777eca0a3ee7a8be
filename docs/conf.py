"""Settings of Sphinx for the documentation; ``make docs`` builds it without network."""

import gc
import subprocess
import sys
from pathlib import Path

DOCS = Path(__file__).parent
sys.path.insert(0, str(DOCS))
EXAMPLES = DOCS.parent / "examples"

from torsionnet.base.version import __version__  # noqa: E402

project = "torsionnet"
author = "torsionnet developers"
copyright = "2026, torsionnet developers"
release = version = __version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "mathml",
    "sphinx_design",
    "sphinx_gallery.gen_gallery",
]
exclude_patterns = [
    "_build",
    "generated",
    "manuals",
    "gallery/**/*.ipynb",
    "gallery/**/*.zip",
    "gallery/**/*.md5",
    "Thumbs.db",
]
nitpicky = False
suppress_warnings = ["sphinx_gallery.space_in_filename"]  # of the folders above the checkout; the examples have none
default_role = "code"

html_theme = "furo"
html_title = "torsionnet"
html_copy_source = False

myst_enable_extensions = ["dollarmath", "amsmath", "deflist", "colon_fence"]
myst_heading_anchors = 3

autodoc_member_order = "bysource"
autodoc_typehints = "description"
napoleon_google_docstring = False
napoleon_use_rtype = False

sphinx_gallery_conf = {
    "examples_dirs": [str(EXAMPLES)],
    "gallery_dirs": ["gallery"],
    "filename_pattern": r"[/\\]plot_",
    "within_subsection_order": "FileNameSortKey",
    "download_all_examples": False,
    "show_memory": False,
    "write_computation_times": False,  # its page loads scripts from elsewhere
    "remove_config_comments": True,
    "plot_gallery": "True",
    "capture_repr": (),
    "image_scrapers": ("gallery_figures", "matplotlib"),
    "reset_modules": ("matplotlib", "gallery_figures.record"),
    "reset_modules_order": "both",
}


def setup(app):
    """Connect the steps of the build: generated pages are written before the others are read."""
    import gallery_figures
    from pygments.lexers.special import TextLexer

    gallery_figures.forget_stale()
    gc.set_threshold(100_000, 50, 50)  # nodes of pages are no garbage; to look through them takes half the time
    app.add_lexer("csv", TextLexer)  # Pygments knows none for it
    app.connect("builder-inited", lambda _: subprocess.run([sys.executable, DOCS / "made_files.py"], check=True))
    app.connect("autodoc-process-docstring", for_sphinx, priority=400)
    app.connect("html-page-context", one_navigation, priority=400)  # before that of the theme


NAVIGATION = {}


def one_navigation(_app, name, _template, context, _doctree):
    """Let the 400 pages of the reference, which stand nowhere in the navigation, have it worked out once."""
    if name.startswith("reference/"):
        resolve = context["toctree"]
        context["toctree"] = lambda **how: NAVIGATION.get(str(how)) or NAVIGATION.setdefault(str(how), resolve(**how))


def for_sphinx(_app, what, _name, _object, _options, lines):
    """Escape |H| and colons of properties in docstring lines, in place, which Sphinx would take for markup."""
    if what in ("property", "attribute") and lines:
        lines[0] = lines[0].replace(": ", " \N{EN DASH} ", 1)
    lines[:] = [line.replace("|", r"\|") for line in lines]
