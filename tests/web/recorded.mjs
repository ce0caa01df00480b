// SPDX-License-Identifier: Apache-2.0
// The samples of a recording, read with the MCAP project's own reader.
import { createRequire } from "node:module";
import { join } from "node:path";
import { leavesOf } from "./leaves.mjs";
import { root } from "./stage.mjs";

const require = createRequire(join(root, "components/bridge/web/package.json"));
const { McapStreamReader } = require("@mcap/core");
const { parseIDL } = require("@foxglove/omgidl-parser");
const { MessageReader } = require("@foxglove/omgidl-serialization");

// Returns the leaves of a sample without the sign of zero, which JSON does not keep.
export function plainLeaves(sample) {
  return Object.fromEntries(Object.entries(leavesOf(sample)).map(([path, value]) => [path, Object.is(value, -0) ? 0 : value]));
}

// Returns, for each topic, functions that decode its samples, by their stamps as text.
export function recordedSamples(bytes, topics) {
  const stream = new McapStreamReader(), schemas = new Map(), channels = new Map(), found = new Map(topics.map((topic) => [topic, new Map()]));
  stream.append(bytes);
  for (let one; (one = stream.nextRecord());) {
    if (one.type === "Schema") schemas.set(one.id, one);
    if (one.type === "Channel" && found.has(one.topic)) {
      const schema = schemas.get(one.schemaId);
      channels.set(one.id, { topic: one.topic, decoder: new MessageReader(schema.name, parseIDL(new TextDecoder().decode(schema.data))) });
    }
    const channel = one.type === "Message" ? channels.get(one.channelId) : undefined;
    if (channel) found.get(channel.topic).set(String(one.logTime), () => channel.decoder.readMessage(one.data));
  }
  return found;
}
