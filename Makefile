# Every target sets up what it needs: python3 (3.11 or newer) and make are enough, and a C compiler for the C targets.
# The environments follow the locks in requirements/: a changed lock is installed by the next target that needs it.

PYTHON ?= python3
# Processes that run the tests side by side, and further arguments for pytest, e.g. ARGS="-k flagship -x".
WORKERS ?= 2
ARGS ?=

VENV := .venv
BENCH := .venv-bench
LOCKER := .venv-lock

GENERATE_READY := $(VENV)/.ready-generate
TEST_READY := $(VENV)/.ready-test
BENCH_READY := $(BENCH)/.ready-bench
PROJECT := pyproject.toml setup.py tools/environment.py

# One thread a process: the tests and the benchmarks count the cores themselves.
export OMP_NUM_THREADS ?= 1
export OPENBLAS_NUM_THREADS ?= 1

.DELETE_ON_ERROR:
# Two targets may set up one environment.
.NOTPARALLEL:
.PHONY: help generate check validate test test-full lint format budgets docs bench lock upgrade clean distclean

help: ## Say what the targets do
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-10s %s\n", $$1, $$2 }' Makefile

generate: $(GENERATE_READY) ## Derive every robot, write generated/ and compile it; end with a table
	$(VENV)/bin/krhpr generate

check: $(GENERATE_READY) ## Say what `make generate` would change, and why; write nothing
	$(VENV)/bin/krhpr generate --check

validate: $(TEST_READY) ## Check generated/ against the derivation; the report is in build/validation/
	$(VENV)/bin/krhpr validate $(ARGS)

test: lint ## Lint, then run the tests on small samples
	$(VENV)/bin/python -m pytest -n $(WORKERS) --dist worksteal -q $(ARGS)

test-full: $(TEST_READY) ## Run the tests that have large samples on these (the others are in `make test`)
	$(VENV)/bin/python -m pytest -n $(WORKERS) --dist worksteal -q --full $(ARGS)

lint: $(TEST_READY) ## Check style, layout and types
	$(VENV)/bin/ruff check .
	$(VENV)/bin/ruff format --check .
	$(VENV)/bin/python tools/typing_tree.py
	$(VENV)/bin/mypy

format: $(TEST_READY) ## Lay the Python sources out as lint wants them
	$(VENV)/bin/ruff check --fix .
	$(VENV)/bin/ruff format .

docs: $(TEST_READY) ## Draw the pictures and refresh the code and tables that docs/ shows
	$(VENV)/bin/python docs/pictures/make.py
	$(VENV)/bin/python docs/refresh.py

budgets: $(GENERATE_READY) ## Record the operations of every kernel as the most that the tests allow it
	$(VENV)/bin/python tools/record_budgets.py

bench: $(BENCH_READY) ## Measure speed against peers, in an environment of their own
	$(BENCH)/bin/python -m benchmarks $(ARGS)

lock: ## Write requirements/*.txt anew for changed *.in, keeping the versions that still fit
	$(PYTHON) tools/lock.py $(LOCKER)

upgrade: ## Write requirements/*.txt anew with the newest versions
	$(PYTHON) tools/lock.py $(LOCKER) --upgrade

clean: ## Remove what was built, but not the environments
	rm -rf build dist krhpr.egg-info .mypy_cache .pytest_cache .ruff_cache .hypothesis
	find . -name '.venv*' -prune -o -name __pycache__ -type d -prune -exec rm -rf {} +

distclean: clean ## Remove the environments as well
	rm -rf $(VENV) $(BENCH) $(LOCKER)

# Makes the environment that the stamp lies in, and installs the lock that the stamp is named after.
define set_up
@command -v $(PYTHON) >/dev/null || { echo "krhpr: no $(PYTHON) here; name one: make PYTHON=..." >&2; exit 1; }
@$(PYTHON) tools/environment.py $(@D) $<
@touch $@
endef

$(GENERATE_READY): requirements/generate.txt $(PROJECT)
	$(set_up)

$(TEST_READY): requirements/test.txt $(PROJECT)
	$(set_up)

$(BENCH_READY): requirements/bench.txt $(PROJECT)
	$(set_up)
