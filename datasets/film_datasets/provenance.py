"""Where a dataset comes from: the global attributes that every dataset has."""

from __future__ import annotations

import hashlib
import os
from datetime import UTC, datetime
from typing import Any

from film_datasets.schema import VERSIONS
from film_model.laws import AbstractLaw
from film_model.scene import Scene
from film_model.scene_file import text_from_table
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


def provenance(kind: str, *, title: str, summary: str, source: str, command: str, comment: str) -> dict[str, Any]:
    """Attributes of a dataset of `kind`. command: what made it, for the attribute `history`."""
    now = moment()
    return {
        "Conventions": "CF-1.11",
        "title": title,
        "summary": summary,
        "source": source,
        "references": REFERENCES,
        "history": f"{now} {PROGRAM}: {command}",
        "license": "film-model claims no rights in its results; the software is under the MIT license",
        "date_created": now,
        "comment": CONVENTIONS + comment,
        "film_model_schema": kind,
        "film_model_schema_version": VERSIONS[kind],
        "film_model_version": __version__,
    }


def text_and_hash(name: str, text: str) -> dict[str, str]:
    """The attributes of a text that is part of a dataset: name_toml and name_sha256."""
    return {f"{name}_toml": text, f"{name}_sha256": hashlib.sha256(text.encode()).hexdigest()}


def scene_text(scene: Scene) -> str:
    """The scene file; a law that is not film-model's is there by its name only."""
    table = scene.to_table()
    if isinstance(scene.contact.law, AbstractLaw):
        table["contact"]["law"] = scene.contact.law.name
    return text_from_table(table)


def moment() -> str:
    """This moment, or SOURCE_DATE_EPOCH, as ISO 8601 in UTC."""
    given = os.environ.get("SOURCE_DATE_EPOCH")
    try:
        now = datetime.now(UTC) if given is None else datetime.fromtimestamp(int(given), UTC)
    except (ValueError, OverflowError, OSError):
        raise ValueError(f"SOURCE_DATE_EPOCH: {given!r} must be a whole number of seconds since 1970") from None
    return now.strftime("%Y-%m-%dT%H:%M:%SZ")
