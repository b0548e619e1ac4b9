"""What the tests run over: every law, every target, the paper's scenes, and combinations of parameters."""

import itertools
import math
from dataclasses import dataclass

import numpy as np
import pytest

import film_model as fm
from film_model.core import springs
from film_model.laws.example_ball import example_ball, example_law

EFFECTIVE_MODULUS = 1 / ((1 - 0.28**2) / 600e9 + (1 - 0.30**2) / 210e9)  # Pa, tungsten carbide on steel
RADIUS, MASS, VELOCITY, YIELD = 0.01, 0.06074, 0.25, 1e9  # m, kg, m/s, Pa

BALL = {"radius": "10 mm", "mass": "60.74 g", "material": "WC, Big-Alabo 2017"}
STEEL = fm.Material("steel of the paper", "210 GPa", 0.30, "7850 kg/m^3", "1 GPa")


@dataclass(frozen=True)
class Saturating(fm.AbstractLaw):
    """A custom law whose stiffness saturates, with residual indentation; its functions are fitted by polynomials."""

    name = "saturating"
    summary = "test law"
    source = "tests"

    stiffness: float = 5e7  # N/m
    depth: float = 4e-6  # m

    def scales(self, energy):
        return self.depth, self.stiffness * self.depth

    def stages(self):
        unloading = fm.Unloading(residual=lambda m: 0.3 * (m - 1.0) ** 2 / (m + 1.0), exponent=1.3)
        return (
            fm.Stage("linear", 0.0, 1.0, fm.Power(slope=1.0)),
            fm.Stage(
                "saturating", 1.0, 60.0, lambda x: 1.0 + 4.0 * np.tanh((x - 1.0) / 4.0) + 0.1 * (x - 1.0), unloading
            ),
        )


def table():
    """A stiffening curve in 25 points, as a measurement might give it."""
    indentation = np.linspace(0.0, 80e-6, 25)
    return fm.Tabulated(indentation, 2e7 * indentation + 3e11 * indentation**2)


SPHERE = (EFFECTIVE_MODULUS, RADIUS)
LAWS = {
    "hertz": fm.Hertz(EFFECTIVE_MODULUS, RADIUS),
    "meyer": fm.Meyer(stiffness=2e13, exponent=2.0),
    "meyer-shifted": fm.Meyer(stiffness=1e9, exponent=1.2, initial_indentation=1e-6),
    "big-alabo": fm.BigAlabo(EFFECTIVE_MODULUS, RADIUS, YIELD),
    "big-alabo-printed": fm.BigAlabo(EFFECTIVE_MODULUS, RADIUS, YIELD, "printed"),
    "stronge": fm.Stronge(EFFECTIVE_MODULUS, RADIUS, YIELD),
    "saturating": Saturating(),
    "thornton": fm.Thornton(*SPHERE, 1.6 * YIELD),
    "kogut-etsion": fm.KogutEtsion(*SPHERE, poissons_ratio=0.3, hardness=2.8 * YIELD),
    "jackson-green": fm.JacksonGreen(*SPHERE, YIELD, poissons_ratio=0.3),
    "yigit-christoforou": fm.YigitChristoforou(*SPHERE, YIELD),
    "rigid-plastic": fm.RigidPlastic(*SPHERE, 0.6 * YIELD),
    "walton-braun": fm.WaltonBraun(loading_stiffness=4e7, unloading_stiffness=8e7),
    "luding": fm.Luding(RADIUS, loading_stiffness=4e7, plastic_stiffness=1e8, plasticity_depth=1e-3),
    "tan-sun": fm.TanSun(stiffness=1e10, critical_indentation=5e-6),
    "tabulated": fm.BrakeUnloading(table(), *SPHERE),
    "linear-dashpot": fm.LinearDashpot(stiffness=4e7, restitution=0.7),
    "tsuji": fm.Tsuji(*SPHERE, restitution=0.7),
    "hunt-crossley": fm.HuntCrossley(*SPHERE, hysteresis_damping=2.0),
    "kuwabara-kono": fm.KuwabaraKono(*SPHERE, dissipation_time=3e-6),
    "big-alabo-brake": fm.BrakeUnloading(fm.BigAlabo(*SPHERE, YIELD), *SPHERE),
}
BALL_EXAMPLE = example_ball(EFFECTIVE_MODULUS, RADIUS, YIELD, 0.3, MASS, VELOCITY)
ADHESIVE = tuple(name for name, law in fm.LAWS.items() if law.family == "adhesive")  # test_adhesive_laws.py: they stick
LAWS |= {name: example_law(law, BALL_EXAMPLE) for name, law in fm.LAWS.items() if name not in (*LAWS, *ADHESIVE)}


def loads_straight(law):
    """Whether loading consists of straight lines, which segments follow exactly."""
    return all(isinstance(stage.force, fm.Power) and stage.force.coefficient == 0.0 for stage in law.stages())


def straight(law):
    """Whether unloading consists of straight lines too: there is no order of convergence to measure."""
    branches = (stage.unloading for stage in law.stages())
    return loads_straight(law) and all(branch is None or branch.exponent == 1.0 for branch in branches)


DAMPED = tuple(name for name, law in LAWS.items() if law.damped)

TARGETS = {
    "half-space": fm.HalfSpace(STEEL),
    "plate": fm.Plate(STEEL, thickness="14 mm"),  # Zener's λ about 0.4
    "thin plate": fm.Plate(STEEL, thickness="8 mm"),  # about 1.2
    "rod": fm.Rod(STEEL, diameter="30 mm"),
    "body": fm.Body(STEEL, radius="15 mm", velocity="0.1 m/s"),
}


def scene(law, target="half-space", velocity=VELOCITY, **solver):
    """The tungsten-carbide ball on a target, under a law by its name in LAWS."""
    return fm.Scene(
        fm.Sphere(velocity=f"{velocity!r} m/s", **BALL),
        TARGETS[target],
        contact=fm.Contact(law=LAWS[law]),
        solver=fm.Solver(**solver),
    )


def zener_scene(value, **solver):
    """Hertz on a plate with Zener's λ = value: one-parameter family, without gravity."""
    velocity, mass, modulus = 1.0, 0.01, 1e10
    stiffness = 4 / 3 * modulus * math.sqrt(RADIUS)
    impedance = stiffness**0.4 * mass**0.6 * velocity**0.2 / value
    density = 10.0  # kg/m²; Z = 8 √(ρ_A D) for an isotropic plate
    bending = (impedance / 8) ** 2 / density
    stiffnesses = fm.BendingStiffness(
        f"{bending!r} N*m", f"{0.3 * bending!r} N*m", f"{bending!r} N*m", f"{0.35 * bending!r} N*m"
    )
    plate = fm.Plate(mass_per_area=f"{density} kg/m^2", bending_stiffness=stiffnesses)
    ball = fm.Sphere(radius="10 mm", mass=f"{mass} kg", velocity=f"{velocity} m/s")
    contact = fm.Contact(law="hertz", effective_modulus=f"{modulus} Pa")
    return fm.Scene(ball, plate, contact=contact, effects=fm.Effects(gravity=False), solver=fm.Solver(**solver))


def _shown(name, values, place):
    """What pytest calls a value of a parameter."""
    value = values[place]
    return str(value) if isinstance(value, str | int | float) else f"{name}{place}"


def combinations(fast=None, **parameters):
    """Parametrize a test over every combination of lists; all are marked slow but a few, which run by default.

    Fast are `fast` combinations, or as many as the longest list has values. They go round every list, so that each of
    its values occurs if there are as many combinations as values.
    """
    names, lists = list(parameters), [list(values) for values in parameters.values()]
    count = fast or max(map(len, lists))
    chosen = {tuple(n % len(values) for values in lists) for n in range(count)}
    marked = [
        pytest.param(
            *(values[place] for values, place in zip(lists, places, strict=True)),
            id="-".join(map(_shown, names, lists, places)),
            marks=() if places in chosen else pytest.mark.slow,
        )
        for places in itertools.product(*(range(len(values)) for values in lists))
    ]
    return pytest.mark.parametrize(names, marked)


CREEPING = 1e-12
"""An over-damped contact ends by rounding, with a restitution below this, or never."""


def creeps(*restitutions):
    """Whether one of two results ends, with no velocity, and the other, whose restitution is None or nan, does not."""
    ended = [value for value in restitutions if value is not None and not math.isnan(value)]
    return len(ended) == 1 and abs(ended[0]) < CREEPING


def knots_of(count, legs):
    """Times of `count` + 1 moments of each leg of contacts, (impacts, times); legs as of `springs.impulses`."""
    legs = np.ascontiguousarray(legs, np.float64)
    times = np.empty((len(legs), 2 * (count + 1)))
    springs._library().film_springs_knots(len(legs), count, legs.ctypes.data, times.ctypes.data)
    return times
