# Needs make and Python >= 3.11, nothing else: each target first installs what it needs into .venv (once).
# Choose an interpreter with `make PYTHON=python3.13 ...`; further arguments with `make test ARGS="-k gear"`.

PYTHON ?= python3
ARGS ?=
SECONDS ?= 600

VENV := .venv
OLDEST := .venv-oldest
NEWEST := .venv-newest
CITATION := .venv-citation
RUN := $(VENV)/bin/python
PIP := $(RUN) -m pip --disable-pip-version-check
NIGHTLY := $(addprefix nightly-,kernels packages mutation fuzz campaigns release)
BENCHMARKS := $(basename $(notdir $(wildcard benchmarks/[!_]*.py)))

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
.NOTPARALLEL:
.PHONY: help signatures demo figures identify test test-slow test-all test-campaigns test-kernel test-oldest test-newest test-nightly $(NIGHTLY) wheel compare compare-parts structure hops move join outputs reach test-changed mutation fuzz precheck lint format types generate docs manuals bench bench-short release-files clean

help:  ## show this list
	@awk -F ':.*## ' '/^[a-z-]+:.*## / {printf "  make %-11s %s\n", $$1, $$2}' Makefile

demo: $(VENV)/.installed  ## tables on the screen, plots and reports in out/
	$(RUN) examples/demo/run_all.py

figures: $(VENV)/.installed  ## only the figures of the virtual test bench, in out/
	$(RUN) examples/demo/figures.py

identify: $(VENV)/.installed  ## the paper's identification on the virtual bench
	$(RUN) examples/demo/identification.py

# Python that writes no bytecode compiles package and tests anew in every process that tests start.
test test-slow test-all test-campaigns test-kernel test-oldest test-newest reach test-changed precheck lint generate docs: export PYTHONDONTWRITEBYTECODE =

test: $(VENV)/.group-test  ## tests and docstring examples, on all cores, without those of over a few seconds
	$(RUN) -m pytest -n auto --dist worksteal -m "not slow" $(ARGS)

test-slow: $(VENV)/.group-test  ## what `make test` leaves out, but for the campaigns of the night
	$(RUN) -m pytest -n auto --dist worksteal -m "slow and not nightly" $(ARGS)

test-all: $(VENV)/.group-test  ## all tests, also campaigns over many seeds
	$(RUN) -m pytest -n auto --dist worksteal --campaigns $(ARGS)

test-campaigns: $(VENV)/.group-test  ## what is marked nightly, and with all seeds what the others try with few
	$(RUN) -m pytest -n auto --dist worksteal --campaigns -m "nightly or campaign" $(ARGS)

test-oldest: $(OLDEST)/.installed  ## `make test` with the oldest packages that pyproject.toml allows, in .venv-oldest
	$(OLDEST)/bin/python -m pytest -n auto --dist worksteal -m "not slow" $(ARGS)

test-newest: $(NEWEST)/.installed  ## the same with what the index has now, in .venv-newest, by Python 3.13 where there is one
	$(NEWEST)/bin/python -m pytest -n auto --dist worksteal -m "not slow" $(ARGS)

# Rounding differs between the kernels of BLAS; no verdict may.
test-kernel: KERNEL ?= next
test-kernel: MARKED ?= not slow
test-kernel: $(VENV)/.group-test  ## those of `make test` that calculate, with the BLAS kernel below the processor's own, or KERNEL=lowest
	$(RUN) tests/support/kernels.py $(KERNEL) $(RUN) -m pytest -n auto --dist worksteal -m "$(MARKED)" --numbers $(ARGS)

test-nightly:  ## all parts of the night; ARGS=status says which are green, ARGS=reached runs those that changed files reach
	PYTHONPATH=tests "$(PYTHON)" -m phases.nightly $(ARGS)

$(NIGHTLY): nightly-%:
	PYTHONPATH=tests "$(PYTHON)" -m phases.nightly $*

wheel: $(VENV)/.group-test  ## as a user has it: a wheel in a fresh environment, run far from the checkout
	rm -rf .cache/wheel
	$(RUN) -m build --wheel --outdir .cache/wheel
	"$(PYTHON)" -m venv .cache/wheel/venv
	.cache/wheel/venv/bin/python -m pip --disable-pip-version-check install --quiet .cache/wheel/*.whl
	cd / && "$(CURDIR)/.cache/wheel/venv/bin/torsionnet" library
	cd / && "$(CURDIR)/.cache/wheel/venv/bin/torsionnet" modes dmf_rig

compare: $(VENV)/.group-test  ## 300 random models against exact mechanics; make compare ARGS="--models 3000 --seed 1"
	cd tests && ../$(RUN) -m oracle $(ARGS)

compare-parts: $(VENV)/.group-test  ## 300 random plants of components and parts against plain equations
	cd tests && ../$(RUN) -m plain $(ARGS)

structure: $(VENV)/.group-test  ## counts: code lines, import circles, doubled names; ARGS=COMMIT beside another commit
	PYTHONPATH=tests $(RUN) -m structure $(ARGS)

hops: $(VENV)/.group-test  ## which functions a stiffness, a firing order, a value of a study and others pass; ARGS=-v names them
	PYTHONPATH=tests $(RUN) -m structure.hops $(ARGS)

move: $(VENV)/.group-test  ## a module elsewhere, with all that names it: make move OLD=solve/tape NEW=solve/elimination/tape
	PYTHONPATH=tests $(RUN) -m structure.move $(OLD) $(NEW)
	$(MAKE) format

join: $(VENV)/.group-test  ## modules into files of one subject, with all that names them: make join PLAN=file
	PYTHONPATH=tests $(RUN) -m structure.join $(PLAN)
	$(MAKE) format

outputs: $(VENV)/.group-test  ## what every command says of every library model: ARGS="record A", ARGS="same A B"
	PYTHONPATH=tests $(RUN) -m structure.outputs $(ARGS)

reach: MARKED ?= not slow
reach: $(VENV)/.group-test  ## which functions every quick test calls, in .cache/reach.npz: some minutes, from Python 3.12 on; MARKED="not nightly" for slow ones, too
	$(RUN) -m pytest -n auto --dist worksteal -m "$(MARKED)" --reach=.cache/reach.npz $(ARGS)
	PYTHONPATH=tests $(RUN) -m reach files

test-changed: $(VENV)/.group-test  ## the tests that reach what differs from HEAD; ARGS=COMMIT from another commit
	PYTHONPATH=tests $(RUN) -m reach changed $(ARGS)

mutation: $(VENV)/.group-test  ## small faults in a copy of the package: which does no test that reaches them notice?
	PYTHONPATH=tests $(RUN) -m mutation $(ARGS)

fuzz: $(VENV)/.group-test  ## broken files of every kind for SECONDS=600: a result or an error, soon, in little memory
	cd tests && ../$(RUN) -m fuzz --seconds $(SECONDS) --keep ../out/fuzz $(ARGS)

precheck: $(VENV)/.group-lint $(VENV)/.group-docs $(VENV)/.group-test  ## in a minute: lint and the types of what changed; each fault with its remedy
	PYTHONPATH=tests $(RUN) -m structure.precheck $(ARGS)

lint: $(VENV)/.group-lint $(VENV)/.group-docs  ## ruff: rules and formatting; rules of form, each fault with its remedy
	$(RUN) -m ruff check .
	$(RUN) -m ruff format --check .
	PYTHONPATH=tests $(RUN) -m structure.form

format: $(VENV)/.group-lint  ## let ruff reformat, and repair what it safely can
	$(RUN) -m ruff format .
	$(RUN) -m ruff check --fix .

types: $(VENV)/.group-lint $(VENV)/.group-test  ## mypy, strict; what pyright and mypy say of programs that use the package
	$(RUN) -m mypy
	PYTHONPATH=tests $(RUN) -m user_types

generate: $(VENV)/.group-docs  ## pages, stubs and schemas whose code has changed; ARGS=--all makes all of them
	$(RUN) docs/made_files.py $(ARGS)

signatures: $(VENV)/.group-docs  ## the list of public signatures, tests/public_signatures.txt, after a decision
	$(RUN) docs/public_names.py

docs: $(VENV)/.group-docs  ## HTML pages in docs/_build/html; a warning or a broken link is an error
	$(RUN) -m sphinx -W --keep-going -b html -d docs/_build/doctrees docs docs/_build/html
	$(RUN) docs/check_links.py

manuals: $(VENV)/.group-docs $(VENV)/.group-test  ## theory and verification manual as PDF in docs/_build/manuals; needs pdflatex
	$(RUN) docs/manuals/print_manuals.py

bench: $(VENV)/.group-test  ## run every script in benchmarks/
	@set -e; for script in $(BENCHMARKS); do echo "== $$script"; $(RUN) -m "benchmarks.$$script"; done

bench-short: $(VENV)/.group-test  ## the same with small sizes, to see that they run
	@set -e; for script in $(BENCHMARKS); do echo "== $$script"; $(RUN) -m "benchmarks.$$script" --short; done

release-files: $(VENV)/.group-test $(VENV)/.group-release $(CITATION)/.installed  ## validate and build what a release consists of, and say what was not run
	PYTHONPATH=tests $(RUN) -m release $(ARGS)

clean:  ## remove everything that make creates, .venv included
	rm -rf $(VENV) $(OLDEST) $(NEWEST) $(CITATION) build dist out docs/_build docs/gallery docs/reference docs/sg_execution_times.rst
	rm -f docs/generated/paper.md docs/generated/element_index.md docs/generated/reference_index.md docs/generated/cases.md docs/generated/verification.md docs/generated/bench_numbers.md
	rm -f docs/generated/signs_*.svg docs/generated/symbol_*.svg docs/generated/tutorial_*
	rm -rf .cache .hypothesis .mypy_cache .pytest_cache .ruff_cache
	find torsionnet tests benchmarks examples docs -name __pycache__ -type d -prune -exec rm -rf {} +

# The package itself, editable. pip knows dependency groups (PEP 735) from 25.1 on.
$(VENV)/.installed: pyproject.toml
	@"$(PYTHON)" -c 'pass' || { echo "no Python at PYTHON=$(PYTHON); torsionnet needs 3.11 or newer" >&2; exit 1; }
	@"$(PYTHON)" -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { \
	    echo "torsionnet needs Python >= 3.11, but $(PYTHON) is $$("$(PYTHON)" --version 2>&1);" \
	         "name another one: make PYTHON=python3.12 ..." >&2; exit 1; }
	"$(PYTHON)" -m venv $(VENV)
	$(PIP) install --quiet --upgrade "pip>=25.1"
	$(PIP) install --quiet --editable .
	@touch $@

$(VENV)/.group-%: $(VENV)/.installed
	$(PIP) install --quiet --group $*
	@touch $@

# The lower bounds of pyproject.toml as constraints; tests/project/test_release_files.py compares them.
$(OLDEST)/.installed: pyproject.toml tests/oldest.txt
	rm -rf $(OLDEST)
	"$(PYTHON)" -m venv $(OLDEST)
	$(OLDEST)/bin/python -m pip --disable-pip-version-check install --quiet --upgrade "pip>=25.1"
	$(OLDEST)/bin/python -m pip --disable-pip-version-check install --quiet --constraint tests/oldest.txt --editable ".[all]" --group test
	@touch $@

# Made anew each time: the index changes.
$(NEWEST)/.installed: FORCE
	rm -rf $(NEWEST)
	"$$(python3.13 -c 'print("python3.13")' 2>/dev/null || echo "$(PYTHON)")" -m venv $(NEWEST)
	$(NEWEST)/bin/python -m pip --disable-pip-version-check install --quiet --upgrade "pip>=25.1"
	$(NEWEST)/bin/python -m pip --disable-pip-version-check install --quiet --editable ".[all]" --group test
	$(NEWEST)/bin/python --version
	@touch $@

FORCE:

# cffconvert cannot share an environment with the other checkers.
$(CITATION)/.installed: pyproject.toml
	"$(PYTHON)" -m venv $(CITATION)
	$(CITATION)/bin/python -m pip --disable-pip-version-check install --quiet --upgrade "pip>=25.1"
	$(CITATION)/bin/python -m pip --disable-pip-version-check install --quiet --group citation
	@touch $@
