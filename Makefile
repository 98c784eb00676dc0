# Everything runs from .venv; what is in it is fixed by requirements.lock.
#
#   PYTHON=…  the interpreter to make .venv with
#   JOBS=…    how many tests run side by side
#   ARGS=…    further arguments, e.g. make test ARGS="-k lag"

JOBS ?= 2
BIN := .venv/bin
LOCKED := .venv/.locked
INSTALLED := .venv/.installed

# A venv knows its own absolute path: where it was copied or moved, or lost its interpreter, its stamps mean nothing.
ifneq ($(shell $(BIN)/python -c '' 2>/dev/null && cat $(LOCKED) 2>/dev/null),$(CURDIR))
.PHONY: $(LOCKED)
endif

# PyBullet's wheels end at Python 3.11, so that comes first; for a newer one pip compiles it. A name on the path may be
# a shim that leads nowhere: each is tried, not looked up.
PYTHONS = $(or $(PYTHON),python3.11 python3 python3.12 python3.13 python3.14)
FIND_PYTHON = found=; for python in $(PYTHONS); do \
	  if $$python -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then found=$$python; break; fi; \
	done; \
	if [ -z "$$found" ]; then \
	  echo 'Python 3.11 or newer is needed; none among: $(PYTHONS).' >&2; \
	  echo 'Install Python 3.11, or name one: make $(MAKECMDGOALS) PYTHON=/path/to/python3.11' >&2; \
	  exit 1; \
	fi

.PHONY: help
help: ## list the targets
	@sed -n 's/^\([a-z-]*\):.*## /  \1\t/p' $(MAKEFILE_LIST) | expand -t 16

.PHONY: setup
setup: $(INSTALLED) ## make .venv with the console script `harness` (every other target does it when needed)

# Stamps are written last: what was interrupted is begun anew.
$(LOCKED): requirements.lock
	@$(FIND_PYTHON); echo "Making .venv with $$($$found --version)" && $$found -m venv --clear .venv
	@$(BIN)/python -c 'import sys; sys.exit(sys.version_info >= (3, 12))' || \
	  echo 'PyBullet has no wheel for this Python and is compiled: that needs a C++ compiler and takes minutes.'
	@echo "Installing $$(grep -c '^[a-z]' requirements.lock) packages, about 570 MB to fetch"
	@$(BIN)/python -m pip install --disable-pip-version-check --quiet --require-hashes -r requirements.lock
	@echo '$(CURDIR)' > $@

$(INSTALLED): $(LOCKED) pyproject.toml
	@$(BIN)/python -m pip install --disable-pip-version-check --quiet --no-index --no-deps --no-build-isolation -e .
	@$(BIN)/python -m pip check || { echo 'requirements.lock is behind pyproject.toml: make lock' >&2; exit 1; }
	@echo 'Compiling the kernels once (about two minutes) ...'
	@$(BIN)/harness compile
	@touch $@

# The bundled rigs, one simulated and one measured, side by side: the first says what it found when both are done.
BUNDLED := paper_protocol open_ball_beam
SAID := build/report.txt

.PHONY: report
report: $(INSTALLED) ## compare and diagnose both bundled rigs, one simulated and one measured: reports/
	@echo 'Comparing and diagnosing $(word 1,$(BUNDLED)) and $(word 2,$(BUNDLED)), about a minute; progress is that of the second.'
	@$(MAKE) --no-print-directory -j 2 report-first report-second
	@echo; cat $(SAID)
	@echo; echo 'Open in a browser:'; for rig in $(BUNDLED); do \
	  echo "  $(CURDIR)/reports/$$rig/report.html     which model follows the recording"; \
	  echo "  $(CURDIR)/reports/$$rig/diagnosis.html  what the model lacks"; done

.PHONY: report-first report-second
report-first: RIG := $(word 1,$(BUNDLED))
report-first:
	@mkdir -p $(dir $(SAID)); { $(BIN)/harness run --quiet $(RIG) $(ARGS) && $(BIN)/harness diagnose --quiet $(RIG); } \
	  > $(SAID) 2>&1 || { status=$$?; cat $(SAID) >&2; exit $$status; }

report-second: RIG := $(word 2,$(BUNDLED))
report-second:
	@$(BIN)/harness run $(RIG) $(ARGS) && $(BIN)/harness diagnose $(RIG)

.PHONY: test
test: $(INSTALLED) ## the fast tests
	$(BIN)/pytest -m "not slow" -n $(JOBS) --dist loadfile $(ARGS)

# What a processor without AVX or FMA does: Numba, OpenBLAS, NumPy and the C library choose other code there, and sums
# round otherwise. Tests of whole commands, engines, files and pages, and those of the search, which decides by the same
# fits, add nothing to what the others compute.
GENERIC := NUMBA_CPU_NAME=generic NUMBA_CPU_FEATURES= NUMBA_CACHE_DIR=$(CURDIR)/build/numba-generic \
  OPENBLAS_CORETYPE=Prescott NPY_DISABLE_CPU_FEATURES='X86_V3 X86_V4 AVX512_ICL AVX512_SPR' \
  GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX512F
ELSEWHERE := acceptance api benchmarks docs engines exports fuzz identify/design identify/selection \
  identify/validation importing jobs mjcf recording report sweeps tolerances tuning urdf viewing

.PHONY: test-generic
test-generic: $(INSTALLED) ## the fast tests of what is computed, as on a processor without vector extensions
	$(GENERIC) $(BIN)/pytest -m "not slow" -n $(JOBS) --dist loadfile $(ELSEWHERE:%=--ignore=tests/%) $(ARGS)

# As they are collected: xdist would begin with the files of many tests and end with single ones of some minutes, for
# which the other workers wait.
.PHONY: test-slow
test-slow: $(INSTALLED) ## the tests that take minutes
	$(BIN)/pytest -m slow -n $(JOBS) --dist loadfile --no-loadscope-reorder --durations=40 $(ARGS)

.PHONY: mutants
mutants: $(INSTALLED) ## change the code here and there and list what no test notices (hours; ARGS="--sample 40" takes one)
	nice $(BIN)/python -m tests.mutation $(ARGS)

.PHONY: lint
lint: $(INSTALLED) ## ruff: rules and format; import-linter: the layers of docs/development.md
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/lint-imports --no-logo --no-cache

.PHONY: format
format: $(INSTALLED) ## let ruff repair what it can
	$(BIN)/ruff check --fix-only .
	$(BIN)/ruff format .

.PHONY: typecheck
typecheck: $(INSTALLED) ## mypy
	$(BIN)/mypy

.PHONY: scenes
scenes: $(INSTALLED) ## write mjcf/*.xml and urdf/*.urdf anew
	$(BIN)/python -m mjcf.scene
	$(BIN)/python -m urdf.scene

.PHONY: recording
recording: $(INSTALLED) ## simulate the bundled recording anew
	$(BIN)/python -m harness.simulator.bundled

.PHONY: schema
schema: $(INSTALLED) ## write the JSON Schema of diagnosis.json anew
	$(BIN)/python -m harness.identify.record

.PHONY: docs
docs: $(INSTALLED) ## write docs/api.md from the docstrings, execute the notebooks, build the site: build/site/index.html
	$(BIN)/python docs/make_api.py
	$(BIN)/python docs/run_notebooks.py
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict
	@echo "$(CURDIR)/build/site/index.html"

.PHONY: tutorial
tutorial: $(INSTALLED) ## run the commands of docs/tutorial.md and the recordings of docs/recording.md anew (some minutes)
	$(BIN)/python docs/make_tutorial.py
	$(BIN)/python docs/make_recording.py

.PHONY: gallery
gallery: $(INSTALLED) ## make the reports of docs/gallery.md and photograph them with Chromium (a few minutes)
	$(BIN)/python docs/make_gallery.py

# Guided by coverage where atheris is installed, which the lock has not: .venv/bin/python -m pip install atheris
SECONDS ?= 600
.PHONY: fuzz
fuzz: $(INSTALLED) ## change good inputs at random for SECONDS=600: each has a result or one message
	$(BIN)/python -m benchmarks.fuzz --seconds $(SECONDS) $(ARGS)

.PHONY: calibrate
calibrate: $(INSTALLED) ## diagnose some 800 simulated rigs blind and tabulate how often that is right (some two hours)
	$(BIN)/python -m benchmarks.calibration --jobs $(JOBS) $(ARGS)

.PHONY: bench
bench: $(INSTALLED) ## time kernel, engines and commands beside what else one would use: docs/performance.md (a quarter of an hour)
	$(BIN)/python -m benchmarks.performance $(ARGS)

.PHONY: accuracy
accuracy: $(INSTALLED) ## errors of the engines over 100 random beam motions: docs/accuracy.md (5 to 20 min)
	$(BIN)/python -m benchmarks.accuracy --jobs $(JOBS) $(ARGS)

.PHONY: sensitivity
sensitivity: $(INSTALLED) ## halve and double every setting of the search on a few blind trials: docs/settings.md (half an hour)
	$(BIN)/python -m benchmarks.sensitivity --jobs $(JOBS) $(ARGS)

.PHONY: measured
measured: $(INSTALLED) ## diagnose the measured rigs in the folder RECORDINGS=… : docs/measured_rigs.md (half an hour)
	@test -n "$(RECORDINGS)" || { echo 'Give a folder of case folders: make measured RECORDINGS=/path/to/recordings' >&2; exit 2; }
	$(BIN)/python -m benchmarks.measured $(RECORDINGS) --out docs/measured_rigs $(ARGS)

# The second command asks what the lock promises: on Linux with Python 3.11, nothing needs a compiler.
# All extras but rerun, whose 170 MB serve one option of one command.
EXTRAS := files matlab ros control video dask sysid dart dev test

.PHONY: lock
lock: ## resolve pyproject.toml into requirements.lock (ARGS=--upgrade for newer versions)
	@$(FIND_PYTHON); $$found -m venv --clear build/lock
	@build/lock/bin/python -m pip install --disable-pip-version-check --quiet 'uv>=0.8,<1'
	build/lock/bin/uv pip compile pyproject.toml $(EXTRAS:%=--extra %) --universal --fork-strategy fewest --generate-hashes \
	  --no-emit-index-url --custom-compile-command 'make lock' --no-config --quiet -o requirements.lock $(ARGS)
	build/lock/bin/uv pip compile requirements.lock --python-version 3.11 --python-platform x86_64-manylinux_2_28 \
	  --only-binary :all: --no-config --quiet > build/lock/linux.txt

.PHONY: clean
clean: ## remove .venv, builds and caches; reports stay
	rm -rf .venv build dist .hypothesis .mypy_cache .pytest_cache .ruff_cache
	find analytic benchmarks harness mjcf urdf tests -name __pycache__ -prune -exec rm -rf {} +
