"""Seeded damage to STEP files that keeps their form: what a faulty export, a bad disk or an attacker makes of them."""

from __future__ import annotations

import random
import re
from collections.abc import Callable

NUMBER = re.compile(rb"(?<=[(,])-?\d+\.\d*(?:E[+-]?\d+)?(?=[,)])")
REFERENCE = re.compile(rb"(?<=[(,])#\d+")
ENTITY = re.compile(rb"^#\d+ ?=.*?;\n", re.MULTILINE | re.DOTALL)
EXTREMES = (
    b"-1.E308",
    b"1.E308",
    b"0.",
    b"1.E-308",
    b"-1.",
    b"1.E9",
    b"1.E-12",
    b"123456789.123",
    b"9" * 400 + b".",
)


def extreme_number(content: bytes, chance: random.Random) -> bytes:
    """One number of an entity becomes an extreme one."""
    return replaced(content, NUMBER, chance, lambda old: chance.choice(EXTREMES))


def near_number(content: bytes, chance: random.Random) -> bytes:
    """One number is off by a little or a factor."""
    return replaced(
        content,
        NUMBER,
        chance,
        lambda old: b"%r." % int(float(old) * chance.choice((-1, 2, 1000)) + chance.random() * 9),
    )


def crossed_references(content: bytes, chance: random.Random) -> bytes:
    """One entity is named where another should be."""
    names = REFERENCE.findall(content)
    return replaced(content, REFERENCE, chance, lambda old: chance.choice(names))


def dangling_reference(content: bytes, chance: random.Random) -> bytes:
    """One name is that of no entity, or of the entity that holds it."""
    return replaced(content, REFERENCE, chance, lambda old: chance.choice((b"#999999", b"$", b"*", b"#1")))


def dropped_entity(content: bytes, chance: random.Random) -> bytes:
    """One entity is missing."""
    return replaced(content, ENTITY, chance, lambda old: b"")


def doubled_entity(content: bytes, chance: random.Random) -> bytes:
    """One entity stands in the place of another, under that one's name."""
    bodies = [entity.split(b"=", 1)[1] for entity in ENTITY.findall(content)]
    return replaced(content, ENTITY, chance, lambda old: old.split(b"=", 1)[0] + b"=" + chance.choice(bodies))


def cut_short(content: bytes, chance: random.Random) -> bytes:
    """A run of entities is missing, the end mark is there."""
    entities = [match.start() for match in ENTITY.finditer(content)]
    first, last = sorted(chance.sample(entities, 2))
    return content[:first] + content[last:]


def flipped_bytes(content: bytes, chance: random.Random) -> bytes:
    """Some bytes are others."""
    damaged = bytearray(content)
    for _ in range(chance.randint(1, 30)):
        damaged[chance.randrange(len(damaged))] = chance.choice(b"#$*(),;'.-0123456789E\x00\xff ABCXYZ_")
    return bytes(damaged)


DAMAGES: tuple[Callable[[bytes, random.Random], bytes], ...] = (
    extreme_number,
    near_number,
    crossed_references,
    dangling_reference,
    dropped_entity,
    doubled_entity,
    cut_short,
    flipped_bytes,
)


def replaced(
    content: bytes, pattern: re.Pattern[bytes], chance: random.Random, make: Callable[[bytes], bytes]
) -> bytes:
    """The content with one of the pattern's places made anew."""
    places = [match.span() for match in pattern.finditer(content)]
    start, end = chance.choice(places)
    return content[:start] + make(content[start:end]) + content[end:]


def damaged(content: bytes, seed: int) -> bytes:
    """A file with one to three damages, of the kind that the seed tells."""
    chance = random.Random(seed)
    damage = DAMAGES[seed % len(DAMAGES)]
    for _ in range(chance.randint(1, 3)):
        content = damage(content, chance)
    return content
