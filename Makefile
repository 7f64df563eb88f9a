# Everything runs in .venv from locked versions; the first target that needs it sets it up.
PYTHON ?= python3
BIN := .venv/bin
export UV_PYTHON_DOWNLOADS := never
# uv works in this environment and no other, whatever is active outside.
export UV_PROJECT_ENVIRONMENT := .venv
unexport VIRTUAL_ENV

.PHONY: help fly school test coverage check audit format bench docs-pictures clean
help: ## list the targets
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## (.*)/  make \1\t\2/' | expand -t 22

.venv/.synced: pyproject.toml uv.lock
	@test -x $(BIN)/python || $(PYTHON) -m venv .venv
	@test -x $(BIN)/uv || $(BIN)/pip install --quiet uv
	@$(BIN)/uv sync --locked --quiet --all-extras
	@touch $@

fly: .venv/.synced ## start a training flight on the simulated vehicle
	@$(BIN)/groundstation --sim

school: .venv/.synced ## learn to fly: mission by mission, with a coach
	@$(BIN)/groundstation school

# What runs real processes in real time runs by itself, one after the other, and what fails there is flown once more
# before it counts: a machine that others use, too, takes the processor away for a second now and then. With
# processors to spare: make test FLIGHTS=2.
FLIGHTS ?= 0
test: check ## run every check and every test
	@$(BIN)/pytest --numprocesses auto --dist loadfile -m "not flight"
	@$(BIN)/pytest --numprocesses $(FLIGHTS) --dist loadfile --no-loadscope-reorder -m flight \
		|| $(BIN)/pytest -m flight --last-failed

coverage: .venv/.synced ## run every test and print which lines no test reached
	@$(BIN)/pytest --numprocesses auto --dist loadfile -m "not flight" --cov --cov-report=
	@$(BIN)/pytest -m flight --cov --cov-append --cov-report=term-missing:skip-covered

check: .venv/.synced ## lint, format, types, import contracts
	@$(BIN)/ruff check
	@$(BIN)/ruff format --check
	@$(BIN)/basedpyright
	@$(BIN)/lint-imports

audit: .venv/.synced ## ask whether a dependency has a known vulnerability
	@$(BIN)/python .ci/audit.py

format: .venv/.synced ## put the code in order
	@$(BIN)/ruff check --fix
	@$(BIN)/ruff format

bench: .venv/.synced ## measure; prints tables
	@$(BIN)/python -m bench

docs-pictures: .venv/.synced ## make the pictures of README and docs anew
	@$(BIN)/python docs/pictures/make.py

clean: ## remove what the targets made, recordings excepted
	rm -rf .venv .pytest_cache .ruff_cache .hypothesis .coverage .coverage.* build dist
