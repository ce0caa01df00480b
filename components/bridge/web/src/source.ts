// SPDX-License-Identifier: Apache-2.0
// Where the page reads samples: the live connection, or one instant of the past.
import { ComponentHealth, TopicName, Topics } from "./messages";

export interface Health { message: ComponentHealth; age: number }  // age [s]

export interface Source {
  // Returns the newest sample, of the instance `key` if given; undefined before the first one.
  newest<T extends TopicName>(topic: T, key?: string): Topics[T] | undefined;
  // Returns the time since the newest sample [s]; infinite before the first one.
  age(topic: TopicName): number;
  // Returns the keys of the instances of a topic whose samples have a key.
  keys(topic: TopicName): string[];
  // Returns the newest health of each process.
  health(): Health[];
  // Returns an enumerator as words, "Mode" 1 -> "slow".
  word(enumeration: string, value: number): string;
  // Returns all enumerators of an enumeration in order.
  enumeration(name: string): string[];
}

// Returns the names of the bits set in ExecutionStatus.causes, as words.
export function causesOf(source: Source, causes: number): string[] {
  return source.enumeration("Cause").filter((_, bit) => causes & (1 << bit)).map((cause) => cause.replaceAll("_", " "));
}
