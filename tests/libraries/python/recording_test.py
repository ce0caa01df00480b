# SPDX-License-Identifier: Apache-2.0
"""handsel.recording against an independent encoder: random samples of every message type of idl/,
written as CDR by this file, read back as columns."""

import os
import random
import re
import struct
import tempfile
import unittest
from pathlib import Path

import numpy as np

from handsel import recording

IDL = Path(os.environ["HANDSEL_SOURCE_DIR"]) / "idl"
NUMBERS = {"boolean": "?", "octet": "B", "short": "h", "unsigned short": "H", "long": "i",
           "unsigned long": "I", "long long": "q", "unsigned long long": "Q", "float": "f",
           "double": "d"}
MAGIC = b"\x89MCAP0\r\n"


def idl_text(name: str, done: set) -> str:
    """Returns the text of a file of idl/ with what it includes, each once."""
    if name in done:
        return ""
    done.add(name)
    out = ""
    for line in (IDL / name).read_text().splitlines():
        include = re.match(r'#include "(.*)"', line)
        if include:
            out += idl_text(include[1], done)
        elif not line.startswith("#"):
            out += line + "\n"
    return out


class Types:
    """Structs and enums of an IDL text, by regular expressions."""

    def __init__(self, text: str):
        text = re.sub(r"//.*", "", text)
        self.enums = {m[1]: [v.strip() for v in m[2].split(",")]
                      for m in re.finditer(r"enum (\w+) \{(.*?)\};", text, re.S)}
        self.structs = {m[1]: re.findall(r"(\w[\w ]*?(?:<.*?>)?) +(\w+);", m[2].replace("@key", ""))
                        for m in re.finditer(r"struct (\w+) \{(.*?)\};", text, re.S)}

    def sample(self, kind: str, dice: random.Random):
        """Returns a random value: dict of a struct, list of a sequence, number or text."""
        sequence = re.fullmatch(r"sequence<(.*?)(?:, *(\d+))?>", kind)
        if sequence:
            length = dice.randint(0, min(3, int(sequence[2] or 3)))
            return [self.sample(sequence[1], dice) for _ in range(length)]
        if kind.startswith("string"):
            return "".join(dice.choice("abcäß 1") for _ in range(dice.randint(0, 5)))
        if kind in self.structs:
            return {name: self.sample(of, dice) for of, name in self.structs[kind]}
        if kind in self.enums:
            return dice.randrange(len(self.enums[kind]))
        if kind in ("double", "float"):
            return dice.choice((0.0, -1.5, 2.0**20, dice.randint(-99, 99) / 64))
        if kind == "boolean":
            return dice.random() < 0.5
        size = struct.calcsize(NUMBERS[kind])
        low = 0 if kind.startswith("unsigned") or kind == "octet" else -2 ** (8 * size - 1)
        return dice.randint(low, low + 2 ** (8 * size) - 1)

    def encode(self, kind: str, value, out: bytearray, order: str) -> None:
        """Appends a value as CDR; `out` begins after the encapsulation header."""
        def number(code, x):
            size = struct.calcsize(code)
            out.extend(bytes(-len(out) % size) + struct.pack(order + code, x))
        sequence = re.fullmatch(r"sequence<(.*?)(?:, *(\d+))?>", kind)
        if sequence:
            number("I", len(value))
            for element in value:
                self.encode(sequence[1], element, out, order)
        elif kind.startswith("string"):
            raw = value.encode() + b"\0"
            number("I", len(raw))
            out.extend(raw)
        elif kind in self.structs:
            for of, name in self.structs[kind]:
                self.encode(of, value[name], out, order)
        elif kind in self.enums:
            number("I", value)
        else:
            number(NUMBERS[kind], value)


def text(value: str) -> bytes:
    return struct.pack("<I", len(value.encode())) + value.encode()


def record(op: int, content: bytes) -> bytes:
    return struct.pack("<BQ", op, len(content)) + content


def chunk(content: bytes) -> bytes:
    return record(6, struct.pack("<QQQI", 0, 0, len(content), 0) + text("") +
                  struct.pack("<Q", len(content)) + content)


def mcap(topics: dict, encoding: str = "cdr") -> bytes:
    """Returns a recording; topics: name to (type, IDL text, list of (time, sample))."""
    out = MAGIC + record(1, text("") + text(""))
    messages = b""
    for i, (name, (kind, idl, samples)) in enumerate(topics.items(), 1):
        out += record(3, struct.pack("<H", i) + text(kind) + text("omgidl") + text(idl))
        out += record(4, struct.pack("<HH", i, i) + text(name) + text(encoding) + text(""))
        for number, (time, sample) in enumerate(samples):
            messages += record(5, struct.pack("<HIQQ", i, number, time, time) + sample)
    return out + chunk(messages) + record(15, bytes(4)) + record(2, bytes(20)) + MAGIC


def leaves(value, path: str, place: tuple, out: dict) -> None:
    """Collects (place in its sequences, value) of each number and text by the name of its column."""
    if isinstance(value, dict):
        for name, part in value.items():
            leaves(part, f"{path}.{name}" if path else name, place, out)
    elif isinstance(value, list):
        out.setdefault(f"len({path})", []).append((place, len(value)))
        for i, part in enumerate(value):
            leaves(part, path, (*place, i), out)
    else:
        out.setdefault(path, []).append((place, value))


class Recording(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.file = Path(self.folder.name) / "a.mcap"

    def tearDown(self):
        self.folder.cleanup()

    def write(self, content: bytes) -> Path:
        self.file.write_bytes(content)
        return self.file

    def test_every_message_type_is_read_back(self):
        checked = 0
        for file in sorted(IDL.glob("*.idl")):
            idl = idl_text(file.name, set())
            types = Types(idl)
            own = Types(file.read_text()).structs
            for kind in own:
                for order, header in (("<", b"\0\1\0\0"), (">", b"\0\0\0\0")):
                    seed = f"{kind}{order}"
                    dice = random.Random(seed)
                    values = [types.sample(kind, dice) for _ in range(5)]
                    samples = []
                    for i, value in enumerate(values):
                        body = bytearray()
                        types.encode(kind, value, body, order)
                        samples.append((i * 1000, header + bytes(body)))
                    path = self.write(mcap({"a": ("handsel::" + kind, idl, samples)}))
                    table = recording.read(path)["a"]
                    np.testing.assert_array_equal(table.time, [0, 1000, 2000, 3000, 4000])
                    expected = {}
                    for i, value in enumerate(values):
                        leaves(value, "", (i,), expected)
                    for name, entries in expected.items():
                        for place, value in entries:
                            self.assertEqual(table[name][place], value, f"{seed} {name} {place}")
                            checked += 1
        self.assertGreater(checked, 5000)

    def table(self, idl: str, body: bytes, **more):
        return recording.read(self.write(mcap({"a": ("T", idl, [(7, b"\0\1\0\0" + body)])})),
                              **more)["a"]

    def test_sequences_are_padded_and_enumerations_have_names(self):
        idl = ("enum E { E_A, E_B };\nstruct P { double x; string s; };\n"
               "struct T { sequence<P, 4> ps; E e; long n[2][3]; };")
        types = Types("enum E { E_A, E_B };\nstruct P { double x; string s; };\n"
                      "struct T { sequence<P, 4> ps; E e; };")
        samples = []
        for ps in ([], [{"x": 1.0, "s": "one"}]):
            body = bytearray()
            types.encode("T", {"ps": ps, "e": 1}, body, "<")
            body += struct.pack("<6i", *range(6))
            samples.append((0, b"\0\1\0\0" + bytes(body)))
        table = recording.read(self.write(mcap({"a": ("T", idl, samples)})))["a"]
        self.assertTrue(np.isnan(table["ps.x"][0, 0]))
        self.assertEqual(table["ps.x"][1, 0], 1)
        self.assertEqual(table["ps.s"].tolist(), [[""], ["one"]])
        self.assertEqual(table["len(ps)"].tolist(), [0, 1])
        self.assertEqual([table.names("e")[i] for i in table["e"]], ["E_B", "E_B"])
        self.assertEqual(table["n"].shape, (2, 2, 3))
        self.assertEqual(table["n"][1].tolist(), [[0, 1, 2], [3, 4, 5]])
        flat = table.flat()
        self.assertEqual(flat["n[1][2]"].tolist(), [5, 5])
        self.assertTrue(all(column.shape == (2,) for column in flat.values()))

    def test_damaged_samples_are_refused_with_topic_sample_and_field(self):
        cases = {
            ("struct T { double x; };", b"\0\0"): "field x: the sample ends",
            ("struct T { string s; };", struct.pack("<I", 9) + b"abc"): "field s: the sample ends",
            ("struct T { string s; };", struct.pack("<I", 3) + b"abc"): "field s: the text has no",
            ("struct T { sequence<double> v; };", struct.pack("<I", 2**31)): "field v: the sample",
            ("struct T { sequence<octet, 2> v; };", struct.pack("<I", 3) + b"abc"): "bound of 2",
            ("struct Q { double x; };", b""): "no struct T",
            ("struct T { nonsense x; };", b""): "IDL line 1: no type nonsense",
            ("struct T { double x }", b""): 'IDL line 1: ";" expected',
            ("struct T { T x; };", b""): "no type T",
            ("struct T {\n/* unfinished", b""): "IDL line 2",
            ("union T { double x; };", b""): "IDL line 1",
            ("struct T { " + "sequence<" * 99, b""): "nested too deep",
        }
        for (idl, body), sentence in cases.items():
            with self.subTest(idl), self.assertRaises(recording.FileError) as caught:
                self.table(idl, body)
            message = str(caught.exception)
            self.assertIn(sentence, message)
            self.assertIn("topic a, sample 0", message)
            self.assertNotIn("\n", message)

    def test_random_damage_never_crashes(self):
        types = Types(idl_text("world.idl", set()))
        idl = idl_text("world.idl", set())
        dice = random.Random(4)
        body = bytearray()
        types.encode("HumanState", types.sample("HumanState", dice), body, "<")
        good = mcap({"a": ("HumanState", idl, [(0, b"\0\1\0\0" + bytes(body))] * 3)})
        for round_ in range(150):
            bad = bytearray(good)
            for _ in range(dice.randint(1, 8)):
                bad[dice.randrange(8, len(bad))] = dice.randrange(256)
            if dice.random() < 0.3:
                del bad[dice.randrange(8, len(bad)):]
            try:
                recording.read(self.write(bytes(bad)), max_bytes=1 << 24)
            except ValueError as error:
                self.assertNotIn("\n", str(error).strip()[:200], f"round {round_}")

    def test_mistakes_of_the_caller_are_one_sentence(self):
        path = self.write(mcap({"a": ("T", "struct T { double x; };", [])}))
        self.assertIsInstance(recording.MissingError(), FileNotFoundError)
        for error, call in (
                (recording.MissingError, lambda: recording.read(path.parent / "none.mcap")),
                (recording.FileError, lambda: recording.read(path.parent)),
                (recording.FileError, lambda: recording.overview(__file__)),
                (TypeError, lambda: recording.read(3)),
                (TypeError, lambda: recording.read(path, "a")),
                (TypeError, lambda: recording.read(path, [1])),
                (TypeError, lambda: recording.read(path, max_bytes=1.5)),
                (ValueError, lambda: recording.read(path, max_bytes=0)),
                (ValueError, lambda: recording.read(path, ["b"]))):
            with self.assertRaises(error) as caught:
                call()
            self.assertNotIn("\n", str(caught.exception))

    def test_columns_beyond_the_limit_are_refused(self):
        with self.assertRaisesRegex(recording.FileError, "column v needs too much memory"):
            self.table("struct T { sequence<double> v; };",
                       struct.pack("<I4x", 100) + bytes(800), max_bytes=500)

    def test_a_recording_that_was_cut_off_is_read_as_far_as_it_goes(self):
        samples = [(i, b"\0\1\0\0" + struct.pack("<d", i)) for i in range(3)]
        whole = mcap({"a": ("T", "struct T { double x; };", samples)})
        path = self.write(whole[:whole.rindex(record(15, bytes(4)))])
        self.assertTrue(recording.overview(path).cut)
        self.assertEqual(recording.read(path)["a"]["x"].tolist(), [0, 1, 2])


if __name__ == "__main__":
    unittest.main()
