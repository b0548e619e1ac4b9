"""Sweeps: designs, and mistakes in them."""

from __future__ import annotations

import shutil
import tomllib
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from sweep_cases import BALL, FILE, PLATE, RANGE, SPEEDS, cli

import film_datasets as fd
import film_model as fm
from film_datasets.sweeps import Sweep, read_sweep
from film_datasets.sweeps.blocks import Blocks
from film_datasets.sweeps.design_table import over_of_file
from film_model.scene.toml import LARGEST_FILE


def test_designs_draw_from_their_distributions() -> None:
    over = {
        "impactor.velocity": {"from": "0.1 m/s", "to": "10 m/s", "spacing": "log"},
        "target.material.yield_strength": {"normal": ["1 GPa", "0.1 GPa"]},
        "impactor.radius": {"lognormal": ["10 mm", "2 mm"]},
        "impactor.mass": {"uniform": ["10 g", "30 g"]},
        "contact.law": ["hertz", "stronge"],
    }
    for design in ("random", "sobol", "latin-hypercube"):
        sweep = Sweep.of(BALL, over, design, samples=4096, seed=5)
        v, s, r, m, law = sweep.values(0, 4096)
        assert np.log10(v).mean() == pytest.approx(0.0, abs=0.03)
        assert (s.mean(), s.std()) == pytest.approx((1e9, 1e8), rel=0.04)
        assert (r.mean(), r.std()) == pytest.approx((0.01, 0.002), rel=0.04)
        assert (m.min(), m.max()) == pytest.approx((0.01, 0.03), rel=0.01)
        assert law.mean() == pytest.approx(0.5, abs=0.03)
        pieces = [sweep.values(first, count) for first, count in ((0, 1), (1, 1000), (1001, 3095))]
        backwards = [sweep.values(first, 7) for first in (4000, 3)]
        for k, whole in enumerate((v, s, r, m, law)):
            assert np.array_equal(np.concatenate([piece[k] for piece in pieces]), whole)
            assert np.array_equal(backwards[0][k], whole[4000:4007])
            assert np.array_equal(backwards[1][k], whole[3:10])
        other = Sweep.of(BALL, over, design, samples=4096, seed=6).values(0, 4096)
        assert not np.array_equal(other[0], v)


def test_no_probability_is_an_infinite_value() -> None:
    over = {"impactor.velocity": {"normal": ["10 m/s", "1 m/s"]}, "impactor.radius": {"lognormal": ["1 mm", "1 mm"]}}
    for axis in Sweep.of(BALL, over, "random", samples=1).axes:
        values = axis.quantile(np.array([0.0, 0.5, 1.0 - 2.0**-53]))
        assert np.isfinite(values).all() and (np.diff(values) > 0).all() and values[0] > 0


def test_zip_pairs_the_lists() -> None:
    over = {"impactor.velocity": ["3 m/s", "1 m/s"], "contact.law": ["hertz", "stronge"]}
    ds = fd.sweep(BALL, over, "zip")
    assert fd.validate(ds) == []
    assert ds["maximum_force"].dims == ("impact",)
    assert ds["impactor_velocity"].values.tolist() == [3.0, 1.0]
    assert ds["coefficient_of_restitution"].values[0] == pytest.approx(1.0, rel=1e-9)


def test_a_very_long_coordinate_is_not_held_in_memory(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    fd.sweep(BALL, SPEEDS, output=tmp_path / "x.nc").close()
    for most, indexed in ((40, True), (39, False)):
        monkeypatch.setattr("film_datasets.files.MOST_INDEXED", most)
        with fd.open(tmp_path / "x.nc") as ds:
            assert ("impactor_velocity" in ds.indexes) == indexed
            assert fd.validate(ds) == []
            assert ds.film.scene(impactor_velocity=5.0).impactor.velocity == 5.0


def test_ends_of_a_range_are_exact() -> None:
    for spacing in ("linear", "log"):
        axis = {"from": "0.1 m/s", "to": "0.7 m/s", "count": 7, "spacing": spacing}
        (values,) = Sweep.of(BALL, {"impactor.velocity": axis}).values(0, 7)
        assert (values[0], values[-1]) == (0.1, 0.7)
        steps = np.diff(np.log(values) if spacing == "log" else values)
        np.testing.assert_allclose(steps, steps[0], rtol=1e-9)


@pytest.mark.parametrize("shape", [(1,), (70_000,), (3, 70_000), (70_000, 3), (300, 2, 400), (5, 66_000, 2), (2, 3, 4)])
def test_blocks_cover_the_sweep_in_order(shape: tuple[int, ...]) -> None:
    paths = ("impactor.velocity", "impactor.radius", "impactor.mass")
    ranges = (("0.1 m/s", "5 m/s"), ("1 mm", "9 mm"), ("1 g", "2 g"))
    over = {
        path: {"from": low, "to": high, "count": count} if count > 1 else [low]
        for path, (low, high), count in zip(paths, ranges, shape, strict=False)
    }
    sweep = Sweep.of(BALL, over)
    flat, first = np.arange(sweep.size).reshape(sweep.shape), 0
    blocks = Blocks(sweep)
    for number in range(len(blocks)):
        block = blocks[number]
        assert block.first == first
        assert np.array_equal(flat[block.region].ravel(), np.arange(first, first + block.count))
        assert block.count <= 65_536
        assert all(part.indices(n)[0] % c == 0 for part, n, c in zip(block.region, shape, blocks.shape, strict=True))
        first += block.count
    assert first == sweep.size


@pytest.mark.parametrize(
    ("before", "after", "line", "says"),
    [
        ('"0.1 m/s"', '"0.1 kg"', 4, '"0.1 kg" is a mass, a velocity is needed'),
        ('"0.1 m/s"', "0.1", 4, "0.1 has no unit, a velocity is needed"),
        ('"5 m/s"', '"-5 m/s"', 4, "must be >"),
        ('"impactor.velocity"', '"impactor.velocty"', 4, 'unknown key; did you mean "velocity"?'),
        ('"impactor.velocity"', '"impacter.velocity"', 4, 'unknown key; did you mean "impactor.velocity"?'),
        ("count = 30", "cuont = 30", 4, 'unknown key "cuont"; did you mean "count"?'),
        ("count = 30, ", "", 4, "missing: count"),
        ("count = 30", "count = 1.5", 4, "count 1.5 is not allowed"),
        ('"log"', '"lgo"', 4, 'spacing "lgo" is not allowed'),
        ('["250 MPa", "310 MPa"]', '"250 MPa"', 5, "is one value: a list of values"),
        ('["250 MPa", "310 MPa"]', "[]", 5, "an empty list"),
        ('["250 MPa", "310 MPa"]', '["250 MPa", "310 mm"]', 5, '"310 mm" is a length'),
        ('["250 MPa", "310 MPa"]', '["310 MPa", "250 MPa", "300 MPa"]', 5, "increase or decrease"),
        ('["250 MPa", "310 MPa"]', '{ normal = ["310 MPa", "15 MPa"] }', 5, "a distribution needs design"),
        ('"target.material.yield_strength"', '"target.thickness"', 5, "unknown key"),
        ('["250 MPa"', '["soft"', 5, '"soft" is not a number and a unit'),
        ('"grid"', '"gird"', 2, 'did you mean "grid"?'),
        ('"grid"', '"sobol"', 2, "needs the number of impacts"),
        ("design =", "desing =", 2, 'unknown key; did you mean "design"?'),
        ("steel.toml", "steal.toml", None, "cannot be read"),
        ("[over]", "[over", 3, "not TOML"),
    ],
)
def test_an_invalid_sweep_file_gives_one_message(
    capsys: pytest.CaptureFixture[str], sweep_file: Path, before: str, after: str, line: int | None, says: str
) -> None:
    assert before in FILE
    sweep_file.write_text(FILE.replace(before, after, 1), encoding="utf-8")
    status, out, err = cli(capsys, "sweep", sweep_file, "--output", sweep_file.with_name("out.nc"))
    assert (status, out) == (2, "")
    assert says in err
    assert "Traceback" not in err
    if line is not None and "samples" not in err:
        assert f"sweep.toml:{line}: " in err
    assert [path.name for path in sweep_file.parent.iterdir()] == ["sweep.toml"]


def test_all_mistakes_of_a_sweep_are_reported_together(sweep_file: Path) -> None:
    sweep_file.write_text(FILE.replace("velocity", "velocty").replace("310 MPa", "310 m"), encoding="utf-8")
    with pytest.raises(fm.SceneError) as caught:
        read_sweep(sweep_file)
    assert [mistake.line for mistake in caught.value.mistakes] == [4, 5]
    for said, options in (
        ("keep: ", {"keep": "sample"}),
        ("variables: ", {"variables": ["impulze"]}),
    ):  # not of the file
        sweep_file.write_text(FILE, encoding="utf-8")
        with pytest.raises(fm.SceneError, match=f"^{said}"):
            read_sweep(sweep_file, **options)


def test_a_misspelt_design_is_the_only_mistake(sweep_file: Path) -> None:
    text = FILE.replace('"grid"', '"sobl"\nsamples = 8').replace(
        '["250 MPa", "310 MPa"]', '{ normal = ["310 MPa", "15 MPa"] }'
    )
    sweep_file.write_text(text.replace(", count = 30", ""), encoding="utf-8")
    with pytest.raises(fm.SceneError) as caught:
        read_sweep(sweep_file)
    assert [mistake.key for mistake in caught.value.mistakes] == ["design"]


@pytest.mark.parametrize(
    ("changes", "lines"),
    [
        ({"design =": "desing =", "0.1 m/s": "0.1 kg", "310 MPa": "310 m"}, [2, 4, 5]),
        ({"design =": 'colour = "red"\ndesign =', '"grid"': '"gird"', "310 MPa": "310 m"}, [2, 3, 6]),
        ({"steel.toml": "steal.toml", '"grid"': '"gird"'}, [2, None]),  # without the scene, [over] cannot be checked
        ({"scene =": "scen =", '"grid"': '"sobol"', "0.1 m/s": "0.1 kg"}, [None, 1, 4]),
        ({"[over]": "[ovr]", '"grid"': '"gird"', "0.1 m/s": "0.1 kg"}, [None, 2, 3]),
        ({FILE[FILE.index("[over]") :]: "over = 3\n", '"grid"': "7"}, [2, 3]),
        ({FILE[FILE.index("[over]") :]: "[over]\n", '"grid"': "7"}, [2, 3]),
    ],
)
def test_mistakes_of_scene_and_sweep_are_reported_together(
    sweep_file: Path, changes: dict[str, str], lines: list[int | None]
) -> None:
    text = FILE
    for before, after in changes.items():
        assert before in text
        text = text.replace(before, after, 1)
    sweep_file.write_text(text, encoding="utf-8")
    with pytest.raises(fm.SceneError) as caught:
        read_sweep(sweep_file)
    assert [mistake.line for mistake in caught.value.mistakes] == lines, str(caught.value)


@pytest.mark.parametrize(
    ("over", "options", "says"),
    [
        ({}, {}, "at least one swept quantity"),
        ({"impactor.drop_height": ["1 m", "2 m"]}, {}, "give drop_height there in its place"),
        ({"target.diameter": ["1 m", "2 m"]}, {}, "give target.radius, half of it"),
        (
            {"impactor.diameter": ["1 m", "2 m"], "impactor.radius": ["1 m", "2 m"]},
            {},
            "over.impactor.diameter: impactor.radius is given, too: give one of them",
        ),
        ({"impactor.speed": ["1 m/s", "2 m/s"]}, {}, 'did you mean "impactor.velocity"?'),
        ({"impactor.density": ["1 kg/m^3"]}, {}, 'did you mean "impactor.material.density"?'),
        ({"impactor.velocity": ["1 m/s"], "impactor": [BALL.to_table()["impactor"]]}, {}, "swept too"),
        ({"contact.law": ["hertz", "hertz"]}, {}, "given 2 times"),
        ({"contact.law": ["hertz", "hurtz"]}, {}, 'did you mean "hertz"?'),
        ({"contact.law": {"from": "hertz", "to": "meyer"}}, {}, "is not a number"),
        ({"impactor.velocity": {"normal": ["1 m/s"]}}, {"design": "random", "samples": 3}, "two values: mean and"),
        ({"impactor.velocity": {"normal": ["1 m/s", "0 m/s"]}}, {"design": "random", "samples": 3}, "must be > 0"),
        (
            {"impactor.velocity": {"uniform": ["2 m/s", "1 m/s"]}},
            {"design": "sobol", "samples": 3},
            "least value first",
        ),
        (
            {"impactor.velocity": {"from": "2 m/s", "to": "1 m/s", "count": 3}},
            {"design": "sobol", "samples": 3},
            "count",
        ),
        ({"impactor.velocity": ["1 m/s"]}, {"design": "sobol", "samples": 0}, "a whole number from 1"),
        (
            {"impactor.velocity": ["1 m/s"]},
            {"design": "sobol", "samples": 2**31},
            "from 1 to 1073741824",
        ),
        ({"impactor.velocity": ["1 m/s"]}, {"samples": 3}, 'is not for design "grid"'),
        ({"impactor.velocity": ["1 m/s"]}, {"design": "random", "samples": 3, "seed": -1}, "seed"),
        ({"impactor.velocity": ["1 m/s", "2 m/s"], "impactor.mass": ["1 g"]}, {"design": "zip"}, "of one length"),
        pytest.param(
            {"solver": [{"segments": k} for k in range(1, 10_102)]}, {}, "at most 10000", marks=pytest.mark.slow
        ),
        ({"impactor.velocity": {**RANGE, "to": "1 m/s"}}, {}, "from and to are the same"),
        ({"impactor.velocity": {**RANGE, "from": "0 m/s", "spacing": "log"}}, {}, "spacing log needs from and to > 0"),
        ({"impactor.velocity": {**RANGE, "normal": ["1 m/s", "0.1 m/s"]}}, {}, "give normal alone"),
        (
            {"target.material.poissons_ratio": {"lognormal": [-0.1, 0.1]}},
            {"design": "random", "samples": 3},
            "the mean -0.1 of a lognormal distribution must be > 0",
        ),
        ({"contact.law": []}, {}, "an empty list"),
        ({"impactor.velocity": []}, {}, "an empty list"),
        ({"target.bending_stiffness.D11": ["1 N*m"]}, {}, "bending_stiffness is not in the scene: give it there first"),
        ({"impactor.velocity.x": ["1 m"]}, {}, "velocity has no entries of its own"),
    ],
)
def test_wrong_sweeps_are_refused(over: dict, options: dict, says: str) -> None:
    with pytest.raises(fm.SceneError, match=says):
        fd.sweep(BALL, over, **options)


@pytest.mark.parametrize(
    ("base", "path", "words", "wrong", "design"),
    [
        (PLATE, "target.kind", ["plate", "half-space"], "over.target.size: unknown key", "grid"),
        (BALL, "target.kind", ["half-space", "plate"], "over.target.thickness: missing", "grid"),
        (BALL, "contact.law", ["hertz", "hunt-crossley"], "give restitution or", "grid"),
        (BALL, "contact.law", ["hunt-crossley", "hertz"], "give restitution or", "grid"),
        (BALL, "contact.law", ["hertz", "hunt-crossley"], "give restitution or", "zip"),
    ],
)
def test_words_that_need_other_keys_can_be_sections(
    base: fm.Scene, path: str, words: list[str], wrong: str, design: str
) -> None:
    with pytest.raises(fm.SceneError) as caught:
        fd.sweep(base, {path: words}, design)
    told = str(caught.value)
    assert wrong in told
    section, key = path.split(".")
    hint = told.partition("list whole sections, e.g. ")[2]
    assert hint.startswith(f'"{section}" = [{{ {key} = ')
    with pytest.raises(fm.SceneError) as plain:  # an unknown word needs no other keys
        fd.sweep(base, {path: [words[0], "hurtz"]})
    assert words[0] == "hunt-crossley" or "sections" not in str(plain.value)
    (again,) = tomllib.loads(hint.splitlines()[0]).values()  # the example itself is a sweep
    assert fd.sweep(BALL, {section: again})["maximum_force"].shape == (2,)


@pytest.mark.slow
def test_tables_of_pandas(tmp_path: Path) -> None:
    """The column of the index, which has no heading, is explained; a table may be larger than a scene file."""
    table = pd.DataFrame({"impactor.velocity [m/s]": np.linspace(1.0, 2.0, 60_000)})
    table.to_csv(tmp_path / "index.csv")
    with pytest.raises(fm.SceneError, match=r"column 1 has no heading.*index=False"):
        over_of_file(tmp_path / "index.csv")
    table.to_csv(tmp_path / "runs.csv", index=False)
    assert (tmp_path / "runs.csv").stat().st_size > LARGEST_FILE
    assert len(over_of_file(tmp_path / "runs.csv")["impactor.velocity"]) == 60_000


def test_other_wrong_arguments(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="keep: "):
        fd.sweep(BALL, SPEEDS, keep="everything")
    with pytest.raises(ValueError, match="workers: 0"):
        fd.sweep(BALL, SPEEDS, workers=0)
    with pytest.raises(ValueError, match=r'must end in "\.nc", "\.zarr"'):
        fd.sweep(BALL, SPEEDS, output=tmp_path / "out.txt")
    with pytest.raises(FileNotFoundError, match="no folder"):
        fd.sweep(BALL, SPEEDS, output=tmp_path / "no" / "out.nc")
    assert list(tmp_path.iterdir()) == []


def test_a_sweep_larger_than_the_memory_or_disk_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    many = {"impactor.velocity": {"from": "0.1 m/s", "to": "5 m/s", "count": 10**9}}
    with pytest.raises(MemoryError, match="1000000000 impacts take about 174 GB, at most 4 GB go into memory"):
        fd.sweep(BALL, many)
    usage = shutil.disk_usage(tmp_path)._replace(free=75 * 10**9)
    monkeypatch.setattr("film_datasets.sweeps.disk_space.shutil.disk_usage", lambda _: usage)
    with pytest.raises(OSError, match=r"1000000000 impacts need about 2.. GB of disk.* GB in the end; 75 GB are free"):
        fd.sweep(BALL, many, output=tmp_path / "out.nc")
    assert list(tmp_path.iterdir()) == []
