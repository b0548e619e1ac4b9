"""Fixtures that several test files share, and settings of the test run."""

import gc
from contextlib import contextmanager
from unittest.mock import patch

import pytest
import sweep_cases
from hypothesis import settings

import fmu_wrapper

settings.register_profile("fast", max_examples=20, deadline=None)
settings.register_profile("thorough", max_examples=300, deadline=None)
settings.load_profile("fast")

gc.disable()  # collection of tests makes millions of lasting objects, which every garbage collection would scan


def pytest_collection_finish():
    gc.enable()
    gc.freeze()  # later garbage collections skip what exists by now


def pytest_unconfigure():
    gc.unfreeze()  # extension modules are freed at exit, or report leaks


@pytest.fixture(scope="session", autouse=True)
def binary_of_this_machine():
    """FMUs contain the binary of this machine only, unless a test asks for others: packing five takes longer."""
    with patch("fmu_wrapper.platforms.can_cross_compile", lambda: False):
        yield


BLANK = b'<svg xmlns="http://www.w3.org/2000/svg"/>'


@contextmanager
def without_pictures():
    """FMUs are exported without the pictures of the documentation, which take nine tenths of the time."""
    with (
        patch.multiple(
            "fmu_wrapper.documentation",
            plot_history=lambda history: None,
            svg=lambda figure: BLANK,
            _law_picture=lambda problem, history: BLANK,
        ),
        patch("fmu_wrapper.terminals._png", lambda figure: b""),
    ):
        yield


@pytest.fixture(scope="session")
def export_undrawn():
    """fmu_wrapper.export without pictures."""
    return without_pictures()(fmu_wrapper.export)


@pytest.fixture(scope="session")
def made(tmp_path_factory, export_undrawn):
    """FMUs without pictures, each exported once: made(scene, version, **options)."""
    folder, known = tmp_path_factory.mktemp("fmus"), {}

    def make(on, version=3, **options):
        key = (on, version, tuple(sorted(options.items())))
        if key not in known:
            known[key] = export_undrawn(on, folder / f"{len(known)}.fmu", version, **options)
        return known[key]

    return make


@pytest.fixture(scope="session")
def packed(tmp_path_factory):
    """SSP packages without pictures, each exported once: packed(scene) is what export_ssp returns."""
    folder, known = tmp_path_factory.mktemp("packages"), {}

    def pack(on):
        if on not in known:
            known[on] = without_pictures()(fmu_wrapper.export_ssp)(on, folder / f"{len(known)}.ssp")
        return known[on]

    return pack


@pytest.fixture
def sweep_file(tmp_path):
    """A sweep of 60 impacts as a TOML file."""
    path = tmp_path / "sweep.toml"
    path.write_text(sweep_cases.FILE, encoding="utf-8")
    return path
