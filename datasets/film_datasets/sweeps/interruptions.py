"""Messages for a run that the user interrupts, or whose output cannot be written."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Generator
from pathlib import Path

from film_datasets.files import reason_of
from film_model.base.errors import SimulationError


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
