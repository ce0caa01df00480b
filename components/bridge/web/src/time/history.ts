// SPDX-License-Identifier: Apache-2.0
// Samples of the past as they came, found again by time. Memory is bounded: the oldest go first.
import { Decoder } from "../decoder";
import { ComponentHealth, TopicName, Topics } from "../messages";
import { Health, Source } from "../source";

// One instance of a topic: samples in the order of their stamps.
class Series {
  bytes = 0;
  private stamps: number[] = [];  // [ms] system clock
  private samples: DataView[] = [];
  private first = 0;              // index of the oldest sample kept
  private decoded = -1;           // index of `message`
  private message: unknown;

  constructor(private readonly decoder: Decoder) {}

  get oldest(): number {
    return this.stamps[this.first] ?? Infinity;
  }
  get newest(): number {
    return this.stamps[this.stamps.length - 1] ?? -Infinity;
  }

  add(stamp: number, sample: DataView): void {
    this.stamps.push(stamp);
    this.samples.push(sample);
    this.bytes += sample.byteLength;
  }

  drop(): void {
    if (this.first >= this.samples.length) return;
    this.bytes -= this.samples[this.first].byteLength;
    this.samples[this.first++] = kNothing;
    if (this.first < 1024) return;
    this.stamps = this.stamps.slice(this.first);
    this.samples = this.samples.slice(this.first);
    this.decoded -= this.first;
    this.first = 0;
  }

  // Returns the last sample at or before a time, with its stamp.
  at(time: number): { message: unknown; stamp: number } | undefined {
    let low = this.first, high = this.stamps.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.stamps[middle] <= time) low = middle + 1;
      else high = middle;
    }
    const found = low - 1;
    if (found < this.first) return undefined;
    if (found !== this.decoded) {
      this.message = this.decoder.read(this.samples[found]);
      this.decoded = found;
    }
    return { message: this.message, stamp: this.stamps[found] };
  }
}

const kNothing = new DataView(new ArrayBuffer(0));

export class History {
  private readonly topics = new Map<TopicName, Map<string, Series>>();
  private readonly words = new Map<string, string[]>();
  private bytes = 0;

  // `maxAge` [ms], `maxBytes`: of all samples together.
  constructor(private readonly maxAge: number, private readonly maxBytes: number) {}

  // Stamps [ms, system clock] of one instance of a topic must not fall; an older sample is left out.
  add(topic: TopicName, key: string, stamp: number, sample: DataView, decoder: Decoder): void {
    let instances = this.topics.get(topic);
    if (!instances) {
      instances = new Map();
      this.topics.set(topic, instances);
      for (const [name, words] of decoder.enumerations()) this.words.set(name, words);
    }
    let series = instances.get(key);
    if (!series) {
      series = new Series(decoder);
      instances.set(key, series);
    }
    if (stamp < series.newest) return;
    series.add(stamp, sample);
    this.bytes += sample.byteLength;
    while (series.oldest < stamp - this.maxAge) this.forget(series);
    while (this.bytes > this.maxBytes) this.forget(this.largest());
  }

  // Returns the time of the oldest moment at which everything that is kept is known [ms].
  get begin(): number {
    return Math.min(...this.all().map(({ oldest }) => oldest));
  }
  get end(): number {
    return Math.max(...this.all().map(({ newest }) => newest));
  }
  get size(): number {
    return this.bytes;
  }

  // Returns what was known at a time [ms, system clock].
  at(time: number): Source {
    return new Instant(this.topics, this.words, time);
  }

  private all(): Series[] {
    return [...this.topics.values()].flatMap((instances) => [...instances.values()]);
  }
  private largest(): Series {
    return this.all().reduce((a, b) => (a.bytes >= b.bytes ? a : b));
  }
  private forget(series: Series): void {
    this.bytes -= series.bytes;
    series.drop();
    this.bytes += series.bytes;
  }
}

class Instant implements Source {
  constructor(private readonly topics: Map<TopicName, Map<string, Series>>, private readonly words: Map<string, string[]>, private readonly time: number) {}

  newest<T extends TopicName>(topic: T, key?: string): Topics[T] | undefined {
    return this.find(topic, key)?.message as Topics[T] | undefined;
  }
  age(topic: TopicName): number {
    const found = this.find(topic);
    return found ? (this.time - found.stamp) / 1000 : Infinity;
  }
  keys(topic: TopicName): string[] {
    return [...(this.topics.get(topic)?.keys() ?? [])];
  }
  health(): Health[] {
    return this.keys("handsel/component_health").flatMap((key) => {
      const found = this.find("handsel/component_health", key);
      return found ? [{ message: found.message as ComponentHealth, age: (this.time - found.stamp) / 1000 }] : [];
    });
  }
  word(enumeration: string, value: number): string {
    return (this.words.get(enumeration)?.[value] ?? `${enumeration} ${value}`).replaceAll("_", " ");
  }
  enumeration(name: string): string[] {
    return this.words.get(name) ?? [];
  }

  private find(topic: TopicName, key?: string): { message: unknown; stamp: number } | undefined {
    const instances = this.topics.get(topic);
    if (key !== undefined) return instances?.get(key)?.at(this.time);
    let best: { message: unknown; stamp: number } | undefined;
    for (const series of instances?.values() ?? []) {
      const found = series.at(this.time);
      if (found && (!best || found.stamp > best.stamp)) best = found;
    }
    return best;
  }
}
