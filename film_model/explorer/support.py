"""How a target that is held moves on the page: its static compliance and its natural vibrations, which Python computed;
of a simply supported plate the page computes them.

The page follows the force on these; what they depend on, the target's geometry and material, cannot change there, but
those numbers of a plate with which all vibrations scale.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import cache
from itertools import product
from types import SimpleNamespace
from typing import Any, cast

from film_model.base.arrays import root
from film_model.base.errors import SimulationError, TooManyModes
from film_model.core import modal, panels
from film_model.effects.choose import Choice
from film_model.effects.edge_effects import SLOW, without_stretching
from film_model.explorer.inputs import STRENGTH_ENTRIES, Input, damping_input
from film_model.scene import DEFAULT_ACCURACY, Scene
from film_model.solve import structures, vibration
from film_model.targets import AbstractTarget, Plate, Structure, line_functions, panel_statics, ritz
from film_model.targets.modes import EQUAL, UNSEEN
from film_model.targets.plate_modes import THIN

SPARE = 4.0
"""Highest frequency of the page's modes over that which the scene as given needs."""

ALL = 1e20
"""Frequency above all vibrations, rad/s."""

MOST_MODES = 4000
"""Largest number of modes on a page: 100 kB."""

LIVE_WORK = modal.MOST_WORK / 2
"""Limit of the runs of an impact on the page, about a second: steps times (modes + `modal.MODES_OF_A_STEP`)."""

LIVE = tuple(f"target.material.{entry}" for entry in STRENGTH_ENTRIES)
"""Entries of such a target that may change: its vibrations do not depend on them."""


def fixed_to(choice: Choice) -> Scene:
    """The scene with the support that was chosen for it, whatever else changes."""
    vibrates, effects = choice.problem.vibrates, choice.scene.effects
    stretching = choice.problem.stretches if choice.scene.target.stretches else effects.stretching
    support = {"target_motion": True, "boundary_reflections": True, "target_inertia": vibrates}
    effects = effects.changed(**support, stretching=stretching)
    return replace(choice.scene, effects=effects)


def scales_of(target: AbstractTarget) -> dict[str, float]:
    """Entries of an isotropic plate without bed and springs with which its vibrations scale, and their values: ω ∝
    h √(E/ρ), share ∝ 1/(ρ h) and compliance ∝ 1/(E h³), whatever its edges. None of other targets, and with shear."""
    if not isinstance(target, Plate) or target.thickness is None or target.stiffness_given:
        return {}
    if target.foundation_stiffness or target.edge_stiffness or target.material is None or target.shear is not THIN:
        return {}
    return {
        "target.thickness": target.thickness,
        "target.material.youngs_modulus": target.material.youngs_modulus,
        "target.material.density": target.material.density,
    }


def scaled(thickness: Any, modulus: Any, density: Any) -> tuple[Any, Any, Any, Any]:
    """How frequencies, shares, compliance and the forms of membrane forces scale with those entries."""
    rate = thickness * root(modulus / density)
    return rate, 1.0 / (thickness * density), 1.0 / (modulus * thickness**3), root(modulus * thickness)


def may_change(path: str, held: dict[str, Any]) -> bool:
    """Whether an entry of the scene may change on the page: the target's vibrations do not depend on it, or scale."""
    return not path.startswith("target.") or path in LIVE or path in held["scales"]


def damping_of(target: AbstractTarget) -> list[Input]:
    """The damping ratio of all modes as an entry, if the scene gives one."""
    ratio = getattr(target, "damping_ratio", None)
    return [damping_input(ratio)] if isinstance(ratio, float) else []


def computed(target: AbstractTarget) -> bool:
    """Whether the page computes how the target moves between edges: a plate of no layers, bed, springs, sensors, of
    no theory "mindlin", and without `in_plane`."""
    if not isinstance(target, Plate) or target.layup is not None or target.stiffness_given or target.sensors:
        return False
    alike = isinstance(target.damping_ratio, float | None) and target.theory != "mindlin" and target.in_plane is None
    return alike and not (target.foundation_stiffness or target.edge_stiffness)


def data(choice: Choice) -> tuple[dict[str, Any] | None, str]:
    """Compliance and modes of the target for the page, None if it has neither; and why the page cannot carry them.

    scales: of :func:`scales_of`. membrane: lower halves of the forms of its energy, and on how many modes it is with
    half of `structures.CARRIED`; none if it is not simulated. lacking: compliance of vibrations that are not there.
    """
    target, vibrates = choice.scene.target, choice.problem.vibrates
    if not vibrates and not (choice.decided[1] and choice.support.compliance > 0.0):
        return None, ""
    found: dict[str, Any] = {"compliance": target.compliance or 0.0, "modes": None, "scales": scales_of(target)}
    if not vibrates:
        return found, ""
    asked = choice.scene.solver.accuracy or DEFAULT_ACCURACY
    own = vibration.vibrate(choice.problem, target, asked, [], recorded=False)[0]
    whole = isinstance(target, Structure)  # all of its vibrations are known
    carried = structures.CARRIED if choice.problem.stretches else 0
    modes = structures.made(target, ALL, own.unit) if whole else _modes_above(target, own.highest, own.unit, carried)
    if modes.tables.count > MOST_MODES:
        return None, f"the {target.kind} moves by {modes.tables.count} natural vibrations, too many for a page"
    found |= {"lacking": modes.omitted, "highest": modes.highest}
    inexact = target.inexact
    found["inexact"] = inexact and {"cornered": inexact.cornered, "crossing": inexact.crossing}
    found |= {"lowest": structures.lowest_frequency(target), "rate": structures.rate_of(target)}
    found["steps"] = structures.steps_of(target)
    if carried:
        few = structures.structure_of(target, modes.highest, own.unit, carried // 2).tables.forms.shape[1]
        halves = [[row[: i + 1].tolist() for i, row in enumerate(form)] for form in modes.tables.forms]
        found["membrane"] = {"forms": halves, "few": few}
    columns = ("frequency", "share", "ratio")
    return found | {"modes": {name: getattr(modes.tables, name).tolist() for name in columns}}, ""


def _modes_above(target: AbstractTarget, needed: float, unit: float, carried: int) -> structures.Structure:
    """The modes up to `SPARE` times a frequency, or up to the frequency if these are too many or cannot be computed."""
    try:
        found = structures.made(target, SPARE * needed, unit, carried)
    except TooManyModes:
        return structures.structure_of(target, needed, unit, carried)
    return found if found.tables.count <= MOST_MODES else structures.structure_of(target, needed, unit, carried)


def constants() -> dict[str, Any]:
    """The numbers of :mod:`film_model.solve.vibration` and :mod:`film_model.solve.structures`."""
    names = (
        "HIGHEST",
        "UNRESOLVED",
    )
    return numbers_of(vibration, names) | {
        "equal": EQUAL,
        "unseen": UNSEEN,
        "most_computed": 10_000,  # bound on the number of modes that the page computes itself: 56 MB for their tables
        "least_frequency": structures.SLOWEST,
        "most_work": LIVE_WORK,
        "slow": SLOW,
    }


def numbers_of(module: Any, names: Iterable[str]) -> dict[str, Any]:
    """Numbers of a module by their names, which on the page are in small letters."""
    return {name.lower(): getattr(module, name) for name in names}


@cache
def loose_edges() -> list[str]:
    """The edges, by their numbers in the core, with which a plate can move without bending."""
    kinds = enumerate(panels.EDGES)
    every = (tuple(zip(*edges, strict=True)) for edges in product(kinds, repeat=4))
    square = (1.0, 0.3, 1.0, 0.35), (1.0, 1.0)
    return ["".join(map(str, numbers)) for numbers, names in every if ritz.loose(ritz.Panel(1.0, *square, names))]


MOVES = ("infinite", "static", "vibrating")
"""How a plate moves: as an infinite one, by its static stiffness, or by its vibrations."""


@cache
def plate_ways() -> dict[str, Any]:
    """How a plate moves, by :func:`film_model.effects.edge_effects.without_stretching`, for every case of: the switches
    boundary_reflections and target_inertia (true, false, "auto"); whether reflected waves matter, the law can be in
    series with a stiffness, is damped, something holds the plate, and its vibrations are small. cases: of each a place
    in `ways`, which are `MOVES` and sentences that say why it is refused."""
    ways, cases = list(MOVES), ""
    for wanted, inertia, *flags in product((True, False, "auto"), (True, False, "auto"), *[(False, True)] * 5):
        near, series, damped, held, quiet = flags
        target = SimpleNamespace(kind="plate", finite=True, held=held, compliance=1.0, whole_mass=1.0)
        target.stiffness_given, target.modes_missing = False, ""
        effects = SimpleNamespace(boundary_reflections=wanted, target_inertia=inertia)
        edges: Any = SimpleNamespace(scene=SimpleNamespace(target=target, effects=effects), bounded=False, near=near)
        edges.impacts = SimpleNamespace(many=False, one_law=SimpleNamespace(name="{law}", damped=damped))
        edges.no_static = "" if series else "law {law} cannot be in series with a static stiffness"
        edges.follows, edges.quiet, edges.parts = True, quiet, lambda holds, own=edges: [(own, holds)]
        edges.infinite, edges.static, edges.vibrating = (lambda *_, way=way: way for way in MOVES)
        try:
            (way,) = cast("Any", without_stretching(edges))
        except SimulationError as error:
            way = str(error)
        ways += [] if way in ways else [way]
        cases += str(ways.index(way))
    return {"ways": ways, "cases": cases}


def ritz_constants() -> dict[str, Any]:
    """The numbers of :mod:`film_model.targets.ritz` and :mod:`film_model.targets.panel_statics`."""
    names = ("SHARPNESS", "LEAST", "NODE", "LOOSE", "SPARE", "MOST_WAVES", "WORK_OF_A_STRIP", "FEWEST")
    return (
        numbers_of(ritz, names)
        | numbers_of(panel_statics, ("STATIC_DEGREE", "LOWER_DEGREES", "FAR", "SEEN", "SLOWER"))
        | {"loose_edges": loose_edges()}
        # largest sum of the cubes of the numbers of functions that interact, and largest degree across a strip, of the
        # modes of a plate on the page
        | {"beyond": line_functions.BEYOND, "most_work": 2e8, "most_degree": 128}
    )
