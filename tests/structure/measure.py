#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures the structure of the source tree and compares each figure with its limit.

Prints one table: figure, today, limit, target, verdict. Exit status: 0 all figures are within their
limits, 1 a figure is over its limit, 2 the tree cannot be measured, 77 Universal Ctags is missing.

Limits and targets are in tests/structure/limits.txt, private words in tests/structure/words.txt. A
limit is the figure of the day it was written: it may only fall, or rise if the figure is a share.
--tighten writes better figures into limits.txt.

What is counted:
  Product code is common, components, sim and deploy. Classes and functions are those Universal
  Ctags finds. A lambda belongs to the function around it.
  class_functions      C++ classes; each overload counts, "= default" and "= delete" do not.
  class_members        C++ classes; static members do not count. Plain aggregates are left out:
                       structs without member functions, and structs in a header whose name ends in
                       settings.hpp or schema.hpp.
  long_functions       From the first line of the declaration (template line, return type) to the
                       closing brace; C++ functions, TypeScript functions and methods.
  long_files, long_nodes
                       The line that names the licence does not count.
  unlicensed_files     The same files as for full_folders, CMakeLists.txt and .cmake: one of the first
                       five lines has to be "SPDX-License-Identifier: Apache-2.0" in a comment.
  full_folders         Files .cpp .hpp .c .h .ts .mjs .py .sh .idl .proto directly in one folder, in
                       the whole tree.
  documented_functions Share of public functions in product headers with a "///" comment before or a
                       "///<" comment behind. Constructors, destructors, operators and overrides do
                       not count, nor what is private, protected, anonymous or in "detail".
  documented_fields    The same share of public data members. One comment suffices for all members
                       of one declaration.
  private_words        Occurrences in identifiers and comments of product headers and in string
                       literals of product .cpp and .hpp.
  state_as_text        A phase compared with a string literal: ==, !=, rfind, starts_with, compare.
  many_parameters      A declaration and its definition count once; functions as above.
  long_lines           .cpp, .hpp and .md of the whole tree. Rows of Markdown tables do not count:
                       they cannot be broken.
  test_names           The second argument of TEST, TEST_F, TEST_P and TYPED_TEST has to be at least
                       two words in snake_case.
"""

import argparse
import re
import sys
from pathlib import Path

sys.dont_write_bytecode = True  # keeps compiled modules out of the source tree
from declarations import Failure, Tree
from figures import FIGURES, Figure, measure

LIMITS = "tests/structure/limits.txt"
LIMIT_LINE = re.compile(
    r"(?P<name>\w+)(?P<gap>\s+)(?P<limit>\d+(?:\.\d)?)(?P<rest>\s+\d+(?:\.\d)?\s*)"
)


def read_limits(tree: Tree) -> dict[str, tuple[float, float]]:
    """Returns limit and target of each figure."""
    limits = {}
    for number, line in enumerate(tree.source(LIMITS).lines, 1):
        if not line.strip() or line.startswith("#"):
            continue
        match = LIMIT_LINE.fullmatch(line)
        if not match or match["name"] not in {figure.name for figure in FIGURES}:
            raise Failure(f"{LIMITS}:{number}: expected: figure limit target")
        limits[match["name"]] = (float(match["limit"]), float(match["rest"]))
    missing = [figure.name for figure in FIGURES if figure.name not in limits]
    if missing:
        raise Failure(f"{LIMITS}: no limit for {', '.join(missing)}")
    return limits


def shown(figure: Figure, value: float) -> str:
    return f"{value:.1f}" if figure.share else f"{value:.0f}"


def is_over(figure: Figure, value: float, limit: float) -> bool:
    return value < limit if figure.share else value > limit


def print_table(tree: Tree) -> tuple[list[str], dict[str, float]]:
    """Returns the figures over their limits, and the values of those that are better."""
    limits, over, better = read_limits(tree), [], {}
    values = {figure.name: measure(tree, figure)[0] for figure in FIGURES}
    width = max(len(figure.what) for figure in FIGURES) + 24
    print(f"{'figure':{width}} {'today':>7} {'limit':>7} {'target':>7}")
    for figure in FIGURES:
        value, (limit, target) = values[figure.name], limits[figure.name]
        if is_over(figure, value, limit):
            over.append(figure.name)
        elif value != limit:
            better[figure.name] = value
        verdict = "over" if figure.name in over else "ok"
        columns = " ".join(f"{shown(figure, v):>7}" for v in (value, limit, target))
        print(f"{figure.name:<22}  {figure.what:{width - 24}} {columns}  {verdict}")
    return over, better


def tighten(tree: Tree, better: dict[str, float]) -> None:
    lines = []
    for line in tree.source(LIMITS).lines:
        match = LIMIT_LINE.fullmatch(line)
        if match and match["name"] in better:
            figure = next(f for f in FIGURES if f.name == match["name"])
            width = len(match["gap"] + match["limit"]) - 1
            value = shown(figure, better[figure.name]).rjust(width)
            line = f"{match['name']} {value}{match['rest']}"
        lines.append(line)
    (tree.root / LIMITS).write_text("\n".join(lines), encoding="utf-8")


def check(tree: Tree, write: bool) -> int:
    over, better = print_table(tree)
    for name in over:
        print(f"{name} is over its limit; offenders: tests/structure/measure.py --list {name}")
    if better and write:
        tighten(tree, better)
        print(f"new limits in {LIMITS}: {', '.join(better)}")
    elif better:
        print(f"better than the limit: {', '.join(better)}")
        print("lower their limits: tests/structure/measure.py --tighten")
    return 1 if over else 0


def print_list(tree: Tree, name: str) -> int:
    figure = next(f for f in FIGURES if f.name == name)
    _, findings = measure(tree, figure)
    for finding in findings:
        print(f"{finding.path}:{finding.line}: {finding.text}")
    return 0


def main() -> int:
    raw = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=raw)
    names = [figure.name for figure in FIGURES]
    add = parser.add_argument
    add("--list", metavar="FIGURE", choices=names, help="name each offender as file:line")
    add("--tighten", action="store_true", help="write better figures as new limits")
    add("--root", type=Path, default=Path(__file__).resolve().parents[2], help="folder of the tree")
    arguments = parser.parse_args()
    try:
        tree = Tree(arguments.root)
        if arguments.list:
            return print_list(tree, arguments.list)
        return check(tree, arguments.tighten)
    except (Failure, OSError) as failure:
        print(f"structure: {failure}", file=sys.stderr)
        return getattr(failure, "status", 2)


if __name__ == "__main__":
    sys.exit(main())
