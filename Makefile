# The README's two commands are `make demo` and `make test`; `make lint` is what CI adds.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed

.PHONY: demo test lint clean

$(STAMP): pyproject.toml constraints.txt
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable '.[test]'
	touch $(STAMP)

demo: $(STAMP)
	$(BIN)/polyfold fold "fold the t-shirt into a rectangular block" --garment tshirt --seed 0 --out runs/demo
	$(BIN)/polyfold garments --out runs/demo/garments.png
	$(BIN)/polyfold fold "fold it in half" --garment tshirt --outline tests/data/artf_tshirt.json --out runs/demo-twin

test: $(STAMP)
	$(BIN)/python -m pytest -n 2 --dist loadfile

lint: $(STAMP)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

clean:
	rm -rf $(VENV) runs build dist
