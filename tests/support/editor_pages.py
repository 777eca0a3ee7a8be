"""The explore page with its text pane in headless Chromium: typing, and what the page says to it."""

import re
import threading
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import urlsplit

from support.explore_pages import WIDE, Visit, visit
from torsionnet.app.explore import ExploreServer, open_documents

ROOT = Path(__file__).parents[2]
README_MODEL = re.search(
    r"```yaml\n(torsionnet: 1\nname: motor and load\n.*?)```",
    (ROOT / "README.md").read_text(encoding="utf-8"),
    re.DOTALL,
)[1]


@contextmanager
def serving_text(path=None, text=None):
    """A server of a file, or of a text without one."""
    documents, _ = open_documents(path) if text is None else open_documents(text=text, is_template=True)
    with ExploreServer(documents) as server:
        thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True)
        thread.start()
        try:
            yield server
        finally:
            server.shutdown()
            thread.join()


class Writing:
    """A page one writes on."""

    def __init__(self, found: Visit):
        self.found, self.page = found, found.page
        self.keys = found.page.keyboard

    def until(self, question, what):
        self.found.until(question, what)

    @property
    def text(self):
        return self.page.evaluate("torsionnet.text()")

    def checked(self):
        """Faults, results and outline belong to the text that stands there."""
        self.until(lambda: self.page.evaluate("torsionnet.isChecked()"), "an answer to the text")
        self.found.settle()
        return self

    def faults(self):
        """Messages of errors, as the list below the text says them."""
        self.checked()
        return self.page.locator("#fault-list li.error .go").all_inner_texts()

    def focus(self):
        self.page.locator(".cm-content").focus()

    def put(self, text):
        """Take the place of the whole text, in one go."""
        self.focus()
        self.keys.press("Control+a")
        if text:
            self.keys.insert_text(text)
        else:
            self.keys.press("Delete")
        return self.checked()

    def go_to(self, word):
        """Select a word of the text by searching for it."""
        self.focus()
        self.keys.press("Control+Home")
        self.keys.press("Control+f")
        self.keys.press("Control+a")
        self.keys.type(word)  # the search listens to keys
        self.keys.press("Enter")
        self.keys.press("Escape")

    def exchange(self, old, new):
        """Overwrite a stretch of the text with another one."""
        self.go_to(old)
        self.keys.insert_text(new)
        return self.checked()

    def said(self):
        return self.page.inner_text("#said")

    def dialog(self):
        self.until(lambda: self.page.locator("dialog").count() == 1, "a dialog")
        return self.page.locator("dialog")

    def is_title_marked(self):
        return self.page.title().startswith("●")


def ready(found):
    """Page with its text, checked."""
    writing = Writing(found)
    writing.until(lambda: found.page.evaluate("Boolean(globalThis.torsionnet?.text)"), "the text")
    return writing.checked()


@contextmanager
def writing_on(chromium, server, **options):
    """The page of a server; afterwards nothing was said on its console and nothing asked of anyone else."""
    with visit(chromium, server.address, **({"viewport": WIDE} | options)) as page:
        yield ready(page)
        assert page.console == [], page.console
        asked = {urlsplit(url).netloc for url in page.requests if not url.startswith(("blob:", "data:"))}
        assert asked == {urlsplit(server.address).netloc}
