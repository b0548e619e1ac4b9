"""The catalogue of hard cases, and thousands of random impacts: every one ends as documented, without a NaN."""

import json
import math
import random

import numpy as np
import pytest
from cases import LAWS, scene

import film_model as fm
from film_model import extended, reference
from film_model.cli import main
from film_model.core import native
from film_model.hard_cases import HardCase, all_cases, problem_for, report

LONG = ("a million steps", "1000000 segments", "Hertz, λ = 50", "Hertz, λ = 20", "Hertz, λ = 8")
CASES = all_cases()


@pytest.mark.parametrize(
    "case", [pytest.param(c, marks=pytest.mark.slow if c.name in LONG else (), id=c.name) for c in CASES]
)
def test_case(case: HardCase):
    found = report(case, others=False).finding
    assert found.good, found
    assert case.why
    assert found.allowed <= 1e-9 or case.name.split()[-1] in ("segments", "1e-8", "0.1")


def test_every_case_has_a_name_of_its_own():
    assert len({case.name for case in CASES}) == len(CASES) > 80


@pytest.mark.parametrize("target", ["half-space", "plate", "thin plate"])
@pytest.mark.parametrize("law", ["hertz", "meyer", "big-alabo"])
def test_extended_precision_and_conventional_integration_agree(law, target):
    on = scene(law, target)
    values = (LAWS[law], on.effective_mass, on.approach_velocity, on.target_impedance)
    tight = reference.integrate(*values, rtol=3e-14)
    for name, value in extended.impact(*values).items():
        assert value == pytest.approx(tight[name], rel=2e-12, abs=1e-20), name


def test_extended_precision_refuses_what_it_cannot():
    with pytest.raises(ValueError, match="multiples of one half"):
        extended.impact(LAWS["stronge"], 0.06, 0.25)


def random_impacts(count, seed):
    chance = random.Random(seed)
    names = list(LAWS)
    for _ in range(count):
        law = LAWS[chance.choice(names)]
        velocity = 10.0 ** chance.uniform(-4.0, 0.5)
        impedance = math.inf if chance.random() < 0.3 else 10.0 ** chance.uniform(2.0, 7.0)
        load = 0.0 if chance.random() < 0.7 else 10.0 ** chance.uniform(-6.0, 2.0)
        yield problem_for(law, 10.0 ** chance.uniform(-6.0, 1.0), velocity, impedance, load), chance.randint(1, 60)


def finite_or_refused(problem, segments):
    mesh = native.mesh(native.WORK_PRESERVING, segments, 2 * segments)
    start = native.Start(problem.approach, problem.gamma, problem.load, 0.0, 1e4)
    status, found = native.impact(problem.curve.native, mesh, start)
    assert status in (native.EVENT, native.OK, native.ENDLESS, native.BEYOND_LAW, native.TOO_STIFF), status
    if status >= 0:
        assert math.isfinite(found.maximum_force) and found.maximum_force >= 0.0
    if status == native.EVENT:
        values = (found.maximum_indentation, found.contact_duration, found.final_velocity, found.shift, found.work)
        assert np.isfinite(values).all(), values
        assert found.time_of_maximum_indentation <= found.contact_duration
        if problem.load == 0.0:
            assert -found.final_velocity <= problem.approach * 1.2  # Stronge's unloading may return a little more


def test_two_thousand_random_impacts():
    for problem, segments in random_impacts(2_000, 1):
        finite_or_refused(problem, segments)


@pytest.mark.slow
def test_a_hundred_thousand_random_impacts():
    for problem, segments in random_impacts(100_000, 2):
        finite_or_refused(problem, segments)


def test_command_line(capsys):
    assert main(["hard-cases", "--match", "damping ratio", "--json"]) == 0
    table = json.loads(capsys.readouterr().out)
    assert table["good"] and len(table["cases"]) == 4
    assert main(["hard-cases", "--match", "turns at the end of stage 3 - 1 ulp"]) == 0
    out = capsys.readouterr().out
    assert "Newmark" in out and "1 of 1 good" in out


def test_conventional_integrators_beside_a_hard_case():
    found = report(next(case for case in CASES if case.name == "Hertz, λ = 3"))
    assert found.finding.good and len(found.others) == 3
    assert all("error" in said or "end" in said for said in found.others.values())


def test_a_bad_result_would_be_found():
    """The catalogue can fail: another law's reference is not this law's impact."""
    from film_model import hard_cases

    wrong = HardCase("wrong", "a forged reference", lambda: hard_cases.examine(fm.Hertz(1e11, 0.01), 0.06, 0.25))
    exact = hard_cases._exact

    def forged(*arguments):
        found = exact(*arguments)
        found.contact_duration *= 1.0 + 1e-7
        return found

    hard_cases._exact = forged
    try:
        assert not report(wrong).finding.good
    finally:
        hard_cases._exact = exact
