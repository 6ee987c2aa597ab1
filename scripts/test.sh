#!/usr/bin/env bash
# Sets up if need be, then checks style, types and layers, and runs the tests (coarse scenes).
set -euo pipefail
cd "$(dirname "$0")/.."
bash scripts/setup.sh
export PATH="$PWD/.venv/bin:$PATH"
ruff format --check ddf tests scripts
ruff check ddf tests scripts
mypy
lint-imports
python -c "import ddf.kernel_cache as cache; cache.use_cache(); cache.warm_kernels()"
python -m pytest -n 2 --dist loadfile "$@"
python -m pytest tests/benchmarks -q -n 0 -o addopts="" --benchmark-disable  # that they still run; nothing is timed
