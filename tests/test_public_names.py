"""Names that the stability promise covers, against those stored in public_names.json.

A name that is gone fails, one that is new does not: `python tests/public_names.py` writes the file before a release.
"""

import json

import public_names

import film_datasets as fd
import film_model as fm


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
    """Published datasets that 0.1.0 wrote, by several versions of their schemas."""
    found = [fd.load(name) for name in fd.published()]
    early = [ds for ds in found if ds.attrs["film_model_version"] == "0.1.0"]
    assert len({(ds.attrs["film_model_schema"], ds.attrs["film_model_schema_version"]) for ds in early}) >= 4
    assert [fd.validate(ds) for ds in found] == [[]] * len(found)
