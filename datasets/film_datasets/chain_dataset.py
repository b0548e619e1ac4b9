"""The motion of a chain of bodies as a dataset."""

from __future__ import annotations

from typing import Any

import numpy as np

from film_datasets.provenance import PROGRAM, as_lines, dataset_of, text_and_hash
from film_datasets.schema import CHAIN, HISTORY
from film_model.base.arrays import Array
from film_model.base.foreign import Dataset
from film_model.solve.chain_motion import ChainMotion
from film_model.solve.sensed import IN_CONTACT


def chain_dataset(motion: ChainMotion, samples: int, command: str) -> Dataset:
    """The motion of a chain as a dataset of kind impact_chain, SI."""
    if samples < 2:
        raise ValueError(f"samples: {samples} must be at least 2")
    t = np.linspace(*motion.span, samples)
    chain, links = motion.chain, motion.chain.links
    values = {
        **{
            "t": t,
            "body": np.arange(1, len(motion.values["body_mass"]) + 1),
            "contact": np.arange(1, len(links) + 1),
            **{
                f"contact_{name}": [0 if end is None else end + 1 for end in ends]
                for name, ends in zip(("front", "behind"), zip(*(link[:2] for link in links), strict=True), strict=True)
            },
        },
        **{**motion.values, "contact_law": np.array(motion.laws), "contact_count": np.array(motion.counts)},
        **_sampled(motion, t),
    }
    bodies, contacts = len(values["body"]), len(links)
    about = {
        "title": chain.title or f"Chain of {bodies} bodies",
        "summary": f"{bodies} bodies with {contacts} contacts: {motion.outcome}.",
        **{"source": PROGRAM, "command": command},
        "comment": "t: even samples while forces act, or over the duration that was asked for.",
    }
    own = {
        **text_and_hash("scene", chain.to_toml()),
        **{"outcome": motion.outcome, "end": motion.end, "estimated_accuracy": motion.estimated},
        "warnings": as_lines(motion.warnings),
    }
    return dataset_of(CHAIN, values, about, own, parts=(f"{HISTORY} sensors", f"{HISTORY} strains"))


def _sampled(motion: ChainMotion, t: Array) -> dict[str, Any]:
    """The motion at times, s, and the largest motions of sensors."""
    if (target := motion.chain.target) is None or not target.sensors:
        return motion.sample_si(t)
    every = np.union1d(t, np.linspace(*motion.span, IN_CONTACT))
    found = motion.sample_si(every)
    known = [name.removeprefix("sensor_") for name in found if name.startswith("sensor_")]
    return {
        "sensor": [sensor.name for sensor in target.sensors],
        **{name: values[:, np.searchsorted(every, t)] for name, values in found.items()},
        **{f"sensor_maximum_{name}": np.abs(found[f"sensor_{name}"]).max(axis=1) for name in known},
    }
