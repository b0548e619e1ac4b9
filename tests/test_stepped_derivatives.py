"""Derivatives on vibrating targets: balances, another integrator, more modes, lost contacts, what is refused."""

import numpy as np
import pytest
from cases import combinations

import film_datasets as fd
import film_model as fm
from film_model.effects.choose import problem_of
from film_model.solve import structures, vibration
from film_model.studies import modal_reference

BEAM = fm.Beam("mild steel", width="10 mm", thickness="5 mm", length="100 mm")
PLATE = fm.Plate("mild steel", thickness="3 mm", size=["100 mm", "150 mm"])


def struck(target=BEAM, velocity="1 m/s", law="hertz", radius="10 mm"):
    ball = fm.Sphere(radius, velocity, material="bearing steel")
    return fm.Scene(ball, target, fm.Contact(law), fm.Effects(gravity=False))


def powers(history, path):
    """(x/y) dy/dx of every value, and the estimated errors over the same."""
    found = history.derivatives
    value = found.entries[path].value
    known = {name: y for name, y in history.summary.items() if y and found.values[name][path] is not None}
    power = {name: found.values[name][path] * value / y for name, y in known.items()}
    return power, {name: found.errors[name][path] * max(abs(power[name]), 1.0) for name in known}


@pytest.mark.parametrize("target", [BEAM, PLATE], ids=["beam", "plate"])
def test_energy_and_momentum_are_kept(target):
    """½ m V² is that of the rebound and of the modes, and m (V − v) the impulse: so are their derivatives."""
    history = fm.simulate(struck(target), accuracy=1e-3, derivatives=["impactor.velocity"])
    values, slope = history.summary, history.derivatives.values
    mass, by = history.problem.mass, "impactor.velocity"
    kept = mass * values["rebound_velocity"] * slope["rebound_velocity"][by] + slope["energy_radiated"][by]
    assert kept == pytest.approx(mass * 1.0, rel=3e-7)
    assert slope["impulse"][by] == pytest.approx(mass * (1.0 - slope["rebound_velocity"][by]), rel=1e-8)


@combinations(path=["impactor.radius", "target.thickness"], law=["hertz", "stronge"], fast=1)
def test_the_estimate_bounds_the_error(path, law):
    """Against the same with more modes."""
    rough, fine = (fm.simulate(struck(law=law), accuracy=a, derivatives=[path]) for a in (3e-3, 3e-5))
    (found, errors), (exact, _) = powers(rough, path), powers(fine, path)
    assert len(found) > 8
    for name in found.keys() & exact.keys():
        assert abs(found[name] - exact[name]) <= errors[name] + 1e-7, name


def test_numbers_that_leave_the_unit_of_time_scale_everything():
    """All moduli and densities 1 % higher: forces are 1 % higher, and all motion is the same."""
    paths = [f"{body}.material.{name}" for body in ("impactor", "target") for name in ("youngs_modulus", "density")]
    history = fm.simulate(struck(), accuracy=1e-3, derivatives=paths)
    sums = {
        name: sum(powers(history, path)[0][name] for path in paths) for name in ("maximum_force", "rebound_velocity")
    }
    assert sums == pytest.approx({"maximum_force": 1.0, "rebound_velocity": 0.0}, abs=1e-6)


@pytest.mark.slow
def test_against_dop853():
    """Differences of impacts on the same modes by another integrator, with another step."""
    one = struck(PLATE, law="stronge")
    history = fm.simulate(one, accuracy=1e-2, derivatives=["impactor.velocity"])
    run, step, weights = history.vibration, 1e-3, np.array([1.0, -8.0, 0.0, 8.0, -1.0]) / 12.0
    runs = []
    for k in range(-2, 3):
        problem = problem_of(one.replace({"impactor.velocity": f"{1.0 + k * step!r} m/s"}))
        scales = problem.scales
        made = structures.structure_of(PLATE, run.highest, scales.time)
        frequency, share = made.tables.frequency * scales.time, made.tables.share * problem.mass
        rest, limit = made.omitted * scales.force / scales.length, vibration.time_limit(problem, PLATE) / scales.time
        other = modal_reference.integrate(problem, frequency, share, rest, 1.0, limit, 1e-10)
        core = other.summary
        motion = core.contact_duration * scales.time, core.final_velocity * scales.velocity
        runs.append((core.maximum_force * scales.force, *motion))
    exact = weights @ np.array(runs) / step
    values = history.derivatives.values
    found = [values[name]["impactor.velocity"] for name in ("maximum_force", "contact_duration", "rebound_velocity")]
    assert found == pytest.approx(exact.tolist(), rel=2e-6)


@pytest.mark.slow
def test_a_contact_that_is_just_lost_gives_one_sided_derivatives():
    def contacts(velocity, **options):
        history = fm.simulate(struck(velocity=f"{velocity!r} m/s"), accuracy=1e-5, **options)
        return sum(event.name == "contact_ends" for event in history.events), history

    speeds = np.geomspace(0.2, 5.0, 8)
    counts = [contacts(float(speed))[0] for speed in speeds]
    first = int(np.flatnonzero(np.diff(counts))[0])
    low, high = float(speeds[first]), float(speeds[first + 1])
    while high / low > 1.0 + 1e-5:
        middle = (low + high) / 2.0
        low, high = (middle, high) if contacts(middle)[0] == counts[first] else (low, middle)
    _, near = contacts(low, derivatives=["impactor.velocity"])
    said = [warning for warning in near.derivatives.warnings if "for smaller values" in warning]
    assert len(said) == 1 and "contact ends otherwise" in said[0]


@pytest.mark.slow
def test_crowded_frequencies_are_refused():
    wide = fm.Plate("mild steel", thickness="2 mm", size=["600 mm", "470 mm"], theory="kirchhoff")
    one = struck(wide).replace({"effects.boundary_reflections": True})
    with pytest.raises(fm.SimulationError, match=r"a derivative by target\.thickness is not supported: it changes the"):
        fm.simulate(one, accuracy=3e-2, derivatives=["target.thickness"])
    assert fm.simulate(one, accuracy=3e-2, derivatives=["impactor.velocity"]).derivatives.warnings


def rows_agree(one, by, **options):
    """A sweep of two velocities, whose second impact is that of the scene, against `simulate`; the sweep."""
    velocities = [f"{factor * one.impactor.velocity} m/s" for factor in (0.8, 1.0)]
    ds = fd.sweep(one, {"impactor.velocity": velocities}, derivatives=by, **options)
    assert fd.validate(ds) == []
    found = fm.simulate(one, derivatives=by).derivatives
    for path in by:
        name, own = path.replace(".", "_"), [row[path] for row in found.errors.values() if row[path] is not None]
        for quantity, row in found.values.items():
            if row[path] is not None:
                assert float(ds[f"d_{quantity}_d_{name}"][1]) == row[path], (quantity, path)
        assert float(ds[f"derivative_accuracy_{name}"][1]) == max(own)
        assert not ds[f"derivative_side_{name}"].values.any()
    return ds


def test_rows_on_a_vibrating_target_have_the_derivatives_of_their_simulation():
    one = struck().replace({"solver.accuracy": 1e-3})
    ds = rows_agree(one, ["impactor.velocity", "target.thickness"])
    assert float(ds.derivative_accuracy_impactor_velocity.max()) > 1e-4  # of the omitted modes, and so larger


def test_rows_of_viscoelastic_bodies_have_the_derivatives_of_their_simulation():
    rubber = fm.Material("rubber", "10 MPa", 0.45, "1100 kg/m^3", prony=[[0.5, "1 ms"]])
    one = fm.Scene(fm.Sphere("10 mm", "1 m/s", material="bearing steel"), fm.HalfSpace(rubber), fm.Contact("hertz"))
    assert fm.simulate(one).relaxed is not None
    rows_agree(one, ["impactor.velocity"])


def test_rows_by_a_number_that_is_not_supported_have_none():
    wide = fm.Plate("mild steel", thickness="2 mm", size=["600 mm", "470 mm"])
    one = struck(wide).replace({"effects.boundary_reflections": True, "solver.accuracy": 3e-2})
    ds = fd.sweep(one, {"impactor.velocity": ["1 m/s"]}, derivatives=["impactor.velocity", "target.thickness"])
    assert ds.derivative_side_impactor_velocity.values.tolist() == [0]
    assert ds.derivative_side_target_thickness.values.tolist() == [2]
    assert (
        "no derivatives by target.thickness in 1 impacts: kinks, or crowded natural frequencies" in ds.attrs["warnings"]
    )
