"""Files related to an FMU, by FMI-LS-REF: the manifest names files that exist; reference results are the FMU's."""

import posixpath
import xml.etree.ElementTree as ET
import zipfile

import numpy as np
import pytest
from cases import scene

import fmu_wrapper
from film_model.base.errors import DamagedFile
from film_model.solve.history import MOTION
from fmu_wrapper import related
from fmu_wrapper.archive import zipped

LS = "{http://fmi-standard.org/fmi-ls-manifest}"


def contents(path):
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "version"), [("impact", 3), ("contact", 2)])
def test_manifest_names_files_of_the_archive(tmp_path, kind, version):
    files = contents(fmu_wrapper.export(scene("big-alabo"), tmp_path / "a.fmu", version, kind=kind))
    root = ET.fromstring(files[f"{related.FOLDER}/fmi-ls-manifest.xml"])
    assert root.tag == "fmiReferences"
    assert root.get(f"{LS}fmi-ls-name") == "org.fmi-standard.fmi-ls-ref" == related.FOLDER.removeprefix("extra/")
    sources = {one.get("source"): one.get("role") for one in root}
    for source, role in sources.items():
        assert posixpath.normpath(posixpath.join(related.FOLDER, source)) in files
        assert role in ("document", "model", "result")
    assert ("result" in sources.values()) == (kind == "impact")


@pytest.mark.slow
@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("target", ["half-space", "plate"])
@pytest.mark.parametrize("law", ["stronge", "tsuji"])
def test_runs_equal_the_reference_results_inside(tmp_path, law, target, version):
    path = fmu_wrapper.export(scene(law, target), tmp_path / "a.fmu", version, initial_gap="1 um")
    stored = related.reference_results(contents(path)[f"{related.FOLDER}/{related.RESULTS}"].decode())
    ds = fmu_wrapper.run(path)
    assert stored["time"].size == 251
    rows = np.abs((ds.t.values - ds.t.values[0])[:, None] - stored["time"]).argmin(axis=0)
    for name in MOTION:
        np.testing.assert_allclose(ds[name].values[rows], stored[name], rtol=0, atol=1e-12 * np.abs(stored[name]).max())


@pytest.mark.slow
def test_check_finds_a_result_that_differs_or_is_no_number(tmp_path):
    path = fmu_wrapper.export(scene("hertz"), tmp_path / "a.fmu")
    files, name = contents(path), f"{related.FOLDER}/{related.RESULTS}"
    lines = files[name].decode().splitlines()
    time, indentation, *others = lines[100].split(",")

    def checked(value):
        lines[100] = ",".join([time, value, *others])
        path.write_bytes(zipped({**files, name: "\n".join(lines).encode()}))
        return fmu_wrapper.check(path)

    assert checked(indentation).good
    bad = [finding for finding in checked(repr(1.001 * float(indentation))).findings if not finding.good]
    assert [finding.what for finding in bad] == ["reference results: indentation"]
    assert bad[0].where == f"t = {float(time):.6g} s"
    with pytest.raises(DamagedFile, match="reference_results"):
        checked("?")
