# Everything runs in .venv from locked versions; the first target that needs it sets it up.
PYTHON ?= python3
BIN := .venv/bin
export UV_PYTHON_DOWNLOADS := never
# uv works in this environment and no other, whatever is active outside.
export UV_PROJECT_ENVIRONMENT := .venv
unexport VIRTUAL_ENV

.PHONY: help fly test check format bench docs-pictures clean
help: ## list the targets
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## (.*)/  make \1\t\2/' | expand -t 22

.venv/.synced: pyproject.toml uv.lock
	@test -x $(BIN)/python || $(PYTHON) -m venv .venv
	@test -x $(BIN)/uv || $(BIN)/pip install --quiet uv
	@$(BIN)/uv sync --locked --quiet --all-extras
	@touch $@

fly: .venv/.synced ## start a training flight on the simulated vehicle
	@$(BIN)/groundstation --sim

test: check .venv/.synced ## run every check and every test, with coverage
	@$(BIN)/coverage erase
	@$(BIN)/coverage run -m pytest
	@$(BIN)/coverage combine --quiet
	@$(BIN)/coverage report | tail -n 15

check: .venv/.synced ## lint, format, types, import contracts
	@$(BIN)/ruff check
	@$(BIN)/ruff format --check
	@$(BIN)/basedpyright
	@$(BIN)/lint-imports

format: .venv/.synced ## put the code in order
	@$(BIN)/ruff check --fix
	@$(BIN)/ruff format

bench: .venv/.synced ## measure; prints tables
	@$(BIN)/python -m bench

docs-pictures: .venv/.synced ## make the pictures of README and docs anew
	@$(BIN)/python docs/pictures/make.py

clean: ## remove what the targets made, recordings excepted
	rm -rf .venv .pytest_cache .ruff_cache .hypothesis .coverage .coverage.* build dist
