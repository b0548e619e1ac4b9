"""Membrane forces of plates and beams that vibrate: against von Kármán's equations, solved by Ritz's method."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import film_datasets as fd
import film_model as fm
from film_model.core import modal, native
from film_model.effects.choose import choose
from film_model.explorer.support import computed, data, fixed_to
from film_model.laws import Hertz
from film_model.problem.curve import curve_of
from film_model.solve import structures, vibration
from tests.test_large_deflections import RATIO, energy_and_force, ritz

SIDE, THICK, YOUNG, DENSITY = 0.1, 0.001, 70e9, 2700.0
SOFT = 2e8  # effective modulus, Pa, so low that the vibrations beyond those of the reference follow statically
LASTS = 8e-3
SOFT_CONTACT = fm.Contact("hertz", effective_modulus=f"{SOFT} Pa")
METAL = fm.Material("aluminium", f"{YOUNG} Pa", RATIO, f"{DENSITY} kg/m^3")
pytestmark = pytest.mark.filterwarnings("ignore::film_model.ImpactWarning")


def struck(velocity, edges="simply supported", in_plane="fixed", accuracy=1e-2, effects=None, **more):
    more = {"edges": edges, "in_plane": in_plane, "theory": "kirchhoff", **more}
    plate = fm.Plate(METAL, f"{THICK} m", size=[f"{SIDE} m"] * 2, **more)
    ball = fm.Sphere("20 mm", f"{velocity} m/s", mass="1 kg", material=METAL)
    wanted = {"gravity": False, **(effects or {})}
    return fm.Scene(
        ball,
        plate,
        SOFT_CONTACT,
        fm.Effects(**wanted),
        fm.Solver(accuracy=accuracy),
    )


def velocity_for(deflection, edges, slides):
    """Of a ball of 1 kg whose energy bends the plate by so many thicknesses; and von Kármán's force then."""
    scale = (SIDE / 2 / THICK) ** 2
    energy, force, _ = energy_and_force(edges, slides, deflection)
    return float(np.sqrt(2 * energy * YOUNG * THICK**3 / scale)), float(force * YOUNG * THICK**2 / scale)


def by_von_karman(velocity, edges, slides):
    """Largest force on the plate in the motion of Ritz's functions under a ball with Hertz's contact."""
    own, half = ritz(edges, slides), SIDE / 2
    bend, membrane, inert = YOUNG * THICK**3 / half**2, YOUNG * THICK / half**2, DENSITY * THICK * half**2
    root = np.linalg.cholesky(own.mass)
    values, shapes = np.linalg.eigh(np.linalg.solve(root, np.linalg.solve(root, own.stiff).T))
    shapes = np.linalg.solve(root.T, shapes)
    at, (dx, dy), n = shapes.T @ own.at, (shapes.T @ slope for slope in own.slopes), len(values)
    pairs = [(one[:, None] * other).reshape(n * n, -1) for one, other in ((dx, dx / 2), (dy, dy / 2), (dx, dy))]
    mixed = own.product(own.strains, pairs)
    energy = (own.product(pairs, pairs) - mixed.T @ own.plane @ mixed).reshape(n, n, n * n)
    energy = membrane * (energy + energy.transpose(1, 0, 2)).reshape(n * n, n * n) / 2
    hertz = 4 / 3 * SOFT * np.sqrt(0.02)

    def rates(_, state):
        w, force = state[:n], hertz * max(state[-2] - at @ state[:n], 0.0) ** 1.5
        pull = bend * values * w + 2 * (energy @ np.outer(w, w).ravel()).reshape(n, n) @ w
        return np.concatenate([state[n:-2], (force * at - pull) / inert, [state[-1], -force]])

    start = np.append(np.zeros(2 * n + 1), velocity)
    found = solve_ivp(rates, (0.0, LASTS), start, method="DOP853", rtol=1e-6, atol=1e-10, max_step=8e-6)
    return float((hertz * np.maximum(found.y[-2] - at @ found.y[:n], 0.0) ** 1.5).max())


@pytest.mark.slow
@pytest.mark.parametrize("slides", [False, True])
@pytest.mark.parametrize("edges", ["simply supported", "clamped"])
@pytest.mark.parametrize("deflection", [0.5, 1.0, 3.0])
def test_the_largest_force_of_an_impact(deflection, edges, slides):
    velocity, _ = velocity_for(deflection, edges, slides)
    found = fm.simulate(struck(velocity, edges, "free" if slides else "fixed", effects={"stretching": True}))
    force = found.summary["maximum_force"]
    exact = by_von_karman(velocity, edges, slides)
    assert force == pytest.approx(exact, rel=0.1)


@pytest.mark.slow
@pytest.mark.parametrize("ratio", [0.0, 0.02])
def test_the_core_against_an_integrator(ratio):
    """Three modes with any forms: displacements and energy, and a record that is the motion itself."""
    random = np.random.default_rng(1)
    frequency, share, ratios = np.array([1.0, 2.3, 4.1]), np.array([0.5, 0.3, 0.4]), np.full(3, ratio)
    forms = random.normal(size=(2, 3, 3))
    forms = forms + forms.transpose(0, 2, 1)
    tables = modal.Tables(frequency, share, ratios, 1.0, forms)
    curve = curve_of(Hertz(1.0, 1.0)).native
    start = modal.Start(1.0, 0.0, 0.1, 2.0, 1.0, 0.0, 1e-11, 60.0, stretch=0.7)
    found = modal.impact(tables, curve, start)
    assert found.status == native.EVENT

    def rates(_, state):
        w, u = state[:3], state[3:6]
        force, s = indented(state[6] - w.sum()), np.einsum("kij,i,j", forms, w, w)
        pull = 2.0 * 0.7 * np.einsum("k,kij,j", s, forms, w)
        accelerations = share * (2.0 * force - pull) - 2 * ratios * frequency * u - frequency**2 * w
        return np.concatenate([u, accelerations, [state[7], -force]])

    def indented(depth):  # xi + 0.1 xi^1.5 = depth
        xi = max(depth, 0.0)
        for _ in range(30):
            xi -= (xi + 0.1 * xi**1.5 - max(depth, 0.0)) / (1.0 + 0.15 * xi**0.5)
        return xi**1.5

    times = np.linspace(0.0, found.events["time"][-1], 200)
    start_at = [0.0] * 7 + [1.0]
    exact = solve_ivp(rates, (0.0, times[-1]), start_at, method="DOP853", rtol=1e-11, atol=1e-13, t_eval=times).y
    values = modal.sample(tables, curve, found.segments, found.flights, times)[0]
    assert values[:, 3] == pytest.approx(exact[7], abs=2e-7)
    motion, moved = modal.Motion(tables, curve, start), []
    for time in times:
        while motion.state.time + motion.state.tau < time and motion.step(time - motion.state.time - motion.state.tau):
            pass
        moved.append(motion.sensed(np.eye(3)))
    assert np.array(moved)[:, 0] == pytest.approx(exact[:3].T, abs=2e-7)
    assert np.array(moved)[:, 1] == pytest.approx(exact[3:6].T, abs=2e-6)
    if not ratio:
        energy = found.energies.sum() + found.stretching + 0.5 * found.summary.core.final_velocity**2
        assert energy == pytest.approx(0.5, abs=1e-10)


def test_the_order_of_the_steps():
    """The error of the energy falls with the tolerance of the steps."""
    scene = struck(1.0, effects={"stretching": True})
    problem = choose(scene).problem
    structure = structures.structure_of(scene.target, 3e4, problem.scales.time, 8)
    errors = []
    for tolerance in (1e-3, 1e-5, 1e-7, 1e-9):
        run = vibration.run(problem, structure, tolerance, 0.05, recorded=False)
        energy = 0.5 * run.summary.final_velocity**2 + run.energy
        errors.append(abs(energy / (0.5 * problem.approach**2) - 1.0))
    assert errors[0] < 1e-4 and errors[3] < 1e-9
    assert all(after < before / 5 for before, after in pairwise(errors))


def test_a_tiny_deflection_is_linear():
    effects = {"target_inertia": True, "boundary_reflections": True}
    linear, stretched = (
        fm.simulate(struck(1e-6, accuracy=1e-3, effects={**effects, "stretching": on})).summary for on in (False, True)
    )
    for name, value in linear.items():
        assert stretched[name] == pytest.approx(value, rel=1e-6, abs=1e-12), name


@pytest.mark.slow
@pytest.mark.parametrize(("edges", "slides"), [("simply supported", False), ("clamped", True)])
def test_the_static_limit(edges, slides):
    """A slow and heavy ball bends the plate as a force at rest does; a part of its energy is in the contact."""
    velocity, force = velocity_for(1.0, edges, slides)
    pressed = 0.4 * force * (force / (4 / 3 * 2e9 * np.sqrt(0.02))) ** (2 / 3)
    heavy = struck(np.sqrt((velocity**2 + 2 * pressed) / 100), edges, "free" if slides else "fixed")
    heavy = heavy.replace({"impactor.mass": "100 kg", "contact.effective_modulus": "2 GPa"})
    assert fm.simulate(heavy).summary["maximum_force"] == pytest.approx(force, rel=0.04)


@pytest.mark.slow
def test_a_beam_between_fixed_ends():
    """U = k w²/2 + E A L ε²/2, ε = π² w²/(4 L²), to which its first vibration alone leads; higher ones soften it."""
    beam = fm.Beam(METAL, "300 mm", "4 mm", "2 mm", in_plane="fixed", theory="euler-bernoulli")
    ball = fm.Sphere("20 mm", "20 mm/s", mass="20 kg", material=METAL)
    scene = fm.Scene(ball, beam, SOFT_CONTACT, fm.Effects(gravity=False), fm.Solver(accuracy=1e-2))
    history = fm.simulate(scene)
    section, length = 4e-3 * 2e-3, 0.3
    bent = 48 * YOUNG * section * 2e-3**2 / 12 / length**3 / 2
    quartic = YOUNG * section * np.pi**4 / 32 / length**3
    square = (-bent + np.sqrt(bent**2 + 4 * quartic * 0.5 * 20 * 0.02**2)) / 2 / quartic
    force = 2 * bent * square**0.5 + 4 * quartic * square**1.5
    assert square**0.5 > 1.2 * 2e-3
    assert history.summary["maximum_force"] == pytest.approx(force, rel=0.06)
    free = scene.replace({"target.in_plane": "free"})
    assert not choose(free).problem.stretches


def effect(scene):
    return next(one for one in choose(scene).effects if one.name == "stretching")


def test_when_they_are_simulated():
    assert effect(struck(1.0)).state == "simulated"
    strip = fm.Beam(METAL, "300 mm", "100 mm", "1 mm", ends="clamped", in_plane="fixed")
    ball = fm.Sphere("20 mm", "0.3 m/s", mass="0.5 kg", material=METAL)  # whose weight keeps the static contact closed
    assert effect(fm.Scene(ball, strip, fm.Contact("hertz"))).state == "simulated"
    assert effect(struck(1e-3)).state == "not needed"
    assert effect(struck(1.0, in_plane=None)).state == "needed but not modelled"
    off = effect(struck(1.0, effects={"stretching": False}))
    assert off.state == "needed but not modelled" and "stretching = false" in off.reason
    assert effect(struck(1e-3, effects={"stretching": False})).state == "switched off"
    with pytest.raises(fm.SimulationError, match="stretching is true"):
        choose(struck(1.0, in_plane=None, effects={"stretching": True}))
    with pytest.raises(ValueError, match="in_plane"):
        fm.Plate(layup=[["carbon/epoxy UD", "1 mm", 0]], material="glass", size=["1 m", "1 m"], in_plane="fixed")
    with pytest.warns(fm.ImpactWarning, match="membrane forces of the plate are left out"):
        fm.ImpactComponent(struck(1.0))


def test_what_a_page_gets():
    """Forms of the lowest modes, and what was decided about them: the page cannot decide it again."""
    choice = choose(struck(1.0))
    found, reason = data(choice)
    assert found is not None and not reason and fixed_to(choice).effects.stretching is True
    forms, few = found["membrane"]["forms"], found["membrane"]["few"]
    known = structures.made(choice.scene.target, found["highest"], 1.0, structures.CARRIED).tables.forms
    assert [len(row) for row in forms[0]] == list(range(1, known.shape[1] + 1)) and few == 8
    assert forms[-1][-1] == known[-1, -1].tolist()
    slow = choose(struck(1e-3))
    found, _ = data(slow)
    assert found is not None and "membrane" not in found and fixed_to(slow).effects.stretching is False
    assert not computed(choice.scene.target) and computed(struck(1.0, in_plane=None).target)


@pytest.mark.slow
def test_sensors_files_and_sweeps(tmp_path):
    """The struck point's own sensor, its velocity, a motion from a file, and rows of a sweep."""
    scene = struck(0.3, sensors=[{"name": "centre", "position": [f"{SIDE / 2} m"] * 2}], damping_ratio=0.01)
    scene = scene.replace({"solver.accuracy": 5e-5})
    history = fm.simulate(scene)
    times = np.linspace(0.0, history.duration, 2001)
    seen = history.sensed_si(times)
    moved = history.sample_si(times).target_displacement
    assert seen.displacement[0] == pytest.approx(moved, abs=5e-3 * moved.max())
    travelled = np.concatenate([[0.0], np.cumsum((seen.velocity[0][1:] + seen.velocity[0][:-1]) / 2 * times[1])])
    assert travelled == pytest.approx(seen.displacement[0], abs=5e-3 * moved.max())
    gained = np.concatenate([[0.0], np.cumsum((seen.acceleration[0][1:] + seen.acceleration[0][:-1]) / 2 * times[1])])
    assert gained == pytest.approx(seen.velocity[0], abs=0.05 * seen.velocity.max())
    fd.write(fd.to_dataset(history), tmp_path / "one.nc")
    again = fd.history_of(fd.open(tmp_path / "one.nc"))
    assert again.sensor_peaks == history.sensor_peaks
    assert again.sample_si(times).contact_force == pytest.approx(history.sample_si(times).contact_force)
    rows = fm.simulate_batch(scene, velocity=["0.2 m/s", "0.3 m/s"])
    assert rows.summary["maximum_force"][1] == pytest.approx(history.summary["maximum_force"], rel=1e-12)
    swept = fd.sweep(scene, {"impactor.velocity": ["0.2 m/s", "0.3 m/s"]})
    largest = history.sensor_peaks["centre"]["maximum_displacement"]
    assert float(swept["sensor_centre_maximum_displacement"][1]) == pytest.approx(largest, rel=1e-12)
