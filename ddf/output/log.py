"""log.txt: what a run says while it goes on, each line with its time of day. A resumed run appends to it."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager, suppress

from ddf.errors import DdfError
from ddf.output.atomic import write_errors
from ddf.output.folder import RunFolder

LOG = "log.txt"
NAMES = ("ddf", "py.warnings")  # what is written down: the package's own words, and Python's warnings


class _QuietFile(logging.FileHandler):
    """A file whose failures (a full disk) do not hide the error that is being told."""

    def handleError(self, record: logging.LogRecord) -> None:
        """Leave the line out."""


@contextmanager
def run_log(folder: RunFolder) -> Iterator[logging.Logger]:
    """The logger of a run while it lasts; an exception that ends it is written down. Raises DdfError."""
    with write_errors(folder / LOG):
        handler = _QuietFile(folder / LOG, encoding="utf-8")
    handler.setFormatter(logging.Formatter("%(asctime)s %(levelname)s %(message)s", "%Y-%m-%dT%H:%M:%S%z"))
    loggers = [logging.getLogger(name) for name in NAMES]
    levels = [logger.level for logger in loggers]
    logging.captureWarnings(True)
    for logger in loggers:
        logger.addHandler(handler)
        logger.setLevel(logging.INFO)
    try:
        yield loggers[0]
    except KeyboardInterrupt:
        loggers[0].warning("stopped at once by a signal; the last checkpoint stands")
        raise
    except DdfError as error:
        loggers[0].error("%s", error)
        raise
    except Exception:
        loggers[0].exception("the run failed")
        raise
    finally:
        logging.captureWarnings(False)
        for logger, level in zip(loggers, levels, strict=True):
            logger.removeHandler(handler)
            logger.setLevel(level)
        with suppress(OSError):
            handler.close()
