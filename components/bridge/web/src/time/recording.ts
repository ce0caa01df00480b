// SPDX-License-Identifier: Apache-2.0
// Reads a recording of `handsel record` (MCAP, not compressed) up to its last complete record.
import { McapStreamReader } from "@mcap/core";
import { Config } from "../config";
import { Decoder } from "../decoder";
import { keyOf, kLayerTopics, kTopics, TopicName } from "../messages";
import { Tape } from "./tape";

const kSlice = 4_000_000;         // read at once [bytes]
const kMaxBytes = 400_000_000;    // of the samples kept

export interface Opened { tape: Tape; note: string }  // note: one sentence about what is missing; empty: nothing

// `onProgress` receives the ratio that has been read. Throws an Error with a sentence when the file
// is no recording of this robot.
export async function readRecording(file: Blob, name: string, config: Config, onProgress: (ratio: number) => void): Promise<Opened> {
  const reader = new Reading(name, config), stream = new McapStreamReader();
  let broken = "";
  for (let at = 0; at < file.size && !broken; at += kSlice) {
    const bytes = new Uint8Array(await file.slice(at, at + kSlice).arrayBuffer());
    try {
      stream.append(bytes);
      for (let record; (record = stream.nextRecord()); ) reader.take(record);
    } catch (error) {
      if (error instanceof Refused) throw error;
      broken = (error as Error).message;
    }
    onProgress(Math.min(1, (at + kSlice) / file.size));
  }
  if (reader.messages === 0) throw new Refused(`${name} holds no samples of a robot${broken ? ` (${broken})` : ""}; open a file that handsel record has written.`);
  const whole = stream.done() && !broken;
  return { tape: reader.tape, note: whole ? "" : `${name} does not end as a complete recording; it is shown up to its last complete record.` };
}

export class Refused extends Error {}

type Record = NonNullable<ReturnType<McapStreamReader["nextRecord"]>>;

// Takes the records of one file in their order.
class Reading {
  readonly tape: Tape;
  messages = 0;
  private readonly schemas = new Map<number, { name: string; text: string }>();
  private readonly channels = new Map<number, { topic: TopicName; decoder: Decoder }>();

  constructor(private readonly name: string, private readonly config: Config) {
    this.tape = new Tape(config, Infinity, kMaxBytes);
  }

  take(record: Record): void {
    if (record.type === "Metadata") this.checkRobot(record.metadata.get("robot"));
    if (record.type === "Schema") this.schemas.set(record.id, { name: record.name, text: new TextDecoder().decode(record.data) });
    if (record.type === "Channel") {
      const topic = [...kTopics, ...kLayerTopics].find((one) => one === record.topic), schema = this.schemas.get(record.schemaId);
      if (topic && schema && !this.channels.has(record.id)) this.channels.set(record.id, { topic, decoder: new Decoder(schema.name, schema.text) });
    }
    if (record.type !== "Message") return;
    const channel = this.channels.get(record.channelId);
    if (!channel) return;
    const bytes = new DataView(record.data.slice().buffer);
    this.tape.take(channel.topic, keyOf(channel.topic, bytes), record.logTime, bytes, channel.decoder);
    this.messages += 1;
  }

  private checkRobot(robot: string | undefined): void {
    if (robot && robot !== this.config.robot)
      throw new Refused(`${this.name} was recorded with the robot ${robot}; this page draws ${this.config.robot}. Open it on the page of a system with ${robot}.`);
  }
}
