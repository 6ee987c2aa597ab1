"""One case in a process of its own: `python -m ddf.sweep.worker CASE FOLDER THREADS go-on|anew`.

Its progress and its end are JSON lines on stdout. It ends at once when the sweep that started it is gone (its
stdin closes), so that a sweep that was killed leaves nothing running.
"""

from __future__ import annotations

import json
import os
import sys
import threading
from typing import Any

from ddf.errors import DdfError, UsageError

GONE = 1


def main(case_file: str, folder: str, threads: str, how: str) -> int:
    """Run the case; the exit code is that of `ddf run`."""
    threading.Thread(target=_end_with_parent, daemon=True).start()
    from ddf.case import load_case
    from ddf.run import Progress, run_case

    def tell(p: Progress) -> None:
        _say(step=p.step, steps=p.steps, stage=p.stage)

    try:
        case = load_case(case_file)
        try:
            go_on = how == "go-on"
            result = run_case(case, folder, threads=int(threads), resume=go_on, force=not go_on, report=tell)
        except UsageError:
            if not go_on:
                raise
            result = run_case(case, folder, threads=int(threads), force=True, report=tell)
    except DdfError as error:
        _say(end="failed", message=str(error))
        return error.exit_code
    except MemoryError:
        _say(end="failed", message="out of memory")
        return 1
    _say(end=result.stop_reason, message="", wall_s=sum(result.wall_s.values()))
    return 0


def _say(**values: Any) -> None:
    print(json.dumps(values), flush=True)


def _end_with_parent() -> None:
    sys.stdin.buffer.read()
    os._exit(GONE)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
