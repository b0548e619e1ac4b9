"""The formulas of friction on the page: recorded from those of :mod:`film_model.oblique`."""

from __future__ import annotations

from collections.abc import Sequence
from types import SimpleNamespace
from typing import cast

from film_model.explorer.formulas import changed_scene, problem_in
from film_model.explorer.trace import Recording
from film_model.oblique import springs
from film_model.oblique.friction import exact_error, normal_impulse, numbers_of, results
from film_model.problem.stresses import contact_radius
from film_model.scene import Scene
from film_model.scene.rolling import Sliding, sliding_of


def friction_functions(template: Scene, paths: Sequence[str]) -> dict[str, str]:
    """Of an impact with friction, from its entries `x`, by what they compute.

    sliding: what friction depends on besides the normal motion `p`. oblique: the results, from the normal rebound, the
    sliding velocity after, the largest friction force and its time.
    """
    r, scene, given = _slides(template, paths)
    problem = problem_in(r, "p", template)
    rate, before = numbers_of(given, problem, scene)
    names = ("friction", "ratio", "modulus", "mass", "velocity", "along")
    outputs = {name: getattr(given, name) for name in names} | {"spin": scene.impactor.spin, "rate": rate}
    outputs |= {"before": before, "error": exact_error(problem, before)}
    found = {"sliding": r.function("sliding", "x, p", outputs)}
    r, scene, given = _slides(template, paths)
    rebound, after, *peak = (r.symbol(name) for name in ("rebound", "after", "force", "time"))
    outputs = results(scene, given, rebound, after, (peak[0], peak[1]))
    return found | {"oblique": r.function("oblique", "x, rebound, after, force, time", outputs)}


def _slides(template: Scene, paths: Sequence[str]) -> tuple[Recording, Scene, Sliding]:
    r = Recording()
    scene = changed_scene(template, r.symbols("x", paths))
    return r, scene, cast("Sliding", sliding_of(scene))


def common_functions(template: Scene) -> list[str]:
    """Of friction by springs: the contact radius in loading, at a force `F` and an indentation `d`, and whether the
    force is Hertz's; the impulse of the normal force; and the error of the sliding velocity, with bounds."""
    r = Recording()
    problem = problem_in(r, "p", template)
    radius, elastic = contact_radius(problem.impacts, r.symbol("F"), r.symbol("d"))
    wide = r.function("contactRadius", "p, n, F, d", {"radius": radius, "elastic": elastic})
    speed, mass = r.symbol('n["speed"]'), r.symbol('n["impactor_mass"]')
    ball = cast("Scene", SimpleNamespace(mass=mass, impactor=SimpleNamespace(speed=speed)))
    impulse = normal_impulse(ball, problem, r.symbol("rebound"), r.symbol("duration"))
    pushed = r.function("impulseOf", "p, n, rebound, duration", {"impulse": impulse})
    ends, errors = ([r.symbol(f"{name}[{k}]") for k in (0, 1)] for name in ("ends", "errors"))
    errors = [springs.SAFETY * error for error in errors]
    error, (low, high) = springs.judged(ends, errors, *map(r.symbol, ("steps", "before", "normal")))
    known = r.function("judged", "ends, errors, steps, before, normal", {"error": error, "low": low, "high": high})
    return [wide, pushed, known]
