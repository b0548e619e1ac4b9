"""What a history says to cite: every source of a law, a rule of unloading or a simulated effect has its entry."""

import re

import pytest

import film_model as fm
from film_model.cli.main import main
from film_model.effects import rate_hardening, viscoelasticity
from film_model.effects.judged import RULES
from film_model.laws.unloading import UNLOADINGS
from film_model.oblique import friction
from film_model.scene.noses import NOSE, OVAL
from film_model.studies.citations import keys, references

BALL = fm.Sphere("10 mm", "1 m/s", material="bearing steel")


def test_every_source_that_can_be_simulated_has_an_entry():
    sources = [law.source for law in fm.LAWS.values()] + [rule.source for rule in UNLOADINGS.values()]
    sources += [RULES["wave_losses"][0].source, RULES["material_damping"][0].source, viscoelasticity.RULE.source]
    sources += [NOSE, OVAL, friction.SOURCE, rate_hardening.RULE.source]
    missing = set(keys(sources)) - set(references())
    assert not missing and len(keys(sources)) >= 30


def test_entries_are_well_formed():
    for key, entry in references().items():
        assert entry.count("{") == entry.count("}") and entry.startswith("@") and entry.endswith("\n}"), key
        assert {"author", "year"} <= set(re.findall(r"(\w+) = \{", entry)), key
        assert key.endswith(re.search(r"year = \{(\d{4})\}", entry)[1]), key


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({}, ["tabor1951", "johnson1983"]),
        ({"contact.law": "stronge", "contact.unloading": "brake"}, ["stronge2000", "brake2015"]),
        ({"contact.law": "hertz", "effects.plasticity": False}, ["hertz1882"]),
        ({"contact.law": "hertz", "target.second_radius": "9 mm"}, ["hertz1882", "johnson1985"]),
        ({"contact.law": "hertz", "contact.friction": 0.1, "impactor.angle": "30 deg"}, ["mindlin1949", "jager1994"]),
    ],
)
def test_a_history_cites_what_it_used(changes, expected, recwarn):
    scene = fm.Scene(BALL, fm.HalfSpace("bearing steel" if "contact.law" in changes else "4340"))
    found = re.findall(r"@\w+\{(\w+),", fm.simulate(scene.replace(changes)).citations())
    assert found[:2] == ["film_model", "bigalabo2017"] and set(expected) <= set(found)


def test_the_command_prints_them(tmp_path, capsys):
    scene = fm.Scene(BALL, fm.Plate(thickness="5 mm", material="soda-lime glass"))
    (tmp_path / "s.toml").write_text(scene.to_toml(), "utf-8")
    assert main(["cite", str(tmp_path / "s.toml")]) == 0
    assert "@article{zener1941," in capsys.readouterr().out
