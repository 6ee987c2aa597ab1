#!/usr/bin/env bash
# Makes .venv with ddf and what it needs, and checks gmsh's system libraries (installs them with apt-get as root).
set -euo pipefail
cd "$(dirname "$0")/.."

python=${DDF_PYTHON:-python3}
"$python" - <<'PY' || { echo "ddf needs Python 3.11 or newer (set DDF_PYTHON to its path)" >&2; exit 1; }
import sys
sys.exit(sys.version_info < (3, 11))
PY

if [ ! -x .venv/bin/python ]; then
  "$python" -m venv .venv || { echo "cannot make a virtual environment: install python3-venv" >&2; exit 1; }
fi
.venv/bin/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e ".[dev]"

libraries="libglu1-mesa libgl1 libxrender1 libxcursor1 libxft2 libxinerama1 libxi6 libgomp1"
if ! message=$(.venv/bin/python -c "import gmsh; gmsh.initialize(interruptible=False); gmsh.finalize()" 2>&1); then
  if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
    echo "installing gmsh's system libraries: $libraries"
    apt-get update -qq
    DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $libraries >/dev/null
    .venv/bin/python -c "import gmsh; gmsh.initialize(interruptible=False); gmsh.finalize()"
  else
    echo "gmsh cannot start: $message" >&2
    echo "install its system libraries, on Debian and Ubuntu: sudo apt-get install $libraries" >&2
    exit 1
  fi
fi
