"""The command line: a thin layer over the Python API; only its commands print.

Exit codes: 0 ok; 1 failure; 2 usage or an invalid case; 3 unstable or an energy limit; 4 a verification missed
its bound; 5 some cases of a sweep failed; 130 interrupted.
"""

from __future__ import annotations

from typing import Any

import click

from ddf import __version__
from ddf.commands.check import check
from ddf.commands.common import INTERRUPTED, fail
from ddf.commands.compare import compare
from ddf.commands.export import export
from ddf.commands.init import init
from ddf.commands.report import report
from ddf.commands.run import run
from ddf.commands.schema import schema
from ddf.commands.study import study
from ddf.commands.sweep import sweep
from ddf.commands.verify import verify
from ddf.errors import DdfError


class _Commands(click.Group):
    """Turns expected failures into one message and their exit code."""

    def invoke(self, ctx: click.Context) -> Any:
        """Run a command; DdfError becomes a message on stderr and an exit code."""
        try:
            return super().invoke(ctx)
        except DdfError as error:
            fail(str(error), error.exit_code)
        except RuntimeError as error:
            if "cannot cache function" not in str(error):  # numba's, where ddf.kernel_cache has found no place
                raise
            fail("compiled kernels can be kept nowhere; set DDF_CACHE_DIR to a folder that can be written to", 1)
        except MemoryError:
            fail("out of memory; larger elements or fewer frames need less", 1)
        except KeyboardInterrupt:
            fail("interrupted", INTERRUPTED)


@click.group(cls=_Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="ddf")
def main() -> None:
    """Simulate double diaphragm forming of woven fabric.

    \b
    ddf init my-case.toml          a commented case to start from
    ddf check my-case.toml         what would run, without running it
    ddf run my-case.toml           run it; results go to runs/my-case
    ddf verify --quick             solve problems with known answers
    ddf study stability            where the method fails, and that the guards see it
    ddf export fibres runs/my-case what the next program needs
    """  # noqa: D301 (click knows a paragraph that is not to be filled by this character)


for _command in (run, check, init, schema, report, verify, compare, sweep, study, export):
    main.add_command(_command)
