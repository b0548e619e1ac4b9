"""Running a sweep: blocks computed by many workers, written in order, and resumed after an interruption."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from film_datasets.files import SUFFIX, ZARR, check_file, check_place, open_dataset, put_in_place, temporary_path, write
from film_datasets.schema import SWEEP, VERSIONS, ContentHash
from film_datasets.sweeps.attributes import Totals, global_attributes
from film_datasets.sweeps.block_writers import FILE_BLOCKS, MemoryWriter, NetCDFWriter, Writer, ZarrWriter
from film_datasets.sweeps.blocks import Blocks
from film_datasets.sweeps.checkpoint import Checkpoint, Written
from film_datasets.sweeps.computed_blocks import Run, computed_blocks
from film_datasets.sweeps.definition import Sweep
from film_datasets.sweeps.disk_space import bytes_text, check_free_space, sizes_text
from film_datasets.sweeps.executor import Workers, workers_of
from film_datasets.sweeps.progress import Progress, explained
from film_datasets.sweeps.storage import Storage, written_content
from film_datasets.tables import TABLES
from film_model.base.foreign import Dataset
from film_model.scene import Scene
from film_model.version import __version__


def sweep(
    scene: Scene | str | os.PathLike[str],
    over: Mapping[str, Any],
    design: str = "grid",
    *,
    samples: int | None = None,
    seed: int | None = None,
    keep: str = "summary",
    correlation: Any = None,
    derivatives: Sequence[str] = (),
    variables: Sequence[str] = (),
    output: str | os.PathLike[str] | None = None,
    workers: int | None = None,
    scheduler: Any = None,
    resume: bool = False,
    overwrite: bool = False,
) -> Dataset:
    """Impacts of a scene over swept quantities, as a dataset with every summary quantity of every impact.

    over: path in a scene file such as "impactor.velocity" → its values: a list (["250 MPa", "310 MPa"], a pint
    quantity that holds an array, or names such as those of laws and materials), {"from": "0.1 m/s", "to": "5 m/s",
    "count": 1000, "spacing": "log"}, or for sampled designs a distribution: {"normal": ["310 MPa", "15 MPa"]} or
    "lognormal", mean and standard deviation; {"uniform": [least, greatest]}; "truncated-normal", mean, standard
    deviation, least and greatest; "triangular", least, most likely, greatest; "weibull", shape and scale; "empirical",
    observed values; or a tolerance, "10 mm ± 0.05 mm", uniform between its limits. Or a pandas DataFrame or xarray
    Dataset with a row for each impact, whose columns are called "impactor.velocity [m/s]".

    design: "grid", every combination, with the swept quantities as dimensions; "zip", lists side by side; "random",
    "sobol" (scrambled; balanced for powers of two) or "latin-hypercube", with `samples` impacts and `seed` (1); these
    draw from lists with equal probability and from ranges uniformly. correlation: for these, a matrix with a row for
    each swept quantity: of the normal deviates by whose probabilities they are drawn (Gaussian copula).
    derivatives: numbers of the scene, such as "impactor.velocity", by which the summary of every impact is
    differentiated, with its decisions about effects held fixed (d_maximum_force_d_impactor_velocity and so on).
    variables: names of summary values, "zener_number" or "estimated_accuracy": only these are kept, with the swept
    quantities, status, law and scene_key; all if empty.
    keep: "summary"; "segments", the exact histories too; "samples=201", histories at 201 normalised times too.

    output: FILE.nc or FILE.zarr, complete or not written at all, opened lazily; or a table in FILE.csv, .parquet or
    .mat. Without it the dataset is in memory. workers: threads, as many as there are cores unless given; scheduler: the
    address of a Dask scheduler, or a distributed.Client, whose workers compute the blocks instead. The data do not
    depend on either. resume: continue an interrupted run with this output. overwrite: replace an existing output or
    interrupted run.

    An impact that fails has NaN as its values and a status that gives the reason. Raises SceneError for mistakes in
    scene or sweep, FileExistsError or another OSError if the output cannot be written, MemoryError for a sweep that is
    too large without an output.

    >>> ds = fd.sweep(scene, {"impactor.velocity": ["1 m/s", "2 m/s", "4 m/s"]})
    >>> ds.maximum_force.dims
    ('impactor_velocity',)
    """
    base = scene if isinstance(scene, Scene) else Scene.from_toml(scene)
    asked = Sweep.of(
        base, over, design, samples=samples, seed=seed, keep=keep, correlation=correlation, derivatives=derivatives,
        variables=variables,
    )  # fmt: skip
    return run_sweep(
        asked, output, workers=workers, scheduler=scheduler, resume=resume, overwrite=overwrite,
        command="film_datasets.sweep",
    )  # fmt: skip


def run_sweep(
    sweep: Sweep,
    output: str | os.PathLike[str] | None = None,
    *,
    command: str,
    workers: int | None = None,
    scheduler: Any = None,
    resume: bool = False,
    overwrite: bool = False,
    progress: Progress | None = None,
    announce: Callable[[str], None] | None = None,
) -> Dataset:
    """Run a sweep; see `film_datasets.sweep`. command: for the attribute `history`. progress: called after each block.
    announce: called before the first, with the sizes that segments and output will have, if segments are kept.

    Raises Interrupted, a KeyboardInterrupt, if it is stopped from the keyboard with some blocks finished.
    """
    if workers is not None and (isinstance(workers, bool) or not isinstance(workers, int) or not 1 <= workers <= 4096):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise ValueError(f"workers: {workers!r} is not allowed: a whole number from 1 to 4096 is needed")
    run = Run(sweep, Blocks(sweep), command, progress)
    if output is None:
        return _in_memory(run, workers, scheduler)
    target = Path(output)
    if target.suffix in TABLES:
        return _write_table(run, target, workers, scheduler, resume, overwrite)
    checkpoint = Checkpoint(target, sweep, run.blocks)
    if resume and target.exists() and not overwrite:
        if (difference := _not_the_output_of(target, sweep)) is not None:
            raise FileExistsError(f"{target}: {difference}; use overwrite=True to replace it")
        checkpoint.remove()
        return open_dataset(target)
    if target.suffix not in (SUFFIX, ZARR):
        words = ", ".join(f'"{suffix}"' for suffix in TABLES)
        raise ValueError(f'{target}: the name of a sweep\'s output must end in "{SUFFIX}", "{ZARR}", {words}')
    check_place(target, overwrite)
    need = check_free_space(target, sweep, run.blocks)
    if announce is not None and sweep.keep == "segments":
        announce(f"expected: {sizes_text(sweep.size * run.blocks.size.history, sweep.size, str(target), need)}")
    with checkpoint.locked(resume, overwrite), explained(target, checkpoint.summary):
        _write_file(run, target, checkpoint, workers, scheduler)
    checkpoint.remove()
    return open_dataset(target)


def _in_memory(run: Run, workers: int | None, scheduler: Any) -> Dataset:
    """The dataset of a sweep without an output."""
    most_in_memory = 4_000_000_000  # bytes of a sweep without an output file
    if (need := run.sweep.size * run.blocks.size.each) > most_in_memory:
        raise MemoryError(
            f"{run.sweep.size} impacts take about {bytes_text(need)}, at most {bytes_text(most_in_memory)} go into "
            "memory: give an output, FILE.nc or FILE.zarr"
        )
    writer = MemoryWriter()
    with workers_of(workers, scheduler) as pool:
        _write_blocks(run, writer, pool)
    return writer.dataset


def _write_table(run: Run, target: Path, workers: int | None, scheduler: Any, resume: bool, overwrite: bool) -> Dataset:
    """Compute the sweep in memory and write it as a table."""
    if run.sweep.keep != "summary":
        raise ValueError(f"{target}: {run.sweep.keep} do not fit a table: use FILE{SUFFIX} or FILE{ZARR}")
    if resume:
        raise ValueError(f"{target}: a table is not computed in blocks that could be resumed; use FILE{SUFFIX}")
    check_file(target, overwrite)
    ds = _in_memory(run, workers, scheduler)
    write(ds, target, overwrite)
    return ds


def _write_file(run: Run, target: Path, checkpoint: Checkpoint, workers: int | None, scheduler: Any) -> None:
    """Write the output under another name and rename it; if that fails, keep what was computed."""
    try:
        writer, content = _writer(run, target, checkpoint)
        try:
            with workers_of(workers, scheduler) as pool:
                _write_blocks(run, writer, pool, checkpoint, content)
            put_in_place(writer.path, target)
        except BaseException:
            if checkpoint.written() is None:
                writer.abandon()
            raise
    except BaseException:
        if not checkpoint.finished():
            checkpoint.remove()
        raise


def _writer(run: Run, target: Path, checkpoint: Checkpoint) -> tuple[NetCDFWriter | ZarrWriter, ContentHash | None]:
    """A writer for the output; and the hash of what an interrupted run has written with it, if that is whole."""
    begun = checkpoint.written()
    if begun is not None:
        with contextlib.suppress(OSError, ValueError, KeyError, RuntimeError):  # of a damaged folder
            writer = ZarrWriter(temporary_path(target), existing=True)
            content = written_content(run.sweep, run.blocks, writer, begun.blocks)
            if content.hexdigest() == begun.content:
                return writer, content
        checkpoint.set_written(None)
    return (ZarrWriter if target.suffix == ZARR else NetCDFWriter)(temporary_path(target)), None


def _write_blocks(
    run: Run, writer: Writer, workers: Workers, checkpoint: Checkpoint | None = None, content: ContentHash | None = None
) -> None:
    """Put the columns of all blocks into the writer, in order, then the attributes; or continue, after the blocks that
    the checkpoint says are written, whose hash is `content`."""
    begun = checkpoint.written() if checkpoint is not None else None
    totals = Totals.of(run.sweep) if begun is None else Totals.from_plain(begun.totals)
    numbers = range(0 if begun is None else begun.blocks, len(run.blocks))
    files = {group.start for group in run.blocks.groups(FILE_BLOCKS)}
    with Storage(run.sweep, run.blocks, writer, workers, content) as storage:
        found = computed_blocks(run, workers, checkpoint, numbers)
        if begun is None:
            storage.create()
        for number, (block, columns) in zip(numbers, found, strict=True):
            if checkpoint is not None and checkpoint.in_files and number in files and number > numbers.start:
                storage.finish()
                checkpoint.set_written(Written(number, storage.content.hexdigest(), totals.to_plain()))
            storage.put(block, columns)
            totals.add(columns)
            if run.progress is not None:
                run.progress(block.first + block.count, run.sweep.size)
    digest = storage.content.hexdigest()
    writer.close({**global_attributes(run.sweep, run.command, totals), "content_sha256": digest})


def _not_the_output_of(target: Path, sweep: Sweep) -> str | None:
    """Why a finished output is not that of this sweep and version; None if it is."""
    wanted = (sweep.scene.archived_text(), sweep.text(), " ".join(sweep.kept), sweep.dense)
    try:
        with open_dataset(target) as ds:
            found = (
                *(ds.attrs.get(name) for name in ("scene_toml", "sweep_toml", "kept")),
                ds.sizes.get("normalised_time", 0),
            )
            version = ds.attrs.get("film_model_schema_version"), ds.attrs.get("film_model_version")
    except (OSError, ValueError, ImportError) as error:
        return f"is not the finished output of a sweep ({error})"
    if found != wanted:
        return "is not the finished output of this sweep and scene"
    if version != (VERSIONS[SWEEP], __version__):
        return f"was made by film-model {version[1]} (schema {version[0]}), this is {__version__} ({VERSIONS[SWEEP]})"
    return None
