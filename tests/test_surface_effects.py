"""Roughness and the squeeze film, against an integrated model, measured relations, and scenes in every form."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from scipy import integrate, special

import film_datasets as fd
import film_model as fm
from film_model.base.arrays import AGREEMENT
from film_model.cli.main import main
from film_model.effects.choose import choose
from film_model.effects.effect import NOT_JUDGED, NOT_MODELLED, NOT_NEEDED
from film_model.effects.surroundings import squeezed
from film_model.explorer.content import Content
from film_model.explorer.inputs import inputs_of

BALL = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3, "density": "7850 kg/m^3"}


def scene(velocity="1 m/s", law="hertz", **contact):
    return fm.Scene(fm.Sphere("5 mm", material=BALL, velocity=velocity), fm.HalfSpace(BALL), fm.Contact(law, **contact))


def effect_of(of, name):
    return next(effect for effect in choose(of).effects if effect.name == name)


# Greenwood and Tripp's rough sphere. Heights are in σ, radii in √(2 R σ), pressures in E √(σ/(8 R)).


def disc(at, radius):
    """Displacement of a half-space at `at` under unit pressure on a disc (Johnson 1985, section 3.4), times E/2."""
    k = (np.minimum(at, radius) / np.maximum(at, radius)) ** 2
    outside = at * (special.ellipe(k) - (1 - k) * special.ellipk(np.minimum(k, 1 - 1e-15)))
    return 2 / math.pi * np.where(at < radius, radius * special.ellipe(k), outside)


GAPS = np.linspace(-60.0, 8.0, 3401)


def moment(power):
    """∫ (z − d)^power φ(z) dz above d, at GAPS: parabolic cylinder functions, by quadrature in t² = z − d."""
    nodes, weights = np.polynomial.legendre.leggauss(200)
    below = np.maximum(GAPS, -9.0)[:, None]
    low, high = np.sqrt(below - GAPS[:, None]), np.sqrt(9.0 - GAPS[:, None].clip(max=8.0))
    t = low + 0.5 * (high - low) * (nodes + 1)
    height = GAPS[:, None] + t**2
    part = (height - GAPS[:, None]) ** power * np.exp(-0.5 * height**2) / math.sqrt(2 * math.pi)
    return np.sum(part * 2 * t * weights, axis=1) * 0.5 * (high - low)[:, 0]


PRESSURE, SLOPE = moment(1.5), -1.5 * moment(0.5)


def rough_sphere(mu, count):
    """Approach of the mean planes/σ, force and central pressure: d = d₀ + r² + u(p) and p = μ ∫(z − d)^{3/2} φ."""
    found = []
    for lowest in np.concatenate([np.arange(4.0, -6.0, -0.2), -np.geomspace(6.0, 110.0, 40)]):
        edges = math.sqrt(max(4.5 - lowest, 1.0) + 4.0) * np.linspace(0.0, 1.0, count + 1)
        at = 0.5 * (edges[1:] + edges[:-1])
        reach = disc(at[:, None], np.maximum(edges, 1e-12))
        bulk = reach[:, 1:] - reach[:, :-1]
        gap = np.maximum(lowest + at**2, -1.0)
        for _ in range(200):
            pressure, slope = (mu * np.interp(gap, GAPS, table) for table in (PRESSURE, SLOPE))
            miss = gap - (lowest + at**2 + bulk @ pressure)
            step = np.linalg.solve(np.eye(count) - bulk * slope, miss)
            gap -= min(1.0, 2.0 / abs(step).max()) * step
            if abs(step).max() < 1e-8:
                break
        else:
            pytest.fail(f"Newton's iteration at {lowest}")
        pressure = mu * np.interp(gap, GAPS, PRESSURE)
        found.append((-lowest, math.pi * np.sum(pressure * np.diff(edges**2)), pressure[0]))
    return np.array(found).T


def changes(mu, count):
    """α of Hertz's contact of the same energy; relative changes of indentation and force, from 1 % of the force."""
    approach, force, _ = rough_sphere(mu, count)
    work = integrate.cumulative_trapezoid(force, approach, initial=0.0)
    found = []
    for end in np.flatnonzero(force > 100 * force[0]):
        hertz = (1.5 * force[end] / math.sqrt(8)) ** (2 / 3)  # a₀²/(R σ), which is δ/σ
        energy = work[end] / (0.4 * force[end] * hertz)
        start = np.interp(math.log(0.01 * force[end]), np.log(force), approach)
        smooth = hertz * energy**0.4
        there = (1 - 0.01 ** (2 / 3)) * smooth
        found.append((1 / smooth, (approach[end] - start) / there - 1, 1 - energy**-0.6))
    return np.array(found).T


@pytest.mark.parametrize("mu", [4.0, *(pytest.param(mu, marks=pytest.mark.slow) for mu in (1.0, 2.0, 8.0, 17.0))])
def test_the_change_by_roughness_is_right_within_a_factor_of_two(mu):
    alpha, indentation, force = changes(mu, 60)
    judged = (alpha > 0.02) & (alpha < 0.75)
    assert np.count_nonzero(judged) > 20
    assert np.all((indentation[judged] > 0.5 * alpha[judged]) & (indentation[judged] < 2.0 * alpha[judged]))
    assert np.all((force[judged] > 0.25 * alpha[judged]) & (force[judged] < alpha[judged]))


def test_the_rough_sphere_tends_to_hertz():
    approach, force, pressure = rough_sphere(4.0, 60)
    radius = (1.5 * force / math.sqrt(8)) ** (1 / 3)  # a₀/√(R σ)
    alpha, peak = radius**-2, 1.5 * force / (0.5 * math.pi * radius**2)
    off = 1 - np.interp(-0.05, -alpha, pressure / peak)
    assert 0.0 < off < 0.07  # Greenwood, Johnson & Matsubara 1984: up to 7 %
    slope = np.gradient(force, approach) / (1.5 * force / radius**2)
    assert np.interp(-0.01, -alpha, slope) == pytest.approx(1.0, abs=0.01)
    assert np.interp(-0.5, -alpha, slope) < 0.9


def test_roughness_is_judged_by_its_height_over_the_indentation():
    polished, ground = scene(roughness="20 nm"), scene("10 mm/s", roughness="0.8 um")
    deepest = fm.simulate(polished).summary["maximum_indentation"]
    found = effect_of(polished, "roughness")
    assert found.value == pytest.approx(20e-9 / deepest, rel=1e-2) and found.change == found.value
    assert found.state == NOT_NEEDED and found.threshold == 0.01
    assert effect_of(ground, "roughness").state == NOT_MODELLED
    (warning,) = fm.simulate(ground).warnings
    assert "roughness" in warning
    assert effect_of(scene(roughness="0 m"), "roughness").change == 0.0
    assert effect_of(scene(), "roughness").state == NOT_JUDGED


# The film: a sphere of 6 mm in silicone oil on glass, and one of 3 mm, as in Gondret, Lance & Petit 2002.


def film(stokes, radius=3e-3, velocity=0.5, restitution=0.97, height=None, modulus=60e9):
    mass = 8000 * 4 / 3 * math.pi * radius**3
    viscosity = mass * velocity / (6 * math.pi * radius**2 * np.asarray(stokes))
    return squeezed(
        mass, radius, velocity, viscosity, modulus, 1e-4 * radius if height is None else height, restitution
    )


def test_the_film_takes_what_measurements_say_within_a_factor_of_two():
    stokes = np.geomspace(11.0, 2000.0, 40)
    measured = 1 - np.exp(-35 / stokes)  # Legendre et al. 2005, of e over that without a liquid
    for radius in (1.5e-3, 3e-3):
        found = film(stokes, radius)
        assert found.stokes == pytest.approx(stokes, rel=1e-12)
        assert np.all((found.share < 2 * measured) & (found.share > 0.5 * measured))
    assert film(10.0).share == 1.0  # Joseph et al. 2001: no rebound below about 10 …
    assert film(500.0).share < 0.05  # … and that without a liquid above 500


def test_the_film_is_the_motion_against_lubrication():
    radius, gap, stokes, dry = 3e-3, 3e-7, 60.0, 0.8

    def resists(_, state):  # gaps in R, velocities in V: St dv/dt = −v/h
        return [state[1], -state[1] / (stokes * state[0])]

    def passes(at):
        def event(_, state):
            return state[0] - at

        event.terminal = True
        return event

    close = integrate.solve_ivp(resists, (0, 10), [1.0, -1.0], events=passes(gap / radius), rtol=1e-10, atol=1e-12)
    back = [gap / radius, -dry * close.y[1, -1]]
    away = integrate.solve_ivp(resists, (0, 10), back, events=passes(1.0), rtol=1e-10, atol=1e-12)
    found = film(stokes, radius, restitution=dry, height=gap)
    assert away.y[1, -1] == pytest.approx(dry * (1 - float(found.share)), rel=1e-6)


def test_the_film_of_many_is_that_of_each():
    rng = np.random.default_rng(7)
    columns = np.exp(rng.uniform(-3, 3, (7, 20))) * np.array([[1e-3], [5e-3], [1.0], [1e-3], [1e11], [1e-7], [0.5]])
    columns[5, ::3] = 0.0
    together = squeezed(*columns)
    for place in range(20):
        alone = squeezed(*columns[:, place].tolist())
        assert [float(x[place]) for x in together] == pytest.approx(list(alone), rel=AGREEMENT)


def test_the_film_in_a_scene():
    water = effect_of(scene(fluid_viscosity="1 mPa*s"), "squeeze_film")
    mass = 7850 * 4 / 3 * math.pi * 5e-3**3
    assert water.value == pytest.approx(mass / (6 * math.pi * 1e-3 * 5e-3**2), rel=1e-12)
    assert (water.state, effect_of(scene(), "squeeze_film").state) == (NOT_NEEDED, NOT_JUDGED)
    oil = scene("0.1 m/s", fluid_viscosity="0.1 Pa*s", roughness="1 nm")
    found = effect_of(oil, "squeeze_film")
    assert found.state == NOT_MODELLED and "below a Stokes number of about 10" in found.warning
    assert "elastic flattening" in found.reason
    at = water.value / water.threshold
    assert effect_of(scene(f"{1 / at!r} m/s", fluid_viscosity="1 mPa*s"), "squeeze_film").change == pytest.approx(
        0.01, rel=0.1
    )
    spring = fm.Scene(
        fm.Sphere("5 mm", mass="4 g", velocity="1 m/s"),
        fm.HalfSpace(),
        fm.Contact("meyer", stiffness="1e6 N/m", exponent=1.0, fluid_viscosity="1 mPa*s"),
    )
    assert effect_of(spring, "squeeze_film").reason == "missing: contact.roughness, or an effective modulus"
    rough = effect_of(spring.replace({"contact.roughness": "1 um"}), "squeeze_film")
    assert "the roughness" in rough.reason and rough.change is not None


def test_both_keys_are_read_written_swept_and_refused(tmp_path, capsys):
    given = scene("0.1 m/s", roughness="0.8 um", fluid_viscosity="20 mPa*s")
    assert (given.contact.roughness, given.contact.fluid_viscosity) == (0.8e-6, 0.02)
    path = tmp_path / "oil.toml"
    path.write_text(given.to_toml(), encoding="utf-8")
    assert fm.Scene.from_toml(path) == given
    assert main(["explain", str(path)]) == 0
    out = capsys.readouterr().out
    assert "roughness" in out and "squeeze film" in out
    assert main(["run", str(path)]) == 0
    err = capsys.readouterr().err
    assert "not modelled: roughness" in err and "not modelled: squeeze film" in err
    swept = fd.sweep(given, {"contact.roughness": ["10 nm", "1 um"], "contact.fluid_viscosity": ["1 mPa*s"]})
    assert swept["contact_fluid_viscosity"].attrs["units"] == "Pa s"
    assert "roughness" in swept.attrs["warnings"]
    for key, bad in (("roughness", "-1 um"), ("fluid_viscosity", "-1 mPa*s")):
        with pytest.raises(fm.SceneError) as wrong:
            scene(**{key: bad})
        (line,) = str(wrong.value).splitlines()
        assert line.startswith(f'Contact.{key}: "{bad}" must be >')


def test_the_page_shows_what_was_judged_and_offers_no_entry_for_it():
    given = scene("0.1 m/s", roughness="0.8 um", fluid_viscosity="20 mPa*s")
    assert not {"contact.roughness", "contact.fluid_viscosity"} & {one.path for one in inputs_of(given)}
    shown = json.dumps(Content([("a", given)]).table(), default=str)
    assert effect_of(given, "squeeze_film").reason in shown
