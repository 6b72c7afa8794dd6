"""SVG drawings that are nearly right: a drawing of all kinds of things with one of them replaced."""

from __future__ import annotations

import random

__all__ = ["make_svg"]

NUMBERS = (
    "0",
    "-0",
    "1e400",
    "-1e400",
    "1e-400",
    "1e300",
    "1e-300",
    "nan",
    "inf",
    "",
    " ",
    "1e",
    ".",
    "+",
    "٣",
)
NUMBERS += (
    "1" * 5000,
    "0x1",
    "1,2",
    "--1",
    "1e+999",
    "9" * 400,
    "1%",
    "1e30",
    "1e29",
    "1e16",
    "3mm",
    "2.5in",
)
LENGTHS = (
    *NUMBERS,
    "5em",
    "50%",
    "1e400%",
    "calc(1px)",
    "auto",
    "initial",
    "inherit",
    "var(--x)",
    "1e308mm",
    "2Q",
)
PAINTS = (
    "red",
    "none",
    "#12",
    "#1234",
    "#12345g",
    "color()",
    "rgb()",
    "rgb(1e400 0 0)",
    "hsl(nan 0 0)",
    "url(",
)
PAINTS += (
    "url(#l)",
    "url(#gone) red",
    "url(#p)",
    "currentcolor",
    "red icc-color(a)",
    "rgb(" * 300,
    "\\",
    "'",
)
PAINTS += (
    "color-mix(in srgb, red, blue)",
    "hwb(0 1e999% 1e999%)",
    "lab(none 0 0)",
    "device-cmyk(0 0 0 1)",
    "",
)
TRANSFORMS = (
    "scale(0)",
    "scale(1e300)",
    "scale(1e-300)",
    "scale(1e20) scale(1e20)",
    "rotate(1e400)",
    "skewX(90)",
)
TRANSFORMS += (
    "matrix(1 1 1 1 0 0)",
    "matrix(1)",
    "translate(nan)",
    "rotate(1 2)",
    "scale(1e-200)" * 3,
    "x(1)",
)
TRANSFORMS += (
    "scale(1,)",
    "scale(-1 1)",
    "rotate(30) " * 50,
    "translate(1e29) scale(1e14)",
    "((",
    "scale(1e14)" * 9,
)
SELECTORS = (
    "*",
    "g>rect",
    "g  g g rect",
    "rect~rect",
    "rect+*",
    ":not(",
    ":not(g rect)",
    ":has(> rect)",
    "[*|a]",
)
SELECTORS += (
    ":nth-child(2n+1 of rect)",
    ":nth-child(1e9n)",
    ":nth-last-of-type(-n+2)",
    "svg|",
    "svg|rect",
    "|",
    ">",
)
SELECTORS += (
    "g>",
    "g>>g",
    "a::before",
    "::x y",
    ":is(:is(:is(rect)))",
    ":lang(de)",
    "[d*='M' i]",
    "#",
    ".",
    "\\",
)
SELECTORS += (
    ":has(:has(a))",
    "rect,,g",
    ":nth-child(" + "9" * 5000 + ")",
    "g " * 60 + "rect",
    "[a=",
    ":hover",
    ":x()",
)
RULES = (
    "@media all{rect{fill:red}}",
    "@media print{rect{fill:none}}",
    "@import 'a';",
    "@x{rect{r:1}}",
    "@media{",
    "}",
)
RULES += (
    "@media all{" * 30,
    "rect{rect{fill:red}}",
    "rect{fill:" + "(" * 30 + "}",
    "rect{width:" + "1" * 5000 + "}",
    "<!--",
)
RULES += (
    "@keyframes a{0%{r:1}}",
    "rect{d:path('M0 0')}",
    "rect{all:unset}",
    "@namespace svg url(x);",
    "rect{fill:red!}",
    "/*",
)
COMMANDS = (
    "A1e300 1e300 0 0 1 9 9",
    "a1e-300 1 0 0 1 1 1",
    "a0 0 0 0 0 1 1",
    "a1 1 0 2 1 1 1",
    "c1 1 2 2",
    "zzz",
    "T9 9",
)
COMMANDS += (
    "L1e400 0",
    "l1e29 1e29",
    "m",
    "M",
    "h",
    "h1e-300",
    "S1 1 2 2",
    "q1e25 1e25 1 1",
    "A9 4 30 1 0 50 50",
    "x",
    ",",
)
COMMANDS += (
    "a5 5 0 01.5.5",
    "A1e20 1e20 0 0 1 9 9",
    "a1e-200 1e-200 0 1 1 1 1",
    "C1e29 0 1e29 0 1 1",
    "H1V1H1V1",
    "Z M1 1",
)
ROOTS = (
    'viewBox="0 0 0 0"',
    'viewBox="0 0 1e-320 1"',
    'viewBox="a"',
    'viewBox="0 0 100 1e30"',
    'viewBox="0 0 50 100"',
)
ROOTS += (
    'preserveAspectRatio="none"',
    'preserveAspectRatio="xMidYMid slice"',
    'preserveAspectRatio="x"',
    'width="0"',
)
ROOTS += (
    'width="1e308mm"',
    'width="1e-320mm"',
    'width="9px"',
    'width="50%"',
    'height="-3mm"',
    'transform="scale(2)"',
)
ROOTS += (
    'style="width:3mm"',
    'xmlns="http://www.w3.org/1999/xhtml"',
    'display="none"',
    'zoomAndPan="x"',
    "'",
)
DOCTYPES = (
    '<!DOCTYPE svg [<!ENTITY a "a">]>',
    '<!DOCTYPE svg [<!ATTLIST g a CDATA "x">]>',
    "<!DOCTYPE svg []>",
)
DOCTYPES += (
    '<!DOCTYPE svg SYSTEM "x">',
    '<!DOCTYPE svg [<!ENTITY % a "b">%a;]>',
    "<!DOCTYPE x [<!ELEMENT svg ((((a))))>]>",
)
DOCTYPES += (
    '<!DOCTYPE svg [<!ATTLIST svg xmlns:a CDATA #FIXED "b">]>',
    "<?xml-stylesheet href='a'?>",
    "<!DOCTYPE",
    "\0",
)
DOCTYPES += (
    "<?xml version='1.0' encoding='utf-16'?>",
    "<?xml version='1.0' encoding='idna'?>",
    "<?xml version='1.1'?>",
    "\ufeff",
)
DOCTYPES += (
    "<?xml version='1.0' encoding='cp037'?>",
    "<?xml version='1.0' encoding='hex'?>",
    "<?xml version='1.0' encoding='utf-7'?>",
)
LINKS = ("#gone", "#all", "#r", "other.svg#a", "", "#%72", "#s", "#%ff", "data:x", "#c")
CLIPS = ("url(#c)", "url(#gone)", "inset(1px)", "url(#all)", "none", "url(")
PLAIN = {
    "head": "<?xml version='1.0' encoding='UTF-8'?>",
    "root": 'width="100mm" height="80mm" viewBox="0 0 100 80"',
    "selector": "g > rect.a",
    "rule": "circle { stroke: none }",
    "transform": "translate(5 5) rotate(10)",
    "style": "fill: none; stroke: #000",
    "paint": "red",
    "x": "5",
    "width": "60",
    "rx": "3",
    "points": "20,20 30,20 25,30",
    "command": "l2 3",
    "link": "#s",
    "clip": "none",
    "opacity": "1",
    "dash": "2 1",
    "origin": "0 0",
    "angle": "30deg",
    "condition": "",
    "tag": "circle",
}
CHOICES = {
    "head": DOCTYPES,
    "root": ROOTS,
    "selector": SELECTORS,
    "rule": RULES,
    "transform": TRANSFORMS,
    "style": tuple(rule.replace("{", ";").replace("'", "") for rule in RULES)
    + tuple(f"fill:{one}".replace('"', "") for one in PAINTS)
    + tuple(f"transform:{one}" for one in TRANSFORMS)
    + tuple(f"r:{one};x:{one}" for one in LENGTHS),
    "paint": PAINTS,
    "x": LENGTHS,
    "width": LENGTHS,
    "rx": LENGTHS,
    "points": tuple(f"1,1 {one} 3,9" for one in NUMBERS),
    "command": COMMANDS,
    "link": LINKS,
    "clip": CLIPS,
    "opacity": (*NUMBERS, "50%", "1e999%"),
    "dash": (*NUMBERS, "1 2 3", "none", "1" + " 1" * 999, "-1 2"),
    "origin": ("50% 50%", "1e400% 0", "left", "top left", "center", "1 2 3 4", *LENGTHS),
    "angle": ("1e400deg", "1turn", "nan", "30", "x 1deg", "z 5rad", "1e300grad"),
    "condition": ('systemLanguage="de"', 'requiredFeatures="x"', 'requiredExtensions=""', 'a="b" a="c"', "<"),
    "tag": (
        "g",
        "svg",
        "switch",
        "a",
        "use",
        "text",
        "image",
        "animate",
        "link",
        "style",
        "symbol",
        "marker",
        "mask",
        "ellipse",
    ),
}


def make_svg(chance: random.Random) -> bytes:
    """A drawing with one or two things replaced; now and then some of its bytes as well.

    Parameters
    ----------
    chance : what is drawn from.
    """
    part = dict(PLAIN)
    for name in chance.sample(sorted(PLAIN), chance.choice((1, 1, 1, 2))):
        part[name] = chance.choice(CHOICES[name])
    text = """{head}
<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" {root}>
<style>{selector} {{ fill: none; stroke: red }} {rule}</style>
<defs><symbol id="s" viewBox="0 0 10 10"><rect id="r" width="5" height="5"/></symbol>
<linearGradient id="l"><stop stop-opacity="{opacity}"/></linearGradient>
<pattern id="p" xlink:href="{link}"/><clipPath id="c"><rect x="-9" y="-9" width="900" height="{width}"/></clipPath></defs>
<g id="all" transform="{transform}" style="{style}" clip-path="{clip}">
<rect class="a" x="{x}" y="5" width="{width}" height="40" rx="{rx}" fill="{paint}" opacity="{opacity}"/>
<g style="rotate:{angle};transform-origin:{origin}">
<{tag} id="t" {condition} cx="20" cy="20" r="{rx}" stroke-dasharray="{dash}"/></g>
<polygon points="{points}" stroke-width="{x}"/>
<path fill-rule="nonzero" d="M40 20h9v9h-9z M42 22{command} h2v2z"/>
<use href="{link}" x="50" y="20" width="10" height="{rx}"/></g></svg>""".format(**part)
    content = bytearray(text.encode("utf-8", "surrogatepass"))
    if chance.random() < 0.1:
        for _ in range(chance.randint(1, 4)):
            place = chance.randrange(len(content))
            content[place : place + chance.randint(0, 3)] = chance.randbytes(chance.randint(0, 3))
    return bytes(content)
