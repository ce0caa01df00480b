# SPDX-License-Identifier: Apache-2.0
"""Recordings as NumPy arrays (docs/recording.md).

    with_times = handsel.recording.read("today.mcap", ["handsel/robot_state"])
    state = with_times["handsel/robot_state"]
    state.time, state["position"]          # (n,) [ns], (n, axes) [rad]

A column holds one field of all samples, named as in idl/, for example "people.joints.position.x".
Sequences are padded to the longest one, floats with NaN, other numbers with 0, texts with "";
"len(<name>)" has their lengths. Types are read from the recording itself, so recordings of other
versions open too.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple, Optional, Union

import numpy as np
from numpy.typing import NDArray

from . import _recording

__all__ = ["FileError", "MissingError", "Overview", "Table", "Topic", "overview", "read"]

FileError = _recording.FileError
MissingError = _recording.MissingError


class Topic(NamedTuple):
    """What a recording has of one topic."""

    type: str  #: name of the message type, "handsel::RobotState"
    encoding: str  #: "cdr" for messages
    messages: int  #: number of messages


class Overview(NamedTuple):
    """Contents of a recording."""

    topics: dict[str, Topic]  #: by name
    metadata: dict[str, str]  #: robot, scenario, seed, data of a study
    cut: bool  #: True when the recorder was ended before it closed the file


class Table(Mapping):
    """Samples of one topic: a mapping from column names to arrays whose first dimension is the
    sample."""

    def __init__(self, type: str, time: NDArray[np.int64], columns: dict[str, NDArray],
                 names: dict[str, list[str]]):
        self.type = type  #: name of the message type
        self.time = time  #: when each sample was written [ns, system clock], shape (n,)
        self._columns = columns
        self._names = names

    def __getitem__(self, column: str) -> NDArray:
        try:
            return self._columns[column]
        except (KeyError, TypeError):
            raise KeyError(f"{self.type} has no column {column!r}; it has: "
                           f"{', '.join(self._columns)}.") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def names(self, column: str) -> list[str]:
        """Returns the names of the values 0, 1, ... of a column of an enumeration."""
        self[column]
        if column not in self._names:
            raise ValueError(f"column {column!r} of {self.type} is no enumeration.")
        return self._names[column]

    def flat(self) -> dict[str, NDArray]:
        """Returns "time" and all columns with one dimension, as "position[0]": what
        pandas.DataFrame takes."""
        out = {"time": self.time}
        for name, values in self._columns.items():
            if values.ndim == 1:
                out[name] = values
                continue
            for place in np.ndindex(values.shape[1:]):
                out[name + "".join(f"[{i}]" for i in place)] = values[(slice(None), *place)]
        return out

    def __repr__(self) -> str:
        return f"<Table of {len(self.time)} {self.type}, {len(self)} columns>"


def _file(path: Union[str, os.PathLike]) -> str:
    if not isinstance(path, (str, os.PathLike)):
        raise TypeError(f"path must be a str or a path, not {type(path).__name__}.")
    return os.fspath(path)


def overview(path: Union[str, os.PathLike]) -> Overview:
    """Returns topics, number of messages and metadata of a recording.

    Raises MissingError for a file that is not there, FileError for one that is no recording.
    """
    topics, metadata, cut = _recording.overview(_file(path))
    return Overview({name: Topic(*topic) for name, topic in topics.items()}, metadata, cut)


def read(path: Union[str, os.PathLike], topics: Optional[Iterable[str]] = None, *,
         max_bytes: int = 4 << 30) -> dict[str, Table]:
    """Returns the samples of topics as tables.

    topics: names; left out: every topic with messages in CDR. max_bytes: largest size of the
    columns of one topic. Raises MissingError for a file that is not there, FileError naming topic
    and field for damaged samples, ValueError for a topic that is not in the recording.
    """
    found = overview(path)
    if topics is None:
        wanted = [name for name, topic in found.topics.items() if topic.encoding == "cdr"]
    else:
        if isinstance(topics, str):
            raise TypeError("topics must be a list of str, not str.")
        wanted = list(topics)
    for name in wanted:
        if not isinstance(name, str):
            raise TypeError(f"topics must be a list of str, not of {type(name).__name__}.")
        if name not in found.topics:
            raise ValueError(f"{_file(path)} has no topic {name!r}; it has: "
                             f"{', '.join(found.topics)}.")
    tables = _recording.read_tables(_file(path), wanted, max_bytes)
    return {name: Table(*tables[name]) for name in wanted}
