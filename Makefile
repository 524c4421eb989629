# `make paper` and `make test` do all the set-up they need in .venv; nothing else has to be installed.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
UV := $(shell command -v uv 2>/dev/null)
OUT ?= paper

.PHONY: paper test lint format benchmark clean

paper: $(VENV)/.installed
	$(BIN)/kvtheory steady
	$(BIN)/kvtheory asymptotes
	$(BIN)/kvtheory transient
	$(BIN)/kvtheory derive -o $(OUT)/derivations
	$(BIN)/kvtheory chart failures -o $(OUT)/failures.html
	$(BIN)/python -m figures -o $(OUT)/figures
	@echo "Done: open $(OUT)/derivations/derivations.html and $(OUT)/figures"

test: $(VENV)/.installed-test
	$(BIN)/python -m pytest -n auto --dist loadscope

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
	$(BIN)/kvtheory chart work-precision --standard all -o $(OUT)/work_precision.png

clean:
	rm -rf $(VENV) $(OUT) build dist *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis .import_linter_cache

$(BIN)/python:
ifdef UV
	$(UV) venv --python $(PYTHON) $(VENV)
else
	$(PYTHON) -m venv $(VENV)
endif

$(VENV)/.installed: pyproject.toml constraints.txt | $(BIN)/python
ifdef UV
	$(UV) pip install --quiet --python $(BIN)/python --constraint constraints.txt --editable '.[fast,data,benchmark]'
else
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable '.[fast,data,benchmark]'
endif
	@touch $@

$(VENV)/.installed-test: $(VENV)/.installed
ifdef UV
	$(UV) pip install --quiet --python $(BIN)/python --constraint constraints.txt --editable '.[fast,data,benchmark,test]'
else
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable '.[fast,data,benchmark,test]'
endif
	@touch $@
