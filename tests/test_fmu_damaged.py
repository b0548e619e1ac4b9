"""Damaged FMUs: one sentence with the path of the FMU, exit status 2, and Python survives."""

import re
import shutil
import sys
import zipfile
from pathlib import Path

import pytest

import film_model as fm
import fmu_wrapper
from film_model.base.errors import DamagedFile
from film_model.cli.main import main
from fmu_wrapper import platforms, resource

BALL = Path(__file__).parents[1] / "examples" / "scenes" / "tungsten_carbide_on_steel.toml"
VERSIONS = pytest.mark.parametrize("version", [2, 3])


def rewritten(source, target, change):
    """A copy whose entries are changed: change(name, content) → name and content, or None to leave it out."""
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(target, "w") as new:
        for name in old.namelist():
            made = change(name, old.read(name))
            if made is not None:
                new.writestr(*made)
    return target


def refused(path, capsys, *words):
    """Check that `run` and `check-fmu` refuse the file in one sentence that contains the words."""
    with pytest.raises(DamagedFile) as error:
        fmu_wrapper.run(path)
    assert main(["check-fmu", str(path)]) == 2
    told = capsys.readouterr().err.strip()
    for text in (str(error.value), told):
        assert text.startswith(f"{path}: ") and "\n" not in text and "Traceback" not in text
        assert all(word in text for word in words), text
        assert "/tmp/tmp" not in text


@pytest.fixture
def whole(made):
    return lambda version: made(fm.Scene.from_toml(BALL), version)


@VERSIONS
def test_a_truncated_binary_does_not_kill_python(whole, tmp_path, capsys, version):
    def cut(name, content):
        return name, content[: len(content) // 2] if name.startswith("binaries/") else content

    where = platforms.folder(platforms.this_platform(), version)
    path = rewritten(whole(version), tmp_path / "cut.fmu", cut)
    refused(path, capsys, f"binaries/{where}/", "cannot be loaded")


@pytest.mark.slow
@VERSIONS
def test_damaged_entries(whole, tmp_path, capsys, version):
    source = whole(version)

    def changed(wanted, new):
        return lambda name, content: (name, new(content)) if name == wanted else (name, content)

    xml = "modelDescription.xml"
    cases = {
        "truncated XML": (changed(xml, lambda c: c[: len(c) // 2]), (xml, "cannot be read")),
        "no experiment": (
            changed(xml, lambda c: b"\n".join(line for line in c.split(b"\n") if b"DefaultExperiment" not in line)),
            (xml, "has no DefaultExperiment"),
        ),
        "no version": (changed(xml, lambda c: c.replace(b"fmiVersion=", b"x=")), (xml, "has no fmiVersion")),
        "no token": (
            changed(xml, lambda c: re.sub(b"(guid|instantiationToken)=", b"x=", c)),
            (xml, "cannot be read: line 2: Element 'fmiModelDescription'"),
        ),
        "another token": (changed(xml, lambda c: c.replace(b"{", b"{0")), (xml, "belong to different FMUs")),
        "no number": (
            changed(xml, lambda c: c.replace(b'startTime="0', b'startTime="a')),
            (xml, "cannot be read", "startTime"),
        ),
        "two identifiers": (
            changed(xml, lambda c: c.replace(b'modelIdentifier="', b'modelIdentifier="a', 1)),
            (xml, "several model identifiers"),
        ),
        "a reference that leads nowhere": (
            changed(xml, lambda c: re.sub(b'<(Output valueReference|Unknown index)="', rb"\g<0>9", c)),
            (xml, "refers to a variable"),
        ),
        "short data": (changed(f"resources/{resource.NAME}", lambda c: c[:-5]), (f"resources/{resource.NAME}",)),
        "changed data": (
            changed(f"resources/{resource.NAME}", lambda c: c[:9999] + bytes([c[9999] ^ 1]) + c[10000:]),
            (f"resources/{resource.NAME}", "checksum"),
        ),
        "zip slip": (
            lambda name, content: ("../../evil.txt" if name.endswith("notes.json") else name, content),
            ("'../../evil.txt' leads out",),
        ),
    }
    for name in (xml, *(f"resources/{one}" for one in resource.NAMES)):
        cases[f"without {name}"] = (
            lambda entry, content, name=name: None if entry == name else (entry, content),
            (f"{name} is missing",),
        )
    for name, (change, words) in cases.items():
        path = rewritten(source, tmp_path / f"{name.replace('/', ' ')}.fmu", change)
        refused(path, capsys, *words)
    assert not (tmp_path.parent.parent / "evil.txt").exists()


@VERSIONS
def test_a_damaged_archive(whole, tmp_path, capsys, version):
    content = whole(version).read_bytes()
    path = tmp_path / "impact.fmu"
    path.write_bytes(content[: len(content) // 2])
    refused(path, capsys, "the archive is damaged")
    path.write_bytes(b"no zip")
    refused(path, capsys, "not an FMU of film-model")
    with zipfile.ZipFile(whole(version)) as archive:
        at = archive.getinfo("documentation/licenses/license.txt").header_offset + 120
    path.write_bytes(content[:at] + bytes([content[at] ^ 255]) + content[at + 1 :])
    refused(path, capsys, "damaged")


def test_a_missing_binary(whole, tmp_path, capsys):
    path = tmp_path / "impact.fmu"
    shutil.copy(whole(3), path)
    where = f"binaries/{platforms.folder(platforms.this_platform(), 3)}/"

    def renamed(name, content):
        return (f"{where}other.so" if name.startswith(where) else name), content

    refused(rewritten(whole(3), tmp_path / "renamed.fmu", renamed), capsys, where, "is missing")


@pytest.mark.skipif(sys.platform != "linux", reason="other systems say it themselves")
def test_a_binary_for_another_processor(whole, tmp_path, capsys):
    where = f"binaries/{platforms.folder(platforms.this_platform(), 3)}/"

    def other(name, content):
        machine = content[:18] + b"\xf3\x00" + content[20:]  # RISC-V
        return name, machine if name.startswith(where) else content

    refused(rewritten(whole(3), tmp_path / "other.fmu", other), capsys, where, "compiled for another processor")
