"""Fixtures that several test files share, and settings of the test run."""

import gc
from unittest.mock import patch

import pytest
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


BLANK = b'<svg xmlns="http://www.w3.org/2000/svg"/>'


@pytest.fixture(scope="session")
def export_undrawn():
    """fmu_wrapper.export without the pictures of the documentation, which take nine tenths of its time."""

    def export(*arguments, **options):
        with patch.multiple(
            "fmu_wrapper.documentation",
            plot_history=lambda history: None,
            svg=lambda figure: BLANK,
            _law_picture=lambda problem, history: BLANK,
        ):
            return fmu_wrapper.export(*arguments, **options)

    return export


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
