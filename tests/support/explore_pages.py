"""A page in headless Chromium, with everything it says on its console and every address it asks for."""

import re
import shutil
import threading
import time
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any
from urllib.parse import urlsplit

import pytest

from support.patience import wait_for
from torsionnet.app.explore import ExploreServer, open_documents

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "microsoft-edge")
WIDE = {"width": 1440, "height": 900}
SLOW = 500.0
"""ms; on a quiet machine an update takes 25. A shared one that builds other things meanwhile is no fault of ours."""
DRAWN = """() => {
  const data = globalThis.torsionnet.drawn();
  return data.map(({ kind, x, magnitude, phase }) => ({ kind, frequencies: x, magnitude, phase }));
}"""


def chromium():
    """The path of an installed Chromium, or None."""
    return next(filter(None, map(shutil.which, NAMES)), None)


def browser_or_skip():
    """The path of Chromium; skips where there is none, and says so."""
    pytest.importorskip("playwright", reason="pages are opened with playwright")
    path = chromium()
    if path is None:
        pytest.skip(f"no Chromium is installed (looked for {', '.join(NAMES)}): no page was opened")
    return path


@contextmanager
def serving(model, **options):
    """A server in a thread of its own."""
    with ExploreServer(open_documents(model, **options)[0]) as server:
        thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True)
        thread.start()
        try:
            yield server
        finally:
            server.shutdown()
            thread.join()


class Pages:
    """Pages of one context of a browser: each new context would start a process and compile every script again."""

    def __init__(self, browser):
        self.context = browser.new_context(viewport=WIDE)

    @contextmanager
    def new(self, viewport=WIDE, **media):
        """A page of a size and with media, as ``color_scheme``; what it keeps in the browser goes with it."""
        page = self.context.new_page()
        if viewport != WIDE:
            page.set_viewport_size(viewport)
        if media:
            page.emulate_media(**media)
        try:
            yield page
        finally:
            if page.url.startswith("http"):
                page.evaluate("localStorage.clear()")
            page.close()


@dataclass
class Visit:
    """An open page and what was noticed on it."""

    page: Any
    console: list = field(default_factory=list)
    requests: list = field(default_factory=list)

    @property
    def updates(self):
        return self.page.evaluate("globalThis.torsionnet ? globalThis.torsionnet.updates : 0")

    def until(self, question, what):
        """Wait for something on the page. (The page forbids the evaluation that playwright would wait with.)"""
        wait_for(question, lambda: f"{what} did not happen; console: {self.console}")

    @contextmanager
    def update(self):
        """Do something, then wait until the page has drawn an answer to it."""
        before = self.updates
        yield
        self.until(lambda: self.updates > before, "an update")
        self.settle()

    def settle(self):
        """Every question has been answered, also those that an answer led to."""
        quiet = 0
        while quiet < 3:
            quiet = quiet + 1 if self.page.evaluate("globalThis.torsionnet.underWay()") == 0 else 0
            time.sleep(0.03)

    def keep(self, way):
        """Choose another way of saving from the menu."""
        self.page.click("#more")
        self.page.click(f"#{way}")

    def text(self, selector):
        return self.page.inner_text(selector)


@contextmanager
def visit(pages, address, before="", **options):
    """The page behind an address, ready; a script may run before those of the page."""
    with pages.new(**options) as page:
        if before:
            page.add_init_script(before)
        page.add_init_script("localStorage.setItem('torsionnet choosers', 'open')")
        found = Visit(page)
        page.on("console", lambda message: found.console.append(message.text))
        page.on("pageerror", lambda error: found.console.append(str(error)))
        page.on("request", lambda request: found.requests.append(request.url))
        page.goto(address)
        found.until(lambda: found.updates, "the first curve")
        yield found


def kept_quiet(found, amt):
    """Whether nothing was said on the console and nothing asked of anyone but the server."""
    asked = {urlsplit(url).netloc for url in found.requests if not url.startswith(("blob:", "data:"))}
    return found.console == [] and asked == {urlsplit(amt.address).netloc}


def drawn(found):
    """The curves as they are handed to the plots."""
    return found.page.evaluate(DRAWN)


def slider(found, name):
    return found.page.get_by_role("slider", name=re.compile(rf"^{name}\b"))
