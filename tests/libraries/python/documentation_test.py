# SPDX-License-Identifier: Apache-2.0
"""Every public name of the package is documented and typed; the document of the libraries lists
them; every name in the umbrella headers is in the C++ headers."""

import importlib
import inspect
import os
import re
import typing
import unittest
from pathlib import Path

import handsel

ROOT = Path(os.environ["HANDSEL_SOURCE_DIR"])
MODULES = [importlib.import_module(f"handsel.{name}")
           for name in handsel.__all__ if (Path(handsel.__file__).parent / f"{name}.py").exists()]


def members(kind: type):
    for name, member in vars(kind).items():
        if name.startswith("_") or name in getattr(kind, "_fields", ()):
            continue
        if isinstance(member, property):
            yield name, member.fget
        elif isinstance(member, (staticmethod, classmethod)):
            yield name, member.__func__
        elif inspect.isfunction(member):
            yield name, member


def public():
    for module in MODULES:
        for name in module.__all__:
            item = getattr(module, name)
            yield f"{module.__name__}.{name}", item
            if inspect.isclass(item) and item.__module__ == module.__name__:
                for member, function in members(item):
                    yield f"{module.__name__}.{name}.{member}", function


class Documentation(unittest.TestCase):
    def test_all_modules_are_there(self):
        self.assertEqual(len(MODULES), len(handsel.__all__))

    def test_every_public_name_has_a_docstring(self):
        names = list(public())
        self.assertGreater(len(names), 60)
        for name, item in names:
            native = getattr(item, "__module__", "").startswith("handsel._")
            self.assertTrue(native or (item.__doc__ or "").strip(), name)

    def test_every_public_function_is_typed(self):
        for name, item in public():
            if inspect.isfunction(item) and not item.__name__.startswith("_"):
                self.assertIn("return", item.__annotations__, name)
                for parameter in inspect.signature(item).parameters.values():
                    typed = parameter.annotation is not inspect.Parameter.empty
                    self.assertTrue(typed or parameter.name == "self", f"{name} {parameter.name}")
        for module in MODULES:
            typing.get_type_hints(module)

    def test_every_field_of_a_result_has_a_comment(self):
        for module in MODULES:
            text = Path(module.__file__).read_text()
            for name in module.__all__:
                for field in getattr(getattr(module, name), "_fields", ()):
                    self.assertRegex(text, rf"\n    {field}: [^\n]+  #: ", f"{name}.{field}")

    def test_the_document_names_every_module_and_component(self):
        document = (ROOT / "docs/libraries.md").read_text()
        for name in handsel.__all__:
            self.assertIn(f"`handsel.{name}`", document)
        parts = (ROOT / "common/libraries/parts.cmake").read_text()
        for name in re.search(r"HANDSEL_LIBRARY_NAMES (.*)\)", parts)[1].split():
            self.assertIn(f"`handsel::{name}`", document)

    def test_the_names_in_the_umbrella_headers_exist(self):
        for header in (ROOT / "common/libraries/include/handsel").glob("*.hpp"):
            text = header.read_text()
            included = "".join((ROOT / path).read_text()
                               for path in re.findall(r'"(common/[^"]+)"', text))
            for line in re.findall(r"^//   (\S.*?)(?:   |$)", text, re.M):
                for name in re.findall(r"[A-Za-z_:]+", line):
                    self.assertIn(name.split(":")[-1], included, f"{header.name}: {name}")


if __name__ == "__main__":
    unittest.main()
