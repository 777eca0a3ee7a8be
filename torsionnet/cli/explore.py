"""``torsionnet explore``."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING

import click

from torsionnet.cli.models import STANDARD_INPUT, piped
from torsionnet.cli.options import model_options
from torsionnet.cli.terminal import message, say, tell

if TYPE_CHECKING:
    from torsionnet.explore import ExploreServer


@click.command("explore")
@model_options
@click.option(
    "--tf",
    "pairs",
    metavar="OUTPUT/INPUT",
    multiple=True,
    help='A response to offer, as "theta_1/T_M"; the first one is shown. Repeatable.',
)
@click.option("--band", nargs=2, type=float, metavar="LOW HIGH", help="Frequencies in Hz; default: from the modes.")
@click.option("--overlay", metavar="FILE", help="A measured response to lay over: CSV, NPZ, MAT, UFF58.")
@click.option("--port", type=click.IntRange(0, 65535), default=0, help="Default: any that is free.")
@click.option("--no-browser", is_flag=True, help="Only print the address.")
def command(
    model: str,
    configurations: tuple[str, ...],
    settings: tuple[tuple[str, str], ...],
    pairs: tuple[str, ...],
    band: tuple[float, float] | None,
    overlay: str | None,
    port: int,
    no_browser: bool,
) -> None:
    """A page in the browser to play with a model: sliders, responses, modes, poles. Ctrl-C ends it.

    \b
    torsionnet explore amt_rig -c V --tf theta_1/T_T
    torsionnet explore amt_rig -c V --tf theta_1/T_T --overlay gear_V.csv --band 0.5 40
    """
    from torsionnet.explore.state import HIGHEST

    if len(configurations) > 1 or "all" in configurations:
        raise click.UsageError(
            "the page begins with one configuration: name one with -c; all of them are tabs of the page"
        )
    if band and not 0 < band[0] < band[1] <= HIGHEST:
        raise click.UsageError(f"--band needs 0 < LOW < HIGH <= {HIGHEST:g} Hz, got {band[0]:g} {band[1]:g}")
    from torsionnet.explore import ExploreServer, open_session
    from torsionnet.explore.choices import read_pair

    session = open_session(
        model,
        "".join(configurations),
        dict(settings),
        [read_pair(pair) for pair in pairs],
        band,
        overlay,
        piped() if model == STANDARD_INPUT else None,
    )
    tell(session.base.check())
    with ExploreServer(session, port) as server:
        _serve(server, open_browser=not no_browser)


def _serve(server: ExploreServer, *, open_browser: bool) -> None:
    """Until Ctrl-C, which is the proper end."""
    say(server.address)
    message("note", "the page is on this machine only; Ctrl-C ends it")
    if open_browser:
        import webbrowser

        # A text browser in this terminal would not return.
        threading.Thread(target=webbrowser.open, args=(server.address,), daemon=True).start()
    try:
        server.serve_forever()
    except KeyboardInterrupt:
        message("note", "ended")
