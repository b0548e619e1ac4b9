"""Summary values in JAX: their derivatives are those of the library, under jit, vmap, grad and in a descent."""

import numpy as np
import pytest

import film_model as fm

SCENE = fm.Scene(
    fm.Sphere("10 mm", drop_height="50 mm", material="bearing steel"), fm.HalfSpace("mild steel"), fm.Contact("stronge")
)
HEIGHT, RADIUS = "impactor.drop_height", "impactor.radius"
QUANTITIES = ["maximum_force", "contact_duration"]


@pytest.fixture(scope="module")
def jax():
    jax = pytest.importorskip("jax")
    jax.config.update("jax_enable_x64", True)
    return jax


@pytest.fixture(scope="module")
def function(jax):
    from film_model.jax import summary_function

    return summary_function(SCENE, [HEIGHT, RADIUS], QUANTITIES)


@pytest.mark.slow
def test_values_and_derivatives_are_those_of_the_library(jax, function):
    history = fm.simulate(SCENE, derivatives=[HEIGHT, RADIUS])
    found = jax.jit(function)(0.05, 0.01)
    for way in (jax.jacfwd, jax.jacrev):
        slopes = jax.jit(way(function, argnums=(0, 1)))(0.05, 0.01)
        for name in QUANTITIES:
            assert float(found[name]) == pytest.approx(history.summary[name], rel=2e-4)
            for k, path in enumerate((HEIGHT, RADIUS)):
                expected = history.derivatives.values[name][path]
                assert float(slopes[name][k]) == pytest.approx(expected, rel=1e-4)


@pytest.mark.slow
def test_arrays_and_vmap_are_one_batch(jax, function):
    heights = np.array([0.01, 0.05, 0.2])
    together = function(heights, 0.01)["maximum_force"]
    mapped = jax.vmap(lambda h: function(h, 0.01)["maximum_force"])(heights)
    np.testing.assert_array_equal(together, mapped)
    slopes = jax.vmap(jax.grad(lambda h: function(h, 0.01)["maximum_force"]))(heights)
    one = [float(jax.grad(lambda h: function(h, 0.01)["maximum_force"])(h)) for h in heights]
    np.testing.assert_allclose(slopes, one, rtol=1e-4)
    assert np.isnan(function(np.array([-1.0, 0.05]), 0.01)["maximum_force"]).tolist() == [True, False]


@pytest.mark.slow
def test_a_descent_finds_the_drop_height_of_a_peak_force(jax, function):
    wanted = fm.simulate(SCENE.replace({HEIGHT: "120 mm"})).summary["maximum_force"]

    def miss(logarithm):
        return (jax.numpy.log(function(jax.numpy.exp(logarithm), 0.01)["maximum_force"] / wanted)) ** 2

    step, logarithm = jax.jit(jax.value_and_grad(miss)), float(np.log(0.05))
    for _ in range(40):
        _, slope = step(logarithm)
        logarithm -= float(slope)
    assert np.exp(logarithm) == pytest.approx(0.12, rel=1e-3)


@pytest.mark.slow
def test_mistakes(jax, function):
    from film_model.jax import summary_function

    with pytest.raises(fm.SceneError, match='did you mean "maximum_force"'):
        summary_function(SCENE, [HEIGHT], ["maximum_forse"])
    with pytest.raises(fm.SceneError, match=r"the scene gives impactor\.drop_height"):
        summary_function(SCENE, ["impactor.velocity"], QUANTITIES)
    with pytest.raises(TypeError, match="1 numbers given, one is needed for each of"):
        function(0.05)


def test_without_jax_the_extra_is_named(monkeypatch):
    from film_model import jax as module

    monkeypatch.setattr(module, "import_module", lambda name: exec("raise ImportError"))
    with pytest.raises(ImportError, match=r"install film-model\[jax\]"):
        module.summary_function(SCENE, [HEIGHT], QUANTITIES)


@pytest.mark.slow
def test_rows_on_vibrating_targets_have_derivatives(jax):
    from film_model.jax import summary_function

    beam = fm.Beam("mild steel", width="10 mm", thickness="5 mm", length="100 mm")
    one = fm.Scene(fm.Sphere("10 mm", "1 m/s", material="bearing steel"), beam, fm.Contact("hertz"))
    force = summary_function(one, ["impactor.velocity"], ["maximum_force"])
    slope = jax.grad(lambda v: force(v)["maximum_force"])(1.0)
    exact = fm.simulate(one, derivatives=["impactor.velocity"]).derivatives.values["maximum_force"]
    assert float(slope) == pytest.approx(exact["impactor.velocity"], rel=1e-9)


@pytest.mark.slow
def test_of_an_oblique_impact(jax):
    from film_model.jax import summary_function

    steel = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3, "density": "7850 kg/m^3"}
    ball = fm.Sphere("5 mm", "3 m/s", material=steel, angle="40 deg")
    scene = fm.Scene(ball, fm.HalfSpace(steel), fm.Contact("hertz", friction=0.2), fm.Effects(gravity=False))
    function = summary_function(scene, ["impactor.angle"], ["rebound_angle", "maximum_force"])
    by = jax.vmap(jax.grad(lambda angle: function(angle)["rebound_angle"]))(jax.numpy.array([0.2, ball.angle]))
    exact = fm.simulate(scene, derivatives=["impactor.angle"]).derivatives
    assert float(by[1]) == pytest.approx(exact.values["rebound_angle"]["impactor.angle"], rel=1e-6)
    with pytest.raises(fm.SceneError, match="rebound_angle: unknown"):
        summary_function(scene.replace({"contact.friction": None}), ["impactor.angle"], ["rebound_angle"])
