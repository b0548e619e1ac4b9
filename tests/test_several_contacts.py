"""Several contacts on one structure, by the code of their page: coupled equations, and the impact of one contact."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import film_model as fm
from examples.guides import BLOCK, DOCS

PAGE = (DOCS / "how_to" / "several_contacts.md").read_text(encoding="utf-8")
STEEL = fm.Material("steel", "210 GPa", 0.3, "7850 kg/m^3")
(A, B), THICK, ZETA, HIGHEST, END = (0.2, 0.15), 0.003, 0.01, 6e4, 6e-4
PLACES = (0.08, 0.075), (0.13, 0.06), (0.09, 0.08)
RADII, SPEEDS, GAPS, SIDES = (0.010, 0.008, 0.005), (0.5, 0.5, 3e-3), (0.0, 1e-4, 2e-6), (1, 1, -1)
MASSES = (7850.0 * 4.0 / 3.0 * math.pi * 0.010**3, 7850.0 * 4.0 / 3.0 * math.pi * 0.008**3, 1000.0)


def own(name):
    """The names in a file of the page."""
    found = {}
    (code,) = (body for kind, body in BLOCK.findall(PAGE) if kind == "python" and body.startswith(f"# {name}\n"))
    exec(code, found)
    return found


CONTACTS = own("several.py")["Contacts"]


def plate(place, sensors=None):
    size = ["200 mm", "150 mm"]
    return fm.Plate(STEEL, "3 mm", size=size, position=place, damping_ratio=ZETA, sensors=sensors)


def made(chosen, step, compliance, highest=HIGHEST):
    """The chosen contacts: two balls in front of a plate, and a fixed one behind it."""
    bodies = []
    for k in chosen:
        ball = fm.Sphere(f"{RADII[k]} m", f"{SPEEDS[k]} m/s", mass=f"{MASSES[k]!r} kg", material=STEEL)
        effects = fm.Effects(gravity=False, wave_losses=False)
        scene = fm.Scene(ball, fm.HalfSpace(STEEL), fm.Contact("hertz"), effects)
        bodies.append(fm.ImpactComponent(scene, initial_gap=GAPS[k], segments=1024))
        if SIDES[k] < 0:
            bodies[-1].initialize(velocity=0.0)
    sensors = [{"name": f"{k}", "position": [f"{x} m" for x in PLACES[k]]} for k in chosen]
    target = plate(["64.159 mm", "41.337 mm"], sensors)
    return CONTACTS(target, bodies, [SIDES[k] for k in chosen], compliance, highest, step)


def marched(chosen, step):
    """Mean forces of the steps and velocities after them, (steps, contacts); the compliance is that of the modes."""
    contacts = made(chosen, step, np.zeros(len(chosen)))
    forces, velocities = [], []
    for _ in range(round(END / step)):
        forces.append(contacts.advance())
        velocities.append([body.outputs.impactor_velocity for body in contacts.bodies])
    return np.array(forces), np.array(velocities)


def coupled(chosen, times):
    """The velocities of the bodies at the times by the equations of balls and Navier's vibrations, with DOP853."""
    m, n = (k.ravel() for k in np.mgrid[1:40, 1:40])
    d = 210e9 * THICK**3 / (12.0 * (1.0 - 0.3**2))
    omega = math.pi**2 * math.sqrt(d / (7850.0 * THICK)) * ((m / A) ** 2 + (n / B) ** 2)
    m, n, omega = (row[omega <= 2.0 * math.pi * HIGHEST] for row in (m, n, omega))
    unit = 2.0 / math.sqrt(7850.0 * THICK * A * B)
    shapes = np.array(
        [SIDES[k] * unit * np.sin(m * math.pi * x / A) * np.sin(n * math.pi * y / B) for k, (x, y) in enumerate(PLACES)]
    )[list(chosen)]
    mass, size = np.array(MASSES)[list(chosen)], len(omega)
    stiffness = 4.0 / 3.0 * 210e9 / (2.0 * (1.0 - 0.3**2)) * np.sqrt(np.array(RADII)[list(chosen)])

    def rates(_, y):
        q, rate, x, v = np.split(y, [size, 2 * size, 2 * size + len(chosen)])
        force = stiffness * np.maximum(x - shapes @ q, 0.0) ** 1.5
        return np.concatenate([rate, force @ shapes - 2.0 * ZETA * omega * rate - omega**2 * q, v, -force / mass])

    start = np.concatenate([np.zeros(2 * size), -np.array(GAPS)[list(chosen)], [0.5, 0.5, 0.0][: len(chosen)]])
    found = solve_ivp(rates, (0.0, END), start, "DOP853", times, rtol=1e-10, atol=1e-15, max_step=2e-6)
    return found.y[2 * size + len(chosen) :].T


@pytest.mark.parametrize("chosen", [(0, 1), pytest.param((0, 1, 2), marks=pytest.mark.slow)])
def test_bodies_on_one_plate_obey_the_coupled_equations(chosen):
    """Forces within 5e-5 of the largest, velocities of the balls within 5e-5 of the approach; errors fall as the square
    of the step."""
    grid = np.linspace(0.0, END, 2401)
    exact, errors = coupled(chosen, grid), []
    for every in (8, 4, 2, 1):
        step = END / 2400 * every
        forces, velocities = marched(chosen, step)
        mean = -np.diff(exact[::every], axis=0) / step * np.array(MASSES)[list(chosen)]
        assert (mean.max(axis=0) > 30.0).all()  # N
        off = np.abs(forces - mean).max(axis=0) / mean.max(axis=0)
        slow = np.abs(velocities - exact[every::every])[:, :2].max() / 0.5
        errors.append(max(off.max(), slow))
    assert errors[-1] < 5e-5 and errors[-2] < 2e-4
    assert math.log2(errors[0] / errors[2]) / 2.0 == pytest.approx(2.0, abs=0.25)


def test_one_ball_is_the_impact_of_simulate():
    """With the static deflection of the vibrations left out, which stand for those above 150 kHz."""
    target = plate(["80 mm", "75 mm"])
    ball = fm.Sphere("10 mm", "0.5 m/s", mass=f"{MASSES[0]!r} kg", material=STEEL)
    scene = fm.Scene(ball, target, fm.Contact("hertz"), fm.Effects(gravity=False))
    exact = fm.simulate(scene, accuracy=1e-5)
    contacts = made([0], 2.5e-7, np.array([target.compliance]), 1.5e5)
    for _ in range(1600):
        contacts.advance()
    (body,) = contacts.bodies
    assert body.largest_force == pytest.approx(exact.summary["maximum_force"], rel=1e-3)
    there = exact.sample_si(np.array([body.time]))
    assert body.outputs.impactor_velocity == pytest.approx(there.impactor_velocity[0], abs=1e-4)
