# Two commands do all: `make demo` and `make test`.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
QUIET ?= -q
# pip compiles nothing: what is imported is compiled then, a fraction of it, and kept whatever the shell says
export PIP_COMPILE := 0
export PYTHONDONTWRITEBYTECODE :=

.PHONY: demo test test-long test-all lint docs build page dist bench stability coupling papers references compatibility install clean help

help: ## what there is to make
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 12

$(VENV)/.made:
	$(PYTHON) -m venv $(VENV)
	@touch $@

# $(call set-up,EXTRAS): the kernel is translated (half a minute) while pip goes on with what that does not need
define set-up
	$(BIN)/python -m pip install $(QUIET) numba
	PYTHONPATH=fmu_src $(BIN)/python -m inertia_module.compiling.linking InertiaModule & \
	$(BIN)/python -m pip install $(QUIET) -e '.[$(1)]'; installed=$$?; wait; exit $$installed
	@touch $@
endef

$(VENV)/.run: $(VENV)/.made pyproject.toml
	$(call set-up,fast)

$(VENV)/.test: $(VENV)/.made pyproject.toml
	$(call set-up,quick)
	@touch $(VENV)/.run

$(VENV)/.all: $(VENV)/.made pyproject.toml
	$(call set-up,all)
	@touch $(VENV)/.run $(VENV)/.test

install: $(VENV)/.all ## set up a virtual environment with everything

build: $(VENV)/.run ## build the FMUs and the kernel for pages into build/
	$(BIN)/inertia-module build

page: $(VENV)/.all ## build the page that `inertia-module view` fills
	$(BIN)/python page/make.py

dist: $(VENV)/.all build page ## sdist and wheel in dist/, complete; the same source gives the same bytes
	rm -rf dist
	$(BIN)/python -m build $(QUIET) --no-isolation

demo: $(VENV)/.run ## set up, build the FMU for this platform, drive a car through the urban cycle
	$(BIN)/inertia-module run examples/urban.toml -o out/urban

TESTS := -m pytest -n auto --dist worksteal

test: $(VENV)/.test ## run the tests but for those that take long
	$(BIN)/python -m tests.ready & $(BIN)/python page/make.py; made=$$?; wait; exit $$made
	$(BIN)/python $(TESTS) -m "not slow"

test-long: $(VENV)/.all page ## run the tests that take long
	$(BIN)/python $(TESTS) -m slow

test-all: test test-long ## run all tests

lint: $(VENV)/.all ## style, types, floors, spelling; the page's too
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/codespell
	$(BIN)/python page/make.py check

docs: $(VENV)/.all page ## build the documentation into site/
	$(BIN)/python docs/make_pages.py --check
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict

bench: $(VENV)/.all page ## measure speed and errors, write docs/*.csv, the picture and the page on performance
	$(BIN)/python -m studies.benchmarks.speed
	$(BIN)/python -m studies.benchmarks.trade
	$(BIN)/python -m studies.benchmarks.page
	$(BIN)/python -m studies.benchmarks.sweep
	$(BIN)/python -m studies.benchmarks.fit
	$(BIN)/python docs/make_pages.py

stability: $(VENV)/.all ## try the extremes, write docs/stability.csv, its picture and page
	$(BIN)/python -m studies stability -o out/stability
	cp out/stability/stability.csv out/stability/*.png docs/
	$(BIN)/python docs/make_pages.py

coupling: $(VENV)/.all ## couple an engine, write docs/coupling*.csv, the picture and the page
	$(BIN)/python -m studies coupling -o out/coupling
	cp out/coupling/*.csv out/coupling/*.png docs/
	$(BIN)/python docs/make_pages.py

papers: $(VENV)/.all ## draw the figures of the papers into docs/papers/, write their page
	$(BIN)/python -m studies papers -o out/papers
	cp out/papers/*.svg docs/papers/
	$(BIN)/python docs/make_pages.py

references: $(VENV)/.all ## make the reference results that the FMUs carry along anew
	$(BIN)/python -m studies references

compatibility: $(VENV)/.all ## the FMUs with inputs and references for those who try importers, in out/compatibility
	$(BIN)/python -m studies compatibility

clean: ## remove what was built
	rm -rf $(VENV) out site dist build/*.fmu build/*.wasm page/node_modules component/node_modules
