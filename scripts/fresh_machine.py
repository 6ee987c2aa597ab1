"""Install ddf as a wheel where nothing is set up, and see that it works or says what to install.

    python scripts/fresh_machine.py [--python 3.11 ...] [--folder DIR] [--quick]

Builds the sdist and, from it, the wheel; then for each Python that is here (3.11 and newer): a new virtual environment
in a folder with spaces and letters beyond ASCII, no display, no cache, a home that cannot be written to, and once
without the system libraries of gmsh (all in a mount namespace of its own: Linux, as root or where users may make them).
Shipped cases are run by their names, far from the source tree. Needs a package index. --quick: no kernels compiled.
Exit code 1 if anything failed.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
HELP_S = 0.5  # a cold `ddf --help`
LOADED_S = 20.0  # to load compiled kernels, on a busy machine: compiling takes longer
TIMEOUT_S = 1200
GMSH_LIBRARIES = ("libGLU.so", "libXrender.so", "libXcursor.so", "libXft.so", "libXinerama.so")
SMALL = (
    "plies.0.element_mm=12.5", "diaphragms.element_mm=14", "tool.fillet_mm=15", "process.stages.0.duration_s=0.004",
    "process.stages.1.duration_s=0.012", "process.stages.2.duration_s=0.004", "process.stages.3.duration_s=0.002",
    "process.stages.4.duration_s=0.002", "output.frames_per_stage=1", "solver.energy_error_limit_percent=100",
)  # fmt: skip
READ_ONLY_HOME = 'mount --bind "$HOME" "$HOME" && mount -o remount,ro,bind "$HOME"'
NO_LIBRARIES = """
mount -t tmpfs none "$OVER" && mkdir "$OVER/up" "$OVER/work" &&
mount -t overlay overlay -o "lowerdir=$LIBS,upperdir=$OVER/up,workdir=$OVER/work" "$LIBS" && rm -f $GONE"""


class Machine:
    """A Python with the wheel, in folders of its own, and what was found on it."""

    def __init__(self, python: str, base: Path) -> None:
        self.version = _version(python)
        self.base = base / f"fresh machine ü 東 {self.version}"
        self.home, self.work, self.tmp, self.over = (self.base / name for name in ("home", "my parts ß", "tmp", "over"))
        for folder in (self.home, self.work, self.tmp, self.over):
            folder.mkdir(parents=True)
        subprocess.run([python, "-m", "venv", self.base / "venv"], check=True)
        self.python = self.base / "venv/bin/python"
        self.failed: list[str] = []

    def install(self, wheel: Path) -> None:
        """Install the wheel and what it needs, as a user would."""
        pip = [self.python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
        subprocess.run([*pip, "-c", ROOT / "constraints.txt", wheel], check=True, cwd=self.work, timeout=TIMEOUT_S)

    def ddf(self, *arguments: str, libraries: bool = True) -> tuple[int, str, float]:
        """Exit code, all that was said, and the seconds of a command on the bare machine."""
        prepare = READ_ONLY_HOME
        environment = {"PATH": f"{self.python.parent}:/usr/bin:/bin", "HOME": str(self.home), "TMPDIR": str(self.tmp)}
        if not libraries:
            found = _library_files()
            environment |= {"OVER": str(self.over), "LIBS": str(found[0].parent), "GONE": " ".join(map(str, found))}
            prepare += f" && {NO_LIBRARIES}"
        shell = f'{prepare} && began=$(date +%s.%N) && "$@"; code=$?; echo "took $began $(date +%s.%N)"; exit $code'
        command = [*_namespace(), "sh", "-c", shell, "sh", str(self.python.parent / "ddf"), *arguments]
        done = subprocess.run(
            command, cwd=self.work, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
            timeout=TIMEOUT_S, check=False,
        )  # fmt: skip
        text, _, took = done.stdout.rpartition("took ")
        began, ended = map(float, took.split())
        return done.returncode, text, ended - began

    def expect(self, what: str, good: bool, detail: str = "") -> None:
        """Print how a check went, and keep it if it failed."""
        print(f"  {'ok  ' if good else 'FAIL'} {what}", flush=True)
        if not good:
            self.failed.append(f"Python {self.version}: {what}: {detail[-2000:]}")


def light_checks(m: Machine) -> None:
    """What needs no kernels."""
    for cache in (m.base / "venv").rglob("site-packages/ddf/**/__pycache__"):
        shutil.rmtree(cache)
    code, text, cold_s = m.ddf("--help")
    m.expect(f"ddf --help, cold: {cold_s:.2f} s", code == 0 and cold_s < HELP_S, text)
    code, text, _ = m.ddf("init", "--list")
    names = {path.stem for path in (ROOT / "cases").glob("*.toml")}
    m.expect("shipped cases are found", code == 0 and names <= set(re.findall(r"[\w-]+", text)), text)
    code, text, _ = m.ddf("init", "mein fall é.toml")
    m.expect("ddf init", code == 0 and (m.work / "mein fall é.toml").is_file(), text)
    if _library_files():
        code, text, _ = m.ddf("check", "hemisphere", libraries=False)
        told = "libGLU" in text and "apt-get install" in text and "Traceback" not in text
        m.expect("without gmsh's libraries it says what to install", code == 1 and told, text)
    code, text, _ = m.ddf("check", "mein fall é.toml")
    m.expect("ddf check of the new case", code == 0 and "Traceback" not in text, text)
    tool = 'tool={shape = "file", file = "hemisphere"}'
    code, text, _ = m.ddf("run", "hemisphere", "--set", "model=kinematic", "--set", tool)
    m.expect("a net on a shipped tool by its name", code == 0 and "report" in text, text)


def run_checks(m: Machine) -> None:
    """A shipped case run twice: kernels are compiled the first time and found again the second, though not at home."""
    settings = [part for item in SMALL for part in ("--set", item)]
    walls, states = [], []
    for folder in ("first", "second"):
        command = ("run", "tetrahedron-0-90-coarse", "-o", f"läufe/{folder}", "--threads", "1", "--quiet", *settings)
        code, text, _ = m.ddf(*command)
        out = m.work / "läufe" / folder
        whole = code == 0 and "Traceback" not in text and (out / "report.html").is_file()
        m.expect(f"{folder} run of tetrahedron-0-90-coarse, small", whole, text)
        if not whole:
            return
        walls.append(json.loads((out / "run.json").read_text())["wall_s"]["compile"])
        states.append(_states(m, out))
    m.expect(f"pictures are drawn without a display ({len(list(out.glob('pictures/*.png')))})",
             (out / "pictures/formed-ply-1.png").is_file())  # fmt: skip
    log = (out / "log.txt").read_text(encoding="utf-8")
    m.expect("the log says where kernels are kept", f"kept in {m.tmp}" in log, log)
    m.expect(f"kernels: {walls[0]:.0f} s the first time, {walls[1]:.1f} s after", walls[1] < LOADED_S)
    m.expect("both runs have the same bits", states[0] == states[1])
    m.expect("nothing was written at home", not list(m.home.iterdir()))


def _states(m: Machine, out: Path) -> str:
    """A digest of the final state of a run."""
    program = (
        "import hashlib, numpy, sys\nwith numpy.load(sys.argv[1]) as d:\n"
        "    print(hashlib.sha256(b''.join(d[n].tobytes() for n in sorted(d.files) if n.startswith('state_')"
        ")).hexdigest())"
    )
    command = [m.python, "-c", program, out / "checkpoint.npz"]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def _namespace() -> list[str]:
    """The command that gives a mount namespace of its own."""
    return ["unshare", "--mount"] if os.getuid() == 0 else ["unshare", "--mount", "--map-root-user"]


def _library_files() -> list[Path]:
    """Files of gmsh's system libraries, in the first folder that has any."""
    for folder in (Path("/usr/lib/x86_64-linux-gnu"), Path("/usr/lib/aarch64-linux-gnu"), Path("/usr/lib64")):
        found = [file for name in GMSH_LIBRARIES for file in sorted(folder.glob(f"{name}*"))]
        if found:
            return found
    return []


def _version(python: str) -> str:
    program = "import sys; print('%d.%d' % sys.version_info[:2])"
    done = subprocess.run([python, "-c", program], capture_output=True, text=True, check=False)
    return done.stdout.strip()


def pythons(wanted: list[str]) -> Iterator[str]:
    """One interpreter for each minor version from 3.11 on, of the path and of pyenv."""
    places = [shutil.which(f"python3.{minor}") for minor in range(11, 16)]
    pyenv = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv")) / "versions"
    seen = set()
    for place in [sys.executable, *sorted(map(str, pyenv.glob("3.*/bin/python")), reverse=True), *filter(None, places)]:
        version = _version(place)  # empty for a pyenv shim without its Python
        number = tuple(int(part) for part in version.split(".") if part)
        if number >= (3, 11) and version not in seen and (not wanted or version in wanted):
            seen.add(version)
            yield place


def built(base: Path) -> Path:
    """The wheel, made from the sdist, which is made from the source tree."""
    builder = base / "builder"
    subprocess.run([sys.executable, "-m", "venv", builder], check=True)
    subprocess.run([builder / "bin/python", "-m", "pip", "install", "--quiet", "build"], check=True, timeout=TIMEOUT_S)
    command = [builder / "bin/python", "-m", "build", "--outdir", base / "dist", ROOT]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, timeout=TIMEOUT_S)
    (wheel,) = (base / "dist").glob("*.whl")
    return wheel


def main() -> int:
    """Build, install and try on every Python; returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--python", action="append", default=[], help="only this minor version, e.g. 3.12; repeatable")
    parser.add_argument("--folder", type=Path, help="where to work  [default: a temporary folder]")
    parser.add_argument("--quick", action="store_true", help="nothing that compiles kernels")
    args = parser.parse_args()
    failed: list[str] = []
    with tempfile.TemporaryDirectory(prefix="ddf-fresh-") as temporary:
        base = (args.folder or Path(temporary)).absolute()
        base.mkdir(parents=True, exist_ok=True)
        wheel = built(base)
        print(f"built {wheel.name} from the sdist", flush=True)
        for python in pythons(args.python):
            began = time.monotonic()
            machine = Machine(python, base)
            print(f"Python {machine.version} ({python})", flush=True)
            machine.install(wheel)
            light_checks(machine)
            if not args.quick:
                run_checks(machine)
            print(f"  {time.monotonic() - began:.0f} s", flush=True)
            failed += machine.failed
    for fault in failed:
        print(f"FAULT {fault}")
    print(f"{len(failed)} faults")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
