"""The core over random laws of a user's: whatever `curve_of` accepts is marched with energy and momentum kept."""

import math
from dataclasses import dataclass

import numpy as np
import pytest

import film_model as fm
from film_model.base.errors import SimulationError
from film_model.core import native
from film_model.problem.curve import curve_of

DOCUMENTED = (
    native.OK,
    native.EVENT,
    native.ENDLESS,
    native.BEYOND_LAW,
    native.BAD_UNLOADING,
    native.TOO_STIFF,
    native.TOO_MANY,
)
ENERGY = 1e-9  # of the largest energy: rounding, which a turn next to the end of a stage multiplies
MOMENTUM = 1e-11  # of the largest momentum
ROUNDING = 1e-12  # of a fitted force
STEPS = 1e-7  # of the largest value: one step against two halves


@dataclass(frozen=True)
class Drawn(fm.AbstractLaw):
    """A user's law with the stages given."""

    given: tuple[fm.Stage, ...]
    damped: bool = False

    name = "drawn"
    summary = "test law"
    source = "tests"

    def scales(self, energy):
        return 1.0, 1.0

    def stages(self):
        return self.given

    def damping_factor(self, mass, velocity, length):
        return 1.0


def over_decades(rng, low, high):
    return float(low * (high / low) ** rng.random())


def power(rng, begin, before, size, last):
    """A power that begins with the force of the stage before: straight, stiffening, a root, or of all terms at once."""
    kind = rng.choice(["line", "power", "root", "both", "softening"])
    exponent = float(rng.choice([1.5, 2.0, 1.2, 3.0, 0.5, 0.8]) if kind != "root" else rng.uniform(0.3, 1.0))
    if kind == "softening" and before > 0.0 and not last:
        return fm.Power(constant=before, slope=-before * float(rng.uniform(0.05, 0.9)) / size)
    slope = over_decades(rng, 1e-2, 1e2) if kind in ("line", "both", "softening") else 0.0
    return fm.Power(before, slope, 0.0 if slope and kind != "both" else over_decades(rng, 1e-2, 1e2), exponent)


def fitted(rng, begin, before, end):
    """A function that has to be fitted, from the force of the stage before."""
    height, span, steepness = over_decades(rng, 0.1, 10.0), end - begin, float(rng.uniform(0.5, 4.0))
    if rng.random() < 0.5:
        return lambda x: before + height * np.tanh(steepness * (x - begin) / span)
    return lambda x: before + height * np.expm1(steepness * (x - begin) / span)


def unloading(rng, force, dented):
    """One of the four rules or, unless dented, none."""
    exponent = float(rng.choice([1.5, 1.0, 2.0]) if rng.random() < 0.5 else rng.uniform(1.0, 3.0))
    reload = exponent * float(rng.uniform(0.5, 1.0)) if rng.random() < 0.2 else None
    scale = force + over_decades(rng, 0.1, 10.0)
    rules = [
        {"residual": fm.Power(slope=float(rng.uniform(0.0, 0.9)), origin=0.0)},
        {"radius_ratio": fm.Power(constant=over_decades(rng, 0.3, 10.0))},
        {"secant": fm.Power(constant=scale)},
        {"shifted": fm.Power(constant=scale)},
    ]
    rule = rng.choice(rules if dented else [*rules, None])
    return None if rule is None else fm.Unloading(**rule, exponent=exponent, reload_exponent=reload)


def value(function, begin, xi):
    if not isinstance(function, fm.Power):
        return float(function(np.array([xi]))[0])
    x = xi - begin
    return function.constant + function.slope * x + function.coefficient * x**function.exponent


def drawn_law(rng):
    """One to four stages; of one stage, sometimes with damping.

    Where the force jumps between stages, a contact leaves a dent: back over the jump it would slide along it.
    """
    stages, begin, force = [], 0.0, 0.0
    count = int(rng.integers(1, 5))
    damped, jumps = count == 1 and rng.random() < 0.5, rng.random() < 0.2
    for k in range(count):
        last = k == count - 1
        end = math.inf if last and rng.random() < 0.7 else begin + over_decades(rng, 0.1, 10.0)
        fit = math.isfinite(end) and rng.random() < 0.3
        before = force * float(rng.uniform(0.8, 1.2)) if jumps else force
        f = fitted(rng, begin, before, end) if fit else power(rng, begin, before, end - begin, math.isinf(end))
        damping = fm.Power(0.1 * float(rng.random()), 0.0, float(rng.random()), 0.5) if damped else None
        stages.append(
            fm.Stage(f"{k}", begin, end, f, None if damped else unloading(rng, force, jumps and k > 0), damping=damping)
        )
        if math.isfinite(end):
            begin, force = end, max(value(f, begin, end), 0.0)
    return Drawn(tuple(stages), damped)


def energy(s):
    return 0.5 * s.nu * s.nu + s.spent - s.load * (s.xi + s.shift)


def finite(s):
    return all(map(math.isfinite, (s.time, s.xi, s.nu, s.shift, s.force, s.spent, s.force_peak)))


def march(curve, mesh, state, until, speed):
    """On to `until` through at most 60 events, with the balances at each; the last status. speed: at first touch."""
    for _ in range(60):
        begin, at_node = energy(state), not state.has_line
        scale = 0.5 * state.nu**2 + abs(state.spent) + abs(state.load) * (abs(state.xi) + abs(state.shift))
        nu, shift, time = state.nu, state.shift, state.time
        status = native.step(curve, mesh, state, max(until - state.time, 0.0))
        assert status in DOCUMENTED
        if status < 0:
            return status
        assert finite(state)
        assert state.force >= -ROUNDING * max(state.f_max, 1.0)
        scale += 0.5 * state.nu**2 + abs(state.spent) + abs(state.f_max * state.xi_max)
        if at_node and status == native.EVENT:  # the ends of lines, where they have done the law's work
            assert energy(state) <= begin + ENERGY * scale
            if state.gamma == 0.0 and state.damper == 0.0:
                assert energy(state) >= begin - ENERGY * scale
        if state.gamma == 0.0:
            assert state.shift == 0.0
        else:
            impulse = (
                speed + abs(nu) + abs(state.nu) + abs(state.load) * (state.time - time) + abs(state.shift) / state.gamma
            )
            change = state.load * (state.time - time) - (state.shift - shift) / state.gamma
            assert state.nu - nu == pytest.approx(change, abs=MOMENTUM * impulse)
        if status != native.EVENT:
            return status
    return native.TOO_MANY


def check_law(rng):
    """0 where the law is refused."""
    law = drawn_law(rng)
    compliance = over_decades(rng, 1e-2, 0.3) if rng.random() < 0.2 else 0.0
    try:
        curve = curve_of(law, compliance).native
    except (ValueError, SimulationError):
        return 0
    mesh = native.mesh(native.WORK_PRESERVING, *map(int, rng.integers(2, 20, 2)))
    for _ in range(4):
        nu, gamma = over_decades(rng, 1e-2, 10.0), 0.0 if rng.random() < 0.4 else over_decades(rng, 1e-3, 10.0)
        load = float(rng.uniform(-0.3, 0.3)) if rng.random() < 0.4 else 0.0
        start = native.Start(nu, gamma, load, 0.0, 50.0, float(rng.random()) if law.damped else 0.0)
        status, summary = native.impact(curve, mesh, start)
        assert status in DOCUMENTED
        if status == native.EVENT:
            assert all(map(math.isfinite, (summary.contact_duration, summary.final_velocity, summary.shift)))
            row = tuple(getattr(start, name) for name in native.START_DTYPE.names)
            statuses, rows = native.batch(curve, mesh, np.array([row], native.START_DTYPE))
            assert statuses[0] == status
            assert np.isfinite(rows["final_velocity"][0])
        check_halves(curve, mesh, start, float(rng.uniform(0.5, 5.0)))
    return 1


def check_halves(curve, mesh, start, dt):
    """Ten steps of dt against twenty of dt/2."""
    one, two = native.initial_state(curve, start), native.initial_state(curve, start)
    for _ in range(10):
        end = one.time + dt
        status = march(curve, mesh, one, end, start.nu)
        halves = march(curve, mesh, two, end - 0.5 * dt, start.nu)
        halves = halves if halves < 0 else march(curve, mesh, two, end, start.nu)
        if native.TOO_MANY in (status, halves) or one.contacts > 1:
            return  # swings without end, bounces at the old depth: rounding decides what follows
        assert status == halves
        if status < 0:
            return
        size = max(one.xi_max, abs(one.xi), 1e-12)
        assert one.xi == pytest.approx(two.xi, abs=STEPS * size)
        assert one.nu == pytest.approx(two.nu, abs=STEPS * max(start.nu, abs(one.nu)))
        assert one.phase == two.phase


def test_every_accepted_law_is_marched():
    rng = np.random.default_rng(20170417)
    assert sum(check_law(rng) for _ in range(60)) >= 40


@pytest.mark.slow
def test_many_accepted_laws_are_marched():
    rng = np.random.default_rng(7)
    assert sum(check_law(rng) for _ in range(800)) >= 480
