"""What the manual's site takes from the code as it is built: a hook of MkDocs.

A line ``::: workhold`` on a page becomes what the docstrings of all public names say, with their signatures and, of classes,
their public members. A line ``::: commands`` becomes the help of every command.
"""

from __future__ import annotations

import inspect
import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

PLACE = re.compile(r"^::: (workhold|commands|toolkits)$", flags=re.M)
# The head of a docstring's section, such as "Parameters", with its line of dashes.
SECTION = re.compile(r"^(\w[\w ]*)\n-{3,}\n", flags=re.M)
# Sections whose entries are names with what they mean; those of the others are types.
OF_NAMES = {"Parameters", "Attributes", "Glossary"}
COLUMNS = "88"
EXPLAINED = Path(__file__).parent.parent / "src" / "workhold" / "web" / "static" / "method"


def on_config(config: Any) -> Any:
    """A page that the order in mkdocs.yml does not name comes last, so that no page is lost."""
    named = set(re.findall(r"[\w-]+\.md", str(config["nav"])))
    pages = sorted({path.name for path in Path(config["docs_dir"]).glob("*.md")} - named)
    config["nav"] += [{"More": pages}] if pages else []
    return config


def on_files(files: Any, config: Any) -> Any:
    """The page that explains the method with pictures, as the server has it, in the folder ``explained``."""
    from mkdocs.structure.files import File

    for path in sorted(EXPLAINED.iterdir()):
        files.append(File.generated(config, f"explained/{path.name}", abs_src_path=str(path)))
    return files


def on_page_markdown(markdown: str, **about: Any) -> str:
    """A page with its places filled."""
    makers = {
        "workhold": describe_every_name,
        "commands": describe_every_command,
        "toolkits": describe_every_toolkit,
    }
    return PLACE.sub(lambda found: makers[found[1]](), markdown)


def describe_every_name() -> str:
    """What is said of every public name: functions, then classes, then errors."""
    import workhold

    things = {name: getattr(workhold, name) for name in workhold.__all__}
    order = sorted(things, key=lambda name: (classify_public_name(things[name]), name.lower()))
    return "\n\n".join(describe_public_name(name, things[name]) for name in order)


def describe_every_toolkit() -> str:
    """The fields of every kind of toolkit under the first name that people give it, a table each."""
    from workhold.fixels.fields import NAMES
    from workhold.fixels.kinds import find_table, resolve_kind

    kinds: dict[str, str] = {}
    for name in NAMES:
        kinds.setdefault(resolve_kind(name)[0], name)
    return "\n\n".join(
        f"### `{name}`: {NAMES[name]}\n\n{tabulate_fields(find_table(kind).fields)}"
        for kind, name in kinds.items()
    )


def tabulate_fields(rows: Any) -> str:
    """The key and the option of each field, what is typed, its default and its help, as Markdown."""
    lines = ["| key in files | option | value | if left out | meaning |", "|---|---|---|---|---|"]
    for row in rows:
        words = row.help.replace("{option}", row.option).replace("|", "\\|")
        value = row.metavar.replace("|", "\\|")
        lines.append(f"| `{row.name}` | `{row.option}` | `{value}` | {describe_default(row)} | {words} |")
    return "\n".join(lines)


def describe_default(row: Any) -> str:
    """What a field is where nobody gives it."""
    if row.is_required:
        return "must be given"
    if row.follows:
        return f"that of `{row.follows}`"
    return f"`{row.default}`" if row.default not in (None, ()) else "none"


def classify_public_name(thing: Any) -> int:
    """0 for a function, 1 for a class, 2 for an error."""
    return inspect.isclass(thing) + (inspect.isclass(thing) and issubclass(thing, Exception))


def describe_public_name(name: str, thing: Any) -> str:
    """What is said of a public name, as Markdown."""
    parts = [
        f"## `{name}` {{ #{name} }}",
        format_signature(name, thing, "workhold"),
        convert_docstring(thing),
    ]
    if inspect.isclass(thing):
        parts += [describe_member(name, one, thing) for one in list_public_members(thing)]
    return "\n\n".join(part for part in parts if part)


def list_public_members(kind: type) -> list[str]:
    """The names of a class's own methods and properties that have something to say."""
    made = (property, classmethod, staticmethod)
    found = {name for name, one in vars(kind).items() if isinstance(one, made) or inspect.isfunction(one)}
    return [
        name for name in sorted(found) if not name.startswith("_") and inspect.getdoc(getattr(kind, name))
    ]


def describe_member(kind: str, name: str, owner: type) -> str:
    """What is said of a method or property."""
    thing = inspect.getattr_static(owner, name)
    if isinstance(thing, property):
        head, called = f"### `{name}`", ""
    else:
        bound = getattr(owner, name)
        holder = kind if isinstance(thing, classmethod | staticmethod) else kind.lower()
        head, called = f"### `{name}()`", format_signature(name, bound, holder)
    anchor = f" {{ #{kind.lower()}-{name} data-toc-label='{name}' }}"
    return "\n\n".join(
        part for part in (head + anchor, called, convert_docstring(getattr(owner, name))) if part
    )


def format_signature(name: str, thing: Any, holder: str) -> str:
    """How something is called, a parameter on a line where the line would be long."""
    if inspect.isclass(thing) and issubclass(thing, BaseException):
        return ""
    signature = inspect.signature(thing)
    own = [one for one in signature.parameters.values() if one.name != "self"]
    words = [simplify_signature(str(one)) for one in own]
    result = signature.return_annotation
    arrow = (
        ""
        if inspect.isclass(thing) or result is inspect.Signature.empty
        else f" -> {simplify_signature(str(result))}"
    )
    line = f"{holder}.{name}({', '.join(words)}){arrow}"
    if len(line) > int(COLUMNS):
        # A star or a slash of its own is a word of the signature too.
        inner = simplify_signature(
            str(signature.replace(parameters=own, return_annotation=inspect.Signature.empty))
        )
        broken = re.sub(r", (?=[*/\w]+(?:: |,|$|=))", ",\n    ", inner[1:-1])
        line = f"{holder}.{name}(\n    {broken},\n){arrow}"
    return f"```python\n{line}\n```"


def simplify_signature(words: str) -> str:
    """A signature without the modules of its types and without what stands in quotes for types."""
    words = re.sub(r"(?:[a-z_]\w*\.)+(?=[A-Z])", "", words).replace("Optional[ForwardRef(Any)]", "Any")
    return re.sub(r"<factory>|NOTHING", "...", words).replace("'", "")


def convert_docstring(thing: Any) -> str:
    """A docstring as Markdown."""
    text = inspect.getdoc(thing) or ""
    head, *sections = SECTION.split(text)
    out = [convert_inline_marks(head.strip())]
    for title, content in zip(sections[::2], sections[1::2], strict=True):
        body = convert_examples(content) if title == "Examples" else list_entries(content, title in OF_NAMES)
        out.append(f"**{title}**\n\n{body}")
    return "\n\n".join(out)


def list_entries(content: str, named: bool) -> str:
    """The entries of a section as a list: ``name : what it means``, or a type with what is said of it below."""
    out: list[str] = []
    for line in content.strip().splitlines():
        if line[:1].strip():
            name, colon, words = line.partition(" : ")
            is_entry = bool(colon) if named else True
            out.append(
                f"- `{name}`{': ' + convert_inline_marks(words) if colon else ''}"
                if is_entry
                else f"- {convert_inline_marks(line)}"
            )
        else:
            out[-1] += (
                "" if out[-1].endswith((":", " ")) else " " if ": " in out[-1] else ": "
            ) + convert_inline_marks(line.strip())
    return "\n".join(out)


def convert_examples(content: str) -> str:
    """What stands in a session of Python as such, words between as words."""
    out = []
    for block in re.split(r"\n\n+", content.strip()):
        out.append(f"```pycon\n{block}\n```" if block.startswith(">>>") else convert_inline_marks(block))
    return "\n\n".join(out)


def convert_inline_marks(words: str) -> str:
    """Marks of reStructuredText as those of Markdown; a session of Python in the middle of words as one."""
    words = re.sub(r":\w+:`~?([^`]+)`", r"`\1`", words.replace("``", "`"))
    return re.sub(
        r"(?:^>>> .*\n?(?:.+\n?)*)+", lambda found: f"```pycon\n{found[0].rstrip()}\n```\n", words, flags=re.M
    )


def describe_every_command() -> str:
    """The help of every command as it stands on a terminal."""
    from workhold.cli.main import COMMANDS

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return "\n\n".join(
            f"## `{name}`\n\n```text\n{words}\n```"
            for name, words in zip(COMMANDS, pool.map(read_help, COMMANDS), strict=True)
        )


def read_help(name: str) -> str:
    """What ``workhold NAME --help`` says."""
    environment = {**os.environ, "COLUMNS": COLUMNS, "NO_COLOR": "1"}
    program = "import sys; sys.argv[0] = 'workhold'; from workhold.__main__ import run; run()"
    words = [sys.executable, "-c", program, name, "--help"]
    return subprocess.run(words, env=environment, capture_output=True, text=True, check=True).stdout.rstrip()
