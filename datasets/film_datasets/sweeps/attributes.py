"""The attributes of a sweep's dataset, global and of its variables."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_datasets.provenance import PROGRAM, provenance, text_and_hash
from film_datasets.schema import (
    EQUATIONS_ON_MODES,
    IMPACT_STATUSES,
    OUT_OF_RANGE,
    SWEEP,
    Variable,
    branch_words,
    flag_words,
    has_failed,
    side_name,
)
from film_datasets.sweeps.block_columns import ENERGY_GAINS, ESTIMATED, FASTER, MISSED, Columns
from film_datasets.sweeps.definition import Sweep
from film_datasets.sweeps.designs import SAMPLED
from film_datasets.sweeps.effect_warnings import effect_warnings, sweep_law_warnings
from film_model.base.arrays import Array
from film_model.base.errors import Status
from film_model.core.modal import MOST_MEMORY
from film_model.core.native import MAX_STAGES
from film_model.laws import LAWS, AbstractLaw
from film_model.problem.summary import weight_warning
from film_model.solve.slopes import NO_DERIVATIVE
from film_model.targets.sensors import sensor_words

COMMENT = (
    "status says how each impact ended; an impact that failed has NaN for its summary and harms no other. With "
    "segments, the motion of each impact is as in an impact_history: its segments begin where those of the impacts "
    "before end, in C order. scene_toml and sweep_toml are the files to run again."
)


@dataclass
class Totals:
    """What the attributes need of all blocks. estimated: largest error for each of `Sweep.accuracies`; missed: impacts
    that miss each. energy_gains: impacts of each of `Sweep.laws` that return more energy than their loading stored.
    failed: impacts that failed, by status. sides: by number of the scene, of how many impacts the derivatives are
    from each side, failed impacts omitted. unkept: impacts that did not fail and whose motion is not kept. faster:
    impacts that leave faster than they come because of their weight."""

    estimated: Array
    missed: NDArray[np.int64]
    energy_gains: NDArray[np.int64]
    failed: Counter[int] = field(default_factory=Counter)
    sides: dict[str, Counter[int]] = field(default_factory=dict[str, "Counter[int]"])
    unkept: int = 0
    faster: int = 0

    @classmethod
    def of(cls, sweep: Sweep) -> Totals:
        """Before the first block."""
        asked, laws = len(sweep.accuracies), len(sweep.laws)
        sides = {entry.path: Counter[int]() for entry in sweep.derivatives}
        return cls(np.zeros(asked), np.zeros(asked, np.int64), np.zeros(laws, np.int64), sides=sides)

    def add(self, columns: Columns) -> None:
        """Add the columns of a block."""
        failed = has_failed(columns["status"])
        counts = [columns[name] for name in ("segment_count", "step_count") if name in columns]
        unkept = int(np.count_nonzero((np.sum(counts, axis=0) == 0) & ~failed)) if counts else 0
        sides = {path: Counter(columns[side_name(path)][~failed].tolist()) for path in self.sides}
        ended = Counter(columns["status"][failed].tolist()), sides, unkept, int(columns[FASTER][0])
        self.merge(Totals(columns[ESTIMATED], columns[MISSED], columns[ENERGY_GAINS], *ended))

    def merge(self, other: Totals) -> None:
        """Add the totals of other blocks."""
        self.estimated = np.maximum(self.estimated, other.estimated)
        self.missed += other.missed
        self.energy_gains += other.energy_gains
        self.failed.update(other.failed)
        self.unkept += other.unkept
        self.faster += other.faster
        for path, sides in self.sides.items():
            sides.update(other.sides[path])

    def to_plain(self) -> dict[str, Any]:
        """Plain values for a JSON file."""
        counters = {"failed": list(self.failed.items()), "sides": {k: list(v.items()) for k, v in self.sides.items()}}
        arrays = {name: getattr(self, name).tolist() for name in ("estimated", "missed", "energy_gains")}
        return {**arrays, **counters, "unkept": self.unkept, "faster": self.faster}

    @classmethod
    def from_plain(cls, plain: Mapping[str, Any]) -> Totals:
        """The totals that `to_plain` wrote."""
        missed, gains = (np.array(plain[name], np.int64) for name in ("missed", "energy_gains"))
        sides = {path: Counter(dict(found)) for path, found in plain["sides"].items()}
        counts = Counter(dict(plain["failed"])), sides, plain["unkept"], plain["faster"]
        return cls(np.array(plain["estimated"]), missed, gains, *counts)


def variable_attributes(sweep: Sweep) -> list[tuple[Variable, dict[str, Any]]]:
    """The variables of a sweep with their attributes."""
    stages = [f"stage_{number}_of_the_law" for number in range(1, MAX_STAGES + 1)]
    meanings = {
        "laws": flag_words(sweep.laws),
        "out_of_range": flag_words([f"{axis.name}_out_of_range" for axis in sweep.axes]),
        "stages": stages,
        "branches": branch_words(stages, any(LAWS[law].family == "adhesive" for law in sweep.laws if law in LAWS)),
    }
    swept = [axis.name for axis in sweep.axes]
    coordinates = {"coordinates": " ".join(swept)} if sweep.dims == ("impact",) else {}
    return [
        (v, v.attributes(meanings) | (coordinates if v.dims[:1] == ("impact",) and v.name not in swept else {}))
        for v in sweep.variables
    ]


def global_attributes(sweep: Sweep, command: str, totals: Totals) -> dict[str, Any]:
    """Global attributes except the hash of the content."""
    scene = sweep.scene
    paths = [axis.path for axis in sweep.axes]
    asked = [accuracy for accuracy in sweep.accuracies if accuracy is not None]
    requested: dict[str, Any] = {"requested_accuracy": max(asked)} if len(asked) == len(sweep.accuracies) else {}
    if sweep.design in SAMPLED:
        requested |= {"samples": str(sweep.samples), "seed": str(sweep.seed)}
    return {
        **provenance(
            SWEEP,
            title=f"{scene.title or 'Impact'}: sweep over {', '.join(paths)}",
            summary=f"{sweep.size} impacts (target: {scene.target.kind}), design {sweep.design}.",
            source=f"{PROGRAM}, force-indentation linearisation method (FILM)",
            command=command,
            comment=COMMENT + (f" With steps, {EQUATIONS_ON_MODES}" if "steps" in sweep.kept else ""),
        ),
        **text_and_hash("scene", scene.archived_text()),
        **text_and_hash("sweep", sweep.text()),
        **({"contact_law": str(scene.contact.law)} if isinstance(scene.contact.law, AbstractLaw) else {}),
        "swept": " ".join(paths),
        "kept": " ".join(sweep.kept),
        "design": sweep.design,
        **({"derivatives": " ".join(entry.path for entry in sweep.derivatives)} if sweep.derivatives else {}),
        **({"variables": " ".join(sweep.chosen)} if sweep.chosen else {}),
        **({"sensors": " ".join(sensor_words(sweep.sensors))} if sweep.sensors else {}),
        "statuses": "\n".join(f"{code} {status.word}: {status.sentence}" for code, status in _statuses(sweep).items()),
        "warnings": "\n".join([*_warnings(sweep, totals), *effect_warnings(sweep), *sweep_law_warnings(sweep)])
        or "none",
        **requested,
        "estimated_accuracy": float(totals.estimated.max()),
    }


def _statuses(sweep: Sweep) -> dict[int, Status]:
    """The values of `status`."""
    statuses = dict(IMPACT_STATUSES)
    for place, axis in enumerate(sweep.axes):
        if axis.field is not None:
            allowed = f"{axis.field.low:g} to {axis.field.high:g} {axis.unit}".rstrip()
            sentence = f"the value drawn is out of range: {allowed} is allowed"
            statuses[OUT_OF_RANGE + place] = Status(f"{axis.name}_out_of_range", sentence)
    return statuses


def _warnings(sweep: Sweep, totals: Totals) -> list[str]:
    statuses = _statuses(sweep)
    reasons = [
        f"{count} {statuses[code].word} ({statuses[code].sentence})" for code, count in totals.failed.most_common()
    ]
    warnings = [f"{totals.failed.total()} of {sweep.size} impacts failed: {', '.join(reasons)}"] if reasons else []
    if totals.unkept:
        advice = f"each takes more than {MOST_MEMORY / 1e6:.0f} MB; ds.film.history simulates such an impact again"
        warnings.append(f"the segments of {totals.unkept} of {sweep.size} impacts are not kept: {advice}")
    for law, count in zip(sweep.laws, totals.energy_gains.tolist(), strict=True):
        if count:
            warnings.append(f"law {law}: in {count} impacts its unloading returns more energy than its loading stored")
    warnings += weight_warning(totals.faster)
    for accuracy, found, missed in zip(sweep.accuracies, totals.estimated, totals.missed.tolist(), strict=True):
        if missed:
            warnings.append(f"accuracy {accuracy:g} was not reached in {missed} impacts: estimated up to {found:.1e}")
    for path, sides in totals.sides.items():
        without = sides[NO_DERIVATIVE]
        if without:
            warnings.append(f"no derivatives by {path} in {without} impacts: kinks, or crowded natural frequencies")
        if sides[-1] + sides[1]:
            warnings.append(f"derivatives by {path} are one-sided in {sides[-1] + sides[1]} impacts, because of kinks")
    return warnings
