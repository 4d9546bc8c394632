# Start with `make demo` and `make test`.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
QUIET ?= -q
# pip compiles no bytecode; Python compiles the imported modules at their first import
export PIP_COMPILE := 0
export PYTHONDONTWRITEBYTECODE :=

.PHONY: demo test test-long test-all lint docs build page dist bench stability coupling papers references compatibility install clean help

help: ## list the targets
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 15

$(VENV)/.made:
	$(PYTHON) -m venv $(VENV)
	@touch $@

$(VENV)/.run: $(VENV)/.made pyproject.toml
	$(BIN)/python -m pip install $(QUIET) -e '.[fast]'
	@touch $@

$(VENV)/.test: $(VENV)/.made pyproject.toml
	$(BIN)/python -m pip install $(QUIET) -e '.[quick]'
	@touch $@ $(VENV)/.run

$(VENV)/.all: $(VENV)/.made pyproject.toml
	$(BIN)/python -m pip install $(QUIET) -e '.[all]'
	@touch $@ $(VENV)/.run $(VENV)/.test

install: $(VENV)/.all ## create a virtual environment with all extras

build: $(VENV)/.run ## build the FMUs and the WebAssembly kernel of the viewer into build/
	$(BIN)/inertia-module build

page: $(VENV)/.all ## build the viewer (template of `inertia-module view`)
	$(BIN)/python viewer/make.py

dist: $(VENV)/.all build page ## build the sdist and the wheel into dist/ (reproducible)
	rm -rf dist
	$(BIN)/python -m build $(QUIET) --no-isolation

demo: $(VENV)/.run ## set up, build the FMU for this platform, simulate a car in the urban cycle
	$(BIN)/inertia-module run examples/urban.toml -o out/urban

TESTS := -m pytest -n auto --dist worksteal

test: $(VENV)/.test ## run the fast tests
	$(BIN)/python -m tests.ready & $(BIN)/python viewer/make.py; made=$$?; wait; exit $$made
	$(BIN)/python $(TESTS) -m "not slow"

SLOW ?= tests
test-long: $(VENV)/.all page ## run the slow tests (of a folder: SLOW=tests/native)
	$(BIN)/python $(TESTS) -m slow $(SLOW)

test-all: test test-long ## run all tests

lint: $(VENV)/.all ## check style, types, layers and spelling, also of the viewer
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/codespell
	$(BIN)/python viewer/make.py check

docs: $(VENV)/.all page ## build the documentation into site/
	$(BIN)/python docs/make_pages.py --check
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict

bench: $(VENV)/.all page ## measure speed and errors; write the tables, the figure and the page of docs/verification
	$(BIN)/python -m benchmarks.speed
	$(BIN)/python -m benchmarks.trade
	$(BIN)/python -m benchmarks.page
	$(BIN)/python -m benchmarks.sweep
	$(BIN)/python -m benchmarks.fit
	$(BIN)/python docs/make_pages.py

stability: $(VENV)/.all ## run extremes and random machines; write their tables, picture and page
	$(BIN)/python -m verification stability -o out/stability
	$(BIN)/python -m verification stability --random 1000 -o out/stability
	cp out/stability/stability.csv out/stability/random.csv docs/verification/
	$(BIN)/python docs/make_stability_picture.py
	$(BIN)/python docs/make_pages.py

coupling: $(VENV)/.all ## compare engine couplings; write the tables, the figure and the page of docs/verification
	$(BIN)/python -m examples.coupling -o out/coupling
	cp out/coupling/*.csv out/coupling/*.png docs/verification/
	$(BIN)/python docs/make_pages.py

papers: $(VENV)/.all ## draw the figures of the papers into docs/papers/ and write their page
	$(BIN)/python -m papers -o out/papers
	cp out/papers/*.svg docs/papers/
	$(BIN)/python docs/make_pages.py

references: $(VENV)/.all ## recompute the reference results that the FMUs include
	$(BIN)/python -m verification references

compatibility: $(VENV)/.all ## write FMUs with inputs and references for importer tests to out/compatibility
	$(BIN)/python -m verification compatibility

clean: ## remove all build results
	rm -rf $(VENV) out site dist build/*.fmu build/*.wasm viewer/node_modules component/node_modules
