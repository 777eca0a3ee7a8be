"""Settings of Sphinx for the manuals on paper: theory and verification, each a document of LaTeX with the version.

``docs/manuals/print_manuals.py`` runs Sphinx with them on the pages of ``docs``.
"""

import os
import re
import subprocess
import sys
from datetime import UTC, datetime
from pathlib import Path

DOCS = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(DOCS))

from conf import author, copyright, project, release, version  # noqa: E402, F401, A004
from docutils import nodes  # noqa: E402
from sphinx import addnodes  # noqa: E402

extensions = ["myst_parser"]
root_doc = "manuals/index"
include_patterns = ["manuals/index.md", "theory/**", "verification.md"]
exclude_patterns = ["generated/**"]
myst_enable_extensions = ["dollarmath", "amsmath", "deflist", "colon_fence"]
myst_heading_anchors = 3
smartquotes = False
DATE = datetime.fromtimestamp(int(os.environ.get("SOURCE_DATE_EPOCH", datetime.now(UTC).timestamp())), UTC)
"""Date of the manuals; SOURCE_DATE_EPOCH gives another than that of the day, so that builds can be repeated."""
today = DATE.strftime("%Y-%m-%d")

latex_documents = [
    ("theory/index", "torsionnet-theory.tex", "torsionnet: theory manual", author, "howto"),
    ("verification", "torsionnet-verification.tex", "torsionnet: verification manual", author, "howto"),
]
latex_domain_indices = False
latex_show_urls = "no"
latex_table_style = ["booktabs"]
PREAMBLE = r"""
\usepackage{etoolbox}
\AtBeginEnvironment{tabulary}{\small}
\AtBeginEnvironment{longtable}{\small}
\makeatletter
\fancypagestyle{normal}{%
  \fancyhf{}\renewcommand{\headrulewidth}{0pt}\renewcommand{\footrulewidth}{0.4pt}%
  \fancyfoot[L]{\small\@title}\fancyfoot[C]{\small version VERSION, DATE}\fancyfoot[R]{\small\thepage}}
\fancypagestyle{plain}{%
  \fancyhf{}\renewcommand{\headrulewidth}{0pt}\renewcommand{\footrulewidth}{0.4pt}%
  \fancyfoot[L]{\small\@title}\fancyfoot[C]{\small version VERSION, DATE}\fancyfoot[R]{\small\thepage}}
\makeatother
\pagestyle{normal}
"""
latex_elements = {
    "papersize": "a4paper",
    "pointsize": "10pt",
    "fontpkg": r"\usepackage{lmodern}",
    "fncychap": "",
    "releasename": "version",
    "printindex": "",
    "maketitle": r"\sphinxmaketitle",
    "preamble": PREAMBLE.replace("VERSION", release).replace("DATE", today),
    "sphinxsetup": "hmargin={25mm,25mm}, vmargin={22mm,25mm}, verbatimwithframe=false, TitleColor={RGB}{0,0,0}",
}
TAG = re.compile(r"\s*\\tag\{([^}]*)\}")


def setup(app):
    """Connect what adapts the pages to paper."""
    app.connect("builder-inited", lambda _: _write_generated())
    app.connect("doctree-read", _adapted)


def _write_generated():
    """Write the generated part of the verification manual, which `docs/conf.py` writes for HTML."""
    subprocess.run([sys.executable, DOCS / "made_files.py", "verification.md"], check=True)


def _adapted(app, doctree):
    """Turn links to pages that are not in the manuals into their titles, and numbered equations into LaTeX's."""
    for link in list(doctree.findall(addnodes.pending_xref)):
        _unlinked(app, link)
    for block in doctree.findall(nodes.math_block):
        block["nowrap"] = block["no-wrap"] = True
        block.children[:] = [nodes.Text(displayed(block.astext()))]


def _unlinked(app, link):
    target = link["reftarget"]
    if link.get("refdomain") != "doc" or target in app.env.found_docs:
        return
    title = link.astext() or _title(target)
    link.replace_self(nodes.emphasis("", title))


def _title(page):
    """Heading of a page of the documentation."""
    path = DOCS / f"{page}.md"
    text = path.read_text(encoding="utf-8") if path.exists() else ""
    found = re.search(r"^# (.+)$", text, re.MULTILINE)
    return found[1] if found else page


def displayed(latex):
    """LaTeX of a displayed formula with the environment that its lines and its number need."""
    tag = TAG.search(latex)
    body = TAG.sub("", latex).strip()
    if (r"\\" in body or "&" in body) and not body.startswith(r"\begin{aligned}"):
        inside = re.sub(r"\\begin\{(\w+)\}.*?\\end\{\1\}", "", body, flags=re.DOTALL)
        if r"\\" in inside or "&" in inside:
            body = r"\begin{aligned}" + body + r"\end{aligned}"
    return r"\begin{equation*}" + body + (rf"\tag{{{tag[1]}}}" if tag else "") + r"\end{equation*}"
