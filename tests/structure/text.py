# SPDX-License-Identifier: Apache-2.0
"""The text of one source file: code without comments and strings, comments, string literals."""

import bisect
import re
import sys
from collections import defaultdict
from functools import cached_property
from typing import Iterator, NamedTuple


class Comment(NamedTuple):
    line: int
    text: str  # as written, with its slashes
    alone: bool  # no code before it on its line


CPP_TOKEN = re.compile(
    r"""(?P<number>(?<![\w'])\d(?:'?[\w.])*)
      | (?P<comment>//(?:[^\n\\]|\\.)*|/\*.*?\*/)
      | (?P<raw>(?:\b(?:u8|[uUL])?R)"(?P<mark>[^()\s\\]*)\((?P<body>.*?)\)(?P=mark)")
      | (?P<string>"(?:[^"\\\n]|\\.)*")
      | (?P<char>'(?:[^'\\\n]|\\.)+')""",
    re.S | re.X,
)
TS_TOKEN = re.compile(
    r"""(?P<comment>//[^\n]*|/\*.*?\*/)
      | (?P<string>"(?:[^"\\\n]|\\.)*"|'(?:[^'\\\n]|\\.)*'|`(?:[^`\\]|\\.)*`)
      | (?<=[(,=:!&|?{};\[\n])[ ]*(?P<raw>/(?![/*])(?:[^/\\\n\[]|\\.|\[(?:[^\]\\\n]|\\.)*\])+/)""",
    re.S | re.X,
)
HIDDEN_FROM_CTAGS = (
    re.compile(
        r"(^[ \t]*(?:(?:static|const|mutable)\s+)*[\w:]+<[^;{}]*\([^;{}]*>[*&]*\s+\w+)"
        r"(\{[^;]*?\})(?=\s*;)",
        re.M,
    ),
    re.compile(r"(\(\*\s*\w+\)\s*\([^;{}]*\))(\{[^;]*?\})(?=\s*;)"),
    re.compile(r"(~\w+\(\)\s*(?:noexcept\s*)?)(override)"),
)
DIRECTIVE = re.compile(r"^[ \t]*#(?:[^\n\\]|\\.)*", re.M | re.S)


def blank(text: str) -> str:
    """Returns spaces for every character but newlines."""
    return re.sub(r"[^\n]", " ", text)


class Source:
    """One file: its code, its comments and its string literals."""

    def __init__(self, path: str, text: str):
        self.path = path
        self.text = text
        self.lines = text.split("\n")
        self.starts = [0]
        for line in self.lines:
            self.starts.append(self.starts[-1] + len(line) + 1)
        self.comments: list[Comment] = []
        self.strings: list[tuple[int, int, str]] = []  # begin, end, contents

    def line_at(self, offset: int) -> int:
        return bisect.bisect_right(self.starts, offset)

    @cached_property
    def bare(self) -> str:
        """Returns the text with comments and contents of strings blanked out."""
        pieces, last = [], 0
        pattern = TS_TOKEN if self.path.endswith(".ts") else CPP_TOKEN
        for token in pattern.finditer(self.text):
            kind = token.lastgroup
            if kind == "number":
                continue
            begin, end = token.start(), token.end()
            pieces.append(self.text[last:begin])
            last = end
            if kind == "comment":
                line = self.line_at(begin)
                alone = not self.text[self.starts[line - 1] : begin].strip()
                self.comments.append(Comment(line, token[0], alone))
                pieces.append(blank(token[0]))
            else:
                body = token.groupdict().get("body")
                if kind != "char":
                    self.strings.append((begin, end, token[0][1:-1] if body is None else body))
                pieces.append('""' + blank(token[0][2:]))
        pieces.append(self.text[last:])
        return "".join(pieces)

    @cached_property
    def code(self) -> str:
        """Returns the code without preprocessor lines."""
        if self.path.endswith(".ts"):
            return self.bare
        return DIRECTIVE.sub(lambda match: blank(match[0]), self.bare)

    @cached_property
    def code_for_ctags(self) -> str:
        """Returns the code without what hides a member from Universal Ctags 5.9.

        That is the initializer in braces of a member whose type has parentheses, and "override" of
        a destructor.
        """
        code = self.bare
        for pattern in () if self.path.endswith(".ts") else HIDDEN_FROM_CTAGS:
            code = pattern.sub(lambda match: match[1] + blank(match[2]), code)
        return code

    @cached_property
    def comments_by_line(self) -> dict[int, list[Comment]]:
        """Each comment stands at every line it covers."""
        self.bare
        found = defaultdict(list)
        for comment in self.comments:
            for line in range(comment.line, comment.line + comment.text.count("\n") + 1):
                found[line].append(comment)
        return found


def past_brackets(code: str, offset: int, ends: str) -> int:
    """Returns where the first of `ends` outside of brackets stands at or behind the offset."""
    depth = 0
    for at in range(offset, len(code)):
        char = code[at]
        if depth == 0 and char in ends:
            return at
        if char in "([{":
            depth += 1
        elif char in ")]}":
            depth -= 1
    return len(code) - 1


class Passage(NamedTuple):
    """Adjacent comments or string literals as one text: a phrase may continue on the next line."""

    text: str
    begins: list[tuple[int, int]]  # offset in the text, line

    def line_at(self, offset: int) -> int:
        return self.begins[bisect.bisect_right(self.begins, (offset, sys.maxsize)) - 1][1]


def join(pieces: list[tuple[int, str]], separator: str) -> Passage:
    text, begins = "", []
    for line, piece in pieces:
        begins.append((len(text), line))
        text += piece + separator
    return Passage(text, begins)


def comment_passages(source: Source) -> Iterator[Passage]:
    """Yields comments; those on adjacent lines are one passage unless code stands before one."""
    source.bare
    pieces: list[tuple[int, str]] = []
    for comment in source.comments:
        if pieces and not (comment.alone and comment.line == pieces[-1][0] + 1):
            yield join(pieces, " ")
            pieces = []
        for number, line in enumerate(comment.text.split("\n")):
            pieces.append((comment.line + number, line.strip().strip("/*<!").strip()))
    if pieces:
        yield join(pieces, " ")


def string_passages(source: Source) -> Iterator[Passage]:
    """Yields string literals; those that the compiler joins are one passage."""
    code, last = source.code, 0
    pieces: list[tuple[int, str]] = []
    for begin, end, contents in source.strings:
        line = source.line_at(begin)
        if source.lines[line - 1].lstrip().startswith("#"):  # include
            continue
        if pieces and code[last:begin].strip():
            yield join(pieces, "")
            pieces = []
        pieces += [(line + number, text) for number, text in enumerate(contents.split("\n"))]
        last = end
    if pieces:
        yield join(pieces, "")


def name_passages(source: Source) -> Iterator[Passage]:
    """Yields each identifier."""
    for match in re.finditer(r"\b[A-Za-z_]\w*", source.code):
        yield Passage(match[0], [(0, source.line_at(match.start()))])
