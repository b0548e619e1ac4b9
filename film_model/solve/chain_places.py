"""Where the bodies of a chain are."""

from __future__ import annotations

import numpy as np

from film_model.base.arrays import Array
from film_model.scene.chain import Chain


def displacements(chain: Chain, indentation: Array, times: Array, structure: Array) -> Array:
    """Displacements, m, (bodies, times), from indentations [m], (contacts, times): x_b = c x_a - (d + gap) at a link.

    structure: of a target that vibrates, at each link. With a rigid one that of the first body follows from the way to
    it, without one from Σ m_b x_b Π c, which grows evenly: at a link, a loses the part c of what b gains.
    """
    row, links = chain.row, chain.links
    moved = indentation + np.array([link.gap for link in links])[:, None]
    if chain.vibrates:
        return _from_structure(chain, moved, structure)
    part, behind = np.ones(len(row)), np.zeros((len(row), times.size))
    for link, way in zip(links, moved, strict=True):
        if link.behind is not None:
            part[link.behind] = link.along * part[link.body]
            behind[link.behind] = link.along * behind[link.body] + way
    if chain.target is not None:
        ends = (k for k, link in enumerate(links) if link.behind is None)
        end = max(ends, key=lambda k: abs(part[links[k].body]))
        first = (moved[end] + behind[links[end].body]) / part[links[end].body]
    else:
        weight = part * np.array([body.own_mass for body in row])
        start = np.array([body.velocity for body in row])
        first = ((weight @ start) * times + weight @ behind) / (weight @ part)
    return part[:, None] * first - behind


def _from_structure(chain: Chain, moved: Array, structure: Array) -> Array:
    """The same from the places of the structure, along each row."""
    found, pushed = np.zeros((len(chain.row), moved.shape[1])), set[int]()
    steps = list(zip(chain.links, moved, structure, strict=True))
    for link, way, there in steps:
        if link.front is None:
            found[link.body] = there - way
            pushed.add(link.body)
        elif link.behind is None:
            found[link.front] = there + way
    for link, way, _ in steps:
        if link.front in pushed and link.behind is not None:
            found[link.behind] = link.along * found[link.front] - way
            pushed.add(link.behind)
    for link, way, _ in reversed(steps):
        if link.front is not None and link.behind is not None and link.front not in pushed:
            found[link.front] = (found[link.behind] + way) / link.along
    return found
