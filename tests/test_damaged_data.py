"""No damaged, foreign or endless file is taken for a result."""

from __future__ import annotations

import errno
import os
import platform
import random
import runpy
import subprocess
import sys
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import xarray as xr

import film_datasets as fd
import film_model as fm
from film_datasets import files
from film_datasets.provenance import made_on
from film_datasets.seal import SEAL
from film_model.cli.main import main

SCENE = fm.Scene(fm.Sphere("10 mm", "1 m/s", material="bearing steel"), fm.HalfSpace("mild steel"))
SPEEDS = {"impactor.velocity": {"uniform": ["0.1 m/s", "5 m/s"]}}


def sample(kind: str, suffix: str, folder: Path) -> Path:
    path = folder / f"good{suffix}"
    if kind == "history":
        return fd.write(fd.to_dataset(fm.simulate(SCENE), samples=20), path)
    fd.sweep(SCENE, SPEEDS, "sobol", samples=100, output=path).close()
    return path


def same_values(one: xr.Dataset, other: xr.Dataset) -> bool:
    return set(one.variables) == set(other.variables) and all(
        one[name].dtype == other[name].dtype and one[name].values.tobytes() == other[name].values.tobytes()
        for name in one.variables
    )


KINDS = pytest.mark.parametrize("kind", [pytest.param("history", marks=pytest.mark.slow), "sweep"])


def flip(content: bytes, bit: int) -> bytes:
    changed = bytearray(content)
    changed[bit // 8] ^= 1 << bit % 8
    return bytes(changed)


@pytest.mark.slow
@pytest.mark.parametrize("reader", ["ours", "xarray"])
@KINDS
def test_a_flipped_bit_of_a_netcdf_file_changes_no_value(tmp_path: Path, kind: str, reader: str) -> None:
    path, rng = sample(kind, ".nc", tmp_path), random.Random(5)
    good, content = fd.read(path), path.read_bytes()
    refused = 0
    for number in range(60):
        damaged = tmp_path / f"damaged{number}.nc"
        damaged.write_bytes(flip(content, rng.randrange(8 * len(content))))
        try:
            if reader == "ours":
                found = fd.read(damaged)
            else:
                with h5py.File(damaged) as file:  # the netCDF library aborts at damaged attributes
                    attributes = [dict(file[name].attrs) for name in file], dict(file.attrs)
                assert attributes
                with xr.open_dataset(damaged, engine="netcdf4") as ds:
                    found = ds.load()
        except Exception:  # each library raises its own
            refused += 1
            continue
        flat = {str(name) for name, array in good.variables.items() if array.dims}
        if reader == "xarray":  # HDF5 has no checksum for numbers without dimension, texts and attributes
            lost = flat - set(found.variables)
            found, kept = found[sorted(flat - lost)], good[sorted(flat - lost)]
            texts = [name for name in kept.variables if kept[name].dtype.kind not in "fi"]
            assert same_values(found.drop_vars(texts), kept.drop_vars(texts)), number
        else:
            assert same_values(found, good), number
    assert refused > 10


@pytest.mark.slow
@KINDS
def test_a_flipped_bit_of_a_zarr_chunk_is_refused(tmp_path: Path, kind: str) -> None:
    pytest.importorskip("zarr")
    path, rng = sample(kind, ".zarr", tmp_path), random.Random(5)
    chunks = sorted(file for file in path.rglob("*") if "c" in file.relative_to(path).parts and file.is_file())
    texts = {name for name, array in fd.read(path).variables.items() if array.dtype.kind not in "fi"}
    for file in rng.sample([c for c in chunks if c.relative_to(path).parts[0] not in texts], 12):
        content = file.read_bytes()
        file.write_bytes(flip(content, rng.randrange(8 * len(content))))
        with pytest.raises(Exception, match=r"damaged|crc|[Cc]hecksum"):  # of zarr
            xr.open_zarr(path).load()
        with pytest.raises(OSError, match="damaged"):
            fd.read(path)
        file.unlink()  # zarr gives the fill value in place of a chunk that is not there
        with pytest.raises(OSError, match="the number of chunks"):
            fd.read(path)
        file.write_bytes(content)
    assert fd.check(path) == []


@pytest.mark.slow
@pytest.mark.parametrize("suffix", [".nc", ".zarr"])
def test_a_changed_unit_is_refused_without_a_seal_too(tmp_path: Path, suffix: str) -> None:
    """Files of earlier versions have no seal."""
    if suffix == ".zarr":
        pytest.importorskip("zarr")
    ds = fd.to_dataset(fm.simulate(SCENE)).copy(deep=True)
    ds["maximum_force"].attrs["units"] = "O"
    path = fd.write(ds, tmp_path / f"changed{suffix}")
    with pytest.raises(OSError, match="units of maximum_force are 'O', not 'N'"):
        fd.open(path)


def edited(path: Path, edit: str) -> None:
    """Change the text of one attribute, or remove a chunk."""
    if edit == "chunk":
        next(file for file in path.rglob("*") if file.is_file() and file.name != "zarr.json").unlink()
    elif path.is_file():
        with h5py.File(path, "r+") as file:
            (file if edit == "title" else file["maximum_force"]).attrs[edit] = np.bytes_("other")
    else:
        place = path if edit == "title" else path / "maximum_force"
        text = (place / "zarr.json").read_text("utf-8")
        (place / "zarr.json").write_text(text.replace(f'"{edit}": "', f'"{edit}": "x'), "utf-8")


@pytest.mark.slow
@pytest.mark.parametrize("edit", ["title", "long_name", "chunk"])
@pytest.mark.parametrize("suffix", [".nc", ".zarr"])
@KINDS
def test_changed_metadata_is_refused_by_everything_that_reads(
    tmp_path: Path, kind: str, suffix: str, edit: str, capsys: pytest.CaptureFixture[str]
) -> None:
    if suffix == ".zarr":
        pytest.importorskip("zarr")
    elif edit == "chunk":
        return
    path = sample(kind, suffix, tmp_path)
    assert SEAL not in fd.read(path).attrs
    edited(path, edit)
    for command in ("check", "plot", "convert", "summarise"):
        more = {"convert": [tmp_path / "other.nc"], "plot": ["--output", tmp_path / "other.png"]}.get(command, [])
        assert main([command, str(path), *map(str, more)]) == 3, command
        assert f"{SEAL} does not match" in capsys.readouterr().err, command


@pytest.mark.slow
@KINDS
def test_a_sealed_file_is_copied_with_a_seal_of_its_own(tmp_path: Path, kind: str) -> None:
    pytest.importorskip("zarr")
    path = sample(kind, ".zarr", tmp_path)
    fd.convert(path, tmp_path / "again.nc")
    fd.convert(tmp_path / "again.nc", tmp_path / "again.zarr")
    assert fd.read(path).identical(fd.read(tmp_path / "again.nc"))
    assert fd.read(path).identical(fd.read(tmp_path / "again.zarr"))


@KINDS
def test_a_file_says_what_computed_it(tmp_path: Path, kind: str) -> None:
    said = fd.read(sample(kind, ".nc", tmp_path)).attrs["computing_platform"]
    assert said.startswith(f"{platform.machine()} (") and f"NumPy {np.__version__}" in said
    assert sys.platform != "linux" or "libc" in said


def test_a_file_tells_other_functions_of_numpy_of_the_same_version(monkeypatch: pytest.MonkeyPatch) -> None:
    """They depend on the vector instructions that NumPy takes (NPY_DISABLE_CPU_FEATURES)."""
    said, cosine = made_on(), np.cos
    assert said == made_on()
    monkeypatch.setattr(np, "cos", lambda x: np.nextafter(cosine(x), 2.0))
    assert said != made_on()


@pytest.mark.slow
def test_the_script_of_bit_flips_finds_no_number_changed(capsys: pytest.CaptureFixture[str]) -> None:
    script = runpy.run_path(str(Path(__file__).parents[1] / "benchmarks" / "bit_flips.py"))
    assert script["main"](["--count", "10", "--seed", "3"]) == 0
    rows = [line.split() for line in capsys.readouterr().out.splitlines()[1:]]
    assert [row[0] for row in rows] == script["KINDS"]
    for kind, *counts in rows:
        assert sum(map(int, counts)) == 10 and counts[2:] == ["0", "0"], kind


@pytest.mark.slow
def test_a_changed_dataset_is_written_with_its_own_hash(tmp_path: Path) -> None:
    ds = fd.to_dataset(fm.simulate(SCENE)).copy(deep=True)
    ds["maximum_force"] = ds["maximum_force"] * 1.5
    path = fd.write(ds, tmp_path / "changed.nc")
    assert fd.read(path)["maximum_force"] == ds["maximum_force"]
    (wrong,) = fd.check(path)
    assert wrong.startswith("maximum_force is ") and "if it is simulated again" in wrong
    part = fd.write(ds.drop_vars("impulse"), tmp_path / "part.nc")
    assert "content_sha256" not in fd.read(part).attrs
    assert fd.check(part) == ["attribute content_sha256 is missing", "variable impulse is missing"]


@pytest.mark.slow
def test_check_simulates_rows_again(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = sample("sweep", ".nc", tmp_path)
    assert main(["check", str(path)]) == 0
    assert capsys.readouterr().out == f"{path}: nothing is wrong\n"
    ds = fd.read(path).copy(deep=True)
    ds["maximum_force"][0] *= 1.001
    fd.write(ds, path, overwrite=True)
    assert main(["check", str(path), "--rows", "3"]) == 3
    assert capsys.readouterr().out.startswith("impact 0: maximum_force is ")
    with pytest.raises(ValueError, match="rows is -1"):
        fd.check(path, -1)


def test_a_later_version_is_refused(tmp_path: Path) -> None:
    ds = fd.to_dataset(fm.simulate(SCENE)).assign_attrs(film_model_schema_version="99.0")
    with pytest.raises(ValueError, match=r"version '99\.0' of impact_history is not known"):
        fd.read(fd.write(ds, tmp_path / "later.nc"))


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["link", "soft link", "virtual", "external"])
def test_a_file_that_leads_to_another_one_is_refused(tmp_path: Path, kind: str) -> None:
    path = sample("sweep", ".nc", tmp_path)
    other = tmp_path / "other.nc"
    other.write_bytes(path.read_bytes())
    with h5py.File(path, "r+") as file:
        values = file["maximum_force"][:]
        del file["maximum_force"]
        if kind == "link":
            file["maximum_force"] = h5py.ExternalLink(str(other), "/maximum_force")
        elif kind == "soft link":
            file["maximum_force"] = h5py.SoftLink("/impulse")
        elif kind == "virtual":
            layout = h5py.VirtualLayout(values.shape, values.dtype)
            layout[:] = h5py.VirtualSource(str(other), "maximum_force", values.shape)
            file.create_virtual_dataset("maximum_force", layout)
        else:
            raw = tmp_path / "raw"
            raw.write_bytes(np.zeros_like(values).tobytes())
            file.create_dataset("maximum_force", values.shape, values.dtype, external=[(str(raw), 0, values.nbytes)])
    with pytest.raises(OSError, match='"maximum_force" is in another file, which is not read'):
        fd.open(path)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["link", "loop"])
def test_a_file_with_groups_is_refused(tmp_path: Path, kind: str) -> None:
    """The netCDF library follows links in groups, and groups that hold themselves without end."""
    path = sample("sweep", ".nc", tmp_path)
    with h5py.File(path, "r+") as file:
        group = file.create_group("inner")
        if kind == "link":
            group["maximum_force"] = h5py.ExternalLink(str(tmp_path / "other.nc"), "/maximum_force")
        else:
            group["loop"] = file["/"]
    with pytest.raises(OSError, match='"inner" is a group: only variables at the top are read'):
        fd.open(path)


def test_a_zarr_folder_that_cannot_be_written_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("zarr")

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(files, "seal_store", full)
    with pytest.raises(OSError, match=r"impact\.zarr: cannot be written: No space left on device"):
        fd.write(fd.to_dataset(fm.simulate(SCENE)), tmp_path / "impact.zarr")
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes")
@pytest.mark.parametrize("kind", ["link", "pipe"])
def test_a_zarr_folder_that_leads_elsewhere_is_refused(tmp_path: Path, kind: str) -> None:
    pytest.importorskip("zarr")
    path = sample("sweep", ".zarr", tmp_path)
    chunk = next(file for file in path.rglob("*") if "c" in file.relative_to(path).parts and file.is_file())
    if kind == "link":
        chunk.rename(tmp_path / "elsewhere")
        chunk.symlink_to(tmp_path / "elsewhere")
    else:
        chunk.unlink()
        os.mkfifo(chunk)
    with pytest.raises(OSError, match=f'"{chunk.name}" in it is a link, a pipe or a device'):
        fd.open(path)


def test_a_filter_of_another_program_is_refused(tmp_path: Path) -> None:
    """HDF5 would load it from a folder of plugins."""
    path, lzf = sample("sweep", ".nc", tmp_path), 32000
    with h5py.File(path, "r+") as file:
        values = file["maximum_force"][:]
        del file["maximum_force"]
        file.create_dataset("maximum_force", data=values, chunks=values.shape, compression="lzf")
    with pytest.raises(OSError, match=f'"maximum_force" needs filter {lzf}, which is not allowed'):
        fd.open(path)


@pytest.mark.skipif(sys.platform == "win32", reason="another kind of locks")
def test_a_file_that_another_program_writes_is_not_called_damaged(tmp_path: Path) -> None:
    path = sample("sweep", ".nc", tmp_path)
    held = f"import h5py, sys; file = h5py.File({str(path)!r}, 'r+'); print(flush=True); sys.stdin.read()"
    with subprocess.Popen([sys.executable, "-c", held], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as other:
        assert other.stdout is not None
        other.stdout.readline()
        with pytest.raises(OSError, match="another program has it open for writing"):
            fd.open(path)
        other.communicate()
    fd.open(path).close()


def test_a_long_key_is_not_printed_whole(tmp_path: Path) -> None:
    key = "k" * 500_000
    with pytest.raises(fm.SceneError) as caught:
        fd.sweep(SCENE, {key: ["1 m/s"]})
    assert len(str(caught.value)) < 1000


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes")
def test_no_command_waits_for_a_pipe(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A scene, a sweep, a measurement, a dataset and a table are read from regular files only."""
    pipe, scene = str(tmp_path / "pipe.nc"), tmp_path / "scene.toml"
    os.mkfifo(pipe)
    scene.write_text(SCENE.to_toml(), encoding="utf-8")
    commands: list[list[Any]] = [
        ["run", pipe],
        ["run", "/dev/zero"],
        ["sweep", pipe, "--output", tmp_path / "out.nc"],
        ["identify", pipe, scene, "--fit", "contact.yield_strength"],
        ["plot", pipe],
        ["summarise", pipe],
        ["check", pipe],
        ["convert", pipe, tmp_path / "out.csv"],
    ]
    for command in commands:
        assert main(list(map(str, command))) in (2, 3), command
        assert "regular file" in capsys.readouterr().err, command
    with pytest.raises(fm.SceneError, match="is a pipe or a device"):
        SCENE.replace({"contact.law": "tabulated", "contact.file": pipe})


def test_a_value_far_outside_those_of_a_sweep_selects_no_impact() -> None:
    ds = fd.sweep(SCENE, {"impactor.velocity": ["1 m/s", "5 m/s"]})
    assert ds.film.scene(impactor_velocity="4.9 m/s").impactor.velocity == 5.0
    assert ds.film.scene(impactor_velocity="5.02 m/s").impactor.velocity == 5.0
    with pytest.raises(KeyError, match="the values are from 1 to 5 m"):
        ds.film.scene(impactor_velocity=1e9)
