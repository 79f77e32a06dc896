# `make reproduce` runs the paper's experiments (`make reproduce FULL=1` at full size), `make test`
# checks the code, `make notebooks` executes the notebooks, `make docs` builds the manual into site/.
# Each sets itself up in a virtual environment first: .venv, or .venv-X.Y when PYTHON names another
# interpreter, as in `PYTHON=python3.13 make test`. A set-up cut short is thrown away and done again.

PYTHON ?= python3
OUT ?= results

# pyenv's shims answer only for the version in use unless they are told the version they stand for.
about := $(PYTHON) -c 'import sys; print(sys.executable, "%d.%d" % sys.version_info[:2])'
found := $(shell $(about) 2>/dev/null || PYENV_VERSION=$(PYTHON:python%=%) $(about) 2>/dev/null)
python := $(word 1,$(found))
version := $(word 2,$(found))

VENV := .venv$(if $(filter python3 python,$(PYTHON)),,-$(version))
bin := $(VENV)/bin
# Named by version, so that an environment of another one is replaced.
ready := $(VENV)/.ready-$(version)
docs_ready := $(VENV)/.docs-$(version)

unexport PYTHONPATH PYTHONHOME VIRTUAL_ENV

.PHONY: reproduce test notebooks docs setup clean
.DELETE_ON_ERROR:

reproduce: $(ready)
	$(bin)/drake-viapoint reproduce --out $(OUT) $(if $(FULL),--full)

test: $(ready)
	$(bin)/ruff check
	$(bin)/ruff format --check
	$(bin)/mypy
	$(bin)/python -m pytest -q --numprocesses auto --dist loadfile --no-loadscope-reorder

notebooks: $(ready)
	$(bin)/python -m pytest -q -m notebook --numprocesses auto tests/test_notebooks.py

docs: $(docs_ready)
	NO_MKDOCS_2_WARNING=1 $(bin)/mkdocs build --strict

setup: $(ready)

# While the stamp is away the environment counts as broken, whatever stopped the set-up.
$(ready): pyproject.toml constraints.txt
	@test -n "$(python)" || { echo "$(PYTHON): no such Python; try PYTHON=python3.11 make" >&2; exit 1; }
	@$(python) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
	    { echo "$(PYTHON) is Python $(version); 3.11 or newer is needed" >&2; exit 1; }
	@echo "Setting up $(VENV) with Python $(version) (a minute or two)"
	@test -f $@ || $(python) -m venv --clear $(VENV)
	@rm -f $(VENV)/.ready-*
	@$(bin)/python -m pip install --quiet --disable-pip-version-check \
	    --constraint constraints.txt hatchling editables
	@$(bin)/python -m pip install --quiet --disable-pip-version-check --no-build-isolation \
	    --constraint constraints.txt --editable '.[dev]'
	@touch $@

# In the same environment, and only for who builds the manual.
$(docs_ready): $(ready)
	@echo "Adding what the manual needs"
	@$(bin)/python -m pip install --quiet --disable-pip-version-check --no-build-isolation \
	    --constraint constraints.txt --editable '.[docs]'
	@touch $@

clean:
	rm -rf .venv .venv-* build dist site $(OUT)
