"""Where a dataset comes from: the global attributes of every dataset, and the scene that is stored among them."""

from __future__ import annotations

import hashlib
import os
import platform
import zlib
from collections.abc import Iterable, Mapping
from datetime import UTC, datetime
from typing import Any

import numpy as np

from film_datasets.scene_constants import check_scene_key, scene_key
from film_datasets.schema import HISTORY, TABLE, VERSIONS, content_sha256, kind_of
from film_model.base.errors import SceneError
from film_model.base.foreign import Dataset
from film_model.core import native
from film_model.effects.choose import Choice, choose
from film_model.scene import Scene
from film_model.version import __version__

PROGRAM = f"film-model {__version__}"

REFERENCES = (
    "Big-Alabo, A., Cartmell, M. P. and Harrison, P. (2017): On the solution of asymptotic impact problems with "
    "significant localised indentation. Proc. IMechE Part C: J. Mechanical Engineering Science 231(5), 807-822, "
    "doi:10.1177/0954406216628556"
)

CONVENTIONS = (
    "SI units. Displacements, velocities and forces are positive into the target. No featureType: the data have no "
    "place on Earth. "
)

KEYWORDS = "impact, contact mechanics, indentation, contact force, coefficient of restitution, contact law"


def provenance(kind: str, *, title: str, summary: str, source: str, command: str, comment: str) -> dict[str, Any]:
    """Attributes of a dataset of `kind`. command: the function or command that made it, for the attribute `history`."""
    now = moment()
    return {
        "Conventions": "CF-1.11",
        "title": title,
        "summary": summary,
        "keywords": KEYWORDS,
        "source": source,
        "references": REFERENCES,
        "history": f"{now} {PROGRAM}: {command}",
        "license": "film-model claims no rights in its results; the software is under the MIT license",
        "date_created": now,
        "comment": CONVENTIONS + comment,
        "film_model_schema": kind,
        "film_model_schema_version": VERSIONS[kind],
        "film_model_version": __version__,
        "computing_platform": made_on(),
    }


def dataset_of(
    kind: str,
    columns: Mapping[str, Any],
    about: Mapping[str, str],
    own: Mapping[str, Any],
    table: str = "",
    meanings: Mapping[str, Any] | None = None,
    coordinates: Iterable[str] = (),
    parts: Iterable[str] = (),
) -> Dataset:
    """A dataset of `kind` with those variables of `TABLE`, or of its key `table`, and of more keys `parts`, that are
    in `columns`.

    about: what `provenance` takes. own: further attributes, besides the hash of the content.
    """
    import xarray as xr

    variables = [v for key in (table or kind, *parts) for v in TABLE[key] if v.name in columns]
    ds = xr.Dataset({v.name: (v.dims, np.asarray(columns[v.name], v.dtype), v.attributes(meanings)) for v in variables})
    ds = ds.set_coords([*coordinates])
    ds.attrs = {**provenance(kind, **about), **own}
    ds.attrs["content_sha256"] = content_sha256(ds)
    return ds


def as_lines(sentences: Iterable[str]) -> str:
    """Sentences as the attribute `warnings` has them."""
    return "\n".join(" ".join(sentence.split()) for sentence in sentences) or "none"


def made_on() -> str:
    """What rounding depends on: processor and its vector instructions, C library or system, NumPy with a checksum of
    its functions, which depend on the instructions that it takes, and Python."""
    instructions = native.INSTRUCTIONS[native.instructions()]
    try:
        c_library = os.confstr("CS_GNU_LIBC_VERSION") or platform.platform()
    except (AttributeError, ValueError, OSError):  # no glibc
        c_library = platform.platform()
    x = np.linspace(0.01, 3.0, 100)
    functions = zlib.crc32(np.concatenate([f(x) for f in (np.cos, np.exp, np.log, np.tan)]).tobytes())
    versions = f"NumPy {np.__version__} ({functions:08x}), Python {platform.python_version()}"
    return f"{platform.machine()} ({instructions}), {c_library}, {versions}"


def text_and_hash(name: str, text: str) -> dict[str, str]:
    """The attributes that store a file's text in a dataset: name_toml and name_sha256."""
    return {f"{name}_toml": text, f"{name}_sha256": hashlib.sha256(text.encode()).hexdigest()}


def scene_of(ds: Dataset) -> Scene:
    """The scene in the attribute scene_toml.

    Raises ValueError if the dataset has no scene, or if its law was an object of Python, which no file can store.
    """
    return choice_of(ds).scene if "contact_law" in ds.attrs else _stored_scene(ds)


def choice_of(ds: Dataset) -> Choice:
    """What film_model chooses for the scene of a dataset; raises what `scene_of` raises.

    It includes the law, which is compared with that of the dataset.
    """
    scene, law = _stored_scene(ds), str(ds.attrs.get("contact_law", ""))
    try:
        choice = choose(scene)
    except SceneError:
        raise _lost_law(law) from None
    if law not in ("", str(choice.problem.law)):
        raise _lost_law(law)
    return choice


def _stored_scene(ds: Dataset) -> Scene:
    if "scene_toml" not in ds.attrs:
        raise ValueError(f"a dataset of kind {kind_of(ds)} has no scene")
    text = str(ds.attrs["scene_toml"])
    try:
        scene = Scene.from_stored_text(text, "scene_toml")
    except SceneError as error:
        if not ds.attrs.get("contact_law") or any(mistake.key.endswith(".file") for mistake in error.mistakes):
            raise
        raise _lost_law(str(ds.attrs.get("contact_law", ""))) from None
    if kind_of(ds) == HISTORY:
        check_scene_key(ds, scene_key(text))
    return scene


def _lost_law(law: str) -> ValueError:
    return ValueError(f"the contact law {law} was an object of Python: the scene cannot be made again without it")


def warnings_of(ds: Dataset) -> tuple[str, ...]:
    """The sentences in the attribute `warnings`."""
    warnings = str(ds.attrs["warnings"])
    return () if warnings == "none" else tuple(warnings.split("\n"))


def moment() -> str:
    """The current time, or SOURCE_DATE_EPOCH if it is set, as ISO 8601 in UTC."""
    given = os.environ.get("SOURCE_DATE_EPOCH")
    try:
        now = datetime.now(UTC) if given is None else datetime.fromtimestamp(int(given), UTC)
    except (ValueError, OverflowError, OSError):
        raise ValueError(f"SOURCE_DATE_EPOCH: {given!r} must be a whole number of seconds since 1970") from None
    return now.strftime("%Y-%m-%dT%H:%M:%SZ")
