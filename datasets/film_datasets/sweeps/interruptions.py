"""Messages for a run that the user interrupts, or whose output cannot be written."""

from __future__ import annotations

import contextlib
import os
import shutil
from collections.abc import Callable, Generator
from pathlib import Path

from film_model.base.errors import SimulationError

NO_SPACE = 1_000_000
"""A disk with fewer free bytes than this is full."""


class Interrupted(KeyboardInterrupt):
    """A sweep was interrupted; the message says where its finished blocks are kept."""


@contextlib.contextmanager
def explained(target: Path, kept: Callable[[], str]) -> Generator[None]:
    """Raise Interrupted or an OSError that names `target` and what is kept for the next run."""
    try:
        yield
    except KeyboardInterrupt:
        raise Interrupted(f"interrupted: {kept()}") from None
    except (SimulationError, FileExistsError):
        raise
    except (OSError, RuntimeError) as error:  # the netCDF library raises RuntimeError for a full disk
        raise OSError(f"{target}: cannot be written: {reason_of(error, target)}; {kept()}") from error


def reason_of(error: Exception, target: Path) -> str:
    """Why writing failed. The netCDF library says "Permission denied" for a full disk, and RuntimeError for others;
    h5py adds lines about its own state to the system's error."""
    if shutil.disk_usage(target.absolute().parent).free < NO_SPACE:
        return "the disk is full"
    number = getattr(error, "errno", None) or 0
    if number > 0:  # below 0 are the netCDF library's own
        return os.strerror(number)
    return (getattr(error, "strerror", None) or str(error)).split("\n")[0]
