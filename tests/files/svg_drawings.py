"""Random structured SVG drawings, each in two writings: an author's, and one in plain attributes that every renderer knows.

Both mean the same by the standard. The author's writing has CSS geometry and CSS transforms, which resvg does not read; what
resvg does read (cascade, visibility, use, symbols, switches, nested drawings, clips, units) is the same text in both.
"""

from __future__ import annotations

from collections.abc import Iterator
from random import Random
from xml.sax.saxutils import quoteattr

from attrs import define, field, frozen

SIZE = 100.0
UNITS = {"px": 1.0, "mm": 96 / 25.4, "cm": 96 / 2.54, "in": 96.0, "pt": 96 / 72, "pc": 16.0, "Q": 96 / 101.6}
SHAPES = ("rect", "rect", "circle", "ellipse", "polygon", "polyline", "path", "path", "path", "line")
KINDS = ("shape", "shape", "shape", "g", "g", "g", "use", "use", "switch", "svg", "a")
INVISIBLE = (
    "display:none",
    "visibility:hidden",
    "opacity:0",
    "opacity: 0%",
    "fill:none;stroke:none",
    "visibility:collapse",
)
CLEAR = {
    "fill": (
        "fill:transparent",
        "fill:rgba(9,9,9,0)",
        "fill:#1230",
        "fill-opacity:0",
        "fill:none",
        "fill:currentColor;color:transparent",
        "fill:url(#gone) none",
        "fill:url(#gone)",
    ),
    "stroke": (
        "stroke:none",
        "stroke-width:0",
        "stroke-opacity:0",
        "stroke:transparent",
        "stroke-dasharray:0 9",
    ),
}
VISIBLE = ("visibility:visible", "opacity:.5", "display:inline", "display:nonsense")


@frozen
class RandomDrawing:
    """A drawing.

    Parameters
    ----------
    author, plain : its two writings.
    ids : the ids in it.
    hazards : why it may be refused; without any it must be read.
    filled : whether its shapes are filled, or stroked.
    """

    author: str
    plain: str
    ids: frozenset[str]
    hazards: frozenset[str]
    filled: bool


@define
class Node:
    """An element: attributes that both writings have, and those of one only."""

    tag: str
    both: dict[str, str] = field(factory=dict)
    author: dict[str, str] = field(factory=dict)
    plain: dict[str, str] = field(factory=dict)
    children: list[Node] = field(factory=list)
    text: str = ""

    def written(self, plain: bool) -> str:
        """The element as XML; both writings' styles are joined, those of one writing last."""
        attributes = dict(self.both)
        for name, value in (self.plain if plain else self.author).items():
            attributes[name] = (
                f"{attributes[name]};{value}" if name == "style" and name in attributes else value
            )
        words = "".join(f" {name}={quoteattr(value)}" for name, value in attributes.items())
        return (
            f"<{self.tag}{words}>{self.text}{''.join(c.written(plain) for c in self.children)}</{self.tag}>\n"
        )


def number(value: float) -> str:
    """A number of a drawing, without blanks or exponents."""
    text = f"{value:.4f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text


class Drafter:
    """Draws one random drawing."""

    def __init__(self, seed: int) -> None:
        self.random = Random(seed)
        self.filled = self.random.random() < 0.6
        self.count = 0
        self.hazards: set[str] = set()
        self.rules: list[str] = []
        self.own_rules: list[str] = []
        self.definitions: list[Node] = []
        self.linked: list[str] = []
        self.anchored = 0
        self.in_view = False

    def chance(self, probability: float) -> bool:
        """True now and then."""
        return self.random.random() < probability

    def between(self, low: float, high: float) -> float:
        """A number with few digits."""
        return round(self.random.uniform(low, high), self.random.choice((0, 1, 3)))

    def node(self, tag: str, **both: str) -> Node:
        """An element with an id of its own."""
        self.count += 1
        return Node(tag, {"id": f"{tag[0]}{self.count}", **both})

    def drawing(self) -> RandomDrawing:
        """The whole."""
        left, top = self.random.choice(((0.0, 0.0), (0.0, 0.0), (-30.0, 12.5)))
        root = self.node("svg", xmlns="http://www.w3.org/2000/svg")
        root.both["xmlns:xlink"] = "http://www.w3.org/1999/xlink"
        root.both["viewBox"] = f"{number(left)} {number(top)} {number(SIZE)} {number(SIZE)}"
        for name in ("width", "height"):
            root.plain[name] = root.author[name] = "100mm"
        if self.chance(0.1):
            root.author = {"width": "7mm", "style": "width:10cm; height:100mm"}
        group = self.node("g")
        group.both["transform"] = f"translate({number(left)} {number(top)})"
        group.both.update(self.paints())
        group.children = self.content(0)
        root.children = [Node("defs", children=self.definitions), group]
        if self.chance(0.04):
            root.both["transform"] = "scale(1.5)"
            self.hazards.add("root transform")
        if self.chance(0.03):
            root.both["style"] = self.random.choice(INVISIBLE)
        sheets = [Node("style", text="\n".join(self.rules))]
        author = Node(
            "svg", root.both, root.author, children=[*sheets, Node("style", text="".join(self.own_rules))]
        )
        author.children += root.children
        plain = Node("svg", root.both, plain=root.plain, children=[*sheets, *root.children])
        written = author.written(plain=False)
        ids = frozenset(part.split('"')[1] for part in written.split(" id=")[1:])
        return RandomDrawing(written, plain.written(plain=True), ids, frozenset(self.hazards), self.filled)

    def paints(self) -> dict[str, str]:
        """What makes the shapes of this drawing seen."""
        if self.filled:
            return {"fill": "#000", "stroke": "none", "fill-rule": self.random.choice(("nonzero", "evenodd"))}
        return {"fill": "none", "stroke": "#000", "stroke-width": "0.5", "stroke-linejoin": "round"}

    def content(self, depth: int) -> list[Node]:
        """Some elements of a container."""
        return [self.element(depth) for _ in range(self.random.randint(1, 3 if depth else 4))]

    def element(self, depth: int) -> Node:
        """Any element."""
        kind = "shape" if depth > 2 else self.random.choice(KINDS)
        kind = "g" if kind == "a" and self.anchored and self.chance(0.8) else kind
        # resvg sizes a drawing nested in a used one by the <use>.
        kind = "g" if kind == "svg" and self.in_view else kind
        if kind == "shape":
            node = self.shape()
        elif kind == "use":
            node = self.use(depth)
        else:
            node = self.node(kind)
            if kind == "a":
                # A link within a link is shown by some programs only; a link may also come by a <use>.
                self.hazards |= {"link in a link"} if self.anchored else set()
                self.anchored += 1
            node.children = self.content(depth + 1)
            if kind == "switch":
                self.condition(node.children)
            if kind == "svg":
                self.view(node, clips=True)
        if kind != "svg":
            self.transform(node)
        self.style(node)
        self.effects(node)
        return node

    def condition(self, children: list[Node]) -> None:
        """Conditions in a switch."""
        for child in children:
            if child.tag == "a":
                self.hazards.add("link in a switch")
            if self.chance(0.4):
                child.both["requiredExtensions"] = self.random.choice(("", "http://example.org/x"))
            elif self.chance(0.1):
                child.both["requiredFeatures"] = "http://www.w3.org/TR/SVG11/feature#Shape"
        if self.chance(0.05):
            children.insert(0, self.node("title"))
            self.hazards.add("title in a switch")

    def view(self, node: Node, clips: bool) -> None:
        """Size and viewBox of a nested drawing or a symbol; one that could cut is a hazard."""
        if self.chance(0.6):
            for name in ("width", "height"):
                node.both[name] = self.random.choice(("120", "40%", "80", "100%", "150%"))
            if clips:
                node.both["x"], node.both["y"] = number(self.between(-5, 20)), number(self.between(-5, 20))
        if self.chance(0.5):
            box = f"{number(self.between(-20, 0))} {number(self.between(-20, 0))} 130 {self.random.choice(('130', '110'))}"
            node.both["viewBox"] = box
            align = self.random.choice(
                ("", "xMinYMax meet", "xMaxYMid slice", "none", "xMidYMin", "xMidYMid slice")
            )
            if align:
                node.both["preserveAspectRatio"] = align
            if align == "none":
                self.hazards.add("unequal scale")
        if self.chance(0.8):
            node.both["overflow"] = "visible"
        else:
            # Of a drawing without a size, resvg shows also what is outside.
            node.both.setdefault("width", "100")
            node.both.setdefault("height", "100")
            self.hazards.add("cut")

    def use(self, depth: int) -> Node:
        """A <use> of a shape, group or symbol among the definitions; duplicate ids come second."""
        node = self.node("use", x=number(self.between(-10, 10)), y=number(self.between(-10, 10)))
        if self.linked and self.chance(0.3):
            target = self.random.choice(self.linked)
        else:
            kind = self.random.choice(("shape", "g", "symbol", "svg"))
            made = self.shape() if kind == "shape" else self.node(kind)
            if kind != "shape":
                before, self.in_view = self.in_view, True
                made.children = self.content(depth + 1)
                self.in_view = before
            if kind in ("symbol", "svg"):
                self.view(made, clips=kind == "svg")
                node.both["width"], node.both["height"] = (
                    number(self.between(40, 140)),
                    self.random.choice(("90", "70")),
                )
                if kind == "symbol":
                    made.both.pop("width", None), made.both.pop("height", None)
            target = made.both["id"]
            self.definitions.append(made)
            if kind in ("shape", "g"):
                self.linked.append(target)
            if self.chance(0.15):
                self.definitions.append(Node("rect", {"id": target, "width": "90", "height": "90"}))
        node.both[self.random.choice(("href", "xlink:href"))] = f"#{target}"
        return node

    def shape(self) -> Node:
        """A shape of the page's size or less."""
        tag = self.random.choice(
            ("rect", "rect", "circle", "ellipse", "polygon", "polyline", "path", "path", "path", "line")
        )
        node = self.node(tag)
        x, y = self.between(5, 60), self.between(5, 60)
        w, h = self.between(12, 40), self.between(12, 40)
        if tag == "path":
            node.both["d"] = self.path_data(x, y)
            if self.chance(0.1):
                node.author = {"d": "M0 0h9v9z", "style": f'd:path("{" ".join(node.both.pop("d").split())}")'}
                node.plain = {"d": node.author["style"][8:-2]}
            return node
        if tag in ("polygon", "polyline"):
            points = [(self.between(5, 95), self.between(5, 95)) for _ in range(self.random.randint(3, 6))]
            blank = self.random.choice((" ", ", "))
            node.both["points"] = blank.join(f"{number(u)},{number(v)}" for u, v in points)
            return node
        if tag == "line":
            node.both.update(x1=number(x), y1=number(y), x2=number(x + w), y2=number(y + h))
            return node
        lengths = {"x": x, "y": y, "width": w, "height": h}
        if tag == "rect" and self.chance(0.5):
            lengths[self.random.choice(("rx", "ry"))] = self.random.choice((0.0, 3.0, 5.5))
        if tag == "circle":
            lengths = {"cx": x + 10, "cy": y + 10, "r": w / 2}
        if tag == "ellipse":
            lengths = {"cx": x + 10, "cy": y + 10, "rx": w / 2, "ry": w / 2}
            if self.chance(0.3):
                lengths.pop(self.random.choice(("rx", "ry")))
        for name, value in lengths.items():
            self.length(node, name, value)
        return node

    def length(self, node: Node, name: str, value: float) -> None:
        """One length, as attribute or in CSS, in any unit."""
        unit = self.random.choice(tuple(UNITS)) if self.chance(0.3) else ""
        exact = number(value) if not unit else repr(value / UNITS[unit]) + unit
        if self.chance(0.15):
            given = exact if unit else f"{exact}px"
            if self.chance(0.5):
                self.own_rules.append(f"#{node.both['id']} {{ {name}: {given} }}\n")
            else:
                node.author["style"] = f"{node.author.get('style', '')};{name}:{given}"
            node.author[name] = number(value * 2 + 3)
            node.plain[name] = number(value)
        elif unit == "Q":
            node.author[name], node.plain[name] = exact, number(value)
        else:
            node.both[name] = exact

    def path_data(self, x: float, y: float) -> str:
        """Path data of lines and arcs, in all ways to write them."""
        words = [f"{self.random.choice('Mm')}{number(x)} {number(y)}"]
        for _ in range(self.random.choice((1, 1, 2))):
            for _ in range(self.random.randint(2, 5)):
                words.append(self.command())
            words.append(self.random.choice(("z", "Z", "")))
            words.append(
                self.random.choice(
                    ("", f"m{number(self.between(-9, 9))},{number(self.between(2, 9))}", "l 9 20")
                )
            )
        if words[-1].startswith("m") and self.chance(0.5):
            words.append("h12 v-9z")
        return self.random.choice(("", " ", "\n")).join(words)

    def command(self) -> str:
        """One command and its repetitions."""
        r = self.random
        u, v, a, b = (number(self.between(5, 95)) for _ in range(4))
        du, dv = number(self.between(-30, 30)), number(self.between(-30, 30))
        radius = r.choice(("25", "30.5", "12", "2", "0", "-20", "1e2", ".5e2"))
        other = r.choice(("0", "7")) if radius == "0" else radius
        flags = r.choice(("0 0 ", "0,1,", "10", "11", "1 0,"))
        turn = r.choice(("0", "30", "-77.5"))
        end = f"{du} {dv}"
        return r.choice(
            (
                f"L{u} {v}",
                f"L{u},{v} {a},{b}",
                f"l{du} {dv}",
                f"H{u}V{v}",
                f"h{du} {number(float(du) / 2 + 4)}",
                f"v{dv}",
                f"A{radius} {other} {turn} {flags}{u} {v}",
                f"a{radius},{other},{turn},{flags}{end}",
                f"a{radius} {other} {turn} {flags}{end} {radius} {other} 0 {flags}9-7",
            )
        )

    def transform(self, node: Node) -> None:
        """A transform, as attribute or in CSS; unequal scales are a hazard for arcs."""
        if not self.chance(0.4):
            return
        tx, ty = self.between(-12, 12), self.between(-12, 12)
        angle = self.random.choice((0.0, 90.0, 30.0, -12.5))
        scale = self.random.choice((1.0, 1.25, 0.75, -1.0))
        second = scale
        if self.chance(0.05):
            second = self.random.choice((0.6, -scale, 1.5))
            if abs(second) != abs(scale):
                self.hazards.add("unequal scale")
        origin = self.chance(0.2)
        middle = (number(self.between(0, 50)), number(self.between(0, 50)))
        numbers = [number(v) for v in (tx, ty, angle, scale, second)]
        plain = "translate({} {}) rotate({}) scale({} {})".format(*numbers)
        way = self.random.choice(("attribute", "attribute", "css", "sheet", "single"))
        if way == "attribute":
            node.both["transform"] = plain
            if origin:
                node.both["transform-origin"] = f"{middle[0]} {middle[1]}"
            return
        if way == "single":
            css = "translate:{}px {}px;rotate:{}deg;scale:{} {}".format(*numbers)
            if self.chance(0.3):
                css += ";transform:scaleX(-1) skew(0)"
                plain += " scale(-1 1)"
        else:
            css = "transform:translate({}px,{}px) rotate({}deg) scale({}, {})".format(*numbers)
        if origin:
            css += f";transform-origin:{middle[0]}px {middle[1]}px"
            back = " ".join(number(-float(value)) for value in middle)
            plain = f"translate({middle[0]} {middle[1]}) {plain} translate({back})"
        node.plain["transform"] = plain
        if way != "single" and self.chance(0.3):
            node.author["transform"] = "translate(7 7)"
        if way == "sheet":
            self.own_rules.append(f"#{node.both['id']} {{ {css} }}\n")
        else:
            node.author["style"] = f"{node.author.get('style', '')};{css}"

    def style(self, node: Node) -> None:
        """Now and then what hides or shows an element, by any way of the cascade."""
        if not self.chance(0.35):
            return
        kind = "fill" if self.filled else "stroke"
        declarations = self.random.choice((*INVISIBLE, *CLEAR[kind], *VISIBLE, *VISIBLE))
        way = self.random.choice(("attribute", "style", "class", "id", "tag", "inside", "important", "not"))
        name = f"c{self.random.randint(1, 6)}"
        if "nonsense" in declarations:
            way = "attribute"  # in a style sheet, resvg does not pass over what is not valid
        if way == "important":
            name = f"i{len(self.rules)}"  # of several important rules, resvg takes the first
        if way == "attribute":
            for part in declarations.split(";"):
                node.both[part.partition(":")[0]] = part.partition(":")[2]
            return
        if way == "style":
            node.both["style"] = declarations
            return
        node.both["class"] = f"{node.both.get('class', '')} {name}".strip()
        selector = {
            "class": f".{name}",
            "id": f"#{node.both['id']}",
            "tag": f"{node.tag}.{name}",
            "inside": f"g > .{name}, a .{name}",
            "important": f"*.{name}",
            "not": f"[class='{name}']",
        }[way]
        if way == "important":
            declarations = ";".join(f"{part} !important" for part in declarations.split(";"))
        self.rules.append(f"{selector} {{ {declarations} }} /* .{name} {{ display: none }} */")

    def effects(self, node: Node) -> None:
        """Now and then a clip path, a mask or a filter, which are hazards."""
        if self.chance(0.05):
            clip = self.node("clipPath")
            box = self.random.choice(
                (("-500", "-500", "1000", "1000"), ("10", "10", "60", "70"), ("0", "0", "100", "100"))
            )
            clip.children = [self.node("rect", **dict(zip(("x", "y", "width", "height"), box, strict=True)))]
            self.definitions.append(clip)
            node.both["clip-path"] = f"url(#{clip.both['id']})"
            self.hazards.add("cut")
        if self.chance(0.01):
            mask = self.node("mask")
            mask.children = [self.node("rect", width="40", height="40", fill="white")]
            self.definitions.append(mask)
            node.both["mask"] = f"url(#{mask.both['id']})"
            self.hazards.add("mask")


def random_drawings(start: int, stop: int) -> Iterator[RandomDrawing]:
    """The drawings of a range of seeds."""
    for seed in range(start, stop):
        yield Drafter(seed).drawing()
