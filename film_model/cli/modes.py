"""film-model modes: the vibrations of a structure from the program that computed them."""

from __future__ import annotations

import argparse
import math
import re

from film_model.cli.output import DONE, Commands, add_common, check_writable, print_warnings, print_written


def add_commands(commands: Commands) -> None:
    """The command and its options."""
    parser = commands.add("modes", "vibrations from a finite-element program, or from matrices M and K", modes)
    parser.add_argument("what", choices=("read",), help='read: write them as a file for kind = "structure"')
    files = (
        ".unv (data sets 55); .op2, .pch of Nastran; .rst of Ansys; .dat of Abaqus, CalculiX; meshes .vtu, .vtk, .pvd, "
        ".xdmf, .med; .npz with K, M, C; .mtx of K"
    )
    parser.add_argument("file", metavar="FILE", help=files)
    parser.add_argument("--mass", metavar="FILE", help="M in Matrix Market format, beside K")
    parser.add_argument("--damping", metavar="FILE", help="C in Matrix Market format, beside K; optional")
    parser.add_argument(
        "--node",
        type=int,
        required=True,
        metavar="N",
        help="node that is struck; point of a mesh, row of matrices, from 1",
    )
    parser.add_argument("--direction", choices=("x", "y", "z"), help="of the impact, at nodes")
    parser.add_argument("--sensors", default="", metavar="N[,N]", help="nodes or rows of sensors: columns shape_N")
    parser.add_argument(
        "--mass-unit", choices=("kg", "g", "t"), help="of the model, e.g. t with mm and N (default: the file's, or kg)"
    )
    parser.add_argument(
        "--array", metavar="NAME", help="shapes of a mesh that has several arrays, without their number"
    )
    parser.add_argument(
        "--frequencies", default="", metavar="F[,F]", help="in Hz, or a file of them, in place of the file's"
    )
    masses = "of the shapes, one or one a vibration, or a file of them, in place of the file's; 1: normalised by mass"
    parser.add_argument("--modal-masses", default="", metavar="M[,M]", help=masses)
    parser.add_argument("--output", required=True, metavar="FILE.csv", help="file of vibrations")
    add_common(parser, json=False)


def modes(options: argparse.Namespace) -> int:
    from pathlib import Path

    from film_model.targets.modes_of_programs import (
        MATRICES,
        Told,
        check_kind,
        gives_vibrations,
        read_matrices,
        read_vibrations,
    )

    check_writable(options.output, options.force)
    sensors = _numbers(options.sensors)
    path = Path(options.file)
    suffix = check_kind(path)
    if suffix not in MATRICES and options.direction is None:
        raise ValueError("--direction: missing: x, y or z is needed at a node")
    shapes = gives_vibrations(path, suffix)
    others = ("mass", "damping") if shapes else ("frequencies", "modal_masses", "array")
    for name in others:
        if getattr(options, name):
            raise ValueError(
                f"--{name.replace('_', '-')}: {path} has {'vibrations' if shapes else 'matrices'}: not allowed"
            )
    if shapes:
        frequencies, masses = (
            _values("--frequencies", options.frequencies),
            _values("--modal-masses", options.modal_masses),
        )
        told = Told(options.mass_unit, frequencies, masses, options.array)
        found = read_vibrations(path, options.node, options.direction, sensors, told)
    else:
        mass, damping = (None if name is None else Path(name) for name in (options.mass, options.damping))
        found = read_matrices(path, mass, damping, options.node, sensors, options.mass_unit, options.direction)
    found.write(Path(options.output))
    low, high = found.frequency[0], found.frequency[-1]
    print(f"{found.frequency.size} vibrations from {low:.6g} to {high:.6g} Hz")
    if found.place:
        print(f"node {options.node} at {', '.join(f'{x:.6g}' for x in found.place)}")
    if found.static_compliance is not None:
        print(f"static compliance {found.static_compliance:.6g} m/N")
    print_written(options.output)
    told = f"damping couples vibrations by up to {found.coupling:.2g} of their own: this is neglected"
    print_warnings([told] if found.coupling > 0.1 else [])
    return DONE


def _values(option: str, text: str) -> list[float]:
    """Numbers above or equal to 0 between commas or, in a file, also white space."""
    from pathlib import Path

    path = Path(text)
    if text and path.is_file():
        text = path.read_text("utf-8", errors="replace")
    try:
        found = [float(part) for part in re.split(r"[,;\s]+", text) if part]
    except ValueError:
        found = [math.nan]
    if not all(0.0 <= value < math.inf for value in found):
        raise ValueError(f'{option}: "{path}" is not a list of numbers such as 708,2453, or a file of them')
    return found


def _numbers(text: str) -> list[int]:
    try:
        found = [int(part) for part in text.split(",") if part.strip()]
    except ValueError:
        raise ValueError(f'--sensors: "{text}" is not a list of numbers such as 17,44') from None
    if len(set(found)) < len(found):
        raise ValueError(f'--sensors: "{text}" names a number twice')
    return found
