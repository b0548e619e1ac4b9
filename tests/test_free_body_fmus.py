"""FMUs of impacts on a free body: the library's motion, momentum, what comes after, and refusals."""

import pytest
from cases import LAWS

import film_model as fm
import fmu_wrapper
from fmu_wrapper.instance import opened, started

STEEL = "bearing steel"
BALL = fm.Sphere("10 mm", "0.5 m/s", material=STEEL)
NAMES = ("impactor_velocity", "target_velocity", "maximum_force", "maximum_indentation", "permanent_indentation")


def on(law="auto", **changes):
    law = LAWS[law] if law == "thornton" else law
    return fm.Scene(BALL, fm.Body("structural steel S235", "15 mm"), fm.Contact(law)).replace(changes)


@pytest.mark.slow
@pytest.mark.parametrize(("version", "law"), [(2, "auto"), (3, "elastoplastic"), (2, "thornton")])
@pytest.mark.filterwarnings("ignore::film_model.ImpactWarning")
def test_an_fmu_has_the_motion_of_both_bodies(made, version, law):
    """With the strength at the rate of this impact, and a frame that moves with the support."""
    history = fm.simulate(on(law), accuracy=1e-6)
    last, momentum = history.events[-1], BALL.own_mass * 0.5
    path = made(on(law, **{"solver.accuracy": 1e-6}), version)
    assert fmu_wrapper.check(path, on(law, **{"solver.accuracy": 1e-6})).good
    with opened(path) as fmu:
        assert fmu.description.modelExchange is None
        for frame in (0.0, 2.0):
            with started(fmu, False, {"initial_velocity": 0.5 + frame, "support_velocity": frame}) as slave:
                slave.step(0.0, 1.1 * history.duration)
                found = slave.get((*NAMES, "rebound_velocity"))
            expected = {name: history.summary[name] for name in NAMES[2:]}
            expected |= {
                "impactor_velocity": last.impactor_velocity + frame,
                "target_velocity": last.target_velocity + frame,
            }
            for name, value in expected.items():
                assert found[name] == pytest.approx(value, rel=1e-5, abs=1e-12), name
            velocities = found["impactor_velocity"] - frame, found["target_velocity"] - frame
            kept = BALL.own_mass * velocities[0] + on().target.own_mass * velocities[1]
            assert kept == pytest.approx(momentum, rel=1e-12)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"target.velocity": "0.1 m/s"}, "target.velocity: 0.1 m/s must be 0 m/s for an FMU: give impactor.velocity"),
        ({"contact.friction": 0.2}, "on a free body, an FMU contains the normal motion only"),
        ({"contact.law": "tsuji", "contact.restitution": 0.8}, "a free body cannot be exported with a damped law"),
    ],
)
def test_refusals(changes, message, tmp_path):
    with pytest.raises(fm.SimulationError, match=message):
        fmu_wrapper.export(on(**changes), tmp_path / "impact.fmu")
