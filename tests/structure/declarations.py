# SPDX-License-Identifier: Apache-2.0
"""The files of a tree and the declarations in them, as Universal Ctags finds them."""

import json
import os
import re
import shutil
import subprocess
import tempfile
from collections import defaultdict
from functools import cached_property
from pathlib import Path
from typing import Optional

from text import Comment, Source, past_brackets

PRODUCT = ("common/", "components/", "sim/", "deploy/")
SKIPPED_FOLDERS = {"node_modules", "build", "__pycache__"}
CLASS_KINDS = ("class", "struct", "union")
FUNCTION_KINDS = ("function", "prototype", "method")


class Failure(Exception):
    """The tree cannot be measured; carries the exit status."""

    def __init__(self, text: str, status: int = 2):
        super().__init__(text)
        self.status = status


class Tag:
    """A declaration as Universal Ctags reports it."""

    def __init__(self, entry: dict):
        self.path: str = entry["path"]
        self.name: str = entry["name"]
        self.kind: str = entry["kind"]
        self.line: int = entry["line"]
        self.end: int = entry.get("end", self.line)
        self.scope: str = entry.get("scope", "")
        self.scope_kind: str = entry.get("scopeKind", "")
        self.access: str = entry.get("access", "")
        self.signature: str = entry.get("signature") or ""
        self.properties = set((entry.get("properties") or "").split(","))
        self.owner: Optional["Tag"] = None  # the class in whose body it stands

    @property
    def full_name(self) -> str:
        return f"{self.scope}::{self.name}" if self.scope else self.name

    @property
    def is_function(self) -> bool:
        return self.kind in FUNCTION_KINDS and not self.name.startswith("__anon")

    @property
    def shown_name(self) -> str:
        last = re.sub(r"__anon\w+", "(anonymous)", self.scope).rsplit("::", 1)[-1]
        return f"{last}::{self.name}" if self.scope_kind in CLASS_KINDS else self.name


def find_ctags() -> str:
    for name in ("ctags-universal", "ctags"):
        program = shutil.which(name)
        if program:
            version = subprocess.run([program, "--version"], capture_output=True, text=True).stdout
            if "Universal Ctags" in version and "+json" in version:
                return program
    raise Failure("Universal Ctags is missing; run: sudo apt-get install universal-ctags", 77)


def read_tags(sources: list[Source]) -> list[Tag]:
    """Returns all declarations; Universal Ctags reads copies of the files."""
    command = [find_ctags(), "--options=NONE", "--sort=no", "--output-format=json"]
    command += ["--languages=C++,TypeScript", "--fields=*", "--fields-C++=*", "--kinds-C++=+p"]
    command += ["-L", "-", "-f", "-"]
    with tempfile.TemporaryDirectory() as folder:
        for source in sources:
            copy = Path(folder, source.path)
            copy.parent.mkdir(parents=True, exist_ok=True)
            copy.write_text(source.code_for_ctags, encoding="utf-8")
        paths = "\n".join(source.path for source in sources)
        options = {"cwd": folder, "input": paths, "capture_output": True, "encoding": "utf-8"}
        run = subprocess.run(command, **options)
    if run.returncode != 0:
        raise Failure(f"{command[0]} failed: {run.stderr.strip()}")
    entries = (json.loads(line) for line in run.stdout.splitlines())
    return [Tag(entry) for entry in entries if entry["_type"] == "tag"]


def set_owners(tags: list[Tag]) -> None:
    """Finds the class of each member. A definition outside of its class has none."""
    classes = defaultdict(list)
    for tag in tags:
        if tag.kind in CLASS_KINDS:
            classes[tag.path, tag.full_name].append(tag)
    for tag in tags:
        around = [c for c in classes.get((tag.path, tag.scope), ()) if c.line <= tag.line <= c.end]
        tag.owner = min(around, key=lambda c: c.end - c.line, default=None)


class Tree:
    """The files below a root folder, without hidden and generated ones."""

    def __init__(self, root: Path):
        self.root = root
        self.paths: list[str] = []
        for folder, folders, files in os.walk(root):
            skipped = {f for f in folders if f in SKIPPED_FOLDERS or f.startswith(".")}
            folders[:] = sorted(set(folders) - skipped)
            at = Path(folder).relative_to(root)
            self.paths += sorted((at / file).as_posix() for file in files)
        self.sources: dict[str, Source] = {}

    def product(self, *extensions: str) -> list[str]:
        return [p for p in self.paths if p.startswith(PRODUCT) and p.endswith(extensions)]

    def source(self, path: str) -> Source:
        if path not in self.sources:
            text = (self.root / path).read_text(encoding="utf-8", errors="replace")
            self.sources[path] = Source(path, text)
        return self.sources[path]

    @cached_property
    def tags(self) -> list[Tag]:
        paths = self.product(".cpp", ".hpp", ".ts")
        tags = read_tags([self.source(path) for path in paths]) if paths else []
        set_owners(tags)
        return tags

    def members(self, kinds: tuple[str, ...]) -> dict[Tag, list[Tag]]:
        """Returns what stands in the body of each C++ class."""
        classes = (tag for tag in self.tags if tag.kind in CLASS_KINDS)
        found = {tag: [] for tag in classes if not tag.path.endswith(".ts")}
        for tag in self.tags:
            if tag.kind in kinds and tag.owner in found:
                found[tag.owner].append(tag)
        return found


def name_offset(source: Source, tag: Tag) -> int:
    begin, end = source.starts[tag.line - 1], source.starts[tag.line]
    match = re.compile(rf"(?<!\w){re.escape(tag.name)}(?!\w)").search(source.code, begin, end)
    return match.start() if match else begin


ACCESS = re.compile(r"\b(public|protected|private)\s*$")


def declaration_start(source: Source, offset: int) -> int:
    """Returns where the declaration around the offset begins, template line included."""
    code, at = source.code, offset - 1
    while at >= 0:
        char = code[at]
        if char == "}" and re.compile(r"\s*,").match(code, at + 1):
            depth = 1  # the initializer of an earlier name of the same declaration
            while depth and at > 0:
                at -= 1
                depth += {"}": 1, "{": -1}.get(code[at], 0)
        elif char in ";{}":
            break
        elif char == ":" and ACCESS.search(code, max(0, at - 20), at):
            break
        at -= 1
    return re.compile(r"\s*").match(code, at + 1).end()


def is_doc(comment: Comment) -> bool:
    return comment.text.startswith(("///", "/**")) and not comment.text.startswith(("///<", "/**<"))


def is_documented(source: Source, tag: Tag) -> bool:
    """Tells whether a documenting comment stands directly above the declaration or behind it."""
    name = name_offset(source, tag)
    start = declaration_start(source, name)
    first = source.line_at(start)
    if not source.code[source.starts[first - 1] : start].strip():
        line = first - 1
        while any(comment.alone for comment in source.comments_by_line.get(line, ())):
            if any(is_doc(comment) for comment in source.comments_by_line[line]):
                return True
            line -= 1
    last = source.line_at(past_brackets(source.code, name, ";{" if tag.is_function else ";"))
    behind = [*range(first, last + 1), tag.end if tag.is_function else last]
    comments = (c for line in behind for c in source.comments_by_line.get(line, ()))
    return any(comment.text.startswith(("///<", "/**<")) for comment in comments)


def count_parameters(signature: str) -> int:
    inner, depth, count = signature[signature.find("(") + 1 :], 0, 1
    if re.match(r"\s*(void\s*)?\)", inner):
        return 0
    for before, char in zip(" " + inner, inner):
        if char in "([{<":
            depth += 1
        elif char in ")]}" or (char == ">" and before != "-"):
            depth -= 1
            if depth < 0:
                break
        elif char == "," and depth == 0:
            count += 1
    return count


def function_lines(tree: Tree, tag: Tag) -> tuple[int, int]:
    """Returns the first and the last line of a function definition."""
    source = tree.source(tag.path)
    name = name_offset(source, tag)
    if not tag.path.endswith(".ts"):
        return source.line_at(declaration_start(source, name)), tag.end
    end = past_brackets(source.code, past_brackets(source.code, name, "{;") + 1, "}")
    body = re.compile(r"\s*(\[\]\s*)*\{").match(source.code, end + 1)  # the braces were its type
    if body:
        end = past_brackets(source.code, body.end(), "}")
    return tag.line, source.line_at(end)
