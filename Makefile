# The README's two commands are `make demo` and `make test`; `make lint` is what CI adds.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
LIGHT := $(VENV)/.light
INSTALLED := $(VENV)/.installed
LINTERS := $(VENV)/.linters
DOCS := $(VENV)/.docs
PIP_INSTALL := $(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt

.PHONY: demo test lint docs results clean

# What `make demo` needs is a third of what the tests do.
$(LIGHT): pyproject.toml constraints.txt
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(PIP_INSTALL) --editable .
	touch $(LIGHT)

$(INSTALLED): pyproject.toml constraints.txt
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(PIP_INSTALL) --editable '.[test]'
	touch $(LIGHT) $(INSTALLED)

$(LINTERS): $(INSTALLED)
	$(PIP_INSTALL) --editable '.[lint]'
	touch $(LINTERS)

$(DOCS): $(LIGHT)
	$(PIP_INSTALL) --editable '.[docs]'
	touch $(DOCS)

demo: $(LIGHT)
	$(BIN)/polyfold fold "fold the t-shirt into a rectangular block" --garment tshirt --seed 0 --out runs/demo
	$(BIN)/polyfold garments --out runs/demo/garments.png
	$(BIN)/polyfold fold "fold it in half" --garment tshirt --outline polyfold/samples/tshirt.json --out runs/demo-twin

test: $(INSTALLED)
	$(BIN)/python -m pytest -n 2 --dist loadfile

# Pyright's type checker and Node come from the Python package index; the variable keeps it from asking for newer ones.
lint: $(LINTERS)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/lint-imports --no-cache --no-logo
	PYRIGHT_PYTHON_IGNORE_WARNINGS=1 $(BIN)/pyright --project . --pythonpath $(BIN)/python

# The site, in build/docs: open build/docs/index.html. A broken link fails.
docs: $(DOCS)
	$(BIN)/python -m sphinx --fail-on-warning --keep-going --quiet docs build/docs

# Every recorded table again, about eight hours of two cores, in runs/results; goes on where it was stopped.
results: $(INSTALLED)
	$(BIN)/python -m experiments.everything

clean:
	rm -rf $(VENV) runs build dist
