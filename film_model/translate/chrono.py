"""Project Chrono, smooth contacts (ChSystemSMC): Hertz or Hooke, by material properties or by coefficients."""

from __future__ import annotations

from functools import partial

from film_model.translate import granular
from film_model.translate.law import Engine, Pair, Parameter, Values

SOURCE = "Project Chrono, ChContactSMC.h (ChDefaultContactForceSMC); manual, Collision detection and contact, SMC"
NOTES = (
    "Chrono takes the mass of a fixed body for the effective mass: make it large, or the damping is too small",
    "Chrono takes 0.1 m for the curvature of shapes whose curvature it does not know: set the default to Reff",
    "the smooth contact is explicit: a time step of at most a hundredth of the contact",
)


def _paste_material(model: str, pair: Pair, values: Values) -> str:
    extra = f"\nsystem.SetCharacteristicImpactVelocity({pair.velocity:.6g})" if model == "Hooke" else ""
    return f"""material = chrono.ChContactMaterialSMC()  # of both bodies
material.SetYoungModulus({values["youngs_modulus"]:.6g})
material.SetPoissonRatio({pair.poissons_ratio:.6g})
material.SetRestitution({values["restitution"]:.6g})
system.UseMaterialProperties(True)
system.SetContactForceModel(chrono.ChSystemSMC.{model}){extra}
{_geometry(pair)}"""


def _geometry(pair: Pair) -> str:
    mass = f"\ntarget.SetMass({1e6 * pair.ball_mass:.6g})  # also when it is fixed" if pair.fixed else ""
    return f"chrono.ChCollisionInfo.SetDefaultEffectiveCurvatureRadius({pair.radius:.6g}){mass}"


def _paste_coefficients(pair: Pair, values: Values) -> str:
    return f"""material = chrono.ChContactMaterialSMC()  # of both bodies
material.SetKn({values["kn"]:.6g})
material.SetGn({values["gn"]:.6g})
system.UseMaterialProperties(False)
system.SetContactForceModel(chrono.ChSystemSMC.Hertz)
{_geometry(pair)}"""


HERTZ = granular.law_by_restitution("hertz", SOURCE, partial(_paste_material, "Hertz"), False, NOTES)

HOOKE = granular.law_by_restitution("hooke", SOURCE, partial(_paste_material, "Hooke"), False, NOTES)

COEFFICIENTS = granular.law_with_viscosity(
    "hertz-coefficients",
    "F = R √δ (kn δ + m gn δ')",
    SOURCE,
    (Parameter("kn", "N/m^2.5", "SetKn", 1e-12, logarithmic=True), Parameter("gn", "1/(s m^1.5)", "SetGn")),
    _paste_coefficients,
    lambda pair: (pair.radius**0.5, pair.radius**0.5),
    notes=NOTES,
)

CHRONO = Engine("chrono", "Project Chrono", (HERTZ, HOOKE, COEFFICIENTS))
