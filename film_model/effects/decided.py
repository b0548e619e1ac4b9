"""A scene with the decisions of one impact in place of "auto": other numbers are simulated with the same effects."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from itertools import product
from typing import NamedTuple

import numpy as np

from film_model.base.arrays import Array, Mask
from film_model.effects import wave_losses
from film_model.problem.law_of_scene import YIELDING, SceneLaw, laws_of
from film_model.problem.problem import Impacts, Problem
from film_model.scene import Scene
from film_model.scene.columns import scene_of_columns


class Decision(NamedTuple):
    """What is simulated in an impact. motion: of the target, of a half-space by its waves. static: by the target's
    static stiffness. hard: strength at the strain rate. damps: by the loss factors of the materials.
    steep: with the slopes of the surfaces."""

    gravity: bool
    motion: bool
    static: bool
    yields: bool
    hard: bool
    damps: bool
    steep: bool

    def put_into(self, scene: Scene) -> Scene:
        """The scene with this decision in place of "auto"."""
        effects = {"gravity": self.gravity, "rate_hardening": self.hard, "viscoelasticity": False}
        if scene.target.gives_way:
            effects["target_motion"] = self.motion
        else:
            effects["wave_losses"] = self.motion
        if scene.contact.law == "auto":
            effects |= {"plasticity": self.yields, "material_damping": self.damps, "small_slope": self.steep}
        if scene.target.structural and self.motion:
            effects["boundary_reflections"] = self.static
        if self.static:
            effects["target_inertia"] = False
        return replace(scene, effects=scene.effects.changed(**effects))


def decisions_of(problem: Problem) -> dict[Decision, Mask]:
    """The decisions for the impacts of a problem, and which impacts have each."""
    strength, slow = problem.impacts.law.strength, problem.impacts.scene.yield_strength
    hard = False if strength is None or slow is None else strength > slow
    static = problem.curve.native.compliance > 0.0
    damps, steep = problem.law.damped and problem.scene.contact.law == "auto", problem.law.steep
    shape = np.shape(problem.approach) or (1,)
    moves = np.isfinite(problem.given.impedance) | static | problem.vibrates
    gravity, motion, harder = (np.broadcast_to(column, shape) for column in (problem.load > 0.0, moves, hard))
    found: dict[Decision, Mask] = {}
    for each in product((False, True), repeat=3):
        mask = (gravity == each[0]) & (motion == each[1]) & (harder == each[2])
        if mask.any():
            found[Decision(each[0], each[1], static, problem.law.name == YIELDING, each[2], damps, steep)] = mask
    return found


def decided_impacts(scene: Scene, columns: Mapping[str, Array], count: int) -> Impacts:
    """Many impacts of a scene that contains a decision, with the strength of slow loading.

    columns: path → SI values.
    """
    varied, ((law, _),) = scene_of_columns(scene, columns), laws_of(scene)
    return Impacts.several(scene, SceneLaw.of(varied, law).reduced(), np.arange(count), columns, varied)


def decided_problem(impacts: Impacts) -> Problem:
    """The problem of such impacts, which share a curve but for its shape and for what it is fitted to."""
    numbers = impacts.numbers
    load = numbers.weight if impacts.base.effects.gravity else impacts.column(0.0)
    return impacts.problem(wave_losses.felt(impacts), load, fitted=False)
