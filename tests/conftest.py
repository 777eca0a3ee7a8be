"""For all tests: one thread for small matrices, what was skipped for want of a tool, and the processor's time."""

import os
import sys
import tempfile
from collections import Counter
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

pytest.register_assert_rewrite("support")  # asserts in helpers tell their values, as those in tests do

from support import campaigns, collecting, processor_time  # noqa: E402

# Before numpy is loaded: threads of BLAS on tiny matrices cost half the time of all tests, and one worker runs per core.
for library in ("OPENBLAS", "OMP", "MKL"):
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")

# Users have blanks and umlauts in the names of their folders: so has the one of all temporary files, also of processes
# that tests start; workers get it from the first process. The locale C can write no umlauts.
STAND = f"Prüf stand {getattr(os, 'getuid', int)()}".encode(sys.getfilesystemencoding(), "ignore").decode()
if STAND not in tempfile.gettempdir():
    tempfile.tempdir = os.environ["TMPDIR"] = str(Path(tempfile.gettempdir(), STAND))
    Path(tempfile.tempdir).mkdir(exist_ok=True)

# How long an example takes depends on what else the machine does.
settings.register_profile("torsionnet", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("torsionnet")

collect_ignore = ["user_types/mistakes.py"]  # mistakes of users do not import

TOOLS = {
    "Chromium": "the system's packages, as apt-get install chromium",
    "playwright": "pip install playwright",
    "pdflatex": "the system's packages, as apt-get install lmodern texlive-latex-recommended texlive-latex-extra texlive-science",
    "pdftoppm": "the system's packages, as apt-get install poppler-utils",
    "compiler": "the system's packages, as apt-get install gcc, or pip install ziglang",
}
ROOT = Path(__file__).parents[1]
WANTING = "skipped for want of a tool"


@pytest.fixture(scope="session", autouse=True)
def built_documents():
    """Reports that tests of this process have built and that were not checked yet."""
    from torsionnet.report import build as module

    found = []
    build = module.build

    def noted(*arguments, **options):
        report = build(*arguments, **options)
        found.append(report)
        return report

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "build", noted)
        yield found


@pytest.fixture(autouse=True)
def documents_close(built_documents):
    """After each test: what the documents it has built print follows from their own digits (``printed_checks``)."""
    yield
    if built_documents:
        from support.printed_checks import document_faults

        from torsionnet.report.writers.markdown import MarkdownWriter

        texts = [MarkdownWriter(report, "figures").page() for report in built_documents]
        built_documents.clear()
        assert [fault for text in texts for fault in document_faults(text)] == []


@pytest.fixture(scope="session")
def chromium():
    """Pages of one Chromium for all tests of a process; skips, with a reason, where there is none."""
    from support.explore_pages import Pages, browser_or_skip

    path = browser_or_skip()
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        found = playwright.chromium.launch(executable_path=path, args=["--no-sandbox"])
        yield Pages(found)
        found.close()


def pytest_addoption(parser):
    campaigns.add_option(parser)
    processor_time.add_options(parser)
    parser.addoption("--reach", metavar="FILE", help="note in a file which functions every test calls (make reach)")
    parser.addoption(
        "--numbers", action="store_true", help="only files that pass rooms that calculate (make test-kernel)"
    )
    parser.addoption("--cases-of-each", metavar="N", type=int, help="of a test with more cases only N, evenly spread")


def pytest_configure(config):
    """Only campaigns try properties with many examples."""
    campaigns.many = config.getoption(campaigns.OPTION)
    config.pluginmanager.register(processor_time.ProcessorTime(config))
    if config.getoption("--reach"):
        from reach.plugin import Noting

        config.pluginmanager.register(Noting(config))
    config.pluginmanager.register(collecting)


def without_numbers(config):
    """Files and functions that a run for another kernel of BLAS leaves out; none in other runs."""
    if not config.getoption("--numbers"):
        return frozenset()
    from reach.recording import WITHOUT_NUMBERS

    return frozenset(WITHOUT_NUMBERS.read_text(encoding="utf-8").splitlines())


def pytest_ignore_collect(collection_path, config):
    """Do not even import files of tests that calculate nothing, where the kernel of BLAS is tried."""
    path = collection_path.resolve()
    named = path.is_relative_to(ROOT) and path.relative_to(ROOT).as_posix() in without_numbers(config)
    return named or None


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_collection_modifyitems(items, config):
    """Mark what a run tries with fewer examples, and what one without slow tests leaves out."""
    campaigns.leave_to_the_night(items)
    campaigns.leave_cases_out(items)
    if "campaign" in config.option.markexpr:  # to read files as syntax takes a tenth of collecting
        campaigns.mark_sized(items)
    if left_out := without_numbers(config):
        gone = [item for item in items if item.nodeid.partition("[")[0] in left_out]
        config.hook.pytest_deselected(items=gone)
        items[:] = [item for item in items if item.nodeid.partition("[")[0] not in left_out]
    yield  # marks that were not asked for leave out tests here
    if most := config.getoption("--cases-of-each"):
        items[:], gone = campaigns.most_of_each(items, most)
        config.hook.pytest_deselected(items=gone)


def pytest_terminal_summary(terminalreporter):
    """Name each tool whose lack left tests out, and where to get it."""
    reasons = Counter(
        report.longrepr[2].removeprefix("Skipped: ")
        for report in terminalreporter.stats.get("skipped", [])
        if isinstance(report.longrepr, tuple)
    )
    for reason, count in sorted(reasons.items()):
        for tool, where in TOOLS.items():
            if tool in reason:
                terminalreporter.write_line(f"{count} {WANTING}: {reason}; {where}")
                break
