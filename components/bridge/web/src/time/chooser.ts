// SPDX-License-Identifier: Apache-2.0
// Opens a recording that the viewer chooses or drops on the page.
import { Config } from "../config";
import { byId, put } from "../elements";
import { Past } from "./past";
import { readRecording } from "./recording";

export class Chooser {
  private reading = false;

  constructor(private readonly config: Config, private readonly past: Past) {
    const input = byId<HTMLInputElement>("recording-file");
    input.addEventListener("change", () => {
      const [file] = input.files ?? [];
      if (file) void this.open(file);
      input.value = "";
    });
    byId("open-recording").addEventListener("click", () => input.click());
    addEventListener("dragover", (event) => event.preventDefault());
    addEventListener("drop", (event) => {
      event.preventDefault();
      const [file] = event.dataTransfer?.files ?? [];
      if (file) void this.open(file);
    });
  }

  private async open(file: File): Promise<void> {
    if (this.reading) return;
    this.reading = true;
    try {
      const { tape, note } = await readRecording(file, file.name, this.config, (ratio) => put("recording-note", `Reading ${file.name}: ${(100 * ratio).toFixed(0)} %`));
      this.past.open(tape);
      put("recording-note", note || `${file.name} is shown; Live returns to the running system.`);
    } catch (error) {
      put("recording-note", (error as Error).message);
    }
    this.reading = false;
  }
}
