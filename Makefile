# The commands of the README. They set up .venv on first use; all they need is Python 3.11 or newer and make.
#   make evaluate     the main job on the default agent (core dependencies only)
#   make test         lint, types, layers, documentation and tests
#   make compatibility   entries of others here, ours beside the official package (fetches packages)
#   make long         every test, also those that take many seconds
#   make figures      the figures of README and documentation, measured anew (hours)
#   make docs         the documentation, in build/site

PYTHON ?= python3
# One more than cores: tests wait for processes that they kill, for deadlines, for a browser.
WORKERS ?= $(shell expr $$(nproc 2>/dev/null || echo 2) + 1)
BIN := .venv/bin
TASK ?= prepare
EPISODES ?= 1000

.PHONY: compatibility figures long evaluate test lint types layers docs players pytest clean

evaluate: .venv/core.installed
	$(BIN)/hockey evaluate --task $(TASK) --episodes $(EPISODES)

test: lint types layers docs pytest

lint: .venv/dev.installed
	$(BIN)/ruff check
	$(BIN)/ruff format --check

types: .venv/dev.installed
	$(BIN)/mypy

layers: .venv/dev.installed
	$(BIN)/lint-imports

docs: .venv/dev.installed
	$(BIN)/python scripts/command_reference.py docs/commands.md
	$(BIN)/python scripts/rules_pages.py docs/rules
	$(BIN)/python scripts/api_reference.py docs/api
	$(BIN)/zensical build --strict --clean

players: .venv/dev.installed
	$(BIN)/python scripts/compile_players.py

pytest: .venv/dev.installed players
	$(BIN)/pytest --numprocesses $(WORKERS) --dist loadgroup

long: .venv/dev.installed players
	LONG=1 $(BIN)/pytest --numprocesses $(WORKERS) --dist loadgroup

figures: .venv/dev.installed
	$(BIN)/python scripts/figures.py measure

compatibility: .venv/dev.installed
	CLEAN_INSTALL=1 LONG=1 $(BIN)/pytest tests/submissions tests/envs/test_official_info.py tests/test_clean_install.py

clean:
	rm -rf .venv build dist *.egg-info .mypy_cache .pytest_cache .ruff_cache .import_linter_cache .cache

.venv/bin/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "Python 3.11 or newer is needed; say which with make PYTHON=...")'
	$(PYTHON) -m venv .venv

.venv/core.installed: pyproject.toml | .venv/bin/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable .
	@touch $@

.venv/dev.installed: pyproject.toml | .venv/bin/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[dev,mushroom]'
	@touch $@ .venv/core.installed
