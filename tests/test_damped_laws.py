"""The rate-dependent laws against closed forms, published numbers and solve_ivp."""

import math

import mpmath
import numpy as np
import pytest
from cases import DAMPED, EFFECTIVE_MODULUS, LAWS, MASS, RADIUS, SPHERE, combinations, scene
from scipy.integrate import solve_ivp

import film_model as fm
from film_model.core import native
from film_model.effects.choose import problem_of
from film_model.laws.damping import (
    hunt_crossley_strength,
    spring_ratio,
    spring_restitution,
)
from film_model.studies import high_precision, quadrature

STIFFNESS = 4 / 3 * EFFECTIVE_MODULUS * math.sqrt(RADIUS)


def case(law, velocity=0.25, target="half-space"):
    """Without gravity, which the closed forms exclude."""
    ball = fm.Sphere("10 mm", velocity=f"{velocity!r} m/s", mass=f"{MASS!r} kg")
    targets = scene("hertz", target).target
    return fm.Scene(ball, targets, contact=fm.Contact(law), effects=fm.Effects(gravity=False))


def run(law, velocity=0.25, accuracy=1e-9, target="half-space"):
    return fm.simulate(case(law, velocity, target), accuracy=accuracy).summary


def laws_in_si(law, velocity):
    """f(δ) and c(δ) in SI, written out here."""
    if isinstance(law, fm.LinearDashpot):
        c = law.damping if law.damping is not None else 2 * spring_ratio(law.restitution) * math.sqrt(
            MASS * law.stiffness
        )  # fmt: skip
        return (lambda d: law.stiffness * d), (lambda d: c)
    hertz = lambda d: STIFFNESS * d**1.5  # noqa: E731
    if isinstance(law, fm.DampedLargeSlope):
        alpha, c = math.sqrt(5) * spring_ratio(law.restitution), law.slope_coefficient
        scale = (law.radius / c**2) ** -0.75
        steep = lambda d: STIFFNESS * d**1.5 * (1 + c * math.sqrt(d / law.radius))  # noqa: E731
        return steep, lambda d: alpha * math.sqrt(MASS * STIFFNESS) * (d**0.25 + 1.2 * scale * d)
    if isinstance(law, fm.Tsuji):
        alpha = math.sqrt(5) * spring_ratio(law.restitution)
        return hertz, lambda d: alpha * math.sqrt(MASS * STIFFNESS) * d**0.25
    if isinstance(law, fm.HuntCrossley):
        given = law.hysteresis_damping
        chi = hunt_crossley_strength(law.restitution) / velocity if given is None else given
        return hertz, lambda d: chi * STIFFNESS * d**1.5
    return hertz, lambda d: 1.5 * law.dissipation_time * STIFFNESS * math.sqrt(d)


def integrated(law, velocity, impedance=math.inf, load=0.0, after=0.0):
    """Summary by DOP853 in real time; with `after` > 0, indentation and velocity so long after first touch."""
    f, c = laws_in_si(law, velocity)

    def rates(_, s):
        d, v = max(s[0], 0.0), s[1]
        rate = (v - f(d) / impedance) / (1 + c(d) / impedance)
        force = f(d) + c(d) * rate if s[0] > 0 else 0.0
        force = max(force, 0.0) if after else force
        return [v - force / impedance, load / MASS - force / MASS, force * force / impedance]

    def force(t, s):
        return rates(t, s)[1] * -MASS

    tools = {"method": "DOP853", "rtol": 1e-11, "atol": [1e-18, 1e-14, 1e-18], "dense_output": True}
    if after:
        solution = solve_ivp(rates, (0.0, after), [1e-14, velocity, 0.0], max_step=after / 2000, **tools)
        return solution.y[0, -1], solution.y[1, -1]

    def release(t, s):
        return force(t, s) if s[0] > 1e-12 else s[0] - 1e-12

    def turns(t, s):
        return rates(t, s)[0]

    release.terminal, release.direction, turns.direction = True, -1, -1
    # the integration begins at an indentation of 1e-13 m, where the force is not 0
    solution = solve_ivp(rates, (0.0, 1.0), [1e-13, velocity, 0.0], events=[release, turns], **tools)
    end, turn = solution.y[:, -1], solution.t_events[1][0]
    from scipy.optimize import minimize_scalar

    grid = np.linspace(0, turn, 400)
    values = [force(t, solution.sol(t)) for t in grid]
    k = int(np.argmax(values))
    best = minimize_scalar(
        lambda t: -force(t, solution.sol(t)), bounds=(grid[max(k - 1, 0)], grid[min(k + 1, 399)]), method="bounded",
        options={"xatol": 1e-12 * turn},
    )  # fmt: skip
    return {
        "maximum_force": max(-best.fun, values[0]),
        "maximum_indentation": solution.y_events[1][0][0],
        "time_of_maximum_indentation": turn,
        "contact_duration": solution.t[-1],
        "rebound_velocity": end[1],
        "energy_radiated": end[2],
    }


@pytest.mark.slow
@combinations(law=DAMPED, target=["half-space", "plate"], fast=1)
def test_high_precision_integrates_damped_laws(law, target):
    on = case(LAWS[law], target=target)
    impedance = on.target_impedance
    found = high_precision.impact(LAWS[law], on.effective_mass, on.approach_velocity, impedance)
    other = integrated(LAWS[law], on.approach_velocity, impedance)
    for name in ("maximum_force", "maximum_indentation", "contact_duration", "rebound_velocity"):
        assert found[name] == pytest.approx(other[name], rel=1e-7), name
    if target == "half-space" and getattr(LAWS[law], "restitution", None) is not None:
        rel = 0.02 if law == "damped-large-slope" else 1e-14
        assert found["coefficient_of_restitution"] == pytest.approx(LAWS[law].restitution, rel=rel)


@pytest.mark.slow
@pytest.mark.parametrize("target", ["half-space", "plate", "thin plate"])
@pytest.mark.parametrize("name", DAMPED)
def test_the_march_agrees_with_an_integrator(name, target):
    got = run(LAWS[name], 0.25, 1e-9, target)
    expected = integrated(LAWS[name], 0.25, case(LAWS[name], 0.25, target).target_impedance)
    for key, value in expected.items():
        assert got[key] == pytest.approx(value, rel=3e-7, abs=1e-15), key
    assert got["permanent_indentation"] == 0.0
    energy = 0.5 * MASS * 0.25**2
    left = 0.5 * MASS * got["rebound_velocity"] ** 2
    assert got["energy_absorbed"] + got["energy_radiated"] + left == pytest.approx(energy, rel=1e-12)


@pytest.mark.parametrize("name", DAMPED)
@pytest.mark.parametrize("target", ["half-space", "thin plate"])
def test_there_is_no_tension_and_the_force_ends_at_zero(name, target):
    history = fm.simulate(scene(name, target), accuracy=1e-6)
    samples = history.sample_si(np.linspace(0, 1.2 * history.duration, 5000))
    top = history.summary["maximum_force"]
    assert samples.contact_force.max() <= top * (1 + 1e-6)
    assert (samples.contact_force >= 0).all()
    just_before = history.sample_si(history.duration * (1 - 1e-9)).contact_force
    assert just_before < 1e-4 * top
    assert history.sample_si(history.duration * (1 + 1e-9)).contact_force == 0.0
    if name != "hunt-crossley":  # its indentation and force reach 0 together
        assert history.events[-1].indentation > 0.01 * history.summary["maximum_indentation"]


@pytest.mark.parametrize("inverse", [spring_ratio, hunt_crossley_strength])
def test_the_damping_for_many_restitutions_is_that_for_each(inverse):
    """From 1e-9 to 1. Near 1 the inverse of one restitution loses digits: its logarithm is that of a rounded number."""
    restitution = np.concatenate([np.geomspace(1e-9, 0.99, 60), [0.5, 0.999, 1.0]])
    alone = [inverse(e) for e in restitution.tolist()]
    np.testing.assert_allclose(inverse(restitution), alone, rtol=1e-12, atol=1e-15)


def test_damping_is_the_limit_of_no_damping():
    plain = run(fm.Hertz(*SPHERE))
    for law in (fm.Tsuji(*SPHERE, 1.0), fm.HuntCrossley(*SPHERE, restitution=1.0), fm.KuwabaraKono(*SPHERE, 0.0)):
        got = run(law)
        for key, value in plain.items():
            assert got[key] == value or got[key] == pytest.approx(value, rel=1e-12, abs=1e-18), key


# ---------------------------------------------------------------- spring and dashpot, Tsuji


@pytest.mark.parametrize("ratio", [0.01, 0.3, 0.9, 1.0, 1.3, 4.0])
def test_linear_dashpot_in_closed_form(ratio):
    stiffness, velocity = 4e7, 0.3
    law = fm.LinearDashpot(stiffness, damping=2 * ratio * math.sqrt(MASS * stiffness))
    omega = math.sqrt(stiffness / MASS)
    got = run(law, velocity)
    assert got["coefficient_of_restitution"] == pytest.approx(spring_restitution(ratio), rel=1e-11)
    if ratio < 1:
        root = math.sqrt(1 - ratio**2)
        duration = math.atan2(2 * ratio * root, 2 * ratio**2 - 1) / root / omega
        e = math.exp(-ratio / root * math.atan2(2 * ratio * root, 2 * ratio**2 - 1))
        turn = math.atan2(root, ratio) / root
        assert got["maximum_indentation"] == pytest.approx(velocity / omega * math.exp(-ratio * turn), rel=1e-12)
    elif ratio > 1:
        root = math.sqrt(ratio**2 - 1)
        duration = 2 * math.acosh(ratio) / root / omega
        e = math.exp(-ratio / root * math.log((ratio + root) / (ratio - root)))
    else:
        duration, e = 2 / omega, math.exp(-2)
    assert got["coefficient_of_restitution"] == pytest.approx(e, rel=1e-11)
    assert got["contact_duration"] == pytest.approx(duration, rel=1e-11)
    if ratio > 0.5:  # the force is largest at first touch
        assert got["maximum_force"] == pytest.approx(law.damping * velocity, rel=1e-12)
    few = fm.simulate(case(law, velocity), segments=2).summary
    assert few["contact_duration"] == pytest.approx(duration, rel=1e-11)


@pytest.mark.parametrize("off", [1e-6, -1e-6, 1e-10, -1e-13])
def test_restitution_keeps_its_digits_near_critical_damping(off):
    """The series there: ln e = −2 − (4/3)(ζ − 1) + (2/5)(ζ − 1)² − …"""
    ratio = 1.0 + off
    beyond = ratio - 1.0
    series = math.exp(-2.0) * math.exp(-4.0 / 3.0 * beyond + 0.4 * beyond**2)
    assert spring_restitution(ratio) == pytest.approx(series, rel=1e-15)


def hunt_crossley_restitution(strength):
    """e from λ (1 + e) = ln((1 + λ)/(1 − λ e)), in 40 digits."""
    with mpmath.workdps(40):
        x = mpmath.mpf(strength)
        ends = mpmath.mpf(0), min(1, 1 / x) * (1 - mpmath.mpf("1e-30"))
        return float(mpmath.findroot(lambda e: x * (1 + e) - mpmath.log((1 + x) / (1 - x * e)), ends, solver="bisect"))


@pytest.mark.parametrize("e", [1e-4, 0.1, math.exp(-2), 0.5, 0.9, 0.999999, 1.0])
def test_restitution_is_inverted_exactly(e):
    assert spring_restitution(spring_ratio(e)) == pytest.approx(e, rel=1e-12)
    strength = hunt_crossley_strength(e)
    if 0.01 < e < 1:
        assert hunt_crossley_restitution(strength) == pytest.approx(e, rel=1e-12)
    for velocity in (0.01, 1.0):
        laws = [fm.LinearDashpot(4e7, restitution=e), fm.Tsuji(*SPHERE, e), fm.HuntCrossley(*SPHERE, restitution=e)]
        for law in laws if e > 0.05 else laws[:2]:
            assert run(law, velocity, 1e-7)["coefficient_of_restitution"] == pytest.approx(e, rel=2e-7), law


@pytest.mark.parametrize(("given", "returned"), [(0.3, 0.397), (0.5, 0.550), (0.7, 0.718), (0.9, 0.902)])
def test_the_usual_tsuji_coefficient_gives_a_larger_restitution(given, returned):
    """α = √5 β, β = −ln e/√(ln² e + π²), assumes that contact ends at δ = 0."""
    beta = -math.log(given) / math.hypot(math.log(given), math.pi)
    assert math.exp(-math.pi * beta / math.sqrt(1 - beta**2)) == pytest.approx(given, rel=1e-13)
    assert spring_restitution(beta) == pytest.approx(returned, abs=5e-4)


# ---------------------------------------------------------------- Hunt–Crossley


@pytest.mark.parametrize(
    ("e", "strength"), [(0.9, 0.16648), (0.7, 0.63483), (0.5, 1.43275), (0.3, 3.08708), (0.1, 9.99816)]
)
def test_hunt_crossley_strength(e, strength):
    assert hunt_crossley_strength(e) == pytest.approx(strength, abs=6e-6)
    chi = strength / 0.25
    got = run(fm.HuntCrossley(*SPHERE, hysteresis_damping=chi), 0.25)
    assert got["coefficient_of_restitution"] == pytest.approx(e, abs=2e-6)
    deepest = ((2.5 * MASS / STIFFNESS) * (0.25 - math.log1p(strength) / chi) / chi) ** 0.4
    assert got["maximum_indentation"] == pytest.approx(deepest, rel=1e-11)


@pytest.mark.parametrize(
    ("shortcut", "returned"),
    [
        (lambda e: 1.5 * (1 - e), (0.516, 0.663, 0.909)),  # Hunt & Crossley
        (lambda e: 0.75 * (1 - e * e), (0.665, 0.725, 0.913)),  # Lankarani & Nikravesh
        (lambda e: 6 * (1 - e) / ((2 * e - 1) ** 2 + 3), (0.491, 0.594, 0.901)),  # Herbert & McWhannell
        (lambda e: (1 - e * e) / e, (0.101, 0.488, 0.876)),  # Gonthier
        (lambda e: 8 * (1 - e) / (5 * e), (0.069, 0.470, 0.894)),  # Flores
    ],
)
def test_restitution_of_published_approximations(shortcut, returned):
    for e, expected in zip((0.1, 0.5, 0.9), returned, strict=True):
        assert hunt_crossley_restitution(shortcut(e)) == pytest.approx(expected, abs=6e-4)


# ---------------------------------------------------------------- Kuwabara–Kono


def time_for(b, velocity=0.25):
    """A with b = (3/2) A (K/m)^{2/5} V^{1/5}."""
    return b / 1.5 / ((STIFFNESS / MASS) ** 0.4 * velocity**0.2)


@pytest.mark.parametrize(("b", "e"), [(0.05, 0.944397), (0.2, 0.800965), (0.5, 0.595252), (1.0, 0.393931)])
def test_kuwabara_kono_restitution(b, e):
    got = run(fm.KuwabaraKono(*SPHERE, time_for(b)))["coefficient_of_restitution"]
    assert got == pytest.approx(e, abs=6e-7)
    s = math.sqrt(b)
    pade = (1 + 0.501086 * s) / (1 + 0.501086 * s + 1.15345 * b + 0.577978 * s**3 + 0.532178 * b**2)
    assert got == pytest.approx(pade, abs=6e-3)


def test_kuwabara_kono_weakly_damped():
    """1 − e = 1.1534489 b: (8/15) (5/4)^{8/5} B(8/5, 1/2)."""
    got = run(fm.KuwabaraKono(*SPHERE, time_for(1e-4)), accuracy=1e-11)["coefficient_of_restitution"]
    assert (1 - got) / 1e-4 == pytest.approx(1.1534489, rel=2e-4)


@pytest.mark.parametrize("target", ["plate", "thin plate"])
def test_a_plate_equals_a_viscoelastic_half_space_until_the_end_of_contact(target):
    """Zener's equation for the indentation is Kuwabara and Kono's with A = m/Z; only the ends of contact differ."""
    plate = case(fm.Hertz(*SPHERE), target=target)
    waves = fm.simulate(plate, accuracy=1e-10).summary
    law = fm.KuwabaraKono(*SPHERE, MASS / plate.target_impedance)
    sphere = run(law, accuracy=1e-10)
    for key in ("maximum_indentation", "time_of_maximum_indentation"):
        assert sphere[key] == pytest.approx(waves[key], rel=1e-12)
    assert sphere["contact_duration"] < waves["contact_duration"]


# ---------------------------------------------------------------- components, batches


@pytest.mark.parametrize("name", DAMPED)
def test_a_batch_equals_its_single_impacts(name):
    law = LAWS[name] if name != "hunt-crossley" else fm.HuntCrossley(*SPHERE, restitution=0.6)
    speeds, masses = [0.05, 0.5, 1.5], [0.02, MASS]
    ureg = pytest.importorskip("pint").get_application_registry()
    batch = fm.simulate_batch(
        case(law), velocity=np.array(speeds) * ureg("m/s"), mass=np.array(masses)[:, None] * ureg.kg, accuracy=1e-7
    )
    for i, mass in enumerate(masses):
        for k, speed in enumerate(speeds):
            one = fm.simulate(with_mass(law, speed, mass), accuracy=1e-9)
            for key, value in one.summary.items():
                if value is not None:
                    scale = one.scene.kinetic_energy if "energy" in key else 0.0
                    assert batch.summary[key][i, k] == pytest.approx(value, rel=2e-7, abs=2e-7 * scale), key
    if name == "hunt-crossley":
        assert batch.summary["coefficient_of_restitution"] == pytest.approx(np.full((2, 3), 0.6), rel=1e-7)


def with_mass(law, speed, mass):
    ball = fm.Sphere("10 mm", velocity=f"{speed!r} m/s", mass=f"{mass!r} kg")
    return fm.Scene(ball, fm.HalfSpace(), contact=fm.Contact(law), effects=fm.Effects(gravity=False))


@pytest.mark.parametrize("inverse", [spring_ratio, hunt_crossley_strength])
@pytest.mark.parametrize("values", [[], [0.9, 0.5], [0.1, 0.02], [1.0, 0.9, 0.05, math.exp(-2.0)]])
def test_damping_of_many_restitutions(inverse, values):
    assert inverse(np.array(values)) == pytest.approx([inverse(value) for value in values], rel=1e-12)


def test_rounding_moves_no_turn():
    """The turn of 7 of 300 velocities that differ by rounding was 8e-9 of its time elsewhere: rounding of the length to
    it was taken for a jump that no line ends at."""
    stiff = {"D11": "154.9 N*m", "D12": "4.76 N*m", "D22": "91.4 N*m", "D66": "1.36430348216347 N*m"}
    plate = fm.Plate(mass_per_area="0.760405341215244 kg/m^2", bending_stiffness=stiff)
    law = fm.Contact("hunt-crossley", restitution=0.39140283705832457, effective_modulus="26914040362.91796 Pa")
    mesh, times = native.mesh(native.WORK_PRESERVING, 96, 96), []
    for k in range(-25, 110):
        speed = f"{0.23763819899901806 * (1.0 + 2.3e-16 * k)!r} m/s"
        ball = fm.Sphere("0.0025031734524793682 m", speed, mass="0.005000043612845453 kg")
        _, found = problem_of(fm.Scene(ball, plate, law, fm.Effects(target_motion=True))).march(mesh)
        times.append(found.time_of_maximum_indentation)
    assert times == pytest.approx([times[0]] * len(times), rel=1e-12)


@pytest.mark.parametrize("segments", [4, 8, 16])
def test_a_weight_that_turns_the_ball_soon_after_its_release(segments):
    """Just fast enough for the force of a linear dashpot to fall to 0 before it rises again: c g + k y = 0 there."""
    ratio, stiffness, speed = spring_ratio(0.6), 3e5, 7.429863162664e-3
    contact = fm.Contact("linear-dashpot", stiffness="300 kN/m", restitution=0.6)
    ball = fm.Sphere("10 mm", "1 m/s", material="bearing steel")
    heavy = fm.Scene(ball, fm.HalfSpace("bearing steel"), contact, fm.Effects(gravity=True))
    faster, slower = (
        fm.simulate(heavy.replace({"impactor.velocity": f"{speed * factor!r} m/s"}), segments=segments)
        for factor in (1.0 + 1e-9, 1.0 - 1e-9)
    )
    assert faster.outcome is fm.Outcome.SEPARATED and slower.outcome is not fm.Outcome.SEPARATED
    leaving = 2.0 * ratio * math.sqrt(heavy.mass / stiffness) * 9.80665
    assert -faster.summary["rebound_velocity"] == pytest.approx(leaving, rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("name", DAMPED)
def test_a_ball_bounces_lower_each_time_and_comes_to_rest(name):
    ball = scene(name)
    heavy = fm.Scene(ball.impactor, ball.target, ball.contact, fm.Effects(gravity=True))
    component = fm.ImpactComponent(heavy, accuracy=1e-5)
    events = component.step("2 s").events
    leaving = [-event.impactor_velocity for event in events if event.name == "contact_ends"]
    assert len(leaving) > 5 and (np.diff(leaving) < 0).all()
    if name != "hunt-crossley":  # its damping vanishes in slow contacts: the ball keeps oscillating
        assert component.phase == "resting"
        assert component.outputs.contact_force == pytest.approx(MASS * 9.80665, rel=1e-12)


@pytest.mark.slow
@combinations(load=[300.0, 3000.0], name=["linear-dashpot", "tsuji", "kuwabara-kono"], fast=1)
def test_a_contact_resumes_within_its_dent_under_a_load(name, load):
    """A load reverses the ball before the indentation returns to 0; F = max(f + c δ̇, 0) throughout."""
    law = LAWS[name]
    component = fm.ImpactComponent(case(law), segments=200)
    steps = [6e-6] * 60
    followed = []
    for dt in steps:
        result = component.step(dt, external_force=load)
        followed += [event.name for event in result.events]
        outputs = result.outputs
        assert outputs.contact_force >= 0.0
    indentation, velocity = integrated(law, 0.25, load=load, after=sum(steps))
    assert outputs.indentation == pytest.approx(indentation, rel=1e-8, abs=2e-9)
    assert outputs.impactor_velocity == pytest.approx(velocity, rel=1e-7, abs=2e-5)


@pytest.mark.parametrize("name", ["linear-dashpot", "tsuji", "kuwabara-kono"])
@pytest.mark.parametrize("share", [0.5, 0.9])
def test_a_contact_resumes_when_the_support_follows_the_ball(name, share):
    """A support that follows the ball lowers its rate of separation: F = max(f + c δ̇, 0) > 0 again."""
    law = LAWS[name]
    component = fm.ImpactComponent(case(law), segments=200)
    while component.phase != "separated":
        left = component.step(1.0, stop_at_events=True).outputs
    support, dt = share * left.impactor_velocity, 2e-6
    f, c = laws_in_si(law, 0.25)

    def rates(_, s):
        rate = s[1] - support
        return [rate, -max(f(max(s[0], 0.0)) + c(max(s[0], 0.0)) * rate, 0.0) / MASS]

    started = [left.indentation, left.impactor_velocity]
    exact = solve_ivp(rates, (0.0, dt), started, method="DOP853", rtol=1e-11, atol=[1e-18, 1e-14]).y[:, -1]
    result = component.step(dt, support_velocity=support)
    assert [event.name for event in result.events] == ["contact_begins"]
    assert component.phase == "unloading" and result.outputs.contact_force > 0.0
    assert result.outputs.indentation == pytest.approx(exact[0], rel=1e-12)
    assert result.outputs.impactor_velocity - left.impactor_velocity == pytest.approx(exact[1] - started[1], rel=1e-7)


def test_restitution_needs_a_velocity():
    ball = fm.Sphere("10 mm", velocity="0 m/s", mass="50 g")
    laid = fm.Scene(ball, fm.HalfSpace(), contact=fm.Contact(fm.HuntCrossley(*SPHERE, restitution=0.5)))
    with pytest.raises(ValueError, match="needs an approach velocity"):
        fm.simulate(laid)


def test_invalid_parameters_of_damped_laws_are_refused():
    for wrong in (
        lambda: fm.LinearDashpot(1e6),
        lambda: fm.LinearDashpot(1e6, restitution=0.5, damping=1.0),
        lambda: fm.Tsuji(*SPHERE, 0.0),
        lambda: fm.HuntCrossley(*SPHERE, restitution=1.5),
        lambda: fm.BrakeUnloading(LAWS["tsuji"], *SPHERE),
        lambda: quadrature.quadrature(LAWS["tsuji"], MASS, 0.25),
        lambda: quadrature.integrate(LAWS["tsuji"], MASS, 0.25),
    ):
        with pytest.raises(ValueError, match=r"restitution|damped"):
            wrong()
