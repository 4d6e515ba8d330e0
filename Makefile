# Two commands do everything on a fresh machine: make demo, make test.
PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
INSTALLED := $(VENV)/.installed
DOCS := $(VENV)/.docs-installed
FUZZ := $(VENV)/.fuzz-installed
MUTATE := $(VENV)/.mutate-installed
COUNT ?= 600
SEED ?= 2026
RELEASE := build/release
TOOLS := $(VENV)-release
NODE_TOOLS := tests/interop/node/node_modules/.installed
# One thread of BLAS for each worker: they share the processors. Compiled modules are kept, whatever
# the environment says: hundreds of tests start processes.
PYTEST := OPENBLAS_NUM_THREADS=1 PYTHONDONTWRITEBYTECODE= $(BIN)/python -m pytest -n auto --dist worksteal

.PHONY: demo test test-pages test-slow test-long test-firmware fuzz mutate lint docs fmus benchmark release clean

$(INSTALLED): pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
		{ echo "Python 3.11 or newer is needed; say which one with: make PYTHON=python3.12 ..."; exit 1; }
	@$(PYTHON) -c 'import ensurepip' || \
		{ echo "Python's venv is missing; on Debian: apt install python3-venv"; exit 1; }
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[dev]'
	@# MAVProxy, a reference tool for the MAVLink link, without what its windows need (OpenCV, VTK, Matplotlib):
	@# no extra can leave that out, and its other modules need nothing that is not here.
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps 'MAVProxy>=1.8.75,<1.9'
	@touch $@

# A landing off the centre heels the deck too far, as published: the trial expects that. The campaign
# does not, and its status 1 says just that, so it is no failure of the demonstration.
demo: $(INSTALLED)
	@echo "== a drone lands on the aft port corner of a catamaran that holds its station"
	@$(BIN)/seatrial run hydrone-landing
	@echo "== all five landing points, landing and take-off: six cases off the centre line FAIL, as in the published work"
	@$(BIN)/seatrial run hydrone-pads || test $$? -eq 1
	@echo "Open the two reports in a browser: each plays its run. The landing with time line, map and charts:"
	@run=$$(ls -td runs/hydrone-landing-* | head -n 1); echo "$$run/report.html"; \
		if [ -t 1 ]; then $(BIN)/seatrial play "$$run"; else echo "$(BIN)/seatrial play $$run"; fi

# canboat, a reference for the NMEA 2000 nodes; where it cannot be installed its tests are skipped.
$(NODE_TOOLS): tests/interop/node/package-lock.json
	@if npm ci --prefix $(<D) --no-audit --no-fund --ignore-scripts; then touch $@; \
		else echo "no canboat: npm is missing, or did not reach its registry"; fi

# A test that hangs fails, with its stack, instead of holding up all others; a hang in C code, which
# no signal ends, has at least shown where it is.
HANGS := --timeout 240 --timeout-method signal -o faulthandler_timeout=200

# All modules: minutes. What takes seconds a test, other people's tools, docs and whole voyages: half
# an hour. What takes longer still.
test: $(INSTALLED)
	$(PYTEST) $(HANGS) -m "not slow and not interop and not long"

# Examples, tables and commands of the pages and the README, the wheel: what CI runs beside `test`.
test-pages: $(INSTALLED)
	$(PYTEST) $(HANGS) -m "not long" tests/test_docs.py tests/test_readme.py tests/test_wheel.py

test-slow: $(INSTALLED) $(NODE_TOOLS)
	$(PYTEST) --timeout 600 -m "(slow or interop) and not long"

test-long: $(INSTALLED) $(NODE_TOOLS)
	$(PYTEST) --timeout 3600 -m long

# Each vehicle in each sea with each fault under ArduPilot's own programs, which SEATRIAL_ARDUPILOT
# names the folder of: an hour, once per release. The table goes into docs/kits/ardupilot/autopilots.md.
test-firmware: $(INSTALLED)
	$(BIN)/python -m tests.interop.firmware_matrix --write

# Every harness in tests/fuzz for long, guided by coverage: 10^6 executions or half an hour each.
fuzz: $(FUZZ)
	$(PYTEST) -m long tests/fuzz

$(FUZZ): $(INSTALLED)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[fuzz]'
	@touch $@

# COUNT changes of equations, drawn by SEED: does a test fail of each? Hours; it goes on where it was
# interrupted. What it is and what it found: docs/decisions/mutation-check.md.
mutate: $(MUTATE)
	OPENBLAS_NUM_THREADS=1 nice -n 10 $(BIN)/python -m benchmarks.mutation --count $(COUNT) --seed $(SEED)

$(MUTATE): $(INSTALLED)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[mutate]'
	@touch $@

lint: $(INSTALLED)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

# Warnings and broken links are errors; the site in build/site opens without a network.
docs: $(DOCS)
	$(BIN)/mkdocs build --strict --clean

$(DOCS): $(INSTALLED)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[docs]'
	@touch $@

benchmark: $(INSTALLED)
	$(BIN)/python -m benchmarks.compare --write
	$(BIN)/python -m benchmarks.components --write
	$(BIN)/python -m benchmarks.carriers --write
	$(BIN)/python -m benchmarks.integrators --write
	$(BIN)/python -m benchmarks.tether --write
	$(BIN)/python -m benchmarks.can --write
	$(BIN)/python -m benchmarks.can_latency --write
	$(BIN)/python -m benchmarks.arduino --write
	$(BIN)/python -m benchmarks.start --write
	$(BIN)/python -m benchmarks.floods --write
	$(BIN)/python -m benchmarks.supervision --write
	$(BIN)/python -m benchmarks.ardupilot --write
	$(BIN)/python -m benchmarks.big_models --write

# A release: the distributions, the documentation in a folder of its version, the packages of the tests as a lock
# with the hashes of their files for this platform and Python (pip install --require-hashes --no-deps -r), and an
# SBOM of these packages. Run it after the tests, in their environment. The tools have an environment of their own,
# so that neither list contains them.
release: docs $(TOOLS)/.installed
	rm -rf $(RELEASE) && mkdir -p $(RELEASE)
	version=$$($(BIN)/python -c 'import seatrial; print(seatrial.__version__)') && cd $(RELEASE) && \
		cp -r ../site $$version && $(abspath $(BIN))/python -m zipfile -c seatrial-$$version-docs.zip $$version && rm -r $$version
	$(BIN)/python -m build --outdir $(RELEASE)
	$(BIN)/python -m pip freeze --exclude-editable > $(RELEASE)/tested.txt
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --dry-run --ignore-installed --no-deps \
		--report $(RELEASE)/report.json --requirement $(RELEASE)/tested.txt
	$(BIN)/python -c 'import json, sys; print("# pip install --require-hashes --no-deps -r seatrial.lock"); \
		[print(one["metadata"]["name"], "==", one["metadata"]["version"], \
		" --hash=sha256:", one["download_info"]["archive_info"]["hashes"]["sha256"], sep="") \
		for one in json.load(sys.stdin)["install"]]' < $(RELEASE)/report.json > $(RELEASE)/seatrial.lock
	$(TOOLS)/bin/cyclonedx-py environment --pyproject pyproject.toml --mc-type library --output-reproducible \
		--output-format JSON --output-file $(RELEASE)/seatrial.cdx.json $(BIN)/python
	rm $(RELEASE)/tested.txt $(RELEASE)/report.json
	cd $(RELEASE) && sha256sum * > SHA256SUMS

$(TOOLS)/.installed: pyproject.toml
	$(PYTHON) -m venv $(TOOLS)
	$(TOOLS)/bin/python -m pip install --quiet --disable-pip-version-check 'cyclonedx-bom>=6,<8'
	@touch $@

fmus: $(INSTALLED)
	$(BIN)/seatrial fmu build --out build/fmus

clean:
	rm -rf .venv .venv-* build dist runs
