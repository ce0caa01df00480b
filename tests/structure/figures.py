# SPDX-License-Identifier: Apache-2.0
"""The figures that measure.py prints."""

import os
import re
from collections import defaultdict
from typing import Callable, Iterator, NamedTuple

from declarations import CLASS_KINDS, FUNCTION_KINDS, Failure, Tag, Tree
from declarations import count_parameters, function_lines, is_documented, name_offset
from text import comment_passages, name_passages, past_brackets, string_passages

MAX_CLASS_FUNCTIONS = 25
MAX_CLASS_MEMBERS = 20
MAX_FUNCTION_LINES = 80
LICENCE = "SPDX-License-Identifier: Apache-2.0"
MAX_FILE_LINES = 500
MAX_FOLDER_FILES = 30
MAX_PARAMETERS = 6
MAX_COLUMNS = 100
MAX_NODE_LINES = 150

SOURCES = (".cpp", ".hpp", ".c", ".h", ".ts", ".mjs", ".py", ".sh", ".idl", ".proto")
WORDS = "tests/structure/words.txt"


class Finding(NamedTuple):
    path: str
    line: int
    text: str


def count_functions(members: list[Tag]) -> int:
    return sum(m.is_function and not m.properties & {"default", "delete"} for m in members)


def class_functions(tree: Tree) -> Iterator[Finding]:
    for owner, members in tree.members(FUNCTION_KINDS).items():
        count = count_functions(members)
        if owner.path.startswith("components/") and count > MAX_CLASS_FUNCTIONS:
            yield Finding(owner.path, owner.line, f"{owner.name} has {count} member functions")


def class_members(tree: Tree) -> Iterator[Finding]:
    functions = tree.members(FUNCTION_KINDS)
    for owner, members in tree.members(("member",)).items():
        count = sum("static" not in m.properties for m in members)
        settings = owner.path.endswith(("settings.hpp", "schema.hpp"))
        plain = owner.kind == "struct" and (settings or count_functions(functions[owner]) == 0)
        if owner.path.startswith("components/") and count > MAX_CLASS_MEMBERS and not plain:
            yield Finding(owner.path, owner.line, f"{owner.name} has {count} data members")


def long_functions(tree: Tree) -> Iterator[Finding]:
    for tag in tree.tags:
        if tag.is_function and tag.kind != "prototype":
            first, last = function_lines(tree, tag)
            if last - first + 1 > MAX_FUNCTION_LINES:
                yield Finding(tag.path, first, f"{tag.shown_name} has {last - first + 1} lines")


def count_lines(tree: Tree, path: str) -> int:
    """Returns the number of lines without the one that names the licence."""
    lines = tree.source(path).text.splitlines()
    return len(lines) - (1 if any(LICENCE in line for line in lines[:2]) else 0)


def unlicensed_files(tree: Tree) -> Iterator[Finding]:
    for path in tree.paths:
        if path.endswith((*SOURCES, "CMakeLists.txt", ".cmake")):
            if not any(LICENCE in line for line in tree.source(path).text.splitlines()[:5]):
                yield Finding(path, 1, f"no line {LICENCE}")


def long_files(tree: Tree) -> Iterator[Finding]:
    for path in tree.product(".cpp", ".hpp", ".ts"):
        if count_lines(tree, path) > MAX_FILE_LINES:
            yield Finding(path, 1, f"{count_lines(tree, path)} lines")


def full_folders(tree: Tree) -> Iterator[Finding]:
    counts = defaultdict(int)
    for path in tree.paths:
        counts[os.path.dirname(path)] += path.endswith(SOURCES)
    for folder, count in counts.items():
        if count > MAX_FOLDER_FILES:
            yield Finding(folder, 1, f"{count} source files")


def is_public(tag: Tag) -> bool:
    """Tells whether users of the header may name it."""
    if tag.scope_kind in CLASS_KINDS:
        return tag.access == "public" and tag.owner is not None and is_public(tag.owner)
    hidden = re.search(r"(^|::)(__anon\w*|detail)(::|$)", tag.scope)
    return tag.scope_kind != "function" and not hidden


def public_tags(tree: Tree, wanted: Callable[[Tag], bool]) -> list[Tag]:
    return [t for t in tree.tags if t.path.endswith(".hpp") and wanted(t) and is_public(t)]


def is_documentable_function(tag: Tag) -> bool:
    if not tag.is_function or tag.name.startswith(("~", "operator ")) or tag.name == "main":
        return False
    constructor = tag.scope_kind in CLASS_KINDS and tag.name == tag.scope.rsplit("::", 1)[-1]
    return not constructor and not tag.properties & {"override", "final", "default", "delete"}


def documented_functions(tree: Tree) -> tuple[int, list[Finding]]:
    groups = defaultdict(list)  # a declaration and a definition in the same header
    for tag in public_tags(tree, is_documentable_function):
        groups[tag.path, tag.scope, tag.name, tag.signature].append(tag)
    bare = []
    for tags in groups.values():
        if not any(is_documented(tree.source(tag.path), tag) for tag in tags):
            bare.append(Finding(tags[0].path, tags[0].line, tags[0].shown_name))
    return len(groups), bare


def documented_fields(tree: Tree) -> tuple[int, list[Finding]]:
    tags = public_tags(tree, lambda t: t.kind == "member")
    bare = [t for t in tags if not is_documented(tree.source(t.path), t)]
    return len(tags), [Finding(t.path, t.line, t.shown_name) for t in bare]


class Word(NamedTuple):
    expression: str
    term: str


def read_words(tree: Tree) -> dict[str, list[Word]]:
    """Returns the private words of each section: names, texts."""
    words: dict[str, list[Word]] = {"names": [], "texts": []}
    section = ""
    for number, line in enumerate(tree.source(WORDS).lines, 1):
        line = line.strip()
        if not line or line.startswith("#"):
            continue
        if re.fullmatch(r"\[\w+\]", line) and line[1:-1] in words:
            section = line[1:-1]
            continue
        expression, arrow, term = (part.strip() for part in line.partition(" => "))
        try:
            re.compile(expression)
        except re.error as error:
            raise Failure(f"{WORDS}:{number}: {expression}: {error}") from error
        if not arrow or not section:
            raise Failure(f"{WORDS}:{number}: expected [names], [texts] or: expression => term")
        words[section].append(Word(expression, term))
    return words


def private_words(tree: Tree) -> Iterator[Finding]:
    words = read_words(tree)
    patterns = {}
    for section, entries in words.items():
        groups = (f"(?P<w{number}>{word.expression})" for number, word in enumerate(entries))
        patterns[section] = re.compile("|".join(groups) or r"(?!)")
    for path in tree.product(".cpp", ".hpp"):
        source = tree.source(path)
        parts = [("texts", string_passages(source))]
        if path.endswith(".hpp"):
            parts += [("names", name_passages(source)), ("texts", comment_passages(source))]
        for section, passages in parts:
            for passage in passages:
                for match in patterns[section].finditer(passage.text):
                    term = words[section][int(match.lastgroup[1:])].term
                    word = passage.text if section == "names" else match[0]
                    yield Finding(path, passage.line_at(match.start()), f'"{word}": {term}')


def state_as_text(tree: Tree) -> Iterator[Finding]:
    compared = re.compile(
        r"""phase\S*\ *[!=]=\ *"
          | phase\S*\.(rfind|starts_with|compare)\("
          | "\ *[!=]=\ *[\w.>-]*phase""",
        re.X,
    )
    for path in tree.product(".cpp", ".hpp"):
        source = tree.source(path)
        for match in compared.finditer(source.code):
            line = source.line_at(match.start())
            yield Finding(path, line, source.lines[line - 1].strip())


def many_parameters(tree: Tree) -> Iterator[Finding]:
    groups: dict[tuple, dict[bool, list[Tag]]] = defaultdict(lambda: {True: [], False: []})
    for tag in tree.tags:
        if not tag.is_function:
            continue
        signature = tag.signature
        if tag.path.endswith(".ts"):
            source = tree.source(tag.path)
            opening = source.code.find("(", name_offset(source, tag))
            signature = source.code[opening : past_brackets(source.code, opening + 1, ")") + 1]
        count = count_parameters(signature)
        if count > MAX_PARAMETERS:
            groups[tag.scope, tag.name, count][tag.kind == "prototype"].append(tag)
    for (_, _, count), tags in groups.items():
        for tag in max(tags[False], tags[True], key=len):
            yield Finding(tag.path, tag.line, f"{tag.shown_name} has {count} parameters")


def long_lines(tree: Tree) -> Iterator[Finding]:
    for path in tree.paths:
        if not path.endswith((".cpp", ".hpp", ".md")):
            continue
        for number, line in enumerate(tree.source(path).lines, 1):
            row = path.endswith(".md") and line.lstrip().startswith("|")
            if len(line) > MAX_COLUMNS and not row:
                yield Finding(path, number, f"{len(line)} columns")


def long_nodes(tree: Tree) -> Iterator[Finding]:
    for path in tree.product("/node.cpp", "/main.cpp"):
        if count_lines(tree, path) > MAX_NODE_LINES:
            yield Finding(path, 1, f"{count_lines(tree, path)} lines")


def test_names(tree: Tree) -> Iterator[Finding]:
    test = re.compile(r"^[ \t]*(?:TYPED_)?TEST(?:_[FP])?\(\s*\w+\s*,\s*(\w+)\s*\)", re.M)
    for path in tree.paths:
        if path.startswith("tests/") and path.endswith((".cpp", ".hpp")):
            source = tree.source(path)
            for match in test.finditer(source.code):
                if not re.fullmatch(r"[a-z][a-z0-9]*(_[a-z0-9]+)+", match[1]):
                    yield Finding(path, source.line_at(match.start()), match[1])


class Figure(NamedTuple):
    name: str
    what: str
    measure: Callable
    share: bool = False  # [%]; counts those without, and may only rise


FIGURES = (
    Figure(
        "class_functions",
        f"classes in components with over {MAX_CLASS_FUNCTIONS} member functions",
        class_functions,
    ),
    Figure(
        "class_members",
        f"classes in components with over {MAX_CLASS_MEMBERS} data members",
        class_members,
    ),
    Figure("long_functions", f"functions over {MAX_FUNCTION_LINES} lines", long_functions),
    Figure("unlicensed_files", "source files without a licence line", unlicensed_files),
    Figure("long_files", f"product files over {MAX_FILE_LINES} lines", long_files),
    Figure("full_folders", f"folders with over {MAX_FOLDER_FILES} source files", full_folders),
    Figure(
        "documented_functions", "public functions with a comment [%]", documented_functions, True
    ),
    Figure("documented_fields", "public fields with a comment [%]", documented_fields, True),
    Figure("private_words", "private words", private_words),
    Figure("state_as_text", "states compared as text", state_as_text),
    Figure("many_parameters", f"functions with over {MAX_PARAMETERS} parameters", many_parameters),
    Figure("long_lines", f"lines over {MAX_COLUMNS} columns", long_lines),
    Figure("long_nodes", f"node.cpp and main.cpp over {MAX_NODE_LINES} lines", long_nodes),
    Figure("test_names", "test names that are no snake_case sentences", test_names),
)


def measure(tree: Tree, figure: Figure) -> tuple[float, list[Finding]]:
    """Returns the figure and its offenders. A share is rounded down to 0.1 %."""
    if not figure.share:
        findings = list(figure.measure(tree))
        return len(findings), findings
    total, findings = figure.measure(tree)
    return (1000 * (total - len(findings)) // total / 10 if total else 100.0), findings
