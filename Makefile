# `make paper` and `make test` do all the set-up they need in .venv; nothing else has to be installed.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
OUT ?= paper
WORKERS ?= auto
# Hundreds of modules are compiled once, and not in each of the many processes of the tests.
export PYTHONDONTWRITEBYTECODE :=

.PHONY: paper docs test test-one test-lowest test-processors package lint format benchmark clean

paper: $(VENV)/.installed
	$(BIN)/kvtheory steady
	$(BIN)/kvtheory asymptotes
	$(BIN)/kvtheory transient
	$(BIN)/kvtheory derive -o $(OUT)/derivations
	$(BIN)/kvtheory chart failures -o $(OUT)/failures.html
	$(BIN)/python -m figures -o $(OUT)/figures
	@echo "Done: open $(OUT)/derivations/derivations.html and $(OUT)/figures"

docs: $(VENV)/.installed-docs
	$(BIN)/python -m sphinx -W --keep-going -j 2 -b html docs docs/_build/html
	$(BIN)/python docs/check_site.py docs/_build/html
	@echo "Done: open docs/_build/html/index.html"

# The workers of the tests share the processors already: more threads of BLAS would only wait for each other.
test test-lowest test-processors: export OPENBLAS_NUM_THREADS := 1

# The figures and pages that the tests make are those of the site, as long as the code is the same.
test: $(VENV)/.installed-test
	KVTHEORY_SITE=docs/generated $(BIN)/python -m pytest -n auto --dist loadscope

# One file of tests, or FILE=tests/test_x.py::test_y, with no more than it needs; a few files need all of `test`.
test-one: $(VENV)/.installed-one
	$(BIN)/python -m pytest -q $(FILE)

ifeq ($(FILE)$(filter test-one,$(MAKECMDGOALS)),test-one)
$(error give a file: make test-one FILE=tests/test_exact.py)
endif

# What depends on NumPy, SciPy, SymPy and the others at run time, with the oldest of them. Their Numba keeps its own
# kernels: two versions with one cache would each compile everything anew.
LOWEST := .venv-lowest
LOWEST_TESTS := test_api test_transient test_elements test_sweep test_cli test_scene test_units test_emit \
	test_presented

test-lowest: $(LOWEST)/.installed
	NUMBA_CACHE_DIR=$(CURDIR)/$(LOWEST)/kernels $(LOWEST)/bin/python -m pytest -n $(WORKERS) --dist loadscope \
		-W "ignore:numpy.ndarray size changed" $(LOWEST_TESTS:%=tests/%.py)

# What may depend on the processor: without what NumPy, OpenBLAS and the C library gain from AVX2 and FMA; then
# with AVX-512, where there is any.
PROCESSOR_TESTS = $(BIN)/python -m pytest -n $(WORKERS) -m processor $$(grep -l mark.processor tests/test_*.py)
GAINED := import numpy._core._multiarray_umath as m; print(*[f for f in m.__cpu_dispatch__ if m.__cpu_features__[f]])

test-processors: $(VENV)/.installed-test
	OPENBLAS_CORETYPE=Nehalem NPY_DISABLE_CPU_FEATURES="$$($(BIN)/python -c '$(GAINED)')" \
		GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2,-FMA $(PROCESSOR_TESTS)
	! grep -qs avx512vl /proc/cpuinfo || OPENBLAS_CORETYPE=SkylakeX $(PROCESSOR_TESTS)

# What users install, in clean environments of all these Pythons that are on the PATH; it names those that are not.
PYTHONS ?= python3.11 python3.12 python3.13

package: $(BIN)/python
	.ci/package $(PYTHONS)

lint: $(VENV)/.installed-test
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

format: $(VENV)/.installed-test
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

benchmark: $(VENV)/.installed
	$(BIN)/python -m figures.benchmark
	$(BIN)/python -m figures.benchmark_transient
	$(BIN)/python -m figures.benchmark_calls
	$(BIN)/python -m figures.benchmark_elements
	$(BIN)/python -m figures.benchmark_foundation
	$(BIN)/python -m figures.benchmark_engines
	$(BIN)/kvtheory chart work-precision --standard all -o $(OUT)/work_precision.png

clean:
	rm -rf $(VENV) $(LOWEST) $(OUT) build dist docs/_build docs/generated *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis .import_linter_cache

# uv unpacks and fetches side by side, in a sixth of the time of pip; where it finds no index, pip does the same.
$(BIN)/python:
	$(PYTHON) -m venv $(VENV)
	-$@ -m pip install --quiet --constraint constraints.txt uv

define installed
$(BIN)/uv pip install --quiet --python $(1)/bin/python --constraint $(2) --editable '.[$(EXTRAS)]' || \
	$(BIN)/python -m pip --python $(1)/bin/python install --quiet --no-compile --constraint $(2) --editable '.[$(EXTRAS)]'
endef

# Each holds those before it.
$(VENV)/.installed-one: EXTRAS = test-one
$(VENV)/.installed: EXTRAS = fast,data,benchmark
$(VENV)/.installed-test: EXTRAS = fast,data,benchmark,test
$(VENV)/.installed-test: HELD = $(VENV)/.installed $(VENV)/.installed-one
$(VENV)/.installed-docs: EXTRAS = fast,data,benchmark,test,docs
$(VENV)/.installed-docs: HELD = $(VENV)/.installed $(VENV)/.installed-one $(VENV)/.installed-test
$(VENV)/.installed-one $(VENV)/.installed $(VENV)/.installed-test $(VENV)/.installed-docs: pyproject.toml constraints.txt | $(BIN)/python
	$(call installed,$(VENV),constraints.txt)
	@touch $(HELD) $@

$(LOWEST)/.installed: EXTRAS = fast,data,test
$(LOWEST)/.installed: pyproject.toml constraints-lowest.txt | $(BIN)/python
	$(PYTHON) -m venv --without-pip $(LOWEST)
	$(call installed,$(LOWEST),constraints-lowest.txt)
	@touch $@
