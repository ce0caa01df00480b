// SPDX-License-Identifier: Apache-2.0
// Decodes CDR bytes to objects by the IDL text of their channel: the same for live and recorded
// samples.
import { IDLMessageDefinition, parseIDL } from "@foxglove/omgidl-parser";
import { MessageReader } from "@foxglove/omgidl-serialization";

export class Decoder {
  private readonly reader: MessageReader;
  private readonly definitions: IDLMessageDefinition[];

  // Throws an Error when the text is no IDL or does not define `type` ("handsel::RobotState").
  constructor(type: string, idl: string) {
    this.definitions = parseIDL(idl);
    this.reader = new MessageReader(type, this.definitions);
  }

  read(bytes: ArrayBufferView): unknown {
    return this.reader.readMessage(bytes);
  }

  // Enumerations of the schema: "Mode" -> ["normal", "slow", ...].
  enumerations(): Map<string, string[]> {
    const result = new Map<string, string[]>();
    for (const definition of this.definitions) {
      if (definition.aggregatedKind !== "module" || !definition.definitions.every((entry) => typeof entry.value === "number")) continue;
      const type = (definition.name ?? "").split("::").pop() ?? "";
      const prefix = type.replace(/([a-z])([A-Z])/g, "$1_$2").toUpperCase() + "_";
      const shared = commonPrefix(definition.definitions.map((entry) => entry.name));
      const cut = definition.definitions.every((entry) => entry.name.startsWith(prefix)) ? prefix.length : shared;
      const words: string[] = [];
      for (const entry of definition.definitions) words[entry.value as number] = entry.name.slice(cut).toLowerCase();
      result.set(type, words);
    }
    return result;
  }
}

function commonPrefix(names: string[]): number {
  const first = names[0] ?? "";
  let shared = 0;
  for (let i = 0; i < first.length && names.every((name) => name[i] === first[i]); ++i) if (first[i] === "_") shared = i + 1;
  return shared;
}
