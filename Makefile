# Targets for users and developers. Needs Python 3.11 or later, pip and make.

PYTHON ?= $(shell for python in python3.11 python3 python; do \
	$$python -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null && echo $$python && break; done)
VENV := .venv
BIN := $(VENV)/bin
RUN := $(VENV)/.installed
EXPLORE := $(VENV)/.installed-explore
TEST := $(VENV)/.installed-test
DEMO := results/demo
# The files with the longest tests come first, see tests/conftest.py.
PARALLEL := -n auto --dist loadfile --no-loadscope-reorder

.DEFAULT_GOAL := help
ifndef INSTALLED
.NOTPARALLEL:  # two installations into one environment would collide
endif
.PHONY: help demo explore test lint types versions docs bench profile peers full clean

help:  ## list the targets
	@awk -F ':.*## ' '/^[a-z]+:.*## / { printf "  make %-8s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

demo: $(RUN)  ## install, play three scenarios, draw their figures into results/demo/figures/
	$(BIN)/kswarms run fig-6.1a fig-6.1b fig-6.1c --seeds 10 --out $(DEMO)
	@echo "Next, in this order:"
	@printf '  %s. %-44s %s\n' \
		1 'look at the figures in' '$(DEMO)/figures/' \
		2 'make kswarms a command of this shell:' 'source $(BIN)/activate' \
		3 'write all results into one HTML file:' 'kswarms report $(DEMO)' \
		4 'film a game:' 'kswarms film fig-6.1c --n 50 --to 60 --out fight.gif' \
		5 'install and open a page that shows games:' 'make explore'

explore: $(EXPLORE)  ## open a page to watch, change and inspect games
	$(BIN)/kswarms explore

# Slow tests run without coverage, which would double the time of many of them.
test: lint  ## run all checks: lint, types, documentation, tests with coverage
	@$(MAKE) --no-print-directory -j2 --output-sync=recurse INSTALLED=1 types docs
	$(BIN)/python -m pytest $(PARALLEL) -m "not slow and not full" --cov --cov-report=term-missing:skip-covered
	$(BIN)/python -m pytest $(PARALLEL) -m "slow and not full"

lint: $(TEST)  ## check style (ruff) and the direction of imports (import-linter)
	$(BIN)/ruff check .
	$(BIN)/lint-imports --no-cache

types: $(TEST)  ## check types (mypy, strict)
	$(BIN)/mypy

versions:  ## run the tests with each Python from 3.11 on that is found, and with the lowest versions of all libraries
	@$(PYTHON) .ci/versions.py $(SHORT)

docs: $(TEST)  ## build the documentation into site/ and execute its notebooks
	NO_MKDOCS_2_WARNING=true $(BIN)/mkdocs build

bench: $(RUN)  ## measure speed, memory and start-up
	$(BIN)/python -m benchmarks.bench
	$(BIN)/python -m benchmarks.report

profile: $(RUN)  ## measure where the time of a game goes
	$(BIN)/python -m benchmarks.profile

peers: $(RUN)  ## measure other simulators, installed into a temporary environment
	$(BIN)/python -m benchmarks.peers

full: $(TEST)  ## run all tests with the full numbers of seeds (long)
	$(BIN)/python -m pytest $(PARALLEL) -m "full or not full" -o faulthandler_timeout=0

clean:  ## remove the environment and all caches; keep results/
	rm -rf $(VENV) .versions build dist site .pytest_cache .hypothesis .mypy_cache .ruff_cache .coverage .coverage.* htmlcov
	find agents model scenarios analysis tests benchmarks -name __pycache__ -type d -prune -exec rm -rf {} +

# One environment, three stamps: `demo` installs the libraries, `explore` adds the page, `test` adds the tools. A
# change of a dependency or a pin installs again. The installation is editable; pip is quiet but shows errors.
$(RUN): EXTRA :=
$(EXPLORE): EXTRA := [explore]
$(TEST): EXTRA := [test]
$(RUN) $(EXPLORE) $(TEST): pyproject.toml constraints.txt
	@test -n "$(PYTHON)" || { echo "kswarms needs Python 3.11 or later; set PYTHON=/path/to/python" >&2; exit 1; }
	@$(BIN)/python -m pip --version >/dev/null 2>&1 || $(PYTHON) -m venv --clear $(VENV)
	@echo "Installing kswarms$(EXTRA) and its libraries into $(VENV); the first time takes a minute or two."
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-input -c constraints.txt -e '.$(EXTRA)'
	@touch $@
