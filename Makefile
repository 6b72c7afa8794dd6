# make demo | test | check | bench | prove | clean -- the first use makes a Python environment in .venv

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
INSTALLED := $(VENV)/.installed
# make check EXTRAS=dev,step runs the tests of STEP files too; it installs 400 MB more.
EXTRAS ?= dev
INSTALLED_DEV := $(VENV)/.installed-$(EXTRAS)
INSTALL := $(BIN)/python -m pip install -qq --disable-pip-version-check -c constraints.txt

.PHONY: demo test check bench prove clean

# Designs for the example bracket, draws the best fixtures and writes the setup sheet of the best.
demo: $(INSTALLED)
	@mkdir -p demo
	$(BIN)/workhold design examples/bracket.dxf --pitch 10 --columns 2 --peg-radius 3 --out demo/bracket.json --draw demo/drawings
	$(BIN)/workhold sheet demo/bracket.json 1 -o demo/setup.pdf --jaw-force 3000
	@echo "Look at demo/setup.pdf, demo/drawings/fixture-01.png and demo/drawings/thumbnails.png; all fixtures are in demo/bracket.json."
	@echo "$(BIN)/workhold serve --open shows the same, and more, as a page in the browser."

# Every test and every example of the documentation.
test: $(INSTALLED_DEV)
	$(BIN)/python -m pytest -n 2

# What a change must pass: format, lint, types, layers, tests.
check: $(INSTALLED_DEV)
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(MAKE) test

# Every target of speed and memory with pass or short, and docs/benchmarks.md from the figures; BENCH=--quick tries a little.
bench: $(INSTALLED)
	$(BIN)/python benchmarks/bench.py $(BENCH)

# Thousands of planted fixtures, ten thousand random SVG drawings against resvg, the paper's Table 2, then both engines on the
# complete sets, the paper's parts and random parts.
prove: $(INSTALLED_DEV)
	$(BIN)/python -m pytest -n 2 -m prove
	$(BIN)/python benchmarks/prove.py

# Everything made by the above but the environment.
clean:
	rm -rf demo build dist .pytest_cache .mypy_cache .ruff_cache .hypothesis .import_linter_cache
	find . -path ./$(VENV) -prune -o -name __pycache__ -type d -exec rm -rf {} +

$(BIN)/python:
	$(PYTHON) -c 'import sys; sys.exit("workhold needs Python 3.11 or later") if sys.version_info < (3, 11) else None'
	$(PYTHON) -m venv $(VENV)

$(INSTALLED): pyproject.toml constraints.txt | $(BIN)/python
	@echo 'Installing workhold and what it needs into $(VENV) ...'
	$(INSTALL) -e .
	@touch $@

$(INSTALLED_DEV): pyproject.toml constraints.txt | $(BIN)/python
	@echo 'Installing workhold and its tools into $(VENV) ...'
	$(INSTALL) -e '.[$(EXTRAS)]'
	@touch $@ $(INSTALLED)
