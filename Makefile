# make demo | wheel | test | check | wheel-test | docs | bench | paper | prove | clean -- the first use makes a Python environment in .venv

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
INSTALLED := $(VENV)/.installed
# make check EXTRAS=dev,step,tables runs the tests of STEP files and of tables too; it installs 600 MB more.
EXTRAS ?= dev
INSTALLED_DEV := $(VENV)/.installed-$(EXTRAS)
INSTALL := $(BIN)/python -m pip install -qq --disable-pip-version-check -c constraints.txt
# The compiler comes in the versions of constraints.txt too.
BUILD := PIP_CONSTRAINT=constraints.txt $(BIN)/python -m pip --disable-pip-version-check
# What the installed program is made of.
SOURCES := $(shell find src building -name '*.py' -o -path 'src/workhold/data/*' -type f -o -path 'src/workhold/web/static/*' -type f)

.PHONY: demo wheel test check wheel-test docs bench paper prove clean

# Designs for the example bracket, draws the best fixtures and writes the setup sheet of the best.
demo: $(INSTALLED)
	@mkdir -p demo
	$(BIN)/workhold design examples/bracket.dxf --pitch 10 --columns 2 --peg-radius 3 --out demo/bracket.json --draw demo/drawings
	$(BIN)/workhold sheet demo/bracket.json 1 -o demo/setup.pdf --jaw-force 3000
	@echo "Look at demo/setup.pdf, demo/drawings/fixture-01.png and demo/drawings/thumbnails.png; all fixtures are in demo/bracket.json."
	@echo "$(BIN)/workhold serve --open shows the same, and more, as a page in the browser."

# A wheel with compiled kernels for machines of this kind, in dist/: it needs no compiler where it is installed, and starts at
# once. Building it takes gcc or binutils, a minute or two, and an environment with numba that is thrown away afterwards.
wheel: | $(BIN)/python
	@echo 'Compiling the kernels into a wheel ...'
	@rm -rf build dist/workhold-*.whl
	$(BUILD) wheel -q --no-deps -w dist .

# Of each package the tests that see most in little time.
test: $(INSTALLED_DEV)
	WORKHOLD_KERNELS=interpreted $(BIN)/python -m pytest -n auto --dist worksteal -m 'not thorough and not prove and not wheel'

# What a change must pass: format, lint, types, layers, the house, a true manual, all tests but the long ones.
check: $(INSTALLED_DEV)
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/python building/house.py
	$(BIN)/python building/check_manual.py
	$(BIN)/python -m pytest -n 3 --dist worksteal

# The wheel in an environment without numba against kernels compiled on first use: the same files, byte for byte.
wheel-test: $(INSTALLED_DEV)
	$(BIN)/python -m pytest -m wheel

# The manual as a site, in site/: open site/index.html. Whatever is doubtful in it, such as a link that leads nowhere, is an error.
docs: $(VENV)/.installed-docs,numba
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict
	@echo 'Open site/index.html.'

# Every target of speed and memory with pass or short, and docs/benchmarks.md from the figures; BENCH=--quick tries a little.
bench: $(INSTALLED)
	$(INSTALL) numba
	$(BIN)/python benchmarks/bench.py $(BENCH)

# The report of the paper's figures and ours, from measurements of this run: paper/report.html and paper/report.pdf, in half an
# hour on two cores; PAPER=--quick makes a small one, PAPER=--keep measures only what this program has not measured yet.
paper: $(INSTALLED)
	-$(INSTALL) distributed fsspec pyarrow
	$(BIN)/python benchmarks/make_paper.py $(PAPER)

# Fifteen hundred planted fixtures and more, ten thousand random SVG drawings against resvg, signals at every stage, how sharp the
# constants are, the paper's Table 2, then both engines on the complete sets, the paper's parts and random parts.
prove: $(INSTALLED_DEV)
	$(BIN)/python -m pytest -n 2 --dist worksteal -m prove
	$(BIN)/python benchmarks/prove.py

# Everything made by the above but the environment.
clean:
	rm -rf demo site paper build dist .pytest_cache .mypy_cache .ruff_cache .hypothesis .import_linter_cache
	find . -path ./$(VENV) -prune -o -name __pycache__ -type d -exec rm -rf {} +

$(BIN)/python:
	$(PYTHON) -c 'import sys; sys.exit("workhold needs Python 3.11 or later") if sys.version_info < (3, 11) else None'
	$(PYTHON) -m venv $(VENV)

# With compiled kernels where there is a linker; they start at once.
$(INSTALLED): pyproject.toml constraints.txt $(SOURCES) | $(BIN)/python
	@echo 'Installing workhold and what it needs into $(VENV) ...'
	@if command -v cc >/dev/null || command -v ld >/dev/null; then \
	    $(MAKE) --no-print-directory wheel && $(INSTALL) --force-reinstall --no-deps dist/workhold-*.whl && $(INSTALL) dist/workhold-*.whl; \
	else \
	    echo 'There is no linker (gcc or binutils) here, so kernels are compiled on first use, in a minute or two.' && \
	    $(INSTALL) -e '.[numba]'; \
	fi
	@# The tests are of these sources, not of the wheel that now stands in their place.
	@rm -f $(VENV)/.installed-*
	@touch $@

$(VENV)/.installed-%: pyproject.toml constraints.txt | $(BIN)/python
	@echo 'Installing workhold and its tools into $(VENV) ...'
	$(INSTALL) -e '.[$*]'
	@touch $@ $(INSTALLED)
