"""Effects that are judged, not computed: where the model ends, by how much, and what is missing to say so.

Each rule takes the scene and the trial march of `effects.choose` and returns an :class:`Effect`. A rule whose change
exceeds the tolerance makes a warning; one that lacks an input of the scene says which. No number is guessed. The
changes are first-order estimates: right in size, not in the second digit.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple, cast

import numpy as np

from film_model.bodies import Beam, Body, HalfSpace, Plate, Rod
from film_model.effects import NOT_JUDGED, NOT_MODELLED, NOT_NEEDED, Effect, Trial, change, march
from film_model.laws import BigAlabo
from film_model.materials import Material
from film_model.problem import assemble
from film_model.scene import Scene
from film_model.targets import plate_impedance, plate_stiffness
from film_model.units import format_si

ABSENT = "not to be had"
"""Cost of what this package does not simulate."""

REFLECTION_CHANGE = 0.03, 2.2
"""c and p of the change c m (1 + e)/(Z e t_c) (t/t_return)^p by waves from the edges of a plate."""

JKR_WORK = 7.0922
"""Work to part a sphere from a flat, over (Γ⁵ R⁴/E²)^{1/3}: Johnson, Kendall & Roberts' force, integrated."""

HERTZ_PULSE = 4.6851
"""∫Ḟ² dt over F_m²/t_c of an elastic impact; π²/2 for a half-sine."""

HERTZ_SQUARE = 0.4113
"""∫F² dt over F_m² t_c of an elastic impact; 1/2 for a half-sine."""

MEAN_FREQUENCY = 0.7737 * math.pi
"""Mean of ω t_c over |F(ω)|² of a half-sine."""

RADIATION = (
    (0.0, 0.1, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.49),
    (0.21396, 0.18556, 0.15986, 0.14813, 0.13723, 0.12723, 0.11824, 0.11047, 0.10542),
)
"""Poisson's ratio, and β: a point force F(t) radiates β/(ρ c_T³) ∫Ḟ² dt into a half-space (Lamb's problem)."""


class Case(NamedTuple):
    """What the rules go by: SI numbers of the trial's impact.

    fraction: of the impact energy that is absorbed. back: time from the centre of the push to the end of contact.
    motion: the target's displacement over V t_c, m (1 + e)/(Z t_c).
    """

    scene: Scene
    trial: Trial
    tolerance: float
    force: float
    indentation: float
    duration: float
    turn: float
    restitution: float
    fraction: float
    back: float
    motion: float

    @property
    def contact_radius(self) -> float:
        """√(R δ_m), m: Hertz's."""
        return math.sqrt(self.scene.effective_radius * self.indentation)

    @property
    def energy(self) -> float:
        """Impact energy, J."""
        return self.scene.kinetic_energy


def judge(scene: Scene, trial: Trial) -> tuple[Effect, ...]:
    """All rules on the impact of a trial; "not judged" without a whole impact."""
    return tuple(judged(scene, trial, name) for name in RULES)


def judged(scene: Scene, trial: Trial, name: str) -> Effect:
    """One rule, by name."""
    indicator, source, rule = RULES[name]
    if not trial.ends or scene.approach_velocity == 0.0:
        return _unjudged(name, indicator, "there is no whole impact to judge by", source)
    return rule(_case(scene, trial), name, indicator, source)


def _case(scene: Scene, trial: Trial) -> Case:
    p, s = trial.problem, trial.summary
    duration, velocity = s.contact_duration * p.scales.time, scene.approach_velocity
    restitution = -s.final_velocity / p.approach
    push = scene.effective_mass * velocity * (1.0 + restitution)
    moved = (s.permanent_indentation + s.shift) * p.scales.length
    back = (velocity * duration - moved) * scene.effective_mass / push if push > 0.0 else 0.5 * duration
    return Case(
        scene=scene,
        trial=trial,
        tolerance=scene.effect_tolerance,
        force=s.maximum_force * p.scales.force,
        indentation=s.maximum_indentation * p.scales.length,
        duration=duration,
        turn=s.time_of_maximum_indentation * p.scales.time,
        restitution=restitution,
        fraction=max(0.0, s.work / (0.5 * p.approach**2)),
        back=back,
        motion=push / (velocity * p.impedance * duration),
    )


def _unjudged(name: str, indicator: str, why: str, source: str, value: float | None = None) -> Effect:
    return Effect(name, indicator, value, None, None, NOT_JUDGED, why, source, ABSENT)


def _absent(name: str, indicator: str, why: str, source: str) -> Effect:
    """An effect that such a scene has not."""
    return Effect(name, indicator, None, None, 0.0, NOT_NEEDED, why, source)


def _judged(
    case: Case,
    name: str,
    indicator: str,
    source: str,
    value: float,
    threshold: float | None,
    size: float,
    reason: str,
    cost: str = ABSENT,
) -> Effect:
    state = NOT_MODELLED if size > case.tolerance else NOT_NEEDED
    return Effect(name, indicator, value, threshold, size, state, reason, source, cost)


def reflection_change(approach: Any, gamma: Any, seen: Any, returns: Any) -> Any:
    """Change by waves from the edges of a plate, as in :func:`reflections`, for arrays in the units of the march.

    approach, gamma: ν and m/Z. seen: summaries (native.SUMMARY_DTYPE) of the impacts on the infinite plate. returns:
    return times.
    """
    push, duration = approach - seen["final_velocity"], seen["contact_duration"]
    back = (approach * duration - seen["permanent_indentation"] - seen["shift"]) / push
    restitution = np.maximum(-seen["final_velocity"] / approach, 1e-3)
    constant, power = REFLECTION_CHANGE
    share = constant * push / approach * gamma / duration / restitution
    return np.minimum(share * (back / returns) ** power, 1.0)


def reflections(case: Case, name: str, indicator: str, source: str) -> Effect:
    """Waves that come back from the edges of a plate or the end of a rod before the contact is over.

    Plate: with the time t from the centre of the push to the end of contact (for a half-sine 2 t is the contact time)
    over t_return, `Plate.return_time`. What comes back moves the plate by a part of its displacement m (1 + e) V/Z,
    and the contact closes at e V at its end: the change is 0.03 (t/t_return)^2.2 m (1 + e)/(Z e t_c). The constants
    are fitted to impacts on the centre of simply supported square plates, summed over their modes, for λ from 0.1 to
    2; they hit the change, which swings with t, within a factor of three from 0.003 to 0.3.

    Rod: the wave is back after 2 L/c. It moves the end by 2/Z times the impulse that was given 2 L/c earlier, which
    is held against the indentation (half-sine force).
    """
    target = case.scene.target
    if isinstance(target, Rod):
        if target.length is None:
            return _unjudged(name, indicator, "missing: target.length", source)
        wave = math.sqrt(target.material.youngs_modulus / target.material.density)
        returns = 2.0 * target.length / wave
        late = max(0.0, 1.0 - returns / case.duration)
        impulse = case.force * case.duration / math.pi * (1.0 - math.cos(math.pi * late))
        size = 2.0 * impulse / target.impedance / case.indentation
        back, lasts = format_si(returns, "time", 3), format_si(case.duration, "time", 3)
        reason = f"the wave is back from the far end after {back}, the contact lasts {lasts}"
        value, cost = case.duration / returns, f"{ABSENT}: needs the modes of the rod"
        return _judged(case, name, indicator, source, value, 1.0, size, reason, cost)
    if isinstance(target, Beam):
        return _unjudged(name, indicator, "the target is taken not to move", source)
    if not isinstance(target, Plate):
        what = "a free body" if isinstance(target, Body) else "a half-space"
        return _absent(name, indicator, f"{what} sends no wave back in this model", source)
    if target.size is None:
        return _unjudged(name, indicator, "missing: target.size", source)
    if case.trial.problem.gamma == 0.0:
        return _unjudged(name, indicator, "the target is taken not to move", source)
    value = case.back / target.return_time
    constant, power = REFLECTION_CHANGE
    share = constant * case.motion / max(case.restitution, 1e-3)
    size = share * value**power
    threshold = (case.tolerance / share) ** (1.0 / power)
    back, felt = format_si(case.back, "time", 3), format_si(target.return_time, "time", 3)
    reason = f"from the centre of the push to the end of contact {back} pass; edge waves are felt after {felt}"
    return _judged(case, name, indicator, source, value, threshold, min(size, 1.0), reason)


def thickness(case: Case, name: str, indicator: str, source: str) -> Effect:
    """How thick a target has to be to count as a half-space, and how thin a plate to bend as Kirchhoff's.

    Half-space: the thickness at which a plate of its material would move by the tolerance; an upper bound, because a
    contact shorter than the wave's way through the plate and back does not feel its thickness. Plate: shear makes the
    driving-point mobility 1/Z larger by k² h²/(6 κ (1 − ν)), k² = ω √(ρ_A/D), κ = 5/6: the pole of Mindlin's plate, to
    first order (rotary inertia drops out). ω is the mean over the spectrum of a half-sine, 0.77 π/t_c; what changes
    is the energy that the bending waves carry off. Beam: the energy ½ c F² that its shear takes up, with Timoshenko's
    c.
    """
    target, problem = case.scene.target, case.trial.problem
    if isinstance(target, Beam):
        value, reason = target.thickness / target.length, "shear in the beam takes up energy that is not counted"
        moves = problem.compliance > 0.0
        size = 0.5 * target.shear_compliance * case.force**2 / case.energy if moves else 0.0
        return _judged(case, name, "h/L", source, value, None, min(size, 1.0), reason)
    if isinstance(target, Plate) and problem.compliance > 0.0:
        reason = "no verified estimate of the shear in a plate that is bent statically"
        return _unjudged(name, indicator, reason, source)
    if isinstance(target, Plate) and target.thickness is not None and target.material is not None:
        ratio = target.material.poissons_ratio
        square = MEAN_FREQUENCY / case.duration * math.sqrt(target.surface_density / target.stiffness[0])
        shear = square * target.thickness**2 / (5.0 * (1.0 - ratio))
        carried = 0.0 if problem.gamma == 0.0 else 1.0 - case.restitution**2 - case.fraction
        value = math.sqrt(square) * target.thickness
        reason = "the plate counts as thin while its bending waves are long against its thickness"
        size, cost = max(0.0, shear * carried), f"{ABSENT}: needs a thick plate's impedance"
        return _judged(case, name, indicator, source, value, None, size, reason, cost)
    if isinstance(target, Plate):
        return _unjudged(name, indicator, "missing: target.thickness", source)
    if isinstance(target, HalfSpace) and target.material is not None:
        least = _half_space_from(case, target.material)
        why = "missing: a thickness; this much or more counts as a half-space"
        return _unjudged(name, "sufficient thickness, m", why, source, least)
    if isinstance(target, HalfSpace):
        return _unjudged(name, indicator, "missing: a thickness and target.material", source)
    return _absent(name, indicator, "the target is neither a half-space nor a plate", source)


def _half_space_from(case: Case, material: Material) -> float:
    """Thickness from which the energy lost to a plate's motion, ∫F² dt/Z with the half-space's F, is tolerable."""
    unit = plate_impedance(
        material.density, plate_stiffness(material.youngs_modulus, material.poissons_ratio, 1.0)
    )  # of 1 m
    lost = HERTZ_SQUARE * case.force**2 * case.duration / unit
    return math.sqrt(lost / (case.tolerance * case.energy))


def small_slope(case: Case, name: str, indicator: str, source: str) -> Effect:
    """Hertz's paraboloid instead of a sphere.

    Sneddon's rigid sphere, δ = (a/2) ln((R + a)/(R − a)), F = E [(a² + R²)/2 ln((R + a)/(R − a)) − a R], expands to
    F = K δ^{3/2} (1 − a²/(10 R²) + …): the force at one indentation changes by a tenth of (a/R)².
    """
    if case.scene.effective_modulus is None:
        return _unjudged(name, indicator, "missing: an effective modulus", source)
    value = case.contact_radius / case.scene.effective_radius
    reason = "the contact radius is to be small against the radius"
    return _judged(case, name, indicator, source, value, math.sqrt(10.0 * case.tolerance), 0.1 * value**2, reason)


def contact_width(case: Case, name: str, indicator: str, source: str) -> Effect:
    """The half-space's contact law on a plate or beam: it holds while the contact is narrow against the thickness."""
    target = case.scene.target
    if not isinstance(target, Plate | Beam):
        return _absent(name, indicator, "the target is neither a plate nor a beam", source)
    if target.thickness is None:
        return _unjudged(name, indicator, "missing: target.thickness", source)
    value = case.contact_radius / target.thickness
    if value > 1.0:
        reason = f"the contact is wider than the {target.kind} is thick, which no half-space law describes"
        return Effect(name, indicator, value, 1.0, None, NOT_MODELLED, reason, source, ABSENT)
    reason = "no verified estimate: the contact stiffens in proportion to a/h"
    return Effect(name, indicator, value, 1.0, None, NOT_JUDGED, reason, source, ABSENT)


def adhesion(case: Case, name: str, indicator: str, source: str) -> Effect:
    """Work that parts the surfaces: e² falls by (V_s/V)², V_s = √(2 · 7.0922 (Γ⁵R⁴/E²)^{1/3}/m) (Thornton & Ning)."""
    work, modulus = case.scene.contact.work_of_adhesion, case.scene.effective_modulus
    if work is None or modulus is None:
        missing = "contact.work_of_adhesion" if work is None else "an effective modulus"
        return _unjudged(name, indicator, f"missing: {missing}", source)
    parting = JKR_WORK * (work**5 * case.scene.effective_radius**4 / modulus**2) ** (1.0 / 3.0)
    value = case.scene.approach_velocity / max(math.sqrt(2.0 * parting / case.scene.effective_mass), 1e-300)
    left = case.restitution**2 - value**-2
    size = 1.0 if left <= 0.0 else case.restitution / math.sqrt(left) - 1.0
    reason = "below V_s the ball sticks" if left > 0.0 else "the ball sticks"
    threshold = 1.0 / math.sqrt(2.0 * case.tolerance)
    return _judged(case, name, indicator, source, value, threshold, max(min(size, 1.0), value**-2), reason)


def material_damping(case: Case, name: str, indicator: str, source: str) -> Effect:
    """Loss in the bulk: π tan δ of the elastic energy, half of what a full cycle of linear hysteresis takes.

    For a linear spring and dashpot it is 1 − e = (π/2) tan δ. The factors of two bodies add by their compliances.
    """
    scene = case.scene
    bodies = (("impactor", scene.impactor.material), ("target", scene.target.material))
    missing = [f"{part}.material.loss_factor" for part, m in bodies if m is None or m.loss_factor is None]
    if missing:
        return _unjudged(name, indicator, "missing: " + " and ".join(missing), source)
    materials = [cast("Material", m) for _, m in bodies]
    soft = [(1.0 - m.poissons_ratio**2) / m.youngs_modulus for m in materials]
    value = sum(cast("float", m.loss_factor) * c for m, c in zip(materials, soft, strict=True)) / sum(soft)
    reason = "damping takes π tan δ of the elastic energy"
    size = min(1.0, math.pi * value * (1.0 - case.fraction))
    return _judged(case, name, indicator, source, value, case.tolerance / math.pi, size, reason)


def wave_losses(case: Case, name: str, indicator: str, source: str) -> Effect:
    """Waves radiated into a half-space: β/(ρ c_T³) ∫Ḟ² dt of the impact energy, with ∫Ḟ² dt = 4.685 F_m²/t_c.

    β(ν) is the imaginary part of the surface's compliance at a point, ω β/(ρ c_T³): Lamb's problem (Miller & Pursey
    1955); two thirds go into the Rayleigh wave. Hunter 1957 has the same V^{3/5}.
    """
    material = case.scene.target.material
    if not isinstance(case.scene.target, HalfSpace):
        return _absent(name, indicator, "the target is no half-space", source)
    if material is None:
        return _unjudged(name, indicator, "missing: target.material", source)
    ratio = material.poissons_ratio
    shear = math.sqrt(material.youngs_modulus / (2.0 * (1.0 + ratio)) / material.density)
    beta = float(np.interp(ratio, *RADIATION))
    radiated = beta / (material.density * shear**3) * HERTZ_PULSE * case.force**2 / case.duration
    size = min(1.0, radiated / case.energy)
    reason = "waves in the half-space carry this part of the energy away"
    return _judged(case, name, indicator, source, size, case.tolerance, size, reason)


def strain_rate(case: Case, name: str, indicator: str, source: str) -> Effect:
    """A yield strength that grows with the rate: strain 0.2 a/R (Tabor 1951) within the time to maximum indentation.

    The change is Big-Alabo's law marched with S_y (1 + C ln ε̇) and without.
    """
    scene = case.scene
    strength, modulus = scene.yield_strength, scene.effective_modulus
    if strength is None or modulus is None:
        return _unjudged(name, indicator, "missing: a yield strength", source)
    if case.fraction <= 1e-9:
        return _absent(name, indicator, "nothing yields", source)
    rate = 0.2 * case.contact_radius / scene.effective_radius / case.turn
    materials = [m for m in (scene.impactor.material, scene.target.material) if m is not None]
    known = [m for m in materials if m.yield_strength is not None]
    soft = min(known, key=lambda m: cast("float", m.yield_strength), default=None)
    factor = None if soft is None else soft.strain_rate_coefficient
    if factor is None:
        why = "missing: strain_rate_coefficient of the material that yields"
        return _unjudged(name, indicator, why, source, rate)
    hard = strength * (1.0 + factor * max(0.0, math.log(rate)))
    one, other = (_plastic(case, BigAlabo(modulus, scene.effective_radius, s)) for s in (hard, strength))
    size = change(one, other)
    reason = f"the yield strength grows by {100 * (hard / strength - 1.0):.2g} %"
    if size is None:
        return _unjudged(name, indicator, "the impact with the higher yield strength cannot be marched", source, rate)
    cost = f"{ABSENT}: needs a rate-dependent yield strength"
    return _judged(case, name, indicator, source, rate, None, min(size, 1.0), reason, cost)


def _plastic(case: Case, law: BigAlabo) -> Trial:
    problem = case.trial.problem
    return march(assemble(case.scene, law, problem.impedance, problem.load * problem.scales.force, problem.compliance))


def heating(case: Case, name: str, indicator: str, source: str) -> Effect:
    """Plastic work over the half-ball (2/3) π a³ under the contact; how it softens the material no scene can say."""
    if case.fraction <= 1e-9:
        return _absent(name, indicator, "nothing yields", source)
    value = case.fraction * case.energy / (2.0 / 3.0 * math.pi * case.contact_radius**3)
    why = "divide by the heat capacity per volume for the rise of temperature; how that softens the material is missing"
    return _unjudged(name, indicator, why, source, value)


RULES: dict[str, tuple[str, str, Callable[[Case, str, str, str], Effect]]] = {
    "boundary_reflections": (
        "t_c/t_return",
        "fitted to sums over the modes of simply supported plates struck at the centre; one-dimensional waves in a rod",
        reflections,
    ),
    "thickness": ("k h", "Zener 1941; pole of Mindlin's plate (1951), to first order", thickness),
    "small_slope": ("a/R", "Sneddon 1965, expanded for small a/R", small_slope),
    "contact_width": ("a/h", "a contact wider than the plate is thick is none on a half-space", contact_width),
    "adhesion": ("V/V_s", "Thornton & Ning 1998; work of parting of Johnson, Kendall & Roberts integrated", adhesion),
    "material_damping": ("tan δ", "half a cycle of linear hysteresis", material_damping),
    "wave_losses": ("E_waves/E", "Lamb's problem, Miller & Pursey 1955", wave_losses),
    "strain_rate": ("strain rate, 1/s", "Tabor 1951; Johnson & Cook 1983", strain_rate),
    "heating": ("plastic work/volume, J/m³", "balance of energy", heating),
}
"""Name → indicator, source and rule."""
