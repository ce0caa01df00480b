#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Feeds measure.py small made-up trees: what each figure finds, and what it does not."""

import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
from declarations import Failure, find_ctags

HERE = Path(__file__).resolve().parent
FIGURES = {
    "class_functions": "0 0",
    "class_members": "0 0",
    "unlicensed_files": "0 0",
    "long_functions": "0 0",
    "long_files": "0 0",
    "full_folders": "0 0",
    "documented_functions": "0.0 95.0",
    "documented_fields": "0.0 95.0",
    "private_words": "0 0",
    "state_as_text": "0 0",
    "many_parameters": "0 0",
    "long_lines": "0 0",
    "long_nodes": "0 0",
    "test_names": "0 0",
}
WORDS = """
# A comment.
[names]
(?<![a-z])told(?![a-z])|kMost => reported
[texts]
\\bgone over\\b => switch to
\\bthe way the\\b => as
"""


def functions(count: int) -> str:
    return "".join(f"  void f{i}();\n" for i in range(count))


def members(count: int) -> str:
    return "".join(f"  int m{i}{{}};\n" for i in range(count))


def body(count: int) -> str:
    return "  f();\n" * count


class TreeTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        self.write("tests/structure/words.txt", WORDS)
        self.write_limits()

    def write(self, path: str, text: str):
        file = self.root / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")

    def write_limits(self, **limits: str):
        lines = (f"{name} {limits.get(name, usual)}\n" for name, usual in FIGURES.items())
        self.write("tests/structure/limits.txt", "# A comment.\n" + "".join(lines))

    def run_measure(self, *arguments: str) -> subprocess.CompletedProcess:
        command = [sys.executable, str(HERE / "measure.py"), "--root", str(self.root), *arguments]
        return subprocess.run(command, capture_output=True, text=True)

    def offenders(self, figure: str) -> list:
        """Returns the offenders as "path:line"."""
        run = self.run_measure("--list", figure)
        self.assertEqual(run.returncode, 0, run.stderr)
        return [re.match(r".*?:\d+", line)[0] for line in run.stdout.splitlines()]

    def texts(self, figure: str) -> list:
        """Returns what is said about the offenders."""
        run = self.run_measure("--list", figure)
        return [line.split(": ", 1)[1] for line in run.stdout.splitlines()]


class Classes(TreeTest):
    def test_class_with_more_than_25_functions_is_found(self):
        big = "// A comment.\nclass Big {\n public:\n" + functions(20) + " private:\n"
        big += "  template <class T>\n  int g(T t) { return t; }\n  static void h();\n"
        big += "  Big();\n  ~Big() override;\n  bool operator==(const Big&) const;\n"
        self.write("components/a/big.hpp", big + "};\n")
        self.assertEqual(self.offenders("class_functions"), [])
        self.write("components/a/big.hpp", big + "  void g(int);\n};\n")
        self.assertEqual(self.offenders("class_functions"), ["components/a/big.hpp:2"])
        self.assertEqual(self.texts("class_functions"), ["Big has 26 member functions"])

    def test_functions_that_do_not_count(self):
        others = (
            "  Small(const Small&) = delete;\n  Small& operator=(Small&&) = default;\n"
            "  friend class Builder;\n  std::function<void()> call{};\n  void (*pointer)(int){};\n"
            "  int value{[] { return 1; }()};\n  // void commented();\n"
            '  const char* text = R"(\n  void quoted();\n)";\n'
            "  struct Inner {\n" + functions(3) + "  };\n"
        )
        self.write("components/a/small.hpp", "struct Small {\n" + functions(25) + others + "};\n")
        self.write("components/a/small.cpp", "void Small::f0() {}\nvoid Small::f1() {}\n")
        self.assertEqual(self.offenders("class_functions"), [])

    def test_only_components_are_measured(self):
        big = "class Big {\n" + functions(26) + members(21) + "};\n"
        self.write("common/a/big.hpp", big)
        self.assertEqual(self.offenders("class_functions") + self.offenders("class_members"), [])
        self.write("components/a/local.cpp", "namespace {\n" + big + "}\n")
        self.assertEqual(self.offenders("class_functions"), ["components/a/local.cpp:2"])

    def test_class_with_more_than_20_members_is_found(self):
        begin = "class Big {\n  void f();\n" + members(16) + "  std::vector<int> a, b{1, 2};\n"
        begin += "  static constexpr int kConstant = 1;\n  static int counter;\n"
        begin += "  std::array<int, size(3)> hidden{};\n  void (*pointer)(int){};\n"
        self.write("components/a/big.hpp", begin + "};\n")
        self.assertEqual(self.offenders("class_members"), [])
        self.write("components/a/big.hpp", begin + "  int last{};\n};\n")
        self.assertEqual(self.texts("class_members"), ["Big has 21 data members"])

    def test_plain_aggregates_do_not_count(self):
        same = "  bool operator==(const Message&) const = default;\n"
        self.write("components/a/message.hpp", "struct Message {\n" + members(30) + same + "};\n")
        with_function = "struct S {\n  bool valid() const;\n" + members(30) + "};\n"
        self.write("components/a/settings.hpp", with_function)
        self.assertEqual(self.offenders("class_members"), [])
        self.write("components/a/message.hpp", with_function)
        self.assertEqual(self.offenders("class_members"), ["components/a/message.hpp:1"])


class Functions(TreeTest):
    def test_function_over_80_lines_is_found(self):
        self.write("common/a/a.cpp", "int x;\nvoid short_one() {\n" + body(78) + "}\n")
        self.assertEqual(self.offenders("long_functions"), [])
        begin = "int x;\ntemplate <class T>\nvoid f(T t) {\n"
        self.write("common/a/a.cpp", begin + body(78) + "}\n")
        self.assertEqual(self.offenders("long_functions"), ["common/a/a.cpp:2"])
        self.assertEqual(self.texts("long_functions"), ["f has 81 lines"])

    def test_lambda_belongs_to_its_function(self):
        inner = "  const auto g = [] {\n" + body(78) + "  };\n"
        self.write("sim/a.cpp", "A::A(int x)\n    : x_(x) {\n" + inner + "}\n")
        self.assertEqual(self.texts("long_functions"), ["A::A has 83 lines"])

    def test_braces_in_strings_and_comments_do_not_count(self):
        text = 'void f() {\n  g("}", R"(\n}\n)", \'}\', 1\'000);  // }\n' + body(10) + "}\n"
        self.write("sim/a.cpp", text + "int table[] = {\n" + "  1,\n" * 100 + "};\n")
        self.assertEqual(self.offenders("long_functions"), [])

    def test_typescript_is_measured(self):
        many = "a: number, b: string, c: number, d: number, e: number, f: number"
        begin = f"function f({many}): {{ x: number }}[] {{\n"
        self.write("components/w/a.ts", begin + body(79) + "}\n")
        self.assertEqual(self.texts("long_functions"), ["f has 81 lines"])
        self.assertEqual(self.offenders("many_parameters"), [])
        begin = f"function f({many}, g: number) {{\n  `}}${{a}}`;\n}}\n"
        self.write("components/w/a.ts", begin + body(90))
        self.assertEqual(self.offenders("long_functions"), [])
        self.assertEqual(self.texts("many_parameters"), ["f has 7 parameters"])

    def test_function_with_7_parameters_counts_once(self):
        six = "int a, int b, std::map<int, int> c,\n    int d, int e = f(1, 2)"
        seven = f"{six}, int f, std::vector<int> g"
        class_a = f"struct A {{\n  A({six}, int f);\n  void g({seven} = {{1, 2}});\n}};\n"
        self.write("common/a/a.hpp", class_a)
        self.assertEqual(self.offenders("many_parameters"), ["common/a/a.hpp:4"])
        self.write("common/a/a.cpp", f"void A::g({seven}) {{}}\n")
        self.assertEqual(self.offenders("many_parameters"), ["common/a/a.cpp:1"])
        callback = "const std::function<void(int, int, int, int, int, int, int)>& f"
        self.write("common/a/b.cpp", f"void h({callback}) {{ g(1, 2, 3, 4, 5, 6, 7); }}\n")
        self.assertEqual(self.offenders("many_parameters"), ["common/a/a.cpp:1"])


class Files(TreeTest):
    def test_file_over_500_lines_is_found(self):
        self.write("common/a/a.cpp", "\n" * 500)
        self.write("deploy/w/a.ts", "\n" * 501)
        self.write("tests/unit/a_test.cpp", "\n" * 501)
        self.assertEqual(self.offenders("long_files"), ["deploy/w/a.ts:1"])

    def test_folder_with_more_than_30_sources_is_found(self):
        for number in range(30):
            self.write(f"tests/unit/a{number}_test.cpp", "")
        self.write("tests/unit/data.csv", "")
        self.write("tests/unit/sub/b_test.cpp", "")
        self.assertEqual(self.offenders("full_folders"), [])
        self.write("tests/unit/b.hpp", "")
        self.assertEqual(self.texts("full_folders"), ["31 source files"])

    def test_generated_and_hidden_folders_are_left_out(self):
        for folder in ("build/release", "components/w/node_modules/x", ".cache"):
            self.write(f"{folder}/a.md", "x" * 101)
        self.assertEqual(self.offenders("long_lines"), [])

    def test_source_without_a_licence_line_is_found(self):
        licence = "SPDX-License-Identifier: Apache-2.0"
        self.write("components/a/a.cpp", f"// {licence}\nint a;\n")
        self.write("components/a/b.py", f"#!/usr/bin/env python3\n# {licence}\n")
        self.write("components/a/CMakeLists.txt", f"# {licence}\n")
        self.write("components/a/c.hpp", "int c();\n")
        self.write("components/a/notes.txt", "c\n")
        self.assertEqual(self.offenders("unlicensed_files"), ["components/a/c.hpp:1"])

    def test_the_licence_line_does_not_count(self):
        licence = "// SPDX-License-Identifier: Apache-2.0\n"
        self.write("components/a/node.cpp", licence + "\n" * 150)
        self.assertEqual(self.offenders("long_nodes"), [])

    def test_node_over_150_lines_is_found(self):
        self.write("components/a/node.cpp", "\n" * 151)
        self.write("components/a/main.cpp", "\n" * 150)
        self.write("components/a/other_node.cpp", "\n" * 151)
        self.assertEqual(self.offenders("long_nodes"), ["components/a/node.cpp:1"])

    def test_line_over_100_columns_is_found(self):
        self.write("docs/a.md", "ä" * 100 + "\n" + "x" * 101 + "\n| " + "x" * 101 + " |\n")
        self.write("tests/unit/a_test.cpp", "//" + "x" * 99 + "\n")
        self.write("common/a/a.txtpb", "x" * 101)
        self.assertEqual(self.offenders("long_lines"), ["docs/a.md:2", "tests/unit/a_test.cpp:1"])


HEADER = """#pragma once
/// A class.
class A {
 public:
  A();
  ~A();
  bool operator==(const A&) const;
  void overrides() override;
  A(const A&) = delete;
  /// Does it.
  void before();
  void behind() const;  ///< Does it.
  void behind_too() { x_ = 1; }  ///< Does it.
  /// Does it for any
  /// type.
  template <class T>
  [[nodiscard]] std::vector<T> of_template(
      const T& t, int x = 1);
  void several_lines(int a,
                     int b);  ///< Does it.
  /// Does it.
  // It is not simple.
  void with_remark();

 private:
  void hidden();
  struct Hidden {
    int field;
    void f();
  };
  int x_;
};
namespace {
void anonymous();
}
namespace detail {
void detailed();
}
"""
BARE_HEADER = """struct B {
  // Plain comment.
  void plain();
  int field{};  ///< Of the field.
                ///< More of the field.
  void after_field();
  /// Far away.

  void far_away();
  /// Of the first.
  void first();
  void second();
  void f() {
    g();  ///< Inside.
  }
};
"""
FIELDS = """/// A struct.
struct C {
  int a{};  ///< Doc.
  /// Doc.
  std::vector<int> b;
  double c{}, d[2]{1, 2},
      e{};  ///< Doc of all.
  /// Doc of both.
  int f, g{3};
  std::function<void(int)> h{};  ///< Doc.
  enum class E { one, two };
  using T = int;
  static constexpr int kLimit = 1;  ///< Doc.
  void function();
};
"""
BARE_FIELDS = """/// A struct.
struct D { int inside; };
struct E {
  int a{};  // plain
  int b{};  ///< Doc.
  int c{};
 protected:
  int d{};
};
"""


class Documentation(TreeTest):
    def test_documented_functions_are_not_listed(self):
        self.write("common/a/a.hpp", HEADER)
        self.assertEqual(self.texts("documented_functions"), [])
        table = self.run_measure().stdout
        self.assertRegex(table, r"documented_functions .* 100\.0 +0\.0 +95\.0  ok")

    def test_functions_without_comment_are_listed(self):
        self.write("common/a/b.hpp", BARE_HEADER)
        names = ["B::plain", "B::after_field", "B::far_away", "B::second", "B::f"]
        self.assertEqual(self.texts("documented_functions"), names)
        self.assertRegex(self.run_measure().stdout, r"documented_functions .* 16\.6 ")

    def test_a_definition_in_the_same_header_is_no_second_function(self):
        text = "/// Doc.\nint f(int x);\nstruct A {\n  int g();  ///< Doc.\n};\n"
        text += "inline int f(int x) { return x; }\ninline int A::g() { return 1; }\n"
        self.write("sim/a.hpp", text)
        self.assertEqual(self.texts("documented_functions"), [])

    def test_only_product_headers_count(self):
        self.write("tests/support/a.hpp", "void f();\n")
        self.write("common/a/a.cpp", "void f() {}\nstruct A { int x; };\n")
        self.assertEqual(self.texts("documented_functions"), [])
        self.assertEqual(self.texts("documented_fields"), [])

    def test_documented_fields_are_not_listed(self):
        self.write("common/a/c.hpp", FIELDS)
        self.assertEqual(self.texts("documented_fields"), [])

    def test_fields_without_comment_are_listed(self):
        self.write("common/a/d.hpp", BARE_FIELDS)
        self.assertEqual(self.texts("documented_fields"), ["D::inside", "E::a", "E::c"])
        self.assertRegex(self.run_measure().stdout, r"documented_fields .* 25\.0 ")


class Words(TreeTest):
    def test_words_in_names_comments_and_literals_are_found(self):
        names = "int told_width;\nint kMostBoxes;\n"
        self.write("common/a/a.hpp", names + "// It was gone\n// over.\nint x;  ///< the way the\n")
        self.write("common/a/a.cpp", '// gone over\nf("gone "\n  "over");\nint told;\n')
        found = ["common/a/a.cpp:2"] + [f"common/a/a.hpp:{line}" for line in (1, 2, 3, 5)]
        self.assertEqual(sorted(self.offenders("private_words")), found)
        self.assertIn('"told_width": reported', self.texts("private_words"))

    def test_other_words_are_not_found(self):
        text = '#include "told/gone over.hpp"\nint untold;\n// told\nint x;  // gone\n'
        self.write("common/a/a.hpp", text + "int y;  // over\n")
        self.write("tests/unit/a_test.cpp", 'f("gone over");\n')
        self.assertEqual(self.offenders("private_words"), [])

    def test_a_wrong_list_is_named(self):
        self.write("tests/structure/words.txt", "[names]\n(a => b\n")
        run = self.run_measure("--list", "private_words")
        self.assertEqual(run.returncode, 2)
        self.assertIn("words.txt:2", run.stderr)


class States(TreeTest):
    def test_phase_compared_with_text_is_found(self):
        text = 'a = status.phase == "x";\nb = "x" != phase_;\nc = phase.rfind("w", 0) == 0;\n'
        self.write("components/a/a.cpp", text)
        found = [f"components/a/a.cpp:{line}" for line in (1, 2, 3)]
        self.assertEqual(self.offenders("state_as_text"), found)

    def test_other_comparisons_are_not_found(self):
        text = 'phase = "x";\nf(phase == Phase::idle);\n// phase == "x"\nname == "x";\n'
        self.write("components/a/a.cpp", text + 'g("phase == \\"x\\"");\n')
        self.assertEqual(self.offenders("state_as_text"), [])


class TestNames(TreeTest):
    def test_names_that_are_no_sentences_are_found(self):
        text = "TEST(A, StopsInTime) {}\nTEST_F(A, stops) {}\nTEST_P(A,\n       stops_At_x) {}\n"
        self.write("tests/unit/a_test.cpp", text + "TYPED_TEST(A, Bad) {}\n")
        found = [f"tests/unit/a_test.cpp:{line}" for line in (1, 2, 3, 5)]
        self.assertEqual(self.offenders("test_names"), found)

    def test_sentences_are_not_found(self):
        text = "TEST(A, stops_before_2_walls) {}\n// TEST(A, Bad)\nTYPED_TEST_SUITE(A, Types);\n"
        self.write("tests/unit/a_test.cpp", text)
        self.assertEqual(self.offenders("test_names"), [])


class Limits(TreeTest):
    def test_an_empty_tree_is_within_its_limits(self):
        run = self.run_measure()
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        self.assertEqual(run.stdout.count("  ok\n"), len(FIGURES))

    def test_a_figure_over_its_limit_fails(self):
        self.write("docs/a.md", "x" * 101)
        run = self.run_measure()
        self.assertEqual(run.returncode, 1)
        self.assertRegex(run.stdout, r"long_lines .* 1 +0 +0  over")
        self.assertIn("--list long_lines", run.stdout)

    def test_a_share_below_its_limit_fails(self):
        self.write_limits(documented_fields="50.1 95.0")
        text = "struct A {\n  int a;  ///< Doc.\n  int b;\n};\n"
        self.write("common/a/a.hpp", "// SPDX-License-Identifier: Apache-2.0\n" + text)
        self.assertEqual(self.run_measure().returncode, 1)
        self.write_limits(documented_fields="50.0 95.0")
        self.assertEqual(self.run_measure().returncode, 0)

    def test_better_figures_are_reported_and_written(self):
        self.write_limits(long_lines="   3  0", documented_fields="40.0 95.0")
        self.write("docs/a.md", "x" * 101)
        run = self.run_measure()
        self.assertEqual(run.returncode, 0)
        self.assertRegex(run.stdout, "better than the limit: .*documented_fields.*long_lines")
        self.assertEqual(self.run_measure("--tighten").returncode, 0)
        limits = (self.root / "tests/structure/limits.txt").read_text(encoding="utf-8")
        self.assertRegex(limits, r"(?m)^long_lines +1 +0$")
        self.assertRegex(limits, r"(?m)^documented_fields +100.0 95.0$")
        self.assertNotIn("better", self.run_measure().stdout)

    def test_tightening_does_not_raise_a_limit(self):
        self.write("docs/a.md", "x" * 101)
        self.assertEqual(self.run_measure("--tighten").returncode, 1)
        limits = (self.root / "tests/structure/limits.txt").read_text(encoding="utf-8")
        self.assertIn("long_lines 0 0", limits)

    def test_a_missing_limit_is_an_error(self):
        self.write("tests/structure/limits.txt", "long_lines 0 0\n")
        run = self.run_measure()
        self.assertEqual(run.returncode, 2)
        self.assertIn("no limit for class_functions", run.stderr)


if __name__ == "__main__":
    try:
        find_ctags()
    except Failure as failure:
        print(failure)
        sys.exit(failure.status)
    unittest.main()
