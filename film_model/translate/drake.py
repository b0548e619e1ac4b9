"""Drake: compliant point contact, and hydroelastic contact of a compliant ball on a rigid target."""

from __future__ import annotations

import math
from typing import Any

from film_model.laws.damping import hunt_crossley_strength
from film_model.translate.law import Engine, EngineLaw, Middle, Pair, Parameter, Values

STIFFNESS = Parameter("stiffness", "N/m", "of the pair; twice as much for each body", 1e-12, logarithmic=True)
DISSIPATION = Parameter("dissipation", "s/m", "hunt_crossley_dissipation")


def dissipation_for(restitution: float, velocity: float) -> float:
    """Dissipation d of F = k δⁿ (1 + d δ') for a restitution at a velocity, for any n."""
    return hunt_crossley_strength(restitution) / velocity


def _start(middle: Middle, name: str, stiffness: float) -> dict[str, float]:
    restitution = min(max(middle.restitution, 0.05), 1.0)
    return {name: stiffness, "dissipation": dissipation_for(restitution, middle.velocity)}


def _paste_point(pair: Pair, values: Values) -> str:
    # Two materials in series: k = k1 k2/(k1 + k2) and d = (k2 d1 + k1 d2)/(k1 + k2)
    return f"""properties = ProximityProperties()  # of both bodies: stiffnesses act in series
AddContactMaterial(
    dissipation={values["dissipation"]:.6g}, point_stiffness={2.0 * values["stiffness"]:.6g},
    friction=CoulombFriction(), properties=properties)
plant = MultibodyPlant(time_step=0.0)  # continuous, or discrete with kLagged, kSimilar or kTamsi, not kSap
plant.set_contact_model(ContactModel.kPoint)"""


def _start_sap(pair: Pair, middle: Middle) -> dict[str, float]:
    stiffness = middle.stiffness(1.0)
    return {"stiffness": stiffness, "relaxation_time": 2.0 * middle.damping_ratio * math.sqrt(pair.mass / stiffness)}


def _paste_sap(pair: Pair, values: Values) -> str:
    # In series k = k1 k2/(k1 + k2); the relaxation times of two bodies are added
    return f"""properties = ProximityProperties()  # of both bodies
AddContactMaterial(point_stiffness={2.0 * values["stiffness"]:.6g}, friction=CoulombFriction(), properties=properties)
properties.AddProperty("material", "relaxation_time", {0.5 * values["relaxation_time"]:.6g})
plant = MultibodyPlant(time_step={0.005 * math.pi * math.sqrt(pair.mass / values["stiffness"]):.1e})
plant.set_discrete_contact_approximation(DiscreteContactApproximation.kSap)
plant.set_contact_model(ContactModel.kPoint)"""


def _hydroelastic(pair: Pair, values: Values, depth: Any, rate: Any) -> Any:
    """The pressure E(1 − r/R) of a ball cut by a plane, integrated: π E δ² (1 − 2δ/(3R)); curved targets: Reff/R."""
    cut = 1.0 - 2.0 * depth / (3.0 * pair.ball_radius) if math.isinf(pair.target_radius) else 1.0
    stiffness = math.pi * values["hydroelastic_modulus"] * (pair.radius / pair.ball_radius)
    return stiffness * depth**2 * cut * (1.0 + values["dissipation"] * rate)


def _start_hydroelastic(pair: Pair, middle: Middle) -> dict[str, float]:
    modulus = middle.stiffness(2.0) / (math.pi * pair.radius / pair.ball_radius)
    return _start(middle, "hydroelastic_modulus", modulus)


def _paste_hydroelastic(pair: Pair, values: Values) -> str:
    # Facets of length h lie h²/(8R) inside the ball: the force is h²/(4Rδ) too small, 1 % for this length
    length = 0.2 * math.sqrt(pair.ball_radius * pair.depth)
    facets = 4.0 * math.pi * pair.ball_radius**2 / (math.sqrt(0.1875) * length**2)
    return f"""# resolution_hint: 1 % error of the force at a depth of {pair.depth:.3g} m, about {facets:.0e} facets
ball, target = ProximityProperties(), ProximityProperties()
AddCompliantHydroelasticProperties(
    resolution_hint={length:.3g}, hydroelastic_modulus={values["hydroelastic_modulus"]:.6g}, properties=ball)
AddContactMaterial(
    dissipation={values["dissipation"]:.6g}, point_stiffness=None, friction=CoulombFriction(), properties=ball)
AddRigidHydroelasticProperties(resolution_hint={length:.3g}, properties=target)
AddContactMaterial(
    dissipation=None, point_stiffness=None, friction=CoulombFriction(), properties=target)
plant.set_contact_model(ContactModel.kHydroelastic)"""


POINT = EngineLaw(
    name="point",
    formula="F = k δ (1 + d δ')",
    source="Drake documentation, Modeling Compliant Contact: Compliant Point Contact (Hunt & Crossley dissipation)",
    parameters=(STIFFNESS, DISSIPATION),
    force=lambda _, values, depth, rate: values["stiffness"] * depth * (1.0 + values["dissipation"] * rate),
    start=lambda _, middle: _start(middle, "stiffness", middle.stiffness(1.0)),
    paste=_paste_point,
    notes=(
        "the two bodies' stiffnesses act in series: each body's point_stiffness is twice the pair's",
        "the discrete contact approximation kSap does not use this dissipation: it has the law sap",
    ),
)

SAP = EngineLaw(
    name="sap",
    formula="F = k (δ + τ δ')",
    source="Drake documentation, Modeling Compliant Contact: discrete contact approximation kSap (linear dissipation)",
    parameters=(STIFFNESS, Parameter("relaxation_time", "s", "of the pair; half as much for each body")),
    force=lambda _, values, depth, rate: values["stiffness"] * (depth + values["relaxation_time"] * rate),
    start=_start_sap,
    paste=_paste_sap,
    notes=(
        "each body has twice the pair's stiffness and half its relaxation time",
        "the solver is of first order: 200 steps a contact, as below, change force by -1 % and restitution by -2 %",
    ),
)

HYDROELASTIC = EngineLaw(
    name="hydroelastic",
    formula="F = π E δ² (Reff/R) (1 − 2δ/(3R)) (1 + d δ'); curved targets: without 1 − 2δ/(3R)",
    source="Drake documentation, Hydroelastic Contact; pressure field of Elandt et al., IROS 2019",
    parameters=(
        Parameter("hydroelastic_modulus", "Pa", "of the compliant ball", 1e-12, logarithmic=True),
        DISSIPATION,
    ),
    force=_hydroelastic,
    start=_start_hydroelastic,
    paste=_paste_hydroelastic,
    notes=("the ball is meshed: facets of length h make the force by about h²/(4Rδ) too small",),
)

DRAKE = Engine("drake", "Drake", (POINT, SAP, HYDROELASTIC))
