"""In every picture that a command draws: texts lie in the picture and apart, and axes have labels."""

from __future__ import annotations

import itertools

import pytest
from sweep_cases import SCENES

from film_model.cli.main import main
from film_model.plot import style

pytest.importorskip("matplotlib")
from matplotlib.backends.backend_agg import FigureCanvasAgg

pytestmark = pytest.mark.slow

BLANK = 2.5
"""Pixels between the edge of a text's box and its letters: height is left for accents and for descending letters."""

BARS = ("tolerance", "tornado")
"""Pictures whose bars have names instead of values and a label."""

DRAWN = ("strobe",)
"""Pictures of bodies, without axes."""

BALL = '[impactor]\nradius = "12 mm"\nvelocity = "2 m/s"\nmaterial = "bearing steel"\n[target]\n'
FILES = {
    "slab.toml": BALL + 'kind = "half-space"\nmaterial = "mild steel"\n',
    "pane.toml": BALL + 'kind = "plate"\nthickness = "6 mm"\nsize = ["300 mm", "300 mm"]\nmaterial = "mild steel"\n',
    "sensed.toml": BALL + 'kind = "beam"\nlength = "300 mm"\nwidth = "30 mm"\nthickness = "8 mm"\n'
    'material = "mild steel"\n'
    'sensors = [{ name = "a", position = "150 mm" }, { name = "b", position = "20 mm", strain = true }]\n',
    "slanted.toml": BALL.replace("[target]", 'angle = "40 deg"\nspin = "-900 rpm"\n[contact]\nfriction = 0.2\n[target]')
    + 'kind = "half-space"\nmaterial = "mild steel"\n',
    "lines.toml": 'scene = "slab.toml"\n[over]\n"target.material" = ["mild steel", "aluminium 6061-T6"]\n'
    '"impactor.velocity" = { from = "0.1 m/s", to = "10 m/s", count = 30, spacing = "log" }\n',
    "map.toml": 'scene = "slab.toml"\n[over]\n"impactor.radius" = { from = "1 mm", to = "10 mm", count = 15 }\n'
    '"impactor.velocity" = { from = "0.1 m/s", to = "10 m/s", count = 15, spacing = "log" }\n',
    "cloud.toml": 'scene = "slab.toml"\ndesign = "sobol"\nsamples = 256\n[over]\n"impactor.radius" = "10 mm ± 1 mm"\n'
    '"impactor.velocity" = "1 m/s ± 0.3 m/s"\n'
    '"target.material.yield_strength" = { normal = ["250 MPa", "12 MPa"] }\n',
    **{
        f"{name}.toml": f'title = "Balls in a row"\n[[bodies]]\ncount = {count}\nradius = "10 mm"\n'
        'material = "bearing steel"\nvelocity = "0.2 m/s"\n[target]\nmaterial = "granite"\n'
        for name, count in (("cradle", 4), ("row", 12))
    },
    **{
        f"{name}.toml": 'contact = { law = "hertz" }\n'
        + "".join(
            f'[[bodies]]\n{entry}\ncount = {count}\nradius = "10 mm"\nmaterial = "bearing steel"\n'
            for entry in ('name = "stem"\nvelocity = "0.2 m/s"', 'behind = "stem"', 'behind = "stem"')
        )
        for name, count in (("fork", 2), ("tree", 8))
    },
    "motions.csv": "time [us], a [m/s^2], b [g]\n"
    + "\n".join(f"{5 * k}, {min(k % 40, 15) * 9}, {-(k % 23)}" for k in range(100)),
    "force.csv": "time [us], contact_force [N]\n0, 0\n10, 50\n20, 90\n",
    "measured.csv": "velocity [m/s], restitution\n0.2, 0.61\n0.5, 0.50\n1, 0.42\n2, 0.36\n",
}
SWEEPS = ("lines", "map", "cloud")
COMMANDS = {
    **{f"run {name}": f"run {name} --plot picture.png" for name in ("slab.toml", "pane.toml", "sensed.toml")},
    **{f"run {path.stem}": f"run {path} --plot picture.png" for path in sorted(SCENES.glob("*.toml"))},
    "oblique": "run slanted.toml --plot picture.png",
    "strobe": "run slanted.toml --strobe picture.png",
    "chain": "run cradle.toml --plot picture.png",
    "chain of many": "run row.toml --plot picture.png",
    "tree": "run fork.toml --plot picture.png",
    "tree of many": "run tree.toml --plot picture.png",
    "bounce": "bounce slab.toml --plot picture.png",
    "spectrum": "spectrum sensed.toml --plot picture.png",
    "laws": "laws --plot picture.png",
    "regimes": "explain slab.toml --plot picture.png",
    "regimes of a plate": f"explain {SCENES / 'olsson_plate.toml'} --plot picture.png",
    "validation": "validate --law all --plot picture.png",
    "engines": "contact-for yade slab.toml --velocity 0.1..2 --plot picture.png",
    "score": "score force.csv --case hertz-half-space-0.4 --plot picture.png",
    "fit": "identify measured.csv slab.toml --fit contact.yield_strength --plot picture.png",
    "force from sensors": "identify --force-from motions.csv sensed.toml --plot picture.png",
    "tolerance": "tolerance cloud.toml --plot picture.png",
    **{name: f"plot {name}.nc --output picture.png --quantity maximum_force" for name in SWEEPS},
    **{
        kind: f"plot cloud.nc --output picture.png --quantity maximum_force --kind {kind}"
        for kind in ("histogram", "ecdf", "scatter", "tornado")
    },
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The files of the commands."""
    made = tmp_path_factory.mktemp("pictures")
    for name, text in FILES.items():
        (made / name).write_text(text, encoding="utf-8")
    for name in SWEEPS:
        assert main(["sweep", str(made / f"{name}.toml"), "--output", str(made / f"{name}.nc")]) == 0
    return made


def drawn(figure):
    """The texts of a figure that are drawn, with their boxes in pixels."""
    canvas, found = FigureCanvasAgg(figure), {}
    renderer = canvas.get_renderer()
    draw_text = renderer.draw_text

    def recorded(*arguments, mtext=None, **options):
        if mtext is not None:  # of several lines none has its text
            found[id(mtext)] = mtext
        draw_text(*arguments, mtext=mtext, **options)

    renderer.draw_text = recorded
    figure.draw(renderer)
    return [(text.get_text(), text.get_window_extent(renderer).padded(-BLANK)) for text in found.values()]


@pytest.mark.parametrize("name", COMMANDS)
def test_texts_lie_in_the_picture_and_apart(name, folder, monkeypatch, capsys):
    figures = []
    monkeypatch.chdir(folder)
    monkeypatch.setattr(style, "_save", lambda figure, target, dpi: figures.append(figure))
    assert main(COMMANDS[name].split()) == 0, capsys.readouterr().err
    (figure,) = figures
    texts = drawn(figure)
    assert texts
    for text, box in texts:
        assert figure.bbox.x0 <= box.x0 and box.x1 <= figure.bbox.x1, text
        assert figure.bbox.y0 <= box.y0 and box.y1 <= figure.bbox.y1, text
    for (one, box), (other, beside) in itertools.combinations(texts, 2):
        assert not box.overlaps(beside), (one, other)
    assert name in DRAWN or any(panel.get_xlabel() for panel in figure.axes) or figure.get_supxlabel()
    assert name in (*BARS, *DRAWN) or any(panel.get_ylabel() for panel in figure.axes) or figure.get_supylabel()
