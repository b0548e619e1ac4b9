"""Damaged FMUs: what is wrong with the file, in one sentence, before anything of it is used."""

from __future__ import annotations

import hashlib
import re
import signal
import subprocess
import sys
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path, PurePosixPath, PureWindowsPath
from typing import Any

from film_model.base.errors import DamagedFile
from fmu_wrapper import platforms, resource

_LOAD = "import ctypes, sys; ctypes.CDLL(sys.argv[1])"


_PLACE = r"^ERROR \((line \d+), column \d+\): "  # in messages of FMPy


def sound(source: Path) -> tuple[resource.Data, list[str]]:
    """The data of an FMU, and the platforms of its binaries.

    Raises FileNotFoundError; DamagedFile if the archive is damaged, leads out of its folder, or lacks a resource.
    """
    if not source.is_file():
        raise FileNotFoundError(f"{source}: no such file")
    try:
        with zipfile.ZipFile(source) as archive:
            names = archive.namelist()
            outside = [name for name in names if _leads_out(name)]
            if outside:
                raise DamagedFile(f"{source}: the entry {outside[0]!r} leads out of the FMU")
            needed = ["modelDescription.xml", *(f"resources/{name}" for name in resource.NAMES)]
            missing = [name for name in needed if name not in names]
            if missing:
                raise DamagedFile(f"{source}: not an FMU of film-model, {missing[0]} is missing")
            bad = archive.testzip()
            if bad is not None:
                raise DamagedFile(f"{source}: damaged, the checksum of {bad} is wrong")
            content = archive.read(f"resources/{resource.NAME}")
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError) as error:
        raise DamagedFile(f"{source}: not an FMU of film-model, the archive is damaged ({first_line(error)})") from None
    try:
        data = resource.read(content)
    except ValueError as error:
        raise DamagedFile(f"{source}: resources/{error}") from None
    return data, sorted({name.split("/")[1] for name in names if name.startswith("binaries/")})


def described(source: Path, folder: str, read: Callable[..., Any]) -> Any:
    """The model description in a folder, by FMPy's `read`; DamagedFile if it does not obey FMI."""
    where = f"{source}: modelDescription.xml"
    try:
        return read(folder, validate=True)
    except AttributeError:  # FMPy looks at the version before the schema
        raise DamagedFile(f"{where} has no fmiVersion") from None
    except LookupError:
        raise DamagedFile(f"{where} refers to a variable that it does not have") from None
    except Exception as error:  # of lxml or FMPy: there is no common class
        first = re.sub(_PLACE, r"\1: ", first_line((getattr(error, "problems", None) or [error])[0]))
        raise DamagedFile(f"{where} cannot be read: {first}") from error


def _leads_out(name: str) -> bool:
    paths = PurePosixPath(name), PureWindowsPath(name)
    return any(path.is_absolute() or ".." in path.parts or path.drive for path in paths)


def check_loads(source: Path, folder: Path, identifier: str, platform: str) -> None:
    """Raise DamagedFile if the binary does not load. It is tried in a process of its own, which it may kill."""
    suffix = Path(platforms.built_library()).suffix
    binary = folder / "binaries" / platform / f"{identifier}{suffix}"
    shown = binary.relative_to(folder).as_posix()
    if not binary.is_file():
        raise DamagedFile(f"{source}: {shown} is missing")
    content = hashlib.sha256(binary.read_bytes()).hexdigest()
    if content not in _FAILURES:
        _FAILURES[content] = _failure(binary)
    why = _FAILURES[content]
    if why:
        raise DamagedFile(f"{source}: {shown} cannot be loaded: {why.replace(str(binary) + ': ', '')}")


_FAILURES: dict[str, str] = {}
"""Hashes of binaries that were tried → why they do not load; "" for those that do."""


def _failure(binary: Path) -> str:
    longest_load = 60  # s
    command = [sys.executable, "-I", "-S", "-c", _LOAD, str(binary)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, errors="replace", timeout=longest_load)
    except subprocess.TimeoutExpired:
        return f"it takes longer than {longest_load:g} s"
    if done.returncode < 0:
        return f"it ends the process by {signal.Signals(-done.returncode).name}"
    if done.returncode and _processor(binary) != _processor(sys.executable):
        return "it is compiled for another processor"  # Linux says "No such file" of it
    return done.stderr.strip().splitlines()[-1].replace("OSError: ", "") if done.returncode else ""


def _processor(binary: str | Path) -> bytes:
    """The field e_machine of an ELF file; empty for other formats, of which the system says what is wrong."""
    head = Path(binary).read_bytes()[:20]
    return head[18:] if head[:4] == b"\x7fELF" else b""


def first_line(error: object) -> str:
    """The first line of an error's message, or its class."""
    return next(iter(str(error).strip().splitlines()), type(error).__name__)
