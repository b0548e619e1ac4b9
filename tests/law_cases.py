"""Scenes of every law, and the velocities and restitutions that their tests compare."""

import math

from cases import MASS

import film_model as fm
from film_model.problem.curve import curve_of
from film_model.studies import quadrature

STEEL = "youngs_modulus = '210 GPa'\npoissons_ratio = 0.3\ndensity = '7850 kg/m^3'\nyield_strength = '1 GPa'\n"

CONTACTS = {
    "thornton": 'yield_pressure = "1.6 GPa"',
    "kogut-etsion": 'hardness = "2.8 GPa"',
    "jackson-green": "",
    "yigit-christoforou": "",
    "rigid-plastic": 'yield_pressure = "3 GPa"',
    "walton-braun": 'loading_stiffness = "40 MN/m"\nunloading_stiffness = "80 MN/m"',
    "luding": 'loading_stiffness = "40 MN/m"\nplastic_stiffness = "100 MN/m"\nplasticity_depth = 1e-3',
    "tan-sun": 'stiffness = "1e10 N/m^1.5"\ncritical_indentation = "5 um"',
    "tabulated": 'indentation = ["0 um", "10 um", "40 um"]\nforce = ["0 N", "400 N", "2.5 kN"]',
    "linear-dashpot": 'stiffness = "40 MN/m"\nrestitution = 0.7',
    "tsuji": "restitution = 0.7",
    "hunt-crossley": 'hysteresis_damping = "2 s/m"',
    "kuwabara-kono": 'dissipation_time = "3 us"',
    "hertz": 'unloading = "brake"',
    "meyer": 'stiffness = "2e13 N/m^2"\nexponent = 2\nunloading = "brake"',
    "stronge": 'unloading = "retrace"',
    "big-alabo": 'unloading = "brake"',
    "auto": 'unloading = "brake"',
}


def scene_text(law, target="half-space", contact=None):
    kind = 'kind = "half-space"' if target == "half-space" else 'kind = "plate"\nthickness = "14 mm"'
    return (
        '[impactor]\nradius = "10 mm"\nmass = "60.74 g"\nvelocity = "0.25 m/s"\nmaterial = "WC, Big-Alabo 2017"\n'
        f"[target]\n{kind}\n[target.material]\n{STEEL}"
        f'[contact]\nlaw = "{law}"\n{CONTACTS[law] if contact is None else contact}\n'
    )


def restitution(law, velocity, mass=MASS):
    return quadrature.quadrature(law, mass, velocity)["coefficient_of_restitution"]


def velocity_of(law, depth, mass=MASS):
    """Velocity that reaches `depth` scales of a law on a half-space."""
    length, force = law.scales(1.0)
    return math.sqrt(2.0 * curve_of(law).work(depth) * length * force / mass)


def yield_velocity(law, mass=MASS):
    length, force = law.scales(1.0)
    return math.sqrt(0.8 * length * force / mass)


def scene_of(law, velocity):
    ball = fm.Sphere("10 mm", velocity=f"{velocity!r} m/s", mass=f"{MASS!r} kg")
    return fm.Scene(ball, fm.HalfSpace(), contact=fm.Contact(law), effects=fm.Effects(gravity=False))
