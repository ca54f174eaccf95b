# kswarms: everything a user or a developer does, one word each. Needs Python 3.11 or later, pip and make.

PYTHON ?= $(shell for python in python3.11 python3 python; do \
	$$python -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null && echo $$python && break; done)
VENV := .venv
BIN := $(VENV)/bin
RUN := $(VENV)/.installed
TEST := $(VENV)/.installed-test
DEMO := results/demo

.DEFAULT_GOAL := help
.NOTPARALLEL:  # two installs into one environment would collide
.PHONY: help demo explore test lint types docs bench full clean

help:  ## show this list
	@awk -F ':.*## ' '/^[a-z]+:.*## / { printf "  make %-7s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

demo: $(RUN)  ## let two swarms compete, in three pairs of policies at ten densities, and draw the scores
	$(BIN)/kswarms run fig-6.1a fig-6.1b fig-6.1c --seeds 10 --out $(DEMO)
	@echo "before: source $(BIN)/activate  (so that the shell finds kswarms)"

explore: $(TEST)  ## open the page in which games are watched
	$(BIN)/kswarms explore

test: lint types docs  ## lint, types, documentation, and every test with its coverage
	$(BIN)/python -m pytest --cov --cov-report=term-missing:skip-covered

lint: $(TEST)  ## ruff, and the direction of imports
	$(BIN)/ruff check .
	$(BIN)/lint-imports --no-cache

types: $(TEST)  ## mypy, strict
	$(BIN)/mypy

docs: $(TEST)  ## build the documentation into site/, notebooks executed, every warning an error
	NO_MKDOCS_2_WARNING=true $(BIN)/mkdocs build

bench: $(RUN)  ## speed, memory and start-up, with the events and conflicts processed; the report
	$(BIN)/python -m benchmarks.bench
	$(BIN)/python -m benchmarks.report

full: $(TEST)  ## the tests again, with every outcome at its full number of seeds (long)
	$(BIN)/python -m pytest -m "full or not full" -o faulthandler_timeout=0

clean:  ## remove the environment and all caches; results/ stays
	rm -rf $(VENV) build dist site .pytest_cache .hypothesis .mypy_cache .ruff_cache .coverage .coverage.* htmlcov
	find agents model scenarios analysis tests benchmarks -name __pycache__ -type d -prune -exec rm -rf {} +

# One environment, two stamps: `demo` installs what running needs, `test` adds the tools. An install happens
# again when a dependency or a pin changes; the code itself is linked, not copied. Quiet, but errors show.
$(RUN): EXTRA :=
$(TEST): EXTRA := [test]
$(RUN) $(TEST): pyproject.toml constraints.txt
	@test -n "$(PYTHON)" || { echo "kswarms needs Python 3.11 or later; set PYTHON=/path/to/python" >&2; exit 1; }
	@$(BIN)/python -m pip --version >/dev/null 2>&1 || $(PYTHON) -m venv --clear $(VENV)
	@echo "Installing kswarms$(EXTRA) and its libraries into $(VENV) (once, a minute or two) ..."
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-input -c constraints.txt -e '.$(EXTRA)'
	@touch $@
