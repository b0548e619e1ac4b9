"""Impedances against the paper's numbers, an independent integral and SciPy's elliptic integral."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.special import ellipk

from film_model.targets import bending_stiffness, plate_waves
from film_model.targets.rod import rod_impedance

OLSSON = (154.9, 4.76, 91.4, 8.97)
SURFACE_DENSITY = 4.132


def _mean_over_directions(mass_per_area: float, d11: float, d12: float, d22: float, d66: float) -> float:
    """1/Z as the mean over θ; the trapezoidal rule is spectrally exact on a period."""
    theta = np.linspace(0, math.pi, 4096, endpoint=False)
    c2, s2 = np.cos(theta) ** 2, np.sin(theta) ** 2
    stiffness = d11 * c2**2 + 2 * (d12 + 2 * d66) * c2 * s2 + d22 * s2**2
    return float(8 * math.sqrt(mass_per_area) / np.mean(stiffness**-0.5))


def test_the_papers_plate() -> None:
    assert plate_waves.paper_plate_impedance(SURFACE_DENSITY, *OLSSON) == pytest.approx(136.87, abs=0.005)
    assert plate_waves.orthotropic_plate_impedance(SURFACE_DENSITY, *OLSSON) == pytest.approx(156.47, abs=0.005)


@pytest.mark.parametrize("d66", [-1.0, 8.97, 57.1, 500.0, 1e4])  # A from −0.06 to 168, through the isotropic 1
def test_exact_orthotropic_impedance(d66: float) -> None:
    d11, d12, d22, _ = OLSSON
    z = plate_waves.orthotropic_plate_impedance(SURFACE_DENSITY, d11, d12, d22, d66)
    assert z == pytest.approx(_mean_over_directions(SURFACE_DENSITY, d11, d12, d22, d66), rel=1e-12)
    a = bending_stiffness.anisotropy(d11, d12, d22, d66)
    by_scipy = 8 * math.sqrt(SURFACE_DENSITY) * (d11 * d22) ** 0.25 * (math.pi / 2) / ellipk((1 - a) / 2)
    assert z == pytest.approx(by_scipy, rel=1e-14)


@pytest.mark.parametrize("formula", [plate_waves.orthotropic_plate_impedance, plate_waves.paper_plate_impedance])
def test_an_isotropic_plate_is_a_special_case(formula: object) -> None:
    ratio, d = 0.3, plate_waves.plate_stiffness(210e9, 0.3, 0.005)
    assert d == pytest.approx(2403.846, rel=1e-6)
    z = plate_waves.plate_impedance(39.25, d)
    assert callable(formula)
    assert formula(39.25, d, ratio * d, d, (1 - ratio) / 2 * d) == pytest.approx(z, rel=1e-14)
    # (4/√3) h² √(ρE/(1 − ν²)), an equivalent form
    assert z == pytest.approx(4 / math.sqrt(3) * 0.005**2 * math.sqrt(7850 * 210e9 / (1 - ratio**2)), rel=1e-14)


def test_rod() -> None:
    area = math.pi * 0.01**2
    assert rod_impedance(210e9, 7850, area) == pytest.approx(7850 * math.sqrt(210e9 / 7850) * area, rel=1e-14)
