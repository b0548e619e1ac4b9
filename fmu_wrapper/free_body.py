"""A free body as a structure that nothing holds, which an FMU follows under any inputs."""

from __future__ import annotations

from dataclasses import replace
from typing import cast

from film_model.base.errors import SimulationError
from film_model.effects.choose import choose
from film_model.scene import Scene
from film_model.targets.body import Body
from film_model.targets.structure import Structure


def as_structure(scene: Scene) -> Scene:
    """The same impact on a structure whose only mode is the motion of the body as a whole, m ẅ = F, which is exact.

    A law that is given by name has the strength at the rate of the impact of the two bodies, whose reduced mass
    is smaller than the impactor's. Both fall alike, so there is no gravity.
    Raises SimulationError for a moving body, for friction, a damped law, whose damping depends on the reduced mass, and
    viscoelastic materials.
    """
    body, problem = cast("Body", scene.target), choose(scene).problem
    if body.velocity != 0.0:
        raise SimulationError(
            f"target.velocity: {body.velocity:g} m/s must be 0 m/s for an FMU: give impactor.velocity relative to it"
        )
    if problem.law.damped or problem.relaxation is not None:
        raise SimulationError(
            "an impact on a free body cannot be exported with a damped law or viscoelastic materials; kind contact is "
            "the force between the two bodies"
        )
    scene.contact.refuse_friction("on a free body, an FMU contains")
    mass, radius = [f"{body.own_mass!r} kg"], f"{body.radius!r} m"
    effects = scene.effects.changed(gravity=False, boundary_reflections=True, target_inertia=True)
    held = replace(scene, target=Structure(None, body.material, ["0 Hz"], mass, radius=radius), effects=effects)
    kept, own = problem.impacts.yield_strength, choose(held).problem.impacts.yield_strength
    if kept and own and scene.yield_strength and isinstance(scene.contact.law, str):
        held = held.replace({"contact.yield_strength": f"{scene.yield_strength * (kept / own)!r} Pa"})
    return held
