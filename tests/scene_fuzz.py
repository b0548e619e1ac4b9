"""Random and mutated scene and sweep files: each gives a scene or the project's own error.

With a guide that looks for new ways through the code (pip install atheris), for as long as one likes:

    mkdir corpus && PYTHONPATH=.:datasets python tests/scene_fuzz.py corpus -max_len=2000 -max_total_time=3600

tests/test_scene_mistakes.py runs some mutations, always the same.
"""

import random
import sys
import tempfile
from pathlib import Path

EXAMPLES = Path(__file__).parents[1] / "examples"
SWEEP = """scene = "base.toml"
design = "sobol"
samples = 64
seed = 1
[over]
"impactor.velocity" = { from = "0.1 m/s", to = "5 m/s", spacing = "log" }
"impactor.mass" = { normal = ["60 g", "5 g"] }
"""
WORDS = (
    '"1e400 m"',
    '"nan m/s"',
    '"-0 m"',
    '"1 parsec"',
    '"10 mm"',
    '""',
    "[]",
    "{}",
    "[[]]",
    "1e308",
    "-1",
    "nan",
    "inf",
    "true",
    '"hertz"',
    '"big-alabo"',
    '"body"',
    '"plate"',
    "0x7fffffffffffffffffff",
    "1979-05-27",
    '"1 m/s * 2"',
    '"' + "9" * 400 + ' m"',
    "[impactor]",
    "[target]",
    "[contact]",
    "[effects]",
    "[solver]",
    "[sweep]",
    "[[x]]",
    "a.b.c = 1",
    "accuracy = 1e-15",
    'gravity = "maybe"',
    'law = "tabulated"',
    'values = ["1 m", 2, [3]]',
    'from = "1 mm"',
    "count = 1000000000",
    "\x00",
    "\ufeff",
    "\u202e",
)


def read(text: str) -> bool:
    """Read a text as a scene file and as a sweep file; False if both refuse it. Any other exception is a defect."""
    from film_datasets.sweeps import read_sweep
    from film_model.base.errors import SceneError
    from film_model.scene import Scene

    good = False
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "x.toml")
        Path(folder, "base.toml").write_bytes((EXAMPLES / "scenes" / "tungsten_carbide_on_steel.toml").read_bytes())
        path.write_bytes(text.encode("utf-8", "surrogatepass"))
        for make in (Scene.from_toml, read_sweep):
            try:
                make(path)
                good = True
            except (SceneError, OSError):  # OSError: the scene that a sweep names cannot be read
                continue
    return good


def mutated(chance: random.Random, seeds: list[str]) -> str:
    """A seed with lines and values cut, doubled, swapped between seeds or replaced."""
    lines = chance.choice(seeds).splitlines()
    for _ in range(chance.randint(1, 6)):
        at = chance.randrange(len(lines)) if lines else 0
        what = chance.randrange(7)
        if not lines or what == 0:
            lines.insert(at, chance.choice(WORDS))
        elif what == 1:
            del lines[at]
        elif what == 2:
            lines.insert(at, chance.choice(chance.choice(seeds).splitlines() or [""]))
        elif what == 3 and "=" in lines[at]:
            lines[at] = lines[at].partition("=")[0] + "= " + chance.choice(WORDS)
        elif what == 4 and lines[at]:
            k = chance.randrange(len(lines[at]))
            lines[at] = (
                lines[at][:k]
                + chr(chance.choice((0, 9, 34, 39, 45, 46, 57, 91, 93, 123, 0x3BC, 0xD800, 0x1F600)))
                + lines[at][k + 1 :]
            )
        elif what == 5:
            lines[at] = lines[at][: chance.randrange(len(lines[at]) + 1)]
        else:
            chance.shuffle(lines)
    return "\n".join(lines)


def seeds() -> list[str]:
    """Every example's scene, and a sweep."""
    return [SWEEP, *(path.read_text("utf-8") for path in sorted(EXAMPLES.rglob("*.toml")))]


def main() -> None:
    """Run under atheris."""
    import atheris

    with atheris.instrument_imports(include=["film_model", "film_datasets"]):
        import film_model.scene  # noqa: F401
    known = seeds()

    def one(data: bytes) -> None:
        if data[:1] < b"\x80":
            read(data[1:].decode("utf-8", "replace"))
        else:
            read(mutated(random.Random(data), known))

    atheris.Setup(sys.argv, one)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
