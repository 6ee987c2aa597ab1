#!/usr/bin/env bash
# Sets up if need be, then runs the coarse form of the paper's 0/90 case into runs/first (pictures, report).
set -euo pipefail
cd "$(dirname "$0")/.."
bash scripts/setup.sh
.venv/bin/ddf run cases/tetrahedron-0-90-coarse.toml -o runs/first --force
