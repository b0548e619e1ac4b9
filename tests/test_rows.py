"""Rows of a sweep give what the scene of each row gives."""

import dataclasses

import numpy as np
import pytest
from cases import LAWS, STEEL, TARGETS, combinations, scene

import film_model as fm
from film_model.base.errors import NO_VELOCITY
from film_model.core import native
from film_model.effects.choose import problem_of
from film_model.effects.many import problems_of
from film_model.problem.curve import curve_of
from film_model.problem.varied import varied_of
from film_model.solve.batch import STATUSES, simulate_many
from film_model.solve.history import SUMMARY

STIFFNESS = {"D11": "154.9 N*m", "D12": "4.76 N*m", "D22": "91.4 N*m", "D66": "8.97 N*m"}
BALL = {"radius": "10 mm", "velocity": "0.3 m/s", "material": "WC, Big-Alabo 2017"}

BENDS = fm.Effects(boundary_reflections=True, target_inertia=False)

CASES = {
    "half-space": (fm.Scene(fm.Sphere(**BALL), TARGETS["half-space"]), ["impactor.radius", "target.material.density"]),
    "curved": (
        fm.Scene(fm.Sphere(**BALL), fm.HalfSpace(STEEL, radius="80 mm")),
        ["target.radius", "impactor.material.youngs_modulus", "target.material.poissons_ratio"],
    ),
    "plate": (
        fm.Scene(fm.Sphere(**BALL), TARGETS["plate"]),
        ["target.thickness", "target.material.density", "target.material.poissons_ratio"],
    ),
    "orthotropic plate": (
        fm.Scene(fm.Sphere(**BALL), fm.Plate(mass_per_area="40 kg/m^2", bending_stiffness=STIFFNESS),
                 fm.Contact(effective_modulus="20 GPa")),
        ["target.bending_stiffness.D11", "target.bending_stiffness.D66", "contact.effective_modulus"],
    ),
    "paper's plate": (
        fm.Scene(fm.Sphere(**BALL), fm.Plate(mass_per_area="40 kg/m^2", bending_stiffness=STIFFNESS,
                 impedance_formula="paper"), fm.Contact(effective_modulus="20 GPa")),
        ["target.bending_stiffness.D22", "target.mass_per_area"],
    ),
    "rod": (fm.Scene(fm.Sphere(**BALL), TARGETS["rod"]), ["target.diameter", "target.material.youngs_modulus"]),
    "body": (fm.Scene(fm.Sphere(**BALL), TARGETS["body"]), ["target.radius", "target.velocity"]),
    "fall": (
        fm.Scene(fm.Sphere("10 mm", drop_height="3 mm", material="bearing steel"), TARGETS["half-space"]),
        ["impactor.drop_height"],
    ),
    "meyer": (
        fm.Scene(fm.Sphere(**BALL), TARGETS["plate"],
                 fm.Contact("meyer", stiffness="2e9 N/m^1.3", exponent=1.3, initial_indentation="2 um")),
        ["contact.initial_indentation"],
    ),
    "two that yield": (
        fm.Scene(fm.Sphere("10 mm", velocity="0.3 m/s", material="aluminium 6061-T6"), TARGETS["half-space"],
                 fm.Contact("kogut-etsion", hardness="2.8 GPa")),
        ["contact.hardness", "impactor.material.yield_strength"],
    ),
    "damped": (
        fm.Scene(fm.Sphere(**BALL), TARGETS["half-space"], fm.Contact("linear-dashpot", stiffness="4e7 N/m",
                 damping="500 N*s/m")),
        ["contact.damping", "contact.stiffness"],
    ),
    "Brake's unloading": (
        fm.Scene(fm.Sphere(**BALL), TARGETS["plate"],
                 fm.Contact("big-alabo", effective_modulus="150 GPa", unloading="brake")),
        ["contact.effective_modulus", "impactor.radius"],
    ),
    "plate that bends": (
        fm.Scene(fm.Sphere(**BALL), fm.Plate(STEEL, "10 mm", size=["200 mm", "300 mm"]), effects=BENDS),
        ["target.thickness", "target.material.youngs_modulus", "target.material.poissons_ratio"],
    ),
    "beam that bends": (
        fm.Scene(fm.Sphere(**BALL), fm.Beam(STEEL, "300 mm", "30 mm", "10 mm", ends="clamped", position="120 mm"),
                 fm.Contact("big-alabo"), fm.Effects(target_inertia=False, tolerance=0.05)),
        ["target.length", "target.width", "target.position", "target.thickness"],
    ),
    "spring in series": (
        fm.Scene(fm.Sphere(**BALL), fm.Beam(STEEL, "300 mm", "30 mm", "10 mm", static_stiffness="3e6 N/m"),
                 fm.Contact("walton-braun", loading_stiffness="2e7 N/m", unloading_stiffness="5e7 N/m")),
        ["target.static_stiffness", "contact.loading_stiffness"],
    ),
    "fitted in series": (
        fm.Scene(fm.Sphere(**BALL), fm.Beam(STEEL, "300 mm", "30 mm", "10 mm", static_stiffness="3e7 N/m"),
                 fm.Contact("jackson-green", poissons_ratio=0.3, yield_strength="0.4 GPa"), BENDS),
        ["target.static_stiffness", "contact.poissons_ratio", "contact.yield_strength"],
    ),
    "yields and sticks": (
        fm.Scene(fm.Sphere(**BALL), TARGETS["half-space"],
                 fm.Contact("thornton-ning", yield_pressure="0.6 GPa", work_of_adhesion="30 J/m^2")),
        ["impactor.radius", "contact.work_of_adhesion", "contact.yield_pressure"],
    ),
}  # fmt: skip
IN_SERIES_OR_SIMILAR = list(CASES)[-5:]
UNITS = {"poissons_ratio": "", "D11": "N*m", "D22": "N*m", "D66": "N*m", "density": "kg/m^3", "mass_per_area": "kg/m^2",
         "youngs_modulus": "Pa", "effective_modulus": "Pa", "yield_strength": "Pa", "velocity": "m/s",
         "hardness": "Pa", "stiffness": "N/m", "damping": "N*s/m", "static_stiffness": "N/m",
         "loading_stiffness": "N/m", "yield_pressure": "Pa", "work_of_adhesion": "J/m^2"}  # fmt: skip


def value(case, path):
    owner = case
    for name in path.split("."):
        owner = owner.parameters[name] if name in getattr(owner, "parameters", {}) else getattr(owner, name)
    return owner


@pytest.mark.parametrize("name", list(CASES))
def test_rows_are_the_scenes_of_the_rows(name):
    base, paths = CASES[name]
    if base.target.material is not None:
        paths = [*paths, "target.material.yield_strength"]
    paths = paths if name == "fall" else [*paths, "impactor.velocity"]
    rng = np.random.default_rng(7)
    factors = np.exp(rng.uniform(-0.25, 0.25, (12, len(paths))))
    factors[:, -1] **= 4  # velocities, on both sides of yield
    columns = {path: value(base, path) * factors[:, k] for k, path in enumerate(paths)}
    solver = fm.Solver(accuracy=1e-9)
    result = simulate_many(base, columns, solver)
    assert (result.status == native.EVENT).all()
    for row in range(12):
        units = {path: UNITS.get(path.rpartition(".")[2], "m") for path in columns}
        own = base.replace({path: f"{float(v[row])!r} {units[path]}".strip() for path, v in columns.items()})
        history = fm.simulate(own, accuracy=1e-10)
        assert result.laws[result.law[row]] == history.problem.law.name
        for key in SUMMARY:
            if history.summary[key] is None:
                assert np.isnan(result.summary[key][row])
                continue
            scale = own.kinetic_energy if "energy" in key else abs(history.summary[key])
            if key == "permanent_indentation":
                scale = history.summary["maximum_indentation"]
            if key == "rebound_velocity":
                scale = max(scale, 1e-3 * own.approach_velocity)
            assert abs(result.summary[key][row] - history.summary[key]) <= 1.1e-9 * scale, (key, row)


@pytest.mark.parametrize("name", list(CASES))
def test_whole_arrays_serve_the_usual_scenes(name, monkeypatch):
    """Row by row is for what they cannot do: it takes a thousand times as long."""

    def one_by_one(*_):
        raise AssertionError("arrays did not serve")

    monkeypatch.setattr("film_model.effects.many._one_by_one", one_by_one)
    base, _ = CASES[name]
    path, values = ("impactor.drop_height", (1e-3, 0.2)) if name == "fall" else ("impactor.velocity", (0.12, 2.0))
    columns = {path: np.geomspace(*values, 40), "impactor.radius": np.linspace(9e-3, 11e-3, 40)}
    assert (simulate_many(base, columns).status >= 0).all()
    if name in IN_SERIES_OR_SIMILAR:  # each with a curve of its own
        columns |= {path: value(base, path) * np.linspace(0.97, 1.03, 40) for path in CASES[name][1]}
        assert (simulate_many(base, columns).status >= 0).all()


@pytest.mark.slow
@pytest.mark.parametrize("law", ["hertz", "meyer", "big-alabo", "stronge"])
def test_weight_counts_where_it_counts_alone(law):
    """Slow impacts are simulated with gravity, each by its own number."""
    base = scene(law, "plate", accuracy=1e-7)
    speeds = np.geomspace(1e-5, 1.0, 25)
    result = simulate_many(base, {"impactor.velocity": speeds})
    for row, speed in enumerate(speeds.tolist()):
        history = fm.simulate(base.replace({"impactor.velocity": f"{speed!r} m/s"}), accuracy=1e-8)
        expected = {"contact ended": native.EVENT, "the impactor came to rest in contact": native.ENDLESS}
        assert result.status[row] == expected.get(history.outcome.value, native.OK)
        assert result.summary["maximum_force"][row] == pytest.approx(history.summary["maximum_force"], rel=2e-7)
        rebound = history.summary["rebound_velocity"]
        assert np.isnan(result.summary["rebound_velocity"][row]) == (rebound is None)


@pytest.mark.slow
@combinations(
    law=["auto", "hertz", "meyer", "stronge", "yigit-christoforou", "tabulated", "tsuji"],
    target=["half-space", "plate", "thin plate", "rod"],
    fast=4,
)
def test_effects_are_those_of_each_impact(law, target):
    """What is decided for neighbours together is what is decided for each alone."""
    count = 60 if law == "tsuji" else 250
    base = scene("hertz" if law == "auto" else law, target)
    base = base.replace({"contact.law": "auto"}) if law == "auto" else base
    rng = np.random.default_rng(11)
    columns = {"impactor.velocity": 10 ** rng.uniform(-3.5, 0.5, count), "impactor.mass": rng.uniform(0.02, 0.2, count)}
    found = problems_of(base, columns, count)
    assert sum(rows.impacts.index.size for rows in found) == count
    effects = {"weight": set(), "motion": set(), "law": set()}
    for rows in found:
        for place, row in enumerate(rows.impacts.index.tolist()):
            speed, mass = (float(values[row]) for values in columns.values())
            own = base.replace({"impactor.velocity": f"{speed!r} m/s", "impactor.mass": f"{mass!r} kg"})
            problem = problem_of(own)
            start = rows.start[place]
            assert rows.law.name == problem.law.name
            assert (start["load"] > 0.0) == (problem.load > 0.0)
            assert (start["gamma"] > 0.0) == (problem.gamma > 0.0)
            assert start["damping"] == pytest.approx(problem.damping, rel=1e-12)
            for name, value in (("weight", start["load"] > 0), ("motion", start["gamma"] > 0), ("law", rows.law.name)):
                effects[name].add(bool(value) if name != "law" else value)
    assert effects["weight"] == {True, False}
    assert law != "auto" or effects["law"] == {"hertz", "elastoplastic"}


def test_curves_are_shared_where_the_dimensionless_form_allows():
    count = 300
    radius = np.geomspace(1e-3, 1e-2, count)
    for law in ("hertz", "big-alabo", "stronge"):
        base = scene("hertz").replace({"contact.law": law})
        (rows,) = problems_of(base, {"impactor.radius": radius}, count)
        assert rows.curve is curve_of(LAWS[law] if law != "hertz" else LAWS["hertz"])
    contact = fm.Contact("meyer", stiffness="1e9 N/m^1.2", exponent=1.2, initial_indentation="1 um")
    base = dataclasses.replace(scene("hertz"), contact=contact)
    (rows,) = problems_of(base, {"contact.initial_indentation": np.linspace(1e-6, 2e-6, count)}, count)
    assert rows.impacts.index.size == count
    parts = problems_of(base, {"contact.exponent": np.repeat([1.2, 1.5, 1.7], 100)}, count)
    assert [part.impacts.index.size for part in parts] == [100, 100, 100]


def test_stages_of_rows_that_differ_in_numbers_are_evaluated_once(monkeypatch):
    asked = []

    def counted(law, count):
        asked.append(count)
        return varied_of(law, count)

    monkeypatch.setattr("film_model.problem.own_curves.varied_of", counted)
    stiffness = np.linspace(3e7, 5e7, 40)
    base = dataclasses.replace(
        scene("hertz"), contact=fm.Contact("walton-braun", loading_stiffness="40 MN/m", unloading_stiffness="80 MN/m")
    )
    (rows,) = problems_of(base, {"contact.loading_stiffness": stiffness}, 40)
    assert rows.own.varied is not None and asked == [40]


@dataclasses.dataclass(frozen=True)
class Scalar(fm.AbstractLaw):
    """A law whose formulas take one number at a time."""

    name = "scalar"
    summary = source = "test"
    effective_modulus: float
    radius: float

    def scales(self, energy):
        return fm.Hertz(self.effective_modulus, self.radius).scales(max(energy, 1e-300))

    def stages(self):
        return LAWS["hertz"].stages()


def test_a_law_of_single_numbers_serves_too(monkeypatch):
    """Row by row where its formulas are asked, and still one curve."""
    monkeypatch.setitem(fm.LAWS, "scalar", Scalar)
    columns = {"impactor.radius": np.linspace(5e-3, 15e-3, 9), "impactor.velocity": np.linspace(0.1, 1, 9)}
    one, other = (simulate_many(scene("hertz").replace({"contact.law": law}), columns) for law in ("scalar", "hertz"))
    for name in SUMMARY:
        np.testing.assert_allclose(one.summary[name], other.summary[name], rtol=1e-12, atol=1e-25)
    assert [problem.impacts.index.size for problem in one.problems] == [9]


def test_a_row_that_fails_says_why_and_harms_no_other():
    base = scene("hertz", "body")
    result = simulate_many(base, {"impactor.velocity": np.array([1.0, 0.1, 0.05, 2.0])})
    assert result.status.tolist() == [native.EVENT, NO_VELOCITY, NO_VELOCITY, native.EVENT]
    assert np.isnan(result.summary["maximum_force"]).tolist() == [False, True, True, False]
    none = simulate_many(base, {"impactor.velocity": np.array([0.1, 0.05])})
    assert none.status.tolist() == [NO_VELOCITY, NO_VELOCITY] and none.problems == ()
    deep = simulate_many(scene("saturating"), {"impactor.velocity": np.array([0.2, 50.0])})
    assert [STATUSES[s][0] for s in deep.status.tolist()] == ["separated", "beyond_law"]


@pytest.mark.parametrize("target", ["half-space", "plate"])
def test_effects_tried_for_neighbours_are_those_tried_for_each(target, monkeypatch):
    """With no cells at all every impact is tried itself: law and weight come out the same."""
    rng = np.random.default_rng(8)
    base = scene("big-alabo", target).replace({"contact.law": "auto"})
    columns = {"impactor.velocity": np.exp(rng.uniform(-5, 0, 80)), "impactor.mass": rng.uniform(0.03, 0.09, 80)}
    cells = simulate_many(base, columns)
    monkeypatch.setattr("film_model.effects.trial.LEVELS", ())
    each = simulate_many(base, columns)
    assert cells.laws == each.laws == ("hertz", "elastoplastic") and np.array_equal(cells.law, each.law)
    loads = [np.concatenate([part.load[np.argsort(part.impacts.index)] for part in r.problems]) for r in (cells, each)]
    assert np.array_equal(*loads) and 0.1 < np.mean(loads[0] > 0.0) < 0.9


def test_the_error_of_every_row_is_the_error_of_all():
    beam = fm.Beam("mild steel", length="200 mm", width="10 mm", thickness="5 mm")
    static = fm.Effects(target_inertia=False)
    base = fm.Scene(fm.Sphere(**BALL), beam, fm.Contact("tsuji", restitution=0.7), static)
    with pytest.raises(fm.SimulationError, match="a damped law cannot be simulated on a beam with edges"):
        simulate_many(base, {"impactor.velocity": np.array([1.0, 2.0])})
