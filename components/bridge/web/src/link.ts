// SPDX-License-Identifier: Apache-2.0
// The connection to the bridge: subscribes, keeps the newest sample of each topic, decodes only
// used topics, reconnects.
import { Channel, FoxgloveClient, MessageData, SubscriptionId } from "@foxglove/ws-protocol";
import { Decoder } from "./decoder";
import { ComponentHealth, kTopics, TopicName, Topics } from "./messages";

const kRetryFirst = 500, kRetryLongest = 5000;  // [ms]

interface Slot { decoder: Decoder; bytes: ArrayBufferView | undefined; message: unknown; at: number; count: number }

export class Link {
  connected = false;
  closedAt = 0;  // [ms] performance clock
  problem = "";  // one sentence
  samples = 0;
  readonly health = new Map<string, { message: ComponentHealth; at: number }>();
  private readonly slots = new Map<string, Slot>();
  private readonly words = new Map<string, string[]>();
  private retry = kRetryFirst;

  constructor(private readonly address: string, private readonly onChange: () => void) {
    this.open();
  }

  // Returns the newest sample; undefined before the first one.
  newest<T extends TopicName>(topic: T): Topics[T] | undefined {
    const slot = this.slots.get(topic);
    if (!slot) return undefined;
    if (slot.bytes) {
      const bytes = slot.bytes;
      slot.bytes = undefined;
      slot.message = this.decode(topic, slot.decoder, bytes) ?? slot.message;
    }
    return slot.message as Topics[T] | undefined;
  }

  // Returns the time since the newest sample arrived [s]; infinite before the first one.
  age(topic: TopicName): number {
    const slot = this.slots.get(topic);
    return slot && slot.count > 0 ? (performance.now() - slot.at) / 1000 : Infinity;
  }

  word(enumeration: string, value: number): string {
    return (this.words.get(enumeration)?.[value] ?? `${enumeration} ${value}`).replaceAll("_", " ");
  }
  enumeration(name: string): string[] {
    return this.words.get(name) ?? [];
  }

  private open(): void {
    const client = new FoxgloveClient({ ws: new WebSocket(this.address, [FoxgloveClient.SUPPORTED_SUBPROTOCOL]) });
    const topicOf = new Map<SubscriptionId, TopicName>();
    client.on("open", () => {
      this.connected = true;
      this.problem = "";
      this.retry = kRetryFirst;
      this.onChange();
    });
    client.on("advertise", (channels: Channel[]) => {
      for (const channel of channels) {
        const topic = kTopics.find((name) => name === channel.topic);
        if (!topic) continue;
        try {
          const decoder = new Decoder(channel.schemaName, channel.schema);
          for (const [name, words] of decoder.enumerations()) this.words.set(name, words);
          this.slots.set(topic, { decoder, bytes: undefined, message: this.slots.get(topic)?.message, at: 0, count: 0 });
          topicOf.set(client.subscribe(channel.id), topic);
        } catch (error) {
          this.problem = `The schema of ${topic} cannot be read: ${(error as Error).message}.`;
        }
      }
    });
    client.on("message", (event: MessageData) => {
      const topic = topicOf.get(event.subscriptionId), slot = topic && this.slots.get(topic);
      if (!topic || !slot) return;
      slot.at = performance.now();
      slot.count += 1;
      this.samples += 1;
      slot.bytes = event.data;
      if (topic === "handsel/component_health") {
        const health = this.newest(topic);
        if (health) this.health.set(health.component, { message: health, at: slot.at });
      }
      this.onChange();
    });
    client.on("error", () => undefined);  // a close follows
    client.on("close", () => {
      if (this.connected) this.closedAt = performance.now();
      this.connected = false;
      setTimeout(() => this.open(), this.retry);
      this.retry = Math.min(2 * this.retry, kRetryLongest);
      this.onChange();
    });
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
