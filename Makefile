# The two commands of the README, each with its own set-up. CONTRIBUTING.md lists the scripts.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin

.PHONY: run test
run: $(VENV)/run.stamp
	@echo "Planning and running problems/roll_cylinder.yaml, then drawing the pictures (about 15 s) ..."
	$(BIN)/hybrid-tamp run problems/roll_cylinder.yaml -o out --video out/video.mp4 --force

test: $(VENV)/test.stamp
	@echo "Checking format, lint and types (about 30 s) ..."
	PATH="$(CURDIR)/$(BIN):$$PATH" scripts/check
	@echo "Running all tests (about 20 minutes on two cores) ..."
	PATH="$(CURDIR)/$(BIN):$$PATH" scripts/test

$(VENV)/run.stamp: pyproject.toml
	@echo "Creating the environment $(VENV) and installing hybrid_tamp (about a minute, only the first time) ..."
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable .
	touch $@

$(VENV)/test.stamp: pyproject.toml
	@echo "Creating the environment $(VENV) and installing hybrid_tamp with all planners (about two minutes) ..."
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[dev]'
	touch $@ $(VENV)/run.stamp
