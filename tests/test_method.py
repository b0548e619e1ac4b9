"""The orders and numbers that docs/method.md states, measured; section numbers are those of that page."""

import importlib.util
import math
import re
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

import film_model as fm
from film_model.core import native

ROOT = Path(__file__).parents[1]
SEGMENTS = np.array([16, 32, 64, 128])


def load_figures():
    """examples/method_figures.py as a module."""
    spec = importlib.util.spec_from_file_location("method_figures", ROOT / "examples" / "method_figures.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


figures = load_figures()
equal, cosine, graded, own_mesh = figures.equal, figures.cosine, figures.graded, figures.own_mesh
HALF_SPACE = figures.Case(figures.ball())


def chords(n):
    return native.mesh(native.CHORD, int(n), int(n))


def lines(n):
    return native.mesh(native.WORK_PRESERVING, int(n), int(n))


def order(case, mesh, name, segments=SEGMENTS):
    return figures.slope(segments, np.array([case.error(mesh(int(n)), name) for n in segments]))


@pytest.mark.parametrize("zener", [0.0, 0.5, 1.5])
def test_24_lines_are_better_than_1000_chords(zener):
    case = figures.Case(figures.on_plate(zener)) if zener else HALF_SPACE
    names = ("maximum_force", "maximum_indentation", "time_of_maximum_indentation", "contact_duration")
    assert case.error(lines(24), *names, "final_velocity") < case.error(chords(1000), *names, "final_velocity")


def test_every_figure_and_test_of_the_page_exists():
    text = (ROOT / "docs" / "method.md").read_text(encoding="utf-8")
    for name in re.findall(r"\]\((method_\w+\.png)\)", text):
        assert (ROOT / "docs" / name).exists(), name
    assert set(re.findall(r"\]\((method_\w+)\.png\)", text)) == set(figures.FIGURES)
    for file, test in re.findall(r"`(test_\w+)::(test_\w+)`", text):
        assert f"def {test}(" in (ROOT / "tests" / f"{file}.py").read_text(encoding="utf-8"), f"{file}::{test}"


def test_section_2_a_chord_adds_work_and_takes_depth():
    """δ_m is off by −1/(8 n²) on Hertz's half-space: the chords' work is too large by h²/12 of the rise of f′."""
    for n in (32, 128):
        off = HALF_SPACE.on(chords(n)).maximum_indentation / HALF_SPACE.exact.maximum_indentation - 1.0
        assert off * 8.0 * n**2 == pytest.approx(-1.0, abs=0.25 / math.sqrt(n))  # f″ ~ ξ^{-1/2} at first touch
    assert order(HALF_SPACE, chords, "contact_duration") == pytest.approx(2.0, abs=0.05)


@pytest.mark.parametrize("n", [1, 2, 5, 40])
def test_section_2_work_preserving_lines_have_the_exact_depth_on_a_half_space(n):
    found = HALF_SPACE.on(lines(n))
    assert found.maximum_indentation == pytest.approx(HALF_SPACE.exact.maximum_indentation, rel=1e-15)
    assert found.final_velocity == pytest.approx(-HALF_SPACE.start.nu, rel=1e-15)


def test_section_2_fourth_order_with_the_predicted_constant():
    """Time is off by Σ h⁵ (f″ g′ − f‴ g)/720 with g = ν⁻³, here over cosine nodes, but for the end segments."""
    s = (np.arange(20000) + 0.5) / 20000
    x, rate = cosine(s), np.pi * np.sin(0.5 * np.pi * s) * np.cos(0.5 * np.pi * s)
    square = 0.8 * (1.0 - x**2.5)  # ν² on f = x^1.5
    g, g_slope = square**-1.5, 3.0 * x**1.5 * square**-2.5
    predicted = (
        np.mean(rate**5 * (0.75 * x**-0.5 * g_slope + 0.375 * x**-1.5 * g)) / 720.0 / np.mean(rate / square**0.5)
    )
    assert predicted == pytest.approx(0.0477, rel=1e-3)
    exact = HALF_SPACE.exact.time_of_maximum_indentation
    for n in (32, 64, 128):
        found = (HALF_SPACE.on(lines(n)).time_of_maximum_indentation / exact - 1.0) * n**4
        assert found == pytest.approx(predicted, rel=4.0 / n)
    assert order(HALF_SPACE, lines, "contact_duration") > 3.85


@pytest.mark.parametrize(
    ("touch", "turn", "expected"),
    [(1.0, 1.0, 2.5), (2.0, 1.2, 3.0), (2.0, 1.1, 2.75), (2.0, 1.8, 4.0), (1.0, 2.0, 3.7)],
)
def test_section_4_order_against_grading_exponents(touch, turn, expected):
    """The turn allows 5/2 of its exponent, first touch 7/2 of its own (reached slowly), the lines themselves 4."""
    way = graded(touch, turn)
    found = order(HALF_SPACE, lambda n: own_mesh(n, way, n, cosine), "time_of_maximum_indentation", 4 * SEGMENTS)
    assert found == pytest.approx(expected, abs=0.12)


@pytest.mark.parametrize("zener", [0.05, 0.5, 1.5, 2.5])
def test_section_4_fourth_order_on_plates(zener):
    case = figures.Case(figures.on_plate(zener))
    for name in ("contact_duration", "time_of_maximum_indentation"):
        assert order(case, lines, name, 2 * SEGMENTS[:3]) > 3.7, name


def test_section_4_the_grading_of_very_slow_contacts_ends_at_order_two_and_a_half():
    """Its nodes do not crowd at the turn (a = 1); errors are below 1e-9 before that shows."""
    case = figures.Case(figures.on_plate(3.2))
    assert case.slowness > 2.5
    segments = np.array([128, 256, 512])
    assert case.error(lines(96), "contact_duration") < 1.5e-9
    assert order(case, lines, "contact_duration", segments) == pytest.approx(2.55, abs=0.15)


def test_section_2_samples_between_nodes_are_of_third_order():
    """A line does the law's work from node to node, not up to a point between: h³ in ν, and on a plate in ξ too."""
    for scene, quantity in (
        (figures.ball(), "impactor_velocity"),
        (figures.on_plate(0.5), "indentation"),
        (figures.on_plate(0.5), "impactor_velocity"),
    ):
        best = fm.simulate(scene, segments=2000)
        times = np.linspace(0.0, 0.999 * best.summary["contact_duration"], 2001)
        exact = getattr(best.sample_si(times), quantity)
        off = [
            np.abs(getattr(fm.simulate(scene, segments=int(n)).sample_si(times), quantity) - exact).max()
            for n in SEGMENTS
        ]
        found = figures.slope(SEGMENTS, np.array(off) / np.abs(exact).max())
        assert found == pytest.approx(3.0, abs=0.15), quantity


CASES_OF_A_LINE = {
    "short": (0.5, 1.0, 0.4),
    "under-damped": (0.3, 1.0, 4.0),
    "critical": (2.0, 1.0, 3.0),
    "over-damped": (6.0, 1.0, 3.0),
    "flat": (1.0, 0.0, 3.0),
    "softening": (0.4, -0.5, 3.0),
}


@pytest.mark.parametrize("gamma,kappa,tau", CASES_OF_A_LINE.values(), ids=CASES_OF_A_LINE)  # noqa: PT006
def test_section_3_one_line_is_exact_in_every_regime(gamma, kappa, tau):
    """Against the matrix exponential of x′ = y, y′ = −φ − κ x − 2 a y."""
    phi, nu = 0.7, 1.1
    x, y = figures.one_line(gamma, kappa, phi, nu, np.array([tau]))
    system = np.array([[0.0, 1.0, 0.0], [-kappa, -kappa * gamma, -phi], [0.0, 0.0, 0.0]])
    exact = expm(system * tau) @ [0.0, nu - gamma * phi, 1.0]
    assert x[0] == pytest.approx(exact[0], rel=1e-13, abs=1e-14)
    assert y[0] == pytest.approx(exact[1], rel=1e-13, abs=1e-13)


def test_section_5_the_turn_is_late_by_what_the_last_line_misses():
    """γ f″ h²/(12 f) with h the last segment, where the line does not meet the law; the core's does."""
    case = figures.Case(figures.on_plate(1.0))
    top, exact = case.exact.maximum_indentation, case.exact.time_of_maximum_indentation
    for n in (24, 48):
        nodes = top * graded(1.2, 1.7)(np.arange(n + 1) / n)
        late = figures.march_in(case, nodes) - exact
        h = nodes[-1] - nodes[-2]
        # f″/f = 3/(4 ξ²)
        assert late == pytest.approx(case.start.gamma * 0.75 / top**2 * h**2 / 12.0, rel=0.05)
        assert case.error(lines(n), "time_of_maximum_indentation") < 0.04 * late / exact


@pytest.mark.parametrize(("law", "expected"), [("tsuji", 3.0), ("kuwabara-kono", 4.0)])
def test_section_7_order_of_damped_laws_on_a_plate(law, expected):
    """c ~ ξ^{1/4}, held constant on the first line, leaves the square of h^{1/4} over h ~ n^{-2}: n^{-3}."""
    modulus = HALF_SPACE.problem.scene.effective_modulus
    laws = {
        "tsuji": fm.Tsuji(modulus, 0.01, restitution=0.7),
        "kuwabara-kono": fm.KuwabaraKono(modulus, 0.01, dissipation_time=1e-5),
    }
    ball = figures.ball(laws[law])
    case = figures.Case(figures.on_mild_steel_plate(ball))
    assert order(case, lines, "maximum_force", 2 * SEGMENTS) == pytest.approx(expected, abs=0.15)
    assert order(figures.Case(ball), lines, "maximum_force") == pytest.approx(4.0, abs=0.15)


@pytest.mark.parametrize(("segments", "apart"), [(6, 3e-5), (24, 2e-8)])
def test_section_10_lanes_and_march_differ_by_less_than_the_lines_leave(segments, apart):
    plate = figures.on_plate(1.5, fm.Meyer(stiffness=3e9, exponent=1.6))  # of exponent 3/2 the lanes need no lines
    values, times = ("maximum_indentation", "final_velocity"), ("contact_duration", "time_of_maximum_indentation")
    for case, tolerance, names in ((HALF_SPACE, 1e-14, values), (figures.Case(plate), apart, (*values, *times))):
        start = np.frombuffer(bytes(case.start), native.START_DTYPE).repeat(40)
        status, batch = native.batch(case.curve, lines(segments), start)
        alone = case.on(lines(segments))
        assert (status == native.EVENT).all()
        for name in names:
            assert batch[name] == pytest.approx(getattr(alone, name), rel=tolerance), name
            assert (batch[name] == batch[name][0]).all()


def test_section_10_two_lines():
    """The worked example: its table, line by line, and what two lines, two chords and a batch leave."""
    recorded, _ = HALF_SPACE.lines(lines(2))
    found = np.array([(line["kappa"], line["phi"], line["nu"], line["time"]) for line in recorded[1:4]])
    text = (ROOT / "docs" / "method.md").read_text(encoding="utf-8")
    rows = [row.replace("−", "-").split("|")[1:-1] for row in re.findall(r"^\| [12] \| .*\|$", text, re.MULTILINE)]
    table = [[float(number) for cell in row[1:] for number in cell.split(",")] for row in rows]
    top, time = (getattr(HALF_SPACE.exact, name) for name in ("maximum_indentation", "time_of_maximum_indentation"))
    for k, (row, line, after) in enumerate(zip(table, found[:2], found[1:], strict=True)):
        x0, x1, (kappa, phi, nu, began) = k * top / 2, (k + 1) * top / 2, line
        work = 0.4 * (x1**2.5 - x0**2.5)
        assert row == pytest.approx(
            [top / 2, x0**1.5, x1**1.5, work, kappa, phi, nu, after[2], after[3] - began], abs=5.1e-5
        )
    assert (top, time, found[2, 3]) == pytest.approx((1.4427, 1.5013, 1.4989), abs=5e-5)
    chord = HALF_SPACE.on(chords(2))
    assert 1 - found[2, 3] / time == pytest.approx(0.0016, abs=5e-5)
    assert 1 - chord.time_of_maximum_indentation / time == pytest.approx(0.0072, abs=5e-5)
    assert 1 - chord.maximum_indentation / top == pytest.approx(0.027, abs=5e-4)
    _, batch = native.batch(HALF_SPACE.curve, lines(2), np.frombuffer(bytes(HALF_SPACE.start), native.START_DTYPE))
    assert batch["time_of_maximum_indentation"] == pytest.approx(time, rel=1e-14)


def test_section_12_a_step_in_parts_is_the_step():
    """To rounding, whatever the parts; the exact agreement of restored states is in test_component.py."""
    case = figures.Case(figures.on_plate(0.8))
    end = 0.37 * case.exact.contact_duration
    ends = []
    for parts in (1, 7, 1000):
        state = native.initial_state(case.curve, case.start)
        for k in range(parts):
            while (
                native.step(case.curve, lines(10), state, max(end * (k + 1) / parts - state.time, 0.0)) == native.EVENT
            ):
                pass
        ends.append((state.xi, state.nu))
    for found in ends[1:]:
        assert found == pytest.approx(ends[0], rel=1e-13)
