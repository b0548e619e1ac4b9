"""The paper in docs/paper: what the journal asks for, and numbers that are those of the pages it names."""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "docs" / "paper"
HEADER, TEXT = (FOLDER / "paper.md").read_text(encoding="utf-8").split("---\n")[1:]
ENTRIES = (FOLDER / "paper.bib").read_text(encoding="utf-8")
SECTIONS = ("Summary", "Statement of need", "State of the field", "Software design", "Research impact statement")


def test_it_has_the_sections_and_the_length_that_are_asked_for():
    assert re.findall(r"^# (.*)$", TEXT, re.MULTILINE) == [*SECTIONS, "References"]
    assert 750 <= len(TEXT.split()) <= 1000


def test_what_it_cites_and_shows_is_there():
    cited = set(re.findall(r"@(\w+)", TEXT))
    assert cited == set(re.findall(r"^@\w+\{(\w+),", ENTRIES, re.MULTILINE))
    for path in re.findall(r"\]\(([^)]+)\)", TEXT):
        assert (FOLDER / path).is_file(), path


def test_its_numbers_are_those_of_the_pages_it_names():
    checked = 0
    for paragraph in TEXT.split("\n\n"):
        pages = [(FOLDER / path).read_text(encoding="utf-8") for path in re.findall(r"\]\(([^)]+\.md)\)", paragraph)]
        words = re.sub(r"@\w+|\{[^}]*\}|\([^)]*\)", "", paragraph)
        for number in re.findall(r"\b\d[\d.,]*(?:e-\d+)?\b", words):
            assert any(re.search(rf"(?<![\d.]){re.escape(number)}(?![\d.]*\d)", page) for page in pages), number
            checked += 1
    assert checked >= 20


def test_authors_and_version_are_those_of_the_citation():
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    authors = re.findall(r"^  - name: (.*)$", citation.partition("references:")[0], re.MULTILINE)
    assert authors and re.findall(r"^  - name: (.*)$", HEADER, re.MULTILINE) == authors
    assert all(f'"{name}"' in (ROOT / ".zenodo.json").read_text(encoding="utf-8") for name in authors)
    assert f"version = {{{re.search(r'^version: (.*)$', citation, re.MULTILINE)[1]}}}" in ENTRIES
