"""Effects of the materials: adhesion, damping, heating and fracture."""

from __future__ import annotations

import math

from film_model.base.materials import Material
from film_model.base.units import format_si
from film_model.effects.case import YIELDS, Case
from film_model.laws.damping import LOSS_SLOPE
from film_model.laws.hertz import hertz_stiffness
from film_model.problem.brittle import BRITTLE, bodies, factors, failure, own_radius
from film_model.problem.stresses import edge_tension
from film_model.targets import Estimate

_BRITTLE = f"{', '.join(BRITTLE[:-1])} or {BRITTLE[-1]}"


def adhesion(case: Case) -> Estimate:
    """Work to separate the surfaces: the restitution falls.

        e² falls by (V_s/V)²,  V_s = √(2 · 7.0922 (Γ⁵R⁴/E²)^{1/3}/m)

    Γ is work_of_adhesion in [contact], or 2 √(γ₁ γ₂) from the surface energies of the materials: an upper bound for
    clean and smooth surfaces. A dent of the radius R_p takes (R_p/R)^{4/3} times the work, R_p of Hertz's contact with
    the largest force over the indentation given back.
    """
    scene = case.scene
    modulus, work = scene.effective_modulus, scene.work_of_adhesion
    if case.problem.curve.pulls:
        return Estimate(f"it is in the law {case.problem.law.name}", applies=False)
    if work is None or modulus is None:
        return Estimate("missing: contact.work_of_adhesion" if work is None else "missing: an effective modulus")
    from film_model.laws.jkr import JKR_LOSS

    parting = JKR_LOSS * (work**5 * _radius_of_parting(case, modulus) ** 4 / modulus**2) ** (1.0 / 3.0)
    value = scene.approach_velocity / max(math.sqrt(2.0 * parting / scene.effective_mass), 1e-300)
    left = case.seen.restitution**2 - value**-2
    size = 1.0 if left <= 0.0 else case.seen.restitution / math.sqrt(left) - 1.0
    size = max(min(size, 1.0), value**-2)
    what = "the velocity below which the ball sticks" if left > 0.0 else "the sticking velocity: the ball sticks"
    origin = "the given work of adhesion"
    if scene.contact.work_of_adhesion is None:
        origin = f"at most {work:.2g} J/m^2 from the surface energies of both materials"
    why = f"the impact is at {value:.3g} times {what}, with {origin}"
    return Estimate(why, value, value * math.sqrt(size / case.seen.tolerance), size, below=True)


def _radius_of_parting(case: Case, modulus: float) -> float:
    """The radius of the contact that opens, m: R, or of a dent F = (4/3) E √R_p (δ_m − δ_f)^{3/2}."""
    radius = case.scene.effective_radius
    recovered = case.seen.indentation - case.problem.trial.summary.permanent_indentation * case.problem.scales.length
    if case.seen.fraction <= YIELDS or not recovered > 0.0:
        return radius
    return max(radius, (case.seen.force / (hertz_stiffness(modulus, 1.0) * recovered**1.5)) ** 2)


def material_damping(case: Case) -> Estimate:
    """Material damping: loss factors tan δ take the fraction 1 − e² of the elastic energy.

        e = 1 − 1.2048 tan δ    of a modulus t^−β, tan δ = tan(πβ/2) (Lee & Radok, Ting): to 1 % up to tan δ = 0.12

    Loss factors are averaged with the compliances as weights; a missing one is 0, or matters if the body is softer than
    5 GPa. Law "auto" takes law tsuji with this e if it matters; where the impact yields, if that leaves less than
    elastoplastic. No law both yields and damps, or damps on a static stiffness: a warning says what is left out.
    """
    if case.problem.law.damped:
        return Estimate(f"it is in the law {case.problem.law.name}", applies=False)
    scene, modulus = case.scene, case.scene.effective_modulus
    bodies = {"impactor": scene.impactor.material, "target": scene.target.material}
    relaxing = [part for part, m in bodies.items() if m is not None and m.prony is not None]
    if len(relaxing) == len(bodies):
        return Estimate("the effect viscoelasticity accounts for it: both materials have a prony series", applies=False)
    known = {part: m for part, m in bodies.items() if m is not None and (m.loss_factor is not None or part in relaxing)}
    missing = [part for part in bodies if part not in known]
    # softer than 5 GPa: a plastic, rubber or foam, whose losses no impact is without
    polymer = [part for part in missing if (m := bodies[part]) is not None and m.youngs_modulus < 5e9]
    if polymer:
        return Estimate(
            f"the loss factor of the {polymer[0]}, as soft as a polymer, is not known, so the restitution is too high: "
            'give loss_factor or prony, or law = "hunt-crossley" with a measured restitution',
            fails=True,
        )
    if not known:
        return Estimate("missing: " + " and ".join(f"{part}.material.loss_factor" for part in missing))
    soft = {part: (1.0 - m.poissons_ratio**2) / m.youngs_modulus for part, m in bodies.items() if m is not None}
    total = sum(soft.values()) if len(soft) == len(bodies) or modulus is None else 1.0 / modulus
    value = scene.loss_factor or 0.0
    share, left = 1.0 - scene.loss_restitution**2, case.seen.restitution * scene.loss_restitution
    why = f"the materials dissipate {100 * share:.2g} % of the elastic energy"
    why += "" if case.seen.vibrates else f": restitution about {left:.2g}"
    size = share * (1.0 - case.seen.fraction)
    if missing:
        given = sum(soft[part] for part in known) / total
        if size <= case.seen.tolerance and given < 0.9:
            return Estimate(f"missing: {missing[0]}.material.loss_factor; without it, {why}", value)
        why += f"; the loss factor of the {missing[0]} is not given and taken as 0"
    return Estimate(why, value, 0.5 * case.seen.tolerance / LOSS_SLOPE, size)


def heating(case: Case) -> Estimate:
    """Plastic work over the hemisphere (2/3) π a³ under the contact; a warning above 300 K. Softening is left out."""
    hot = 300.0  # K: by Johnson & Cook's (ΔT/1500 K)^1.03 of 4340 steel, it takes a fifth of the strength
    steel_heat = 3.6e6  # of steel per volume, J/(m³ K): 460 J/(kg K) at 7850 kg/m³
    if case.seen.fraction <= YIELDS:
        return Estimate("nothing yields", applies=False)
    radius = own_radius(case.problem, case.seen.force, case.seen.indentation)
    value = case.seen.fraction * case.seen.energy / (2.0 / 3.0 * math.pi * radius**3)
    rise = value / steel_heat
    why = f"the plastic work would heat steel under the contact by {rise:.2g} K"
    if rise > hot:
        return Estimate(f"{why}: the strength falls, and some metals melt", value, hot * steel_heat, fails=True)
    return Estimate(f"{why}; how much this softens the material is unknown", value)


def fracture(case: Case) -> Estimate:
    """Crushing, or a cone crack at the edge of the contact.

        F = (3 π²/4 ψ) K_Ic² R/E       fracture_toughness: least force of a ring crack, K² = F² ψ/(π² a³), with the
                                       maximum of ψ(c/a, r/a) by Huber's radial stress over the depth c and r
        σ = (1 − 2ν) p0/3              tensile_strength: stress at the edge (Hertz), p0 = 1.5 times the mean pressure
        F ≤ W + √(W² + 4π R p_c E)     crushing_strength: p_c = 3 times it, weight W, impact energy E

    Surfaces without such flaws bear more: first cracks in float glass gave a higher toughness than other tests, in part
    by friction (Geandier, Denis & Mocellin 2003, J. Non-Cryst. Solids 318:284). Small contacts bear several times the
    tensile strength, on concrete more than p_c; ice 2 to 3.3 times its strength (Gagnon & Gammon 1997, J. Glaciol. 43).
    What a crack absorbs is unknown.
    """
    scene = case.scene
    brittle = bodies(scene)
    if not brittle:
        given = {"impactor": scene.impactor.material, "target": scene.target.material}
        unknown = [f"{part}.material" for part, m in given.items() if m is None or m.initial_strength is None]
        if unknown:
            return Estimate(f"missing: {_BRITTLE} of " + " and ".join(unknown))
        return Estimate(f"no body is brittle: none has a {_BRITTLE}", applies=False)
    radius = own_radius(case.problem, case.seen.force, case.seen.indentation)
    indicator, value, why, then = max((_failing(body, case, radius) for body in brittle), key=lambda found: found[1])
    if value <= 1.0:
        return Estimate(why, value, 1.0, 0.0, indicator=indicator)
    return Estimate(f"{why}: {then}", value, 1.0, fails=True, indicator=indicator)


def _failing(body: Material, case: Case, radius: float) -> tuple[str, float, str, str]:
    """Indicator of a brittle body's failure, its value (1: it fails), a sentence, and what happens above 1."""
    crushed = 3.0  # mean pressure that crushed material is taken to bear below a ball, over its uniaxial strength
    name, value = body.name or "the brittle body", float(failure(factors(body), case.seen.force, radius))
    if body.crushing_strength is None:
        return *_cracking(body, name, case.seen.force, radius, value), "it may crack"
    pressure = case.seen.force / (math.pi * radius**2)
    why = (
        f"the mean pressure, {format_si(pressure, 'pressure', 3)}, is {value:.3g} times the crushing strength of {name}"
    )
    weight = case.problem.impacts.numbers.weight
    stopping = math.sqrt(
        4.0 * math.pi * case.scene.effective_radius * crushed * body.crushing_strength * case.seen.energy
    )
    bound = weight + math.hypot(weight, stopping)
    then = "it crushes" if value > crushed else "it begins to crush"
    if bound < case.seen.force:
        most = format_si(bound, "force", 3)
        then += f", and the force is at most about {most} if what is crushed bears {crushed:g} times that strength"
    return "mean pressure/crushing strength", value, why, then


def _cracking(body: Material, name: str, force: float, radius: float, value: float) -> tuple[str, float, str]:
    """Indicator of a crack in a brittle body, its value (1: it may crack), and a sentence."""
    if body.fracture_toughness is not None:
        least = format_si(force / value, "force", 2)
        why = f"the force is {value:.3g} times the least that can crack {name}, {least} (Auerbach's law)"
        return "force/least force of a crack", value, why
    stress = edge_tension(body.poissons_ratio, 1.5 * force / (math.pi * radius**2))
    why = (
        f"the tensile stress at the edge of the contact, {format_si(stress, 'pressure', 3)}, is {value:.3g} times the "
        f"strength of {name}, though small contacts bear more (give its fracture_toughness)"
    )
    return "tensile stress/strength", value, why
