# The two commands of the README. Both set up .venv on first use; all they need is Python 3.11 or newer and make.
#   make evaluate     the main job on the default agent (core dependencies only)
#   make test         lint, types, layers and tests

PYTHON ?= python3
BIN := .venv/bin
TASK ?= prepare
EPISODES ?= 1000

.PHONY: evaluate test lint types layers pytest clean

evaluate: .venv/core.installed
	$(BIN)/hockey evaluate --task $(TASK) --episodes $(EPISODES)

test: lint types layers pytest

lint: .venv/dev.installed
	$(BIN)/ruff check
	$(BIN)/ruff format --check

types: .venv/dev.installed
	$(BIN)/mypy

layers: .venv/dev.installed
	$(BIN)/lint-imports

pytest: .venv/dev.installed
	$(BIN)/pytest --numprocesses auto

clean:
	rm -rf .venv build dist *.egg-info .mypy_cache .pytest_cache .ruff_cache .import_linter_cache

.venv/bin/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "Python 3.11 or newer is needed; say which with make PYTHON=...")'
	$(PYTHON) -m venv .venv

.venv/core.installed: pyproject.toml | .venv/bin/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable .
	@touch $@

.venv/dev.installed: pyproject.toml | .venv/bin/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[dev,mushroom]'
	@touch $@ .venv/core.installed
