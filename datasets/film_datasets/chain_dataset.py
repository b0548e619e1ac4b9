"""The motion of a chain of bodies as a dataset, and the chain in it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from film_datasets.provenance import PROGRAM, provenance, text_and_hash
from film_datasets.schema import CHAIN, TABLE, content_sha256
from film_model.scene.chain import Chain
from film_model.solve.chain_motion import ChainMotion

if TYPE_CHECKING:
    import xarray as xr

COMMENT = "t: even samples while forces act, or over the duration that was asked for."


def chain_dataset(motion: ChainMotion, samples: int, command: str) -> xr.Dataset:
    """The motion of a chain as a dataset of kind impact_chain, SI."""
    import xarray as xr

    if samples < 2:
        raise ValueError(f"samples: {samples} must be at least 2")
    t = np.linspace(*motion.span, samples)
    chain, links = motion.chain, motion.chain.links
    values = {
        **{
            "t": t,
            "body": np.arange(1, len(motion.values["body_mass"]) + 1),
            "contact": np.arange(1, len(links) + 1),
            "contact_front": [link.front + 1 for link in links],
            "contact_behind": [0 if link.behind is None else link.behind + 1 for link in links],
        },
        **{**motion.values, "contact_law": np.array(motion.laws), "contact_count": np.array(motion.counts)},
        **motion.sample_si(t),
    }
    ds = xr.Dataset({v.name: (v.dims, np.asarray(values[v.name], v.dtype), v.attributes()) for v in TABLE[CHAIN]})
    ds.attrs = {
        **provenance(
            CHAIN,
            title=chain.title or f"Chain of {ds.sizes['body']} bodies",
            summary=f"{ds.sizes['body']} bodies with {ds.sizes['contact']} contacts: {motion.outcome}.",
            source=PROGRAM,
            command=command,
            comment=COMMENT,
        ),
        **text_and_hash("scene", chain.to_toml()),
        "outcome": motion.outcome,
        "end": motion.end,
        "estimated_accuracy": motion.estimated,
        "warnings": "\n".join(" ".join(sentence.split()) for sentence in motion.warnings) or "none",
    }
    ds.attrs["content_sha256"] = content_sha256(ds)
    return ds


def chain_in(ds: xr.Dataset) -> Chain:
    """The chain that a dataset of kind impact_chain is of."""
    return Chain.from_text(str(ds.attrs["scene_toml"]), "scene_toml")
