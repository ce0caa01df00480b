// SPDX-License-Identifier: Apache-2.0
// What the bridge sends is what was written: a viewer's own libraries decode one random sample of every message type, compared field by
// field with what the writer printed. node decode_test.mjs SAMPLES BRIDGE [DOMAIN [SEED...]]
import { strict as assert } from "node:assert";
import { createRequire } from "node:module";
import { expectedLeaves, leavesOf, start, within } from "./leaves.mjs";

const require = createRequire(import.meta.url);
const { parseIDL } = require("@foxglove/omgidl-parser");
const { MessageReader } = require("@foxglove/omgidl-serialization");
const { FoxgloveClient } = require("@foxglove/ws-protocol");
const WebSocket = require("ws");

const [samplesBinary, bridgeBinary, domain = "36", ...seeds] = process.argv.slice(2);

async function check(seed) {
  const bridge = start(bridgeBinary, ["--domain", domain], "stderr", { HANDSEL_WEB_PORT: "0" });
  let samples;
  try {
    const port = await within("the bridge", new Promise((resolve, reject) => {
      bridge.lines.on("line", (line) => {
        const match = line.match(/http:\/\/127\.0\.0\.1:(\d+)/);
        if (match) resolve(match[1]);
      });
      bridge.ended.then((code) => reject(new Error(`the bridge ended with ${code}`)));
    }));
    const client = new FoxgloveClient({ ws: new WebSocket(`ws://127.0.0.1:${port}/`, [FoxgloveClient.SUPPORTED_SUBPROTOCOL]) });
    const offered = await within("advertise", new Promise((resolve, reject) => {
      client.on("advertise", resolve);
      client.on("error", reject);
    }));
    const channels = offered.filter((channel) => channel.topic.startsWith("handsel/"));

    samples = start(samplesBinary, [domain, String(seed)], "stdout");
    const written = new Map();
    for await (const line of samples.lines) {
      const sample = JSON.parse(line);
      written.set(sample.topic, sample);
      if (written.size === channels.length) break;
    }
    assert.equal(written.size, channels.length, "a sample for every channel");

    const readers = new Map();
    const waiting = new Set(written.keys());
    let fields = 0;
    const all = new Promise((resolve, reject) => {
      client.on("message", ({ subscriptionId, data }) => {
        const { channel, reader } = readers.get(subscriptionId);
        if (!waiting.has(channel.topic)) return;
        try {
          const decoded = leavesOf(reader.readMessage(data));
          const expected = expectedLeaves(written.get(channel.topic));
          if (decoded.stamp !== expected.stamp) return; // the bridge's own health
          assert.deepEqual(decoded, expected, channel.topic);
          fields += Object.keys(expected).length;
          waiting.delete(channel.topic);
          if (waiting.size === 0) resolve();
        } catch (error) {
          reject(error);
        }
      });
    });
    for (const channel of channels) {
      assert.equal(channel.encoding, "cdr");
      assert.equal(channel.schemaEncoding, "omgidl");
      const reader = new MessageReader(channel.schemaName, parseIDL(channel.schema));
      readers.set(client.subscribe(channel.id), { channel, reader });
    }
    await within("all samples", all).catch((error) => {
      throw waiting.size > 0 && !(error instanceof assert.AssertionError) ? new Error(`${error.message}; missing: ${[...waiting].join(", ")}`) : error;
    });
    console.log(`seed ${seed}: ${written.size} types, ${fields} fields equal`);
    client.close();
  } finally {
    samples?.child.stdin.end();
    bridge.child.kill("SIGTERM");
    await Promise.all([samples?.ended, bridge.ended]);
  }
}

for (const seed of seeds.length > 0 ? seeds : [Date.now() % 1_000_000]) await check(seed);
