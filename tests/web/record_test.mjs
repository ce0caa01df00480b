// SPDX-License-Identifier: Apache-2.0
// What `handsel record` writes is what was said: the MCAP project's own reader and a viewer's decoder find one random sample of every message
// type in it, compared field by field with what the writer printed; and nearly all of it when the recorder was killed.
// node record_test.mjs SAMPLES HANDSEL [DOMAIN [SEED]]
import { strict as assert } from "node:assert";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createRequire } from "node:module";
import { expectedLeaves, leavesOf, start, within } from "./leaves.mjs";

const require = createRequire(import.meta.url);
const { McapIndexedReader, McapStreamReader } = require("@mcap/core");
const { parseIDL } = require("@foxglove/omgidl-parser");
const { MessageReader } = require("@foxglove/omgidl-serialization");

const [samplesBinary, handselBinary, domain = "37", seed = String(Date.now() % 1_000_000)] = process.argv.slice(2);
const folder = mkdtempSync(join(tmpdir(), "handsel-test-"));
console.log(`seed ${seed}`);

// Records `seconds` of samples, then ends the recorder with `signal`. The samples as their writer printed them, and the file.
async function record(name, seconds, signal) {
  const file = join(folder, name);
  const recorder = start(handselBinary, ["record", file, "--domain", domain], "stderr");
  await within("the recorder", new Promise((resolve) => recorder.lines.on("line", (line) => line.includes("recording") && resolve())));
  const samples = start(samplesBinary, [domain, seed], "stdout");
  const written = new Map();
  samples.lines.on("line", (line) => written.set(JSON.parse(line).topic, JSON.parse(line)));
  await new Promise((resolve) => setTimeout(resolve, 1000 * seconds));
  recorder.child.kill(signal);
  const code = await within("the recorder's end", recorder.ended);
  samples.child.stdin.end();
  await samples.ended;
  return { written, bytes: readFileSync(file), code };
}

try {
  const { written, bytes, code } = await record("ended.mcap", 3, "SIGINT");
  assert.equal(code, 0);
  const reader = await McapIndexedReader.Initialize({
    readable: { size: async () => BigInt(bytes.length), read: async (at, length) => new Uint8Array(bytes.subarray(Number(at), Number(at + length))) },
  });
  assert.equal(reader.channelsById.size, written.size);
  const decoders = new Map();
  for (const channel of reader.channelsById.values()) {
    const schema = reader.schemasById.get(channel.schemaId);
    assert.equal(channel.messageEncoding, "cdr");
    assert.equal(schema.encoding, "omgidl");
    decoders.set(channel.id, new MessageReader(schema.name, parseIDL(new TextDecoder().decode(schema.data))));
  }
  const waiting = new Set(written.keys());
  let fields = 0, messages = 0, last = 0n;
  for await (const message of reader.readMessages({ validateCrcs: true })) {
    ++messages;
    assert(message.logTime >= last, "in the order of their times");
    last = message.logTime;
    const { topic } = reader.channelsById.get(message.channelId);
    if (!waiting.delete(topic)) continue;
    const decoded = leavesOf(decoders.get(message.channelId).readMessage(message.data));
    const expected = expectedLeaves(written.get(topic));
    assert.deepEqual(decoded, expected, topic);
    fields += Object.keys(expected).length;
  }
  assert.deepEqual([...waiting], [], "a sample of every type");
  assert.equal(BigInt(messages), reader.statistics.messageCount);
  console.log(`${messages} messages of ${written.size} types, ${fields} fields equal`);

  const killed = await record("killed.mcap", 4, "SIGKILL");
  const stream = new McapStreamReader();
  stream.append(killed.bytes);
  let first, latest, count = 0;
  for (let one; (one = stream.nextRecord());) {
    if (one.type !== "Message") continue;
    first ??= one.logTime;
    latest = one.logTime;
    ++count;
  }
  const length = Number(latest - first) / 1e9;
  assert(length > 2, `${count} messages, ${length} s of 4 are there after a kill`);
  console.log(`killed: ${count} messages, ${length.toFixed(1)} s`);
} finally {
  rmSync(folder, { recursive: true });
}
