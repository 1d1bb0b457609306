# `make demo` and `make test` need Python 3.11 or later and make; everything else they install.
PYTHON ?= python3
VENV   ?= .venv
BIN    := $(VENV)/bin
# Two cores are what CI has; BLAS threads on top of our own processes only get in each other's way.
export OPENBLAS_NUM_THREADS ?= 1

.PHONY: demo test cases firmware browser picture docs lint clean

$(VENV)/.run: pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit("usmbench needs Python 3.11 or later; set PYTHON=... to one") if sys.version_info < (3, 11) else None'
	@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV) || { echo "python cannot make a virtual environment; on Debian: apt-get install python3-venv" >&2; exit 1; }
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e .
	@touch $@

$(VENV)/.dev: $(VENV)/.run
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e '.[dev]'
	@touch $@

demo: $(VENV)/.run
	$(BIN)/usmbench demo --out demo

test: $(VENV)/.dev firmware browser
	$(BIN)/python -m pytest -n 2 --dist worksteal

# What takes longer than a test of every change may: docs/decisions/0012-tests-and-cases.md.
cases: $(VENV)/.dev
	$(BIN)/python -m pytest -n 2 --dist worksteal benchmarks/cases

# The image that is flashed is tested too, wherever its tools are or can be had.
firmware: $(VENV)/.dev
	@if sh firmware/tools.sh; then \
	  $(MAKE) --no-print-directory -C firmware PYTHON='$(abspath $(BIN))/python'; \
	else \
	  echo "without them the tests hold only the emulated board to the protocol" >&2; \
	fi

# The live page is looked at in a browser, wherever one is or can be had.
browser:
	@sh tests/chromium.sh || echo "without it the live page is tested without a browser" >&2

# The picture in README, of the demonstration's report.
picture: demo browser
	chromium --headless --no-sandbox --disable-gpu --hide-scrollbars --window-size=1100,1090 \
	  --screenshot=docs/images/report.png "file://$(CURDIR)/demo/report.html"

# The documentation as a site; its code blocks are run by the tests.
docs: $(VENV)/.dev
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --quiet

lint: $(VENV)/.dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

clean:
	rm -rf demo build dist site .pytest_cache .mypy_cache .ruff_cache
