"""Plates and beams that follow the force statically: their compliances, and the contact law in series with them."""

import math

import numpy as np
import pytest
from cases import BALL, DAMPED, LAWS, MASS, STEEL, VELOCITY, combinations
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.sparse import diags, identity, kron
from scipy.sparse.linalg import spsolve

import film_model as fm
from film_model.core import native
from film_model.problem.curve import curve_of
from film_model.problem.scales import scales_of
from film_model.studies import quadrature
from film_model.targets import panel_statics, plate_statics
from film_model.targets.beam_theory import Line, line_compliance
from film_model.targets.panel_statics import compliance_and_error, panel_compliance, ritz_compliance, unit_compliance
from film_model.targets.ritz import Panel

ISOTROPIC = (1.0, 0.3, 1.0, 0.35)
OLSSON = (154.9, 4.76, 91.4, 8.97)
TWISTED = (100.0, 50.0, 20.0, 300.0)  # A = 14.5: real roots
QUIET = fm.Effects(gravity=False, target_inertia=False)


def _clamped(stiffness, size, place):
    return panel_compliance(Panel(1.0, stiffness, size, ("clamped",) * 4), place)


def _on(stiffness, law="hertz", velocity=VELOCITY, **scene):
    """The tungsten-carbide ball on a beam of a given static stiffness [N/m]."""
    beam = fm.Beam(STEEL, "300 mm", "30 mm", "10 mm", static_stiffness=f"{stiffness!r} N/m")
    ball = fm.Sphere(velocity=f"{velocity!r} m/s", **BALL)
    return fm.Scene(ball, beam, fm.Contact(law=LAWS[law]), **{"effects": QUIET, **scene})


# ---------------------------------------------------------------- compliances


@pytest.mark.slow
@pytest.mark.parametrize("place", [(0.5, 0.5), (0.35, 0.17), (0.03, 0.6)])
@pytest.mark.parametrize("stiffness", [ISOTROPIC, OLSSON, TWISTED])
def test_simply_supported_plate_against_the_double_series(stiffness, place):
    a, b = 0.2, 0.3
    d11, d12, d22, d66 = stiffness

    def navier(terms):
        i, j = np.arange(1.0, terms + 1)[:, None], np.arange(1.0, terms + 1)
        bent = d11 * (i / a) ** 4 + 2 * (d12 + 2 * d66) * (i * j / (a * b)) ** 2 + d22 * (j / b) ** 4
        shape = np.sin(i * math.pi * place[0]) * np.sin(j * math.pi * place[1])
        return 4 / (a * b) / math.pi**4 * float(np.sum(shape**2 / bent))

    series = navier(1600) + (navier(1600) - navier(800)) / 3  # the truncation error falls with the square of terms
    got = plate_statics.plate_compliance(stiffness, (a, b), (place[0] * a, place[1] * b))
    assert got == pytest.approx(series, rel=1e-9)
    turned = plate_statics.plate_compliance((d22, d12, d11, d66), (b, a), (place[1] * b, place[0] * a))
    assert turned == pytest.approx(got, rel=1e-10)


def test_plates_that_are_nearly_isotropic():
    """The roots of the series are then nearly double: the compliance passes through that of the isotropic plate as a
    parabola."""

    def compliance(anisotropy):
        return plate_statics.plate_compliance((1.0, 0.3, 1.0, (anisotropy - 0.3) / 2), (0.4, 0.3), (0.1, 0.2))

    low, one, high = (compliance(1.0 + off) for off in (-1e-3, 0.0, 1e-3))
    for off in (1e-4, 3e-5, 1e-6, 5e-7, 1e-9, 1e-12):
        for signed in (off, -off):
            x = signed / 1e-3
            expected = one + 0.5 * (high - low) * x + 0.5 * (high - 2.0 * one + low) * x * x
            assert compliance(1.0 + signed) == pytest.approx(expected, rel=1e-10)


def test_square_plates_at_the_centre():
    """86.20 D/L² simply supported, by Navier's series; 178.2 D/L² clamped."""
    centre = (0.5, 0.5)
    assert 1 / plate_statics.plate_compliance(ISOTROPIC, (1.0, 1.0), centre) == pytest.approx(86.20, abs=0.005)
    assert plate_statics.plate_compliance(ISOTROPIC, (1.0, 1.0), centre) == pytest.approx(0.0116008, abs=5e-8)
    assert _clamped(ISOTROPIC, (1.0, 1.0), centre) == pytest.approx(0.0056120, abs=1e-7)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("stiffness", "size"),
    [(ISOTROPIC, (1.0, 1.0)), pytest.param(OLSSON, (0.2, 0.25), marks=pytest.mark.slow)],
)
def test_clamped_plate_against_finite_differences(stiffness, size):
    """Clamped edges by mirroring w; the errors of the finite differences fall with the step squared."""
    d11, d12, d22, d66 = stiffness

    def centre(steps):
        n, (hx, hy) = steps - 1, (side / steps for side in size)
        second = diags([1.0, -2.0, 1.0], [-1, 0, 1], shape=(n, n))
        fourth = diags([1.0, -4.0, 6.0, -4.0, 1.0], [-2, -1, 0, 1, 2], shape=(n, n)).tolil()
        fourth[0, 0] = fourth[-1, -1] = 7.0
        one = identity(n)
        operator = d11 / hx**4 * kron(fourth, one) + d22 / hy**4 * kron(one, fourth)
        operator = operator + 2 * (d12 + 2 * d66) / (hx * hy) ** 2 * kron(second, second)
        load = np.zeros((n, n))
        load[n // 2, n // 2] = 1 / (hx * hy)
        return spsolve(operator.tocsc(), load.ravel())[(n // 2) * n + n // 2]

    coarse, fine = centre(60), centre(120)
    exact = _clamped(stiffness, size, (size[0] / 2, size[1] / 2))
    assert exact == pytest.approx(fine + (fine - coarse) / 3, rel=3e-4)
    assert exact == pytest.approx(fine, rel=2e-3)


@combinations(degree=[12, 28], fast=1)
def test_clamped_plate_is_converged(degree):
    """The reference with two edges simply supported has the same error under the force: other degrees agree."""
    size, place = (0.2, 0.3), (0.07, 0.05)
    held, like = (
        Panel(1.0, OLSSON, size, edges) for edges in (("clamped",) * 4, ("simply supported",) * 2 + ("clamped",) * 2)
    )
    d11, d12, d22, d66 = OLSSON
    exact = plate_statics.levy_compliance((d22, d12, d11, d66), size[::-1], ("clamped",) * 2, place[::-1])
    other = exact + ritz_compliance(held, place, degree) - ritz_compliance(like, place, degree)
    assert _clamped(OLSSON, size, place) == pytest.approx(other, rel=5e-5 if degree == 12 else 1e-5)
    assert ritz_compliance(held, place) < _clamped(OLSSON, size, place)  # Ritz's method is too stiff


@pytest.mark.parametrize("ends", ["simply supported", "clamped", "cantilever"])
@pytest.mark.parametrize("share", [0.5, 0.3, 0.9])
def test_beams_against_closed_forms(ends, share):
    """a²b²/(3 EI L) on simple supports, a³b³/(3 EI L³) clamped at both ends, a³/(3 EI) clamped at the first."""
    a, b = 2.0 * share, 2.0 * (1 - share)
    lever = {"simply supported": a**2 * b**2 / 2.0, "clamped": (a * b / 2.0) ** 3, "cantilever": a**3}[ends]
    both = ("clamped", "free") if ends == "cantilever" else (ends, ends)
    assert line_compliance(Line(1.0, 7.0, 2.0, both), a) == pytest.approx(lever / (3 * 7.0), rel=1e-12)


def test_defaults_of_position_and_overriding_stiffness():
    beam = fm.Beam(STEEL, "1 m", "20 mm", "10 mm", theory="euler-bernoulli")
    assert beam.compliance == pytest.approx(1 / (48 * 210e9 * 20e-3 * 10e-3**3 / 12), rel=1e-12)
    hanging = fm.Beam(STEEL, "1 m", "20 mm", "10 mm", ends="cantilever", theory="euler-bernoulli")
    assert hanging.compliance == pytest.approx(16 * beam.compliance, rel=1e-12)
    plate = fm.Plate(STEEL, "5 mm", size=["1 m", "2 m"])
    placed = fm.Plate(STEEL, "5 mm", size=["1 m", "2 m"], position=["0.5 m", "1 m"])
    assert placed.compliance == plate.compliance
    assert fm.Plate(STEEL, "5 mm", static_stiffness="2 kN/mm").compliance == 0.5e-6


# ---------------------------------------------------------------- the law in series with a spring


def _turning(law, stiffness):
    """Depth, force, dent and restitution from the balance of energy, W(δ) + F²/(2k) = mV²/2."""
    energy = 0.5 * MASS * VELOCITY**2
    length, force = law.scales(energy)
    softness, ahead = force / (stiffness * length), energy / (force * length)
    stages = law.stages()

    def at(xi):
        return next(s for s in reversed(stages) if s.begin <= xi)

    def work(xi):
        passed = [(s, min(xi, s.end)) for s in stages if s.begin < xi or s.begin == 0.0]
        return sum(float(quadrature.work_before(s, to, to - s.begin)) for s, to in passed)

    def f(xi):
        return float(quadrature.value(at(xi).force, xi, at(xi)))

    top = brentq(lambda xi: work(xi) + softness * f(xi) ** 2 / 2 - ahead, 0.0, min(1e4, stages[-1].end), xtol=1e-15)
    dent, returned, unloading = 0.0, work(top), at(top).unloading
    if unloading is not None:
        branch = quadrature.unloaded(unloading, at(top), top, f(top))
        dent, returned = branch.begin, float(quadrature.work_before(branch, top, top - branch.begin))
    speed = math.sqrt((returned + softness * f(top) ** 2 / 2) / ahead)
    return top * length, f(top) * force, dent * length, speed


JUMPS = ("big-alabo-printed",)


@combinations(law=[name for name in LAWS if name not in JUMPS + DAMPED], stiffness=[1e5, 1e7, 1e9])
def test_balance_of_energy(law, stiffness):
    depth, force, dent, speed = _turning(LAWS[law], stiffness)
    history = fm.simulate(_on(stiffness, law))
    assert history.summary["maximum_indentation"] == pytest.approx(depth, rel=1e-12)
    assert history.summary["maximum_force"] == pytest.approx(force, rel=1e-12)
    assert history.summary["permanent_indentation"] == pytest.approx(dent, rel=1e-11, abs=1e-12 * depth)
    assert history.summary["coefficient_of_restitution"] == pytest.approx(speed, rel=1e-12)
    assert history.summary["energy_radiated"] == 0.0
    many = fm.simulate_batch(_on(stiffness, law), velocity=[f"{VELOCITY} m/s"] * 9, segments=24)
    for name in ("maximum_force", "maximum_indentation", "rebound_velocity", "contact_duration"):
        assert many.summary[name] == pytest.approx([history.summary[name]] * 9, rel=2e-4), name


def test_two_springs_in_series():
    """A linear law: half a period of the oscillator of both springs in series, to rounding."""
    contact, plate = 3e6, 5e5
    both = contact * plate / (contact + plate)
    beam = fm.Beam(STEEL, "300 mm", "30 mm", "10 mm", static_stiffness=f"{plate} N/m")
    law = fm.Contact("meyer", stiffness=f"{contact} N/m", exponent=1)
    history = fm.simulate(fm.Scene(fm.Sphere(velocity="0.25 m/s", **BALL), beam, law, QUIET))
    summary, pace = history.summary, math.sqrt(both / MASS)
    assert summary["contact_duration"] == pytest.approx(math.pi / pace, rel=1e-12)
    assert summary["maximum_force"] == pytest.approx(0.25 * math.sqrt(both * MASS), rel=1e-12)
    times = np.linspace(0.0, math.pi / pace, 50)
    samples = history.sample_si(times)
    np.testing.assert_allclose(samples.contact_force, 0.25 * both / pace * np.sin(pace * times), rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(samples.indentation, samples.contact_force / contact, rtol=1e-12, atol=1e-20)
    np.testing.assert_allclose(samples.target_displacement, samples.contact_force / plate, rtol=1e-12, atol=1e-20)
    share = contact / (contact + plate)
    np.testing.assert_allclose(samples.target_velocity, share * samples.impactor_velocity, rtol=0, atol=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("law", ["hertz", "big-alabo", "saturating"])
def test_duration_against_integration_and_order(law):
    """δ̇ = v/(1 + F′/k), v̇ = −F/m along the loading curve and along the branch that leads back; fourth order."""
    stiffness, model = 3e7, LAWS[law]
    length, force = model.scales(0.5 * MASS * VELOCITY**2)
    scales = scales_of(model, 0.5 * MASS * VELOCITY**2, MASS)
    softness = force / (stiffness * length)
    depth, top, dent, _ = (x / y for x, y in zip(_turning(model, stiffness), (length, force, length, 1), strict=True))
    stages = model.stages()
    last = next(s for s in reversed(stages) if s.begin <= depth)

    def along(f, slope, start, to, speed):
        way = (lambda _, y: y[0] - to) if to < start else (lambda _, y: y[1])
        way.terminal = True
        rates = lambda _, y: (y[1] / (1 + softness * slope(y[0])), -f(y[0]))  # noqa: E731
        return solve_ivp(rates, (0.0, 1e4), (start, speed), "DOP853", events=way, rtol=1e-12, atol=1e-14)

    def loading(xi):
        stage = next(s for s in reversed(stages) if s.begin <= max(xi, 0.0))
        return float(quadrature.value(stage.force, max(xi, 0.0), stage))

    time, speed = 0.0, VELOCITY / scales.velocity
    xi = 1e-9
    time += xi / speed
    for stage in stages:
        end = min(stage.end, depth)
        if xi >= end:
            continue

        def f(x, stage=stage):
            return float(quadrature.value(stage.force, x, stage))

        def slope(x, f=f):
            return (f(x * (1 + 1e-6)) - f(x * (1 - 1e-6))) / (2e-6 * x)

        run = along(f, slope, xi, math.inf if stage is last else stage.end, speed)
        if stage is not last:
            crossing = lambda _, y, to=stage.end: y[0] - to  # noqa: E731
            crossing.terminal = True
            rates = lambda _, y, f=f, slope=slope: (y[1] / (1 + softness * slope(y[0])), -f(y[0]))  # noqa: E731
            run = solve_ivp(rates, (0.0, 1e4), (xi, speed), "DOP853", events=crossing, rtol=1e-12, atol=1e-14)
        time, xi, speed = time + run.t[-1], run.y[0, -1], run.y[1, -1]
    assert xi == pytest.approx(depth, rel=1e-9)
    back = None if last.unloading is None else quadrature.unloaded(last.unloading, last, depth, top)

    def branch(x):
        return float(quadrature.value(back.force, max(x, back.begin), back))

    def rise(x):
        return (branch(x * (1 + 1e-6)) - branch(x * (1 - 1e-6))) / (2e-6 * x)

    if last.unloading is None:
        time *= 2.0
    else:
        time += along(branch, rise, depth, dent, 0.0).t[-1]
    exact = time * scales.time
    errors = [
        abs(fm.simulate(_on(stiffness, law), segments=n).summary["contact_duration"] / exact - 1) for n in (12, 24, 48)
    ]
    assert errors[2] < 1e-6
    if law == "hertz":
        assert errors[0] / errors[1] > 10
    assert fm.simulate(_on(stiffness, law), accuracy=1e-6).summary["contact_duration"] == pytest.approx(exact, rel=1e-6)


@pytest.mark.parametrize("law", ["hertz", "stronge"])
def test_samples_at_events_equal_the_events(law):
    stiffness = 2e7
    history = fm.simulate(_on(stiffness, law), accuracy=1e-8)
    times = np.linspace(0.0, 1.2 * history.duration, 4001)
    s = history.sample_si(times)
    assert np.array_equal(s.impactor_displacement, s.indentation + s.target_displacement)
    np.testing.assert_allclose(s.target_displacement, s.contact_force / stiffness, rtol=1e-12, atol=0)
    np.testing.assert_allclose(s.relative_velocity, s.impactor_velocity - s.target_velocity, rtol=0, atol=1e-15)
    corners = np.array([event.time for event in history.events])
    smooth = np.abs(times[:, None] - corners).min(axis=1) > 3 * times[1]
    for moved, rate in ((s.target_displacement, s.target_velocity), (s.indentation, s.relative_velocity)):
        numeric = np.gradient(moved, times)
        np.testing.assert_allclose(numeric[smooth], rate[smooth], rtol=0, atol=3e-3 * VELOCITY)
    for event in history.events:
        at = history.sample_si(event.time)
        for name in ("indentation", "contact_force", "target_displacement", "impactor_displacement"):
            assert getattr(at, name) == pytest.approx(getattr(event, name), rel=1e-12, abs=1e-14), (event.name, name)
    assert fm.simulate(_on(1e15, law), accuracy=1e-8).summary["contact_duration"] == pytest.approx(
        fm.simulate(fm.Scene(_on(1.0).impactor, fm.HalfSpace(STEEL), _on(1.0, law).contact), accuracy=1e-8).summary[
            "contact_duration"
        ],
        rel=1e-6,
    )


def test_component_follows_the_simulation_and_bounces_on_the_dent():
    scene = _on(2e7, "big-alabo")
    history = fm.simulate(scene, segments=30)
    component = fm.ImpactComponent(scene, segments=30)
    events = []
    for _ in range(40):
        result = component.step(history.duration / 37.5)
        events += result.events
        at = history.sample_si(result.time)
        for name in ("indentation", "target_displacement", "impactor_displacement", "contact_force"):
            assert getattr(result.outputs, name) == pytest.approx(getattr(at, name), rel=1e-12, abs=1e-13), name
        assert result.outputs.target_velocity == pytest.approx(at.target_velocity, rel=1e-12, abs=1e-12)
    assert [event.name for event in events] == [event.name for event in history.events]
    back = component.step("1 s", external_force="5 N", stop_at_events=True).events[0]
    assert (back.name, back.stage) == ("contact_begins", "unloading")
    assert back.indentation == pytest.approx(history.summary["permanent_indentation"], rel=1e-12)


def test_rests_where_contact_and_target_carry_the_weight():
    effects = fm.Effects(gravity=True, target_inertia=False)
    history = fm.simulate(_on(1e4, velocity=1e-6, effects=effects))
    first = next(event for event in history.events if event.name == "maximum_indentation")
    weight = MASS * 9.80665  # released at rest, it reaches twice the depth of equilibrium
    assert first.target_displacement == pytest.approx(2 * weight / 1e4, rel=1e-2)
    assert first.target_displacement * 1e4 == pytest.approx(first.contact_force, rel=1e-12)


def test_a_falling_force_is_refused_on_a_compliant_target():
    law = fm.BigAlabo(LAWS["big-alabo"].effective_modulus, 0.01, 1e9, "printed")
    with pytest.raises(
        fm.SimulationError, match=r"the force must not jump, but it does where stage 'fully plastic' begins"
    ):
        curve_of(law, 0.1)

    class Falling(type(LAWS["saturating"])):
        def stages(self):
            return (fm.Stage("falling", 0.0, 3.0, lambda x: np.sin(x)),)

    assert curve_of(Falling(), 0.5).native.compliance == 0.5
    with pytest.raises(fm.SimulationError, match="would snap through"):
        curve_of(Falling(), 1.5)
    assert native.BEYOND_LAW == -4


@pytest.mark.parametrize("law", DAMPED)
def test_damped_laws_are_refused(law):
    with pytest.raises(fm.SimulationError, match="a damped law cannot be simulated on a beam with edges"):
        fm.simulate(_on(1e6, law))
    with pytest.raises(fm.SimulationError, match="damped laws are not supported on targets with a static stiffness"):
        curve_of(LAWS[law], 0.1)


@pytest.mark.parametrize("bed", [0.0, 1e4, 1e8])
@pytest.mark.parametrize("place", [(0.5, 0.35), (0.03, 0.2)])
def test_beds_in_closed_form(bed, place):
    """Navier's series: the bed's part of it converges as the eighth power of the number of half-waves."""
    stiffness, size, n = (1.0, 0.3, 1.0, 0.35), (1.0, 0.7), np.arange(1.0, 1501.0)
    u, v = (n / size[0])[:, None] ** 2, (n / size[1]) ** 2
    square = math.pi**4 * (u + v) ** 2
    seen = np.sin(n * math.pi * place[0])[:, None] * np.sin(n * math.pi * place[1] / size[1])
    less = 4 / math.prod(size) * float(np.sum(seen**2 * (bed / square / (square + bed))))
    exact = plate_statics.plate_compliance(stiffness, size, place) - less
    got, error = compliance_and_error(Panel(1.0, stiffness, size, ("simply supported",) * 4, foundation=bed), place)
    assert abs(got - exact) <= error
    assert got == pytest.approx(exact, rel=5e-8)


@pytest.mark.parametrize("ends", [("free", "free"), ("clamped", "free"), ("free", "clamped")])
def test_springs_and_beds_of_plates_between_simple_supports(ends):
    """Polynomials of high degree, whose deflections under the force are too small by their error on another plate."""
    stiffness, size, place = (1.3, 0.3, 0.8, 0.4), (1.0, 0.6), (0.4, 0.25)
    springs = tuple(30.0 if end == "free" else 0.0 for end in ends)
    held = Panel(1.0, stiffness, size, (*ends, *("simply supported",) * 2), (*springs, 0.0, 0.0), 500.0)
    plain = Panel(1.0, stiffness, size, (*ends, *("simply supported",) * 2))
    lacking = panel_compliance(plain, place) - ritz_compliance(plain, place, 32)
    assert panel_compliance(held, place) == pytest.approx(ritz_compliance(held, place, 32) + lacking, rel=1e-6)


@pytest.mark.slow
def test_the_bound_on_the_error_of_static_deflections():
    """Plates struck beside free and clamped edges, against polynomials of degree 44: 14 of 15 at least are bounded."""
    draw, bounded, most = np.random.default_rng(5), 0, 0.0
    for _ in range(15):
        edges = ("free", str(draw.choice(["clamped", "free"])), "clamped", str(draw.choice(["clamped", "free"])))
        size, bed = (1.0, float(draw.uniform(0.5, 2.0))), float(draw.choice([0.0, 1e4]))
        own = Panel(1.0, (1.0, 0.3, 1.0, 0.35), size, edges, foundation=bed)
        place = (float(draw.uniform(0.0, 0.1)), float(draw.uniform(0.1, 0.9)) * size[1])
        got, error = compliance_and_error(own, place)
        with pytest.MonkeyPatch.context() as changed:
            changed.setattr(panel_statics, "STATIC_DEGREE", 44)
            exact = unit_compliance.__wrapped__(own, place)[0]
        bounded, most = bounded + (abs(got - exact) <= error), max(most, error / got)
    assert bounded >= 14
    assert most < 3e-3
