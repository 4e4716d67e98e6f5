# Both commands do all set-up themselves, on a machine that has Python (>= 3.11) and make.
#   make test     lint, imports, names and calls, the test suite
#   make report   regenerate the comparison reports in reports/; makes the runs of Fig. 2 first if they are stale
#   make report-full   the same with all shipped cases run (hours); unchanged ones are not repeated

PYTHON ?= python3
BIN := .venv/bin
INSTALLED := .venv/.installed

.PHONY: test report report-full format clean

test: $(INSTALLED)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/lint-imports
	$(BIN)/mypy
	$(BIN)/python -m pytest

report: $(INSTALLED)
	$(BIN)/restitution report all

report-full: $(INSTALLED)
	$(BIN)/restitution report all --full

format: $(INSTALLED)
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

clean:
	rm -rf .venv build dist

# Installed anew only when what is to be installed has changed.
$(INSTALLED): pyproject.toml constraints.txt
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable ".[dev]"
	touch $@
