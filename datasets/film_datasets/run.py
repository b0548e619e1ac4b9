"""A sweep from beginning to end: blocks computed by many workers, put together in order, resumed after a kill."""

from __future__ import annotations

import contextlib
import os
import shutil
from collections.abc import Iterator, Mapping
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from film_datasets.design import SAMPLED
from film_datasets.files import SUFFIX, ZARR, check_place, open_dataset
from film_datasets.parts import Parts
from film_datasets.progress import Progress
from film_datasets.provenance import PROGRAM, provenance, scene_text, text_and_hash
from film_datasets.schema import REFUSED, SWEEP, ContentHash, flag_words
from film_datasets.stores import GROWING, Memory, Store, put_in_place, store_for
from film_datasets.sweeps import Sweep
from film_datasets.unmodelled import unmodelled
from film_model.batch import STATUSES
from film_model.core.native import MAX_STAGES
from film_model.errors import SimulationError
from film_model.laws import AbstractLaw
from film_model.scene import Scene

MOST_IN_MEMORY = 4_000_000_000
"""Bytes of a sweep that is not written to a file."""

AHEAD = 2
"""Blocks that wait for the one before them, besides those that are computed."""

COMMENT = (
    "status says how each impact ended; an impact that failed has NaN for its summary and harms no other. With "
    "segments, the motion of each impact is as in an impact_history: its segments begin where those of the impacts "
    "before end, in C order. scene_toml and sweep_toml are the files to run again."
)

NEEDS_DASK = 'a scheduler needs Dask: install film-model[dask] (pip install "film-model[dask]")'


class Interrupted(KeyboardInterrupt):
    """A sweep was stopped before its end; what was computed is kept, and the message says where."""


def sweep(
    scene: Scene | str | os.PathLike[str],
    over: Mapping[str, Any],
    design: str = "grid",
    *,
    samples: int | None = None,
    seed: int | None = None,
    keep: str = "summary",
    output: str | os.PathLike[str] | None = None,
    workers: int | None = None,
    scheduler: Any = None,
    resume: bool = False,
    overwrite: bool = False,
) -> xr.Dataset:
    """Impacts of a scene over swept quantities, as a dataset with one value of every summary quantity an impact.

    over: path of a scene file such as "impactor.velocity" → its values: a list (["250 MPa", "310 MPa"], a pint
    quantity that holds an array, words such as laws or materials), {"from": "0.1 m/s", "to": "5 m/s", "count": 1000,
    "spacing": "log"}, or for sampled designs a distribution {"normal": ["310 MPa", "15 MPa"]}, "lognormal" (mean and
    standard deviation too) or {"uniform": [least, greatest]}.

    design: "grid", every combination, with the swept quantities as dimensions; "zip", lists side by side; "random",
    "sobol" (scrambled; balanced for powers of two) or "latin-hypercube", with `samples` impacts and `seed` (1), of
    which lists are choices and ranges uniform. keep: "summary"; "segments", the exact histories; "samples=201", dense
    ones on normalised time.

    output: FILE.nc or FILE.zarr, written whole or not at all, and opened; without it the dataset is in memory.
    workers: threads, all cores unless given; scheduler: the address of a Dask scheduler, or a distributed.Client,
    whose workers compute the blocks instead. The data do not depend on either. resume: go on with what an interrupted
    run with this output left behind. overwrite: replace an output that is there, and begin anew.

    An impact that fails has a status that says why, and NaN. Raises SceneError for mistakes in scene or sweep,
    FileExistsError and other OSErrors where the output cannot be written, MemoryError for too much without an output.
    """
    base = scene if isinstance(scene, Scene) else Scene.from_toml(scene)
    made = Sweep.of(base, over, design, samples=samples, seed=seed, keep=keep)
    return run(
        made, output, workers=workers, scheduler=scheduler, resume=resume, overwrite=overwrite,
        command="film_datasets.sweep",
    )  # fmt: skip


def run(
    made: Sweep,
    output: str | os.PathLike[str] | None = None,
    *,
    command: str,
    workers: int | None = None,
    scheduler: Any = None,
    resume: bool = False,
    overwrite: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Run a sweep; see :func:`sweep`. command: for the attribute `history`. progress: told impacts done and in all."""
    if workers is not None and (isinstance(workers, bool) or not isinstance(workers, int) or not 1 <= workers <= 4096):
        raise ValueError(f"workers: {workers!r} is not allowed: a whole number from 1 to 4096 is needed")
    if output is None:
        if (need := made.size * made.bytes_a_row) > MOST_IN_MEMORY:
            raise MemoryError(
                f"{made.size} impacts take about {_bytes(need)}, at most {_bytes(MOST_IN_MEMORY)} go into memory: give "
                "an output, FILE.nc or FILE.zarr"
            )
        store = Memory()
        with _executor(workers, scheduler) as (pool, ahead):
            _fill(made, store, pool, ahead, None, command, progress)
        return store.dataset
    target = Path(output)
    if resume and target.exists() and not overwrite:
        if not _is_of(target, made):
            raise FileExistsError(
                f"{target}: is not the finished output of this sweep and scene; say overwrite=True to replace it"
            )
        Parts(target, made).remove()
        return open_dataset(target)
    if target.suffix not in (SUFFIX, ZARR):
        raise ValueError(f'{target}: the name of a sweep\'s output must end in "{SUFFIX}" or "{ZARR}"')
    check_place(target, overwrite)
    _check_room(target, made)
    parts = Parts(target, made)
    with parts.locked(resume, overwrite):
        try:
            store = store_for(target)
            try:
                with _executor(workers, scheduler) as (pool, ahead):
                    _fill(made, store, pool, ahead, parts, command, progress)
                put_in_place(store.path, target)
            except BaseException:
                store.abandon()
                if not parts.done():
                    parts.remove()
                raise
        except KeyboardInterrupt:
            raise Interrupted(f"interrupted: {parts.said()}") from None
        except (OSError, RuntimeError) as error:
            if isinstance(error, SimulationError | FileExistsError):
                raise
            reason = getattr(error, "strerror", None) or f"is the disk full? ({error})"
            raise OSError(f"{target}: cannot be written: {reason}; {parts.said()}") from error
    parts.remove()
    return open_dataset(target)


@contextlib.contextmanager
def _executor(workers: int | None, scheduler: Any) -> Iterator[tuple[Executor, int]]:
    """What computes blocks, and how many blocks may be under way."""
    if scheduler is not None:
        try:
            from distributed import Client
        except ImportError as error:
            raise ImportError(NEEDS_DASK) from error
        try:
            client = scheduler if isinstance(scheduler, Client) else Client(scheduler, timeout=10)
        except (OSError, ValueError) as error:
            raise SimulationError(f"no Dask scheduler answers at {scheduler}: {error}") from error
        try:
            yield client.get_executor(pure=False), 2 * max(1, sum(client.nthreads().values())) + AHEAD
        finally:
            if client is not scheduler:
                client.close()
        return
    count = workers or _cores()
    pool = ThreadPoolExecutor(count, thread_name_prefix="sweep")
    try:
        yield pool, count + AHEAD
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _fill(
    made: Sweep,
    store: Store,
    pool: Executor,
    ahead: int,
    parts: Parts | None,
    command: str,
    progress: Progress | None,
) -> None:
    """Compute the blocks, and put them into the store in their order."""
    meanings = {
        "laws": flag_words(made.laws),
        "refused": flag_words([f"{axis.name}_out_of_range" for axis in made.axes]),
        "stages": [f"stage_{number}_of_the_law" for number in range(1, MAX_STAGES + 1)],
    }
    along = {"coordinates": " ".join(axis.name for axis in made.axes)} if made.dims == ("impact",) else {}
    swept = {axis.name for axis in made.axes}
    variables = [
        (v, v.attributes(meanings) | (along if v.dims[:1] == ("impact",) and v.name not in swept else {}))
        for v in made.variables
    ]
    sizes = dict(zip(made.dims, made.shape, strict=True)) | ({"normalised_time": made.dense} if made.dense else {})
    chunks = dict(zip(made.dims, made.chunks, strict=True)) | {"normalised_time": made.dense or 1}
    store.create(sizes, chunks, variables)
    content = ContentHash(made.variables)
    _coordinates(made, store, content)
    estimated, gained = np.zeros(len(made.accuracies)), np.zeros(len(made.laws), np.int64)
    failed, segments = 0, 0
    for number, columns in _blocks(made, pool, ahead, parts):
        region, first, count = made.block(number)
        if "segment_count" in columns:
            ends = segments + np.cumsum(columns["segment_count"], dtype=np.int64)
            columns["segment_begin"], segments = ends - columns["segment_count"], int(ends[-1])
        for variable in made.variables:
            name = variable.name
            if name not in columns:
                continue
            values = np.asarray(columns[name], variable.dtype)
            content.update(name, values)
            if GROWING in variable.dims:
                store.grow(name, values)
            else:
                shape = tuple(s.stop - s.start if s.stop is not None else 0 for s in _whole(region, made.shape))
                store.put(name, region, values.reshape(shape + values.shape[1:]))
        estimated = np.maximum(estimated, columns["estimated"])
        gained += columns["gained"]
        failed += int(np.count_nonzero((columns["status"] < 0) | (columns["status"] >= REFUSED)))
        if progress is not None:
            progress(first + count, made.size)
    attributes = _attributes(made, command, estimated, gained, failed)
    store.close({**attributes, "content_sha256": content.hexdigest()})


def _whole(region: tuple[slice, ...], shape: tuple[int, ...]) -> list[slice]:
    return [slice(*part.indices(size)) for part, size in zip(region, shape, strict=True)]


def _coordinates(made: Sweep, store: Store, content: ContentHash) -> None:
    """The coordinates that are not columns of the blocks."""
    if made.dense:
        values = np.linspace(0.0, 1.0, made.dense)
        store.put("normalised_time", (slice(None),), values)
        content.update("normalised_time", values)
    for axis, chunk in zip(made.axes, made.chunks, strict=True) if made.dims != ("impact",) else ():
        piece = chunk * max(1, (1 << 20) // chunk)  # whole chunks: half a chunk would be read and written again
        for first in range(0, axis.count, piece):
            values = axis.at(np.arange(first, min(first + piece, axis.count)))
            store.put(axis.name, (slice(first, first + len(values)),), values)
            content.update(axis.name, values)


def _blocks(
    made: Sweep, pool: Executor, ahead: int, parts: Parts | None
) -> Iterator[tuple[int, dict[str, NDArray[Any]]]]:
    """The columns of every block in order; `ahead` blocks at most are under way."""
    here = isinstance(pool, ThreadPoolExecutor)
    if here and made.blocks == 1:  # nothing to wait for: no thread is needed
        yield 0, made.compute(0)
        return
    saves = parts is not None and made.blocks > 1
    kept = parts.done() if parts is not None else set[int]()

    def task(number: int) -> dict[str, NDArray[Any]]:
        columns = made.compute(number)
        if saves and parts is not None:
            parts.save(number, columns)
        return columns

    under_way: dict[int, Future[dict[str, NDArray[Any]]]] = {}
    upcoming = iter(number for number in range(made.blocks) if number not in kept)
    for number in range(made.blocks):
        while len(under_way) < ahead and (following := next(upcoming, None)) is not None:
            under_way[following] = pool.submit(task, following) if here else pool.submit(made.compute, following)
        if number in under_way:
            columns = under_way.pop(number).result()
            if saves and not here and parts is not None:
                parts.save(number, columns)
        else:
            assert parts is not None
            columns = parts.load(number) or task(number)
        yield number, columns


def _attributes(
    made: Sweep, command: str, estimated: NDArray[np.float64], gained: NDArray[np.int64], failed: int
) -> dict[str, Any]:
    """Global attributes but the hash of the content."""
    scene = made.scene
    paths = [axis.path for axis in made.axes]
    statuses = [f"{code} {word}: {sentence}" for code, (word, sentence) in sorted(STATUSES.items())]
    for place, axis in enumerate(made.axes):
        field = axis.field
        if field is not None:
            allowed = f"{field.low:g} to {field.high:g} {axis.unit}".rstrip()
            sentence = f"the value drawn is out of range: {allowed} is allowed"
            statuses.append(f"{REFUSED + place} {axis.name}_out_of_range: {sentence}")
    warnings = [f"{failed} of {made.size} impacts failed: see status"] if failed else []
    for law, count in zip(made.laws, gained.tolist(), strict=True):
        if count:
            warnings.append(f"law {law}: in {count} impacts its unloading returns more energy than its loading stored")
    asked = [accuracy for accuracy in made.accuracies if accuracy is not None]
    for accuracy, found in zip(made.accuracies, estimated.tolist(), strict=True):
        if accuracy is not None and found > accuracy:
            warnings.append(f"accuracy {accuracy:g} was not reached everywhere: estimated {found:.1e}")
    warnings += unmodelled(made)
    requested: dict[str, Any] = {"requested_accuracy": max(asked)} if len(asked) == len(made.accuracies) else {}
    if made.design in SAMPLED:
        requested |= {"samples": str(made.samples), "seed": str(made.seed)}
    return {
        **provenance(
            SWEEP,
            title=f"{scene.title or 'Impact'}: sweep over {', '.join(paths)}",
            summary=f"{made.size} impacts (target: {scene.target.kind}), design {made.design}.",
            source=f"{PROGRAM}, force-indentation linearisation method (FILM)",
            command=command,
            comment=COMMENT,
        ),
        **text_and_hash("scene", scene_text(scene)),
        **text_and_hash("sweep", made.text()),
        **({"contact_law": str(scene.contact.law)} if isinstance(scene.contact.law, AbstractLaw) else {}),
        "swept": " ".join(paths),
        "kept": " ".join(made.kept),
        "design": made.design,
        "statuses": "\n".join(statuses),
        "warnings": "\n".join(warnings) or "none",
        **requested,
        "estimated_accuracy": float(estimated.max()),
    }


def _is_of(target: Path, made: Sweep) -> bool:
    """Whether a finished output is of this very sweep."""
    try:
        with open_dataset(target) as ds:
            found = (
                *(ds.attrs.get(name) for name in ("scene_toml", "sweep_toml", "kept")),
                ds.sizes.get("normalised_time", 0),
            )
    except (OSError, ValueError, ImportError):
        return False
    return found == (scene_text(made.scene), made.text(), " ".join(made.kept), made.dense)


def _check_room(target: Path, made: Sweep) -> None:
    """Refuse before the work what the disk cannot hold: the output, and the blocks until it is finished."""
    need = 2 * made.size * made.bytes_a_row
    free = shutil.disk_usage(target.absolute().parent).free
    if need > free:
        raise OSError(
            f"{target}: {made.size} impacts need about {_bytes(need)} of disk while they are computed, half of it in "
            f"the end; {_bytes(free)} are free"
        )


def _bytes(count: int) -> str:
    return f"{count / 1e9:.3g} GB" if count >= 1e9 else f"{max(count / 1e6, 0.1):.3g} MB"
