"""Names that the stability promise covers, against those stored in public_names.json.

A name that is gone fails, one that is new does not: `python tests/public_names.py` writes the file before a release.
"""

import json
from pathlib import Path

import public_names
import pytest

import film_datasets as fd
import film_model as fm

EARLIER = Path(__file__).parent / "earlier_files"


def test_dir_lists_the_public_names_only():
    assert {"cli", "solve"} <= vars(fm).keys()  # loaded, and not listed
    assert dir(fm) == sorted({*fm.__all__})
    assert {"Scene", "HalfSpace", "LAWS", "simulate", "__version__"} <= {*dir(fm)}


def test_no_public_name_is_gone_or_renamed():
    stored, now = json.loads(public_names.STORED.read_text(encoding="utf-8")), public_names.names()
    gone = {group: sorted({*names} - {*now.get(group, ())}) for group, names in stored.items()}
    assert not {group: names for group, names in gone.items() if names}
    assert now.keys() == stored.keys() and all(len(names) > 1 for names in stored.values())


def test_files_of_earlier_versions_are_read():
    """Files that 0.1.0 wrote, by several versions of their schemas: as it published them."""
    early = [fd.read(path) for path in sorted(EARLIER.glob("*.nc"))]
    assert {ds.attrs["film_model_version"] for ds in early} == {"0.1.0"}
    schemas = {(ds.attrs["film_model_schema"], ds.attrs["film_model_schema_version"]) for ds in early}
    assert schemas == {("impact_history", "1.4"), ("impact_measurement", "1.3"), ("impact_sweep", "1.5")}
    assert [fd.validate(ds) for ds in early] == [[]] * len(early)


@pytest.mark.slow
def test_published_files_are_read():
    assert not [problems for name in fd.published() if (problems := fd.validate(fd.load(name)))]
