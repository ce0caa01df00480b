// SPDX-License-Identifier: Apache-2.0
// Sends commands to the bridge, with the token at the end of the page's address. Without a token the
// page only shows.
const kToken = /^[\w-]{16,128}$/;
const kKept = "handsel-token";  // of this tab, over reloads
const kReadOnly = "Read-only. To take part, open the address that handsel has printed at its start, with #token= at its end.";

export type Command =
  | { task: string; object?: string; human?: string; surface?: string; onto?: string; value?: number }
  | { person: string; action: string; side?: string; point?: [number, number, number]; time?: number; speed?: number };

// "the token is wrong" -> "The token is wrong."
const sentence = (text: string): string => `${text.charAt(0).toUpperCase()}${text.slice(1).replace(/\.?\s*$/, "")}.`;

export class Steering {
  note = "";  // why the page may not command; empty: it may
  private token = "";

  constructor() {
    this.takeToken();
    addEventListener("hashchange", () => this.takeToken());
  }

  get allowed(): boolean {
    return this.token !== "";
  }

  // Returns why the command was refused, one sentence; empty: it was accepted.
  async send(command: Command): Promise<string> {
    if (!this.allowed) return this.note;
    try {
      const answer = await fetch("command", {
        method: "POST", cache: "no-store", body: JSON.stringify(command),
        headers: { Authorization: `Bearer ${this.token}`, "Content-Type": "application/json" },
      });
      if (answer.ok) return "";
      const why = sentence(await answer.text());
      if (answer.status === 401 || answer.status === 404) this.lose(why);
      return why;
    } catch (error) {
      return `The bridge does not answer (${(error as Error).message}).`;
    }
  }

  // Takes the token from the address, where others could read it over the shoulder.
  private takeToken(): void {
    const given = new URLSearchParams(location.hash.slice(1)).get("token") ?? "";
    if (given) history.replaceState(null, "", location.pathname + location.search);
    const token = given || (sessionStorage.getItem(kKept) ?? "");
    if (!kToken.test(token)) return this.lose(given ? "Read-only: the token in the address is incomplete." : kReadOnly);
    sessionStorage.setItem(kKept, token);
    this.token = token;
    this.note = "";
  }

  private lose(why: string): void {
    sessionStorage.removeItem(kKept);
    this.token = "";
    this.note = why.startsWith("Read-only") ? why : `Read-only: ${why.charAt(0).toLowerCase()}${why.slice(1)}`;
  }
}
