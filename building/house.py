"""What the sources are measured by, so that they get no worse: run by ``make check``.

``python building/house.py check`` compares the counts of ``house_rules.py`` with those in ``house.json`` and exits with 1
where one has risen. ``record`` writes lower counts down; with ``--raise`` it writes down higher ones too. ``show`` lists
every place that is counted, or those of the rules whose names begin with the words that follow.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from house_rules import RULES, Finding, Rule, long_subjects, sources_of
from house_words import replaced_words

ROOT = Path(__file__).resolve().parent.parent
SOURCES, GLOSSARY, RECORD = (
    Path("src", "workhold"),
    Path("docs", "glossary.md"),
    Path("building", "house.json"),
)
# How many places a sentence names.
PLACES = 6
# Counts by rule, then by what the rule counts them for, such as a room.
Counts = dict[str, dict[str, int]]
Places = Mapping[str, Mapping[str, Sequence[str]]]


def rules_of(root: Path) -> tuple[Rule, ...]:
    """Every rule of which findings are counted; those of words need the glossary."""
    words = replaced_words(root / GLOSSARY)
    return (
        *RULES,
        Rule("words that the glossary replaces", "use the word that stands beside it there", words),
    )


def places_of(root: Path) -> Places:
    """The places of all findings by rule and key, in the order of the files."""
    sources = sources_of(root / SOURCES)
    return {rule.name: by_key(list(rule.find(sources))) for rule in rules_of(root)}


def by_key(findings: Sequence[Finding]) -> dict[str, list[str]]:
    """The places of findings by their key."""
    keys = sorted({one.key for one in findings})
    grouped: dict[str, list[str]] = {key: [] for key in keys}
    for one in findings:
        grouped[one.key].append(one.place)
    return grouped


def counts_of(places: Places) -> Counts:
    """How many places there are of each."""
    return {name: {key: len(found) for key, found in keys.items()} for name, keys in places.items()}


def read_record(root: Path) -> Counts:
    """The counts that were recorded; none where there is no record yet."""
    path = root / RECORD
    record: Counts = json.loads(path.read_text()) if path.exists() else {}
    return record


def write_record(root: Path, counts: Counts) -> None:
    """Writes counts, one a line and sorted, so that branches merge."""
    (root / RECORD).write_text(json.dumps(counts, indent=1, sort_keys=True) + "\n")


def raised(places: Places, record: Counts, rules: Sequence[Rule]) -> list[str]:
    """A sentence for each count above the recorded one, with its places and what to do."""
    remedies = {rule.name: rule.remedy for rule in rules}
    found = []
    for name, keys in places.items():
        for key, where in keys.items():
            most = record.get(name, {}).get(key, 0)
            if len(where) > most:
                named = ", ".join(dict.fromkeys(where[-PLACES:])) if name != "size" else str(SOURCES)
                found.append(
                    f"{name}, {key}: {len(where)} where {most} are recorded: {remedies[name]} ({named})."
                )
    return found


def check(root: Path) -> int:
    """Says which counts have risen and which subjects of commits are too long; 1 where there are any."""
    places, recorded = places_of(root), read_record(root)
    offences = [*raised(places, recorded, rules_of(root)), *long_subjects(root, RECORD)]
    sys.stdout.write("".join(f"{sentence}\n" for sentence in offences))
    if not offences:
        fallen = counts_of(places) != recorded
        lower = " Some counts have fallen: write them down with `record`." if fallen else ""
        sys.stdout.write(f"The house is no worse than recorded.{lower}\n")
    return int(bool(offences))


def record(root: Path, *, may_raise: bool) -> int:
    """Writes the counts of now, unless one has risen and may not."""
    places, before = places_of(root), read_record(root)
    offences = [] if may_raise or not before else raised(places, before, rules_of(root))
    if offences:
        sys.stdout.write("".join(f"{sentence}\n" for sentence in offences))
        sys.stdout.write("Nothing is recorded: mend these, or raise the record with --raise and say why.\n")
        return 1
    write_record(root, counts_of(places))
    return 0


def show(root: Path, wanted: Sequence[str]) -> int:
    """Lists the places that are counted, but not those of the size."""
    for name, keys in places_of(root).items():
        if not name.startswith(tuple(wanted) or ""):
            continue
        for key, where in keys.items():
            sys.stdout.write(f"{name}, {key}: {len(where)}\n")
            if name != "size":
                sys.stdout.write("".join(f"  {place}\n" for place in where))
    return 0


def main(words: Sequence[str]) -> int:
    """Does what the words of the command ask for."""
    sys.path.insert(0, str(ROOT / "src"))
    match list(words):
        case ["check"]:
            return check(ROOT)
        case ["record", *flags] if set(flags) <= {"--raise"}:
            return record(ROOT, may_raise=bool(flags))
        case ["show", *wanted]:
            return show(ROOT, wanted)
    sys.stderr.write("usage: python building/house.py check | record [--raise] | show [RULE ...]\n")
    return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
