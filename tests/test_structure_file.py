"""Structures from files of vibrations: what is read, and one sentence for every mistake."""

import math
import os
import random

import netCDF4
import numpy as np
import pytest
from cases import LAWS

import film_datasets as fd
import film_model as fm
from film_model.cli.main import main
from film_model.effects.choose import choose
from film_model.targets.structure_file import read_structure

GOOD = (
    "frequency [Hz], modal_mass [kg], shape, damping_ratio\n300, 0.02, -0.7, 0.01\n100, 0.01, 1, 0.02\n0, 0.03, 1, 0\n"
)


@pytest.fixture
def written(tmp_path):
    def write(text, name="modes.csv"):
        path = tmp_path / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return str(path)

    return write


def scene(target, gravity=False):
    ball = fm.Sphere("10 mm", "0.1 m/s", material="mild steel")
    return fm.Scene(ball, target, fm.Contact("hertz"), fm.Effects(gravity=gravity))


def test_a_csv_file(written):
    target = fm.Structure(written(GOOD), material="mild steel")
    assert target.frequency == (0.0, 100.0, 300.0) and target.damping_ratio == (0.02, 0.01) and target.file is None
    assert target.modal_mass == pytest.approx((0.03, 0.01, 0.02 / 0.49))
    modes = target.modes(2 * math.pi * 200.0)
    assert modes.frequency == pytest.approx([0.0, 200 * math.pi]) and modes.damping_ratio.tolist() == [0.0, 0.02]
    assert modes.share == pytest.approx([1 / 0.03, 100.0]) and not target.held
    assert target.compliance == pytest.approx(100.0 / (200 * math.pi) ** 2 + 24.5 / (600 * math.pi) ** 2)
    again = fm.Scene.from_text(scene(target).to_toml())
    assert again == scene(target)


@pytest.mark.parametrize(
    "text",
    [
        "# a comment\nfrequency; modal_mass; shape\n\n0.1 kHz; 10 g; 1\n0.3 kHz; 20 g; -0.7\n",
        "\ufefffrequency (rad/s)\tmass_normalised_shape (1/√kg)\n628.31853071\t10\n1884.95559215\t4.949747468\n",
        "frequency [Hz], mass_normalised_shape [t^-0.5]\n100, 316.22776601683796\n300, -156.52475842498527\n",
        'shape,"frequency [Hz]",modal_mass [g]\n1,100,10\n0.7,300,20\n0,200,20\n',
    ],
)
def test_separators_units_and_columns(text, written):
    target = fm.Structure(written(text))
    assert target.frequency == pytest.approx((100.0, 300.0)) and target.held
    assert target.modal_mass == pytest.approx((0.01, 0.02 / 0.49))


def make_netcdf(path, **variables):
    with netCDF4.Dataset(path, "w") as file:
        for name, (values, unit) in variables.items():
            values = np.asarray(values)
            dimensions = [file.createDimension(f"{name}{k}", size).name for k, size in enumerate(values.shape)]
            variable = file.createVariable(name, values.dtype if values.dtype.kind != "U" else str, dimensions)
            variable[...] = values
            if unit is not None:
                variable.units = unit
    return str(path)


def test_a_netcdf_file(tmp_path):
    target = fm.Structure(
        make_netcdf(
            tmp_path / "modes.nc",
            frequency=([300.0, 100.0], "Hz"),
            modal_mass=([0.02, 0.01], "kg"),
            shape=([-0.7, 1.0], "1"),
            static_compliance=(3e-4, "m/N"),
        )
    )
    assert target.frequency == (100.0, 300.0) and target.compliance == 3e-4 and target.damping_ratio is None
    for wrong, message in (
        ({"frequency": ([1.0], "Hz")}, "no variable modal_mass"),
        (
            {"freq": ([1.0], "Hz"), "phi": ([1.0], "1")},
            "no variable frequency: frequency, and modal_mass and shape or mass_normalised_shape, are needed; the file "
            'has "freq", "phi"$',
        ),
        (
            {"frequency": ([1.0], None), "mass_normalised_shape": ([1.0], "1/sqrt(kg)")},
            "the attribute units is missing",
        ),
        ({"frequency": ([1.0, 2.0], "Hz"), "mass_normalised_shape": ([1.0], "kg-0.5")}, "1 values of mass_normalised"),
        ({"frequency": ([[1.0]], "Hz"), "mass_normalised_shape": ([1.0], "kg-0.5")}, "must have one dimension"),
        ({"frequency": (["a"], "Hz"), "mass_normalised_shape": ([1.0], "kg-0.5")}, "frequency must be numbers"),
        ({"frequency": ([np.nan], "Hz"), "mass_normalised_shape": ([1.0], "kg-0.5")}, "vibration 1: frequency is nan"),
    ):
        with pytest.raises(fm.SceneError, match=message) as caught:
            fm.Structure(make_netcdf(tmp_path / "wrong.nc", **wrong))
        assert len(str(caught.value).splitlines()) == 1


HEAD = "frequency [Hz], modal_mass [kg], shape\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "line 1: no column frequency"),
        (HEAD, "has no vibrations"),
        ("frequency, modal_mass, shape\n1,2,3", 'line 2: frequency is "1", without a unit'),
        (HEAD + "1 Hz,2,3", 'line 2: frequency is "1 Hz", but the unit stands in the heading'),
        (HEAD + "1,2,3\n4,-2,3", "line 3: modal_mass is -2, from"),
        (HEAD + "1,0,3", "line 2: modal_mass is 0, from"),
        (HEAD + "-1,2,3", "line 2: frequency is -1, from"),
        (HEAD + "1,nan,3", 'line 2: modal_mass is "nan", a number is needed'),
        (HEAD + "1,2,inf", 'line 2: shape is "inf", a number is needed'),
        (HEAD + "1,2", 'line 2: shape is "", a number is needed'),
        (HEAD + "1,2,3,4", "line 2: 4 values for 3 columns"),
        (HEAD + "1,2,0\n3,4,0", "every shape is 0 at the struck point"),
        ("freqency [Hz], modal_mass [kg], shape\n", 'line 1: unknown column .*; did you mean "frequency"'),
        ("frequency [m], modal_mass [kg], shape\n1,2,3", 'line 1: frequency: the unit "m" is not understood: Hz or'),
        ("frequency [Hz], modal_mass [N], shape\n1,2,3", "line 1: modal_mass: .* is a force, a mass is needed"),
        ("frequency [Hz], modal_mass [kg], shape [m]\n1,2,3", "shape is a plain number"),
        ("frequency [Hz], modal_mass [kg]\n1,2", "no column shape"),
        ("frequency [Hz], mass_normalised_shape [kg^-0.5], shape\n1,2,3", "not both"),
        ("frequency [Hz], frequency [Hz]\n1,2", "two columns frequency"),
        ("frequency [Hz], modal_mass [kg], shape, damping_ratio\n1,2,3,1.5", "damping_ratio is 1.5"),
        (b"frequency \xff [Hz]", "is not a text in UTF-8: byte 10"),
        (b"CDF\x01garbage", "no variable frequency"),
        (b"\x89HDF\r\n\x1a\ngarbage", "cannot be read as netCDF"),
    ],
)
def test_one_sentence_names_the_line(text, message, written):
    with pytest.raises(fm.SceneError, match=message) as caught:
        fm.Structure(written(text))
    assert len(str(caught.value).splitlines()) == 1 and str(caught.value).startswith("Structure.file: ")


def test_only_files_of_limited_size_are_read(tmp_path, monkeypatch):
    os.mkfifo(tmp_path / "pipe")
    monkeypatch.setattr("film_model.targets.structure_file.MOST_BYTES", 10)
    (tmp_path / "large").write_text(GOOD)
    for path, message in (
        (tmp_path, "is a folder, a regular file is needed"),
        (tmp_path / "pipe", "is a pipe or a device, a regular file is needed"),
        (tmp_path / "large", "read at most"),
    ):
        with pytest.raises(fm.SceneError, match=message):
            fm.Structure(str(path))
    with pytest.raises(fm.SceneError, match="cannot be read: No such file or directory"):
        fm.Structure(str(tmp_path / "absent"))


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({}, "Structure.file: missing: give file, or frequency and modal_mass"),
        ({"frequency": ["1 Hz"]}, "Structure.modal_mass: missing"),
        ({"frequency": ["1 Hz", "2 Hz"], "modal_mass": ["1 kg"]}, "1 values for 2 frequencies"),
        ({"frequency": ["1 Hz"], "modal_mass": ["-1 kg"]}, "value 1 is -1"),
        ({"frequency": "1 Hz", "modal_mass": ["1 kg"]}, "is not a list"),
        ({"frequency": ["1 kg"], "modal_mass": ["1 kg"]}, "is a mass, a frequency is needed"),
        (
            {"frequency": ["1 Hz"], "modal_mass": ["1 kg"], "static_compliance": "1e-3 m/N"},
            "is less than that of the vibr",
        ),
    ],
)
def test_mistakes_of_lists(values, message):
    with pytest.raises(fm.SceneError, match=message):
        fm.Structure(**values)


def test_a_plate_as_a_structure_gives_the_same_impact(tmp_path):
    """The vibrations of a beam, written to a file, and its static compliance."""
    steel = fm.Material("steel", "210 GPa", 0.3, "7850 kg/m^3")
    beam = fm.Beam(steel, "200 mm", "10 mm", "8 mm", position="80 mm", theory="euler-bernoulli")
    modes = beam.modes(4e5)
    rows = [
        f"{w / 2 / math.pi!r}, {math.sqrt(s)!r}"
        for w, s in zip(modes.frequency.tolist(), modes.share.tolist(), strict=True)
    ]
    path = tmp_path / "beam.csv"
    path.write_text("frequency [Hz], mass_normalised_shape [1/sqrt(kg)]\n" + "\n".join(rows))
    same = fm.Structure(str(path), steel, static_compliance=f"{beam.compliance!r} m/N")
    a, b = (fm.simulate(scene(target), accuracy=1e-3).summary for target in (beam, same))
    assert b["maximum_force"] == pytest.approx(a["maximum_force"], rel=2e-3)
    assert b["rebound_velocity"] == pytest.approx(a["rebound_velocity"], rel=5e-3)


def test_missing_vibrations_are_a_warning():
    """One vibration of a beam whose contact lasts a fiftieth of its period."""
    few = {"frequency": ["400 Hz"], "modal_mass": ["0.05 kg"], "material": "mild steel"}
    effect = {e.name: e for e in choose(scene(fm.Structure(**few))).effects}["omitted_modes"]
    assert effect.state == "needed but not modelled" and "end at 400 Hz" in effect.reason
    assert effect.reason.endswith("needs more vibrations, or static_compliance")
    held = fm.Structure(**few, static_compliance="3.2e-6 m/N")
    again = {e.name: e for e in choose(scene(held)).effects}["omitted_modes"]
    assert again.value == effect.value and again.reason.endswith("needs more vibrations")


def test_on_the_command_line(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "modes.csv").write_text("frequency [Hz], modal_mass [kg], shape\n1,x,3")
    (tmp_path / "scene.toml").write_text(
        '[impactor]\nradius = "5 mm"\nvelocity = "1 m/s"\nmaterial = "mild steel"\n'
        '[target]\nkind = "structure"\nfile = "modes.csv"\nmaterial = "mild steel"\n'
    )
    assert main(["run", "scene.toml"]) == 2
    assert (
        capsys.readouterr()
        .err.strip()
        .endswith('target.file: "modes.csv", line 2: modal_mass is "x", a number is needed')
    )


@pytest.mark.parametrize("least", ["1e-6 Hz", "1e-4 Hz", "1 Hz"])
def test_slow_vibrations_are_as_motions_of_the_whole_structure(least):
    """Finite-element programs give a motion as a whole a small frequency: the ball is gone before it matters."""
    masses = ["1 kg", "0.1 kg", "0.1 kg"]
    lowest, steel = (least, "0 Hz"), "mild steel"
    parts = [fm.Structure(material=steel, frequency=[f, "1 kHz", "2.5 kHz"], modal_mass=masses) for f in lowest]
    slow, free = (fm.simulate(scene(part, gravity="auto")) for part in parts)
    assert slow.outcome is fm.Outcome.SEPARATED and slow.vibration.summary.lines < free.vibration.summary.lines + 5
    for name in ("maximum_force", "contact_duration", "rebound_velocity"):
        assert slow.summary[name] == pytest.approx(free.summary[name], rel=1e-6)


def test_a_structure_that_only_moves_as_a_whole_is_a_free_body():
    found = fm.simulate(scene(fm.Structure(frequency=["0 Hz"], modal_mass=["50 g"], material="mild steel"))).summary
    body = fm.simulate(scene(fm.Body("mild steel", radius="1 km", mass="50 g"))).summary
    for name in ("maximum_force", "contact_duration", "rebound_velocity"):
        assert found[name] == pytest.approx(body[name], rel=1e-4)


def test_a_structure_so_soft_that_the_indentation_is_rounding():
    """A heavy ball on a body of 1 g that hardly anything holds."""
    soft = fm.Structure(frequency=["1e-7 Hz"], modal_mass=["1 g"], material="mild steel")
    heavy = fm.Sphere("13 mm", "0.5 m/s", mass="70 kg", material="mild steel")
    effects = choose(fm.Scene(heavy, soft, fm.Contact(LAWS["saturating"]), fm.Effects(gravity=False))).effects
    assert any("too soft for an estimate" in effect.reason for effect in effects)


def test_the_motion_that_a_sweep_keeps():
    part = fm.Structure(frequency=["500 Hz"], modal_mass=["50 g"], material="mild steel")
    speeds = {"impactor.velocity": ["0.1 m/s", "0.2 m/s"]}
    kept = fd.sweep(scene(part), speeds, keep="samples=11")
    for k, speed in enumerate(speeds["impactor.velocity"]):
        one = fm.simulate(scene(part).replace({"impactor.velocity": speed}))
        times = np.linspace(0.0, 1.0, 11) * one.summary["contact_duration"]
        for name in ("contact_force", "target_displacement"):
            exact = getattr(one.sample_si(times), name)
            assert kept[f"sampled_{name}"].values[k] == pytest.approx(exact, abs=1e-3 * exact.max())


@pytest.mark.slow
def test_the_spectrum_of_one_vibration(tmp_path):
    """Its axes have no width of their own, which would be a warning of matplotlib."""
    part = fm.Structure(frequency=["500 Hz"], modal_mass=["50 g"], material="mild steel")
    spectrum = fm.simulate(scene(part)).plot().axes[-1]
    assert (
        spectrum.get_xlim()[1] > 10.0 * spectrum.get_xlim()[0]
        and spectrum.get_ylim()[1] > 10.0 * spectrum.get_ylim()[0]
    )


@pytest.mark.slow
def test_the_reader_survives_damaged_files(written, tmp_path):
    rng = random.Random(5)
    with open(
        make_netcdf(tmp_path / "good.nc", frequency=([1.0], "Hz"), mass_normalised_shape=([1.0], "kg-0.5")), "rb"
    ) as file:
        starts = [GOOD.encode(), HEAD.encode() + b"1,2,3\n" * 50, file.read(2000)]
    said = []
    for n in range(1500):
        data = bytearray(rng.choice(starts[: 2 if n % 10 else 3]))
        for _ in range(rng.randint(1, 8)):
            at = rng.randrange(len(data) + 1)
            what = rng.choice(
                [b"", b",", b"\n", b'"', b"-", b"\0", b"nan", b"1e999", b"[", bytes([rng.randrange(256)])]
            )
            data[at : at + rng.randint(0, 3)] = what
        path = written(bytes(data))
        try:
            listed = read_structure(path)
        except ValueError as error:
            said.append(str(error))
        else:
            assert np.isfinite(listed.frequency).all() and (np.array(listed.modal_mass) > 0).all()
    assert len(said) > 100 and not [text for text in said if "\n" in text or not text.startswith('"')]


def test_a_vibration_without_mass_is_named():
    """A contact that bounces on it more often than can be followed: which one, its mass, and what to check."""
    ball = fm.Sphere(radius="5 mm", velocity="1 m/s", material="mild steel")
    target = fm.Structure(frequency=["2.8 kHz"], modal_mass=["1.8e-22 kg"], material="mild steel")
    scene = fm.Scene(ball, target, fm.Contact("hertz"))
    with pytest.raises(fm.SimulationError, match=r"at 2800 Hz, has a modal mass of 1.8e-22 kg .*: check modal_mass"):
        fm.simulate(scene)


def test_numbers_of_other_programs(written):
    """Decimal commas between semicolons, exponents of Fortran, and the static compliance in a comment."""
    head = "# static_compliance = 4.01e-6 m/N\nfrequency [Hz]; mass_normalised_shape [1/sqrt(kg)]\n"
    text = head + "7,0804D+02; 8,771\n2453.4; -4.6\n"
    found = read_structure(written(text))
    assert found.frequency == (708.04, 2453.4) and found.modal_mass[0] == pytest.approx(8.771**-2)
    assert found.static_compliance == 4.01e-6
    with pytest.raises(ValueError, match="line 4: the same vibration as in line 2"):
        read_structure(written(GOOD.replace("0, 0.03, 1, 0\n", "300, 0.02, -0.7, 0.01\n")))
    with pytest.raises(ValueError, match="static_compliance: "):
        read_structure(written(text.replace("m/N", "kg")))
