// SPDX-License-Identifier: Apache-2.0
// The connection to the bridge: subscribes, keeps the newest sample of each instance of a topic,
// decodes only what is used, reconnects.
import { Channel, FoxgloveClient, MessageData, SubscriptionId } from "@foxglove/ws-protocol";
import { Decoder } from "./decoder";
import { keyOf, kLayerTopics, kTopics, TopicName, Topics } from "./messages";
import { Health, Source } from "./source";

const kRetryFirst = 500, kRetryLongest = 5000;  // [ms]

interface Sample { bytes: DataView | undefined; message: unknown; at: number }
interface Slot { channel: Channel; decoder: Decoder; newest: string; samples: Map<string, Sample> }

export class Link implements Source {
  connected = false;
  closedAt = 0;  // [ms] performance clock
  problem = "";  // one sentence
  samples = 0;
  // Receives each sample with the stamp of its writer [ns].
  onSample: (topic: TopicName, key: string, stamp: bigint, bytes: DataView, decoder: Decoder) => void = () => undefined;
  // Called when the connection opens and when it closes, however slowly the page draws.
  onConnection: () => void = () => undefined;
  private readonly slots = new Map<TopicName, Slot>();
  private readonly subscribed = new Map<SubscriptionId, TopicName>();
  private client: FoxgloveClient | undefined;
  private wanted = new Set<TopicName>(kTopics);
  private readonly counts = new Map<TopicName, number>();
  private readonly words = new Map<string, string[]>();
  private retry = kRetryFirst;

  constructor(private readonly address: string, private readonly onChange: () => void) {
    this.open();
  }

  newest<T extends TopicName>(topic: T, key?: string): Topics[T] | undefined {
    const slot = this.slots.get(topic), sample = slot?.samples.get(key ?? slot.newest);
    if (!slot || !sample) return undefined;
    if (sample.bytes) {
      sample.message = this.decode(topic, slot.decoder, sample.bytes) ?? sample.message;
      sample.bytes = undefined;
    }
    return sample.message as Topics[T] | undefined;
  }

  age(topic: TopicName): number {
    const slot = this.slots.get(topic), sample = slot?.samples.get(slot.newest);
    return sample ? (performance.now() - sample.at) / 1000 : Infinity;
  }

  // Returns the number of samples of a topic so far.
  received(topic: TopicName): number {
    return this.counts.get(topic) ?? 0;
  }

  keys(topic: TopicName): string[] {
    return [...(this.slots.get(topic)?.samples.keys() ?? [])];
  }

  health(): Health[] {
    const now = performance.now(), topic = "handsel/component_health" as const;
    return this.keys(topic).flatMap((key) => {
      const message = this.newest(topic, key), at = this.slots.get(topic)?.samples.get(key)?.at ?? 0;
      return message ? [{ message, age: (now - at) / 1000 }] : [];
    });
  }

  // Reads these large topics too, and no others of them.
  want(topics: Iterable<TopicName>): void {
    this.wanted = new Set([...kTopics, ...topics]);
    for (const [id, topic] of this.subscribed) {
      if (this.wanted.has(topic)) continue;
      this.client?.unsubscribe(id);
      this.subscribed.delete(id);
      this.slots.get(topic)?.samples.clear();
    }
    const read = new Set(this.subscribed.values());
    for (const [topic, { channel }] of this.slots)
      if (this.connected && this.wanted.has(topic) && !read.has(topic)) this.subscribe(channel, topic);
  }

  word(enumeration: string, value: number): string {
    return (this.words.get(enumeration)?.[value] ?? `${enumeration} ${value}`).replaceAll("_", " ");
  }
  enumeration(name: string): string[] {
    return this.words.get(name) ?? [];
  }

  private open(): void {
    const client = new FoxgloveClient({ ws: new WebSocket(this.address, [FoxgloveClient.SUPPORTED_SUBPROTOCOL]) });
    this.client = client;
    this.subscribed.clear();
    client.on("open", () => {
      this.connected = true;
      this.problem = "";
      this.retry = kRetryFirst;
      this.onConnection();
      this.onChange();
    });
    client.on("advertise", (channels: Channel[]) => {
      for (const channel of channels) {
        const topic = [...kTopics, ...kLayerTopics].find((name) => name === channel.topic);
        if (!topic) continue;
        try {
          const decoder = new Decoder(channel.schemaName, channel.schema);
          for (const [name, words] of decoder.enumerations()) this.words.set(name, words);
          this.slots.set(topic, { channel, decoder, newest: "", samples: this.slots.get(topic)?.samples ?? new Map() });
          if (this.wanted.has(topic)) this.subscribe(channel, topic);
        } catch (error) {
          this.problem = `The schema of ${topic} cannot be read: ${(error as Error).message}.`;
        }
      }
    });
    client.on("message", (event: MessageData) => {
      const topic = this.subscribed.get(event.subscriptionId), slot = topic && this.slots.get(topic);
      if (!topic || !slot) return;
      const bytes = new DataView(event.data.buffer, event.data.byteOffset, event.data.byteLength);
      const key = keyOf(topic, bytes);
      slot.newest = key;
      const sample = slot.samples.get(key);
      slot.samples.set(key, { bytes, message: sample?.message, at: performance.now() });
      this.samples += 1;
      this.counts.set(topic, this.received(topic) + 1);
      this.onSample(topic, key, event.timestamp, bytes, slot.decoder);
      this.onChange();
    });
    client.on("error", () => undefined);  // a close follows
    client.on("close", () => {
      if (this.connected) this.closedAt = performance.now();
      this.connected = false;
      this.onConnection();
      setTimeout(() => this.open(), this.retry);
      this.retry = Math.min(2 * this.retry, kRetryLongest);
      this.onChange();
    });
  }

  private subscribe(channel: Channel, topic: TopicName): void {
    if (this.client) this.subscribed.set(this.client.subscribe(channel.id), topic);
  }

  private decode(topic: string, decoder: Decoder, bytes: ArrayBufferView): unknown {
    try {
      return decoder.read(bytes);
    } catch (error) {
      this.problem = `A sample of ${topic} cannot be read: ${(error as Error).message}.`;
      return undefined;
    }
  }
}
