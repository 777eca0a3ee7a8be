"""Page on the kinds of faults, made from their table."""

from __future__ import annotations

from pygments.lexers import YamlLexer
from pygments.token import Error

from torsionnet.app.text.text_faults import GROUPS, RIG, FaultKind, fault_kinds
from torsionnet.base.errors import in_brackets


def faults_page() -> str:
    """Sections on all kinds of faults, group by group."""
    parts = ["Examples without elements belong to this drivetrain:", _block("yaml", RIG)]
    for group, title in GROUPS.items():
        parts += [f"## {title}", *(_section(one) for one in fault_kinds().values() if one.group == group)]
    return "\n\n".join(parts) + "\n"


def _section(kind: FaultKind) -> str:
    language = "yaml" if kind.model else "python" if kind.python else "text"
    said = _block("text", f"{kind.says}{in_brackets(kind.name)}")
    mended = _block(language, kind.changed_lines) if kind.changed_lines else "by leaving it out"
    return f"### {kind.name}\n\n{kind.means}\n\n{_block(language, kind.text)}\n\n{said}\n\nMended:\n\n{mended}"


def _block(language: str, text: str) -> str:
    if language == "yaml" and any(token is Error for token, _ in YamlLexer().get_tokens(text)):
        language = "text"  # no lexer colours what is no YAML
    return f"```{language}\n{text.rstrip()}\n```"
