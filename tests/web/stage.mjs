// SPDX-License-Identifier: Apache-2.0
// What the page's tests share: a running system, a headless browser, DDS samples, pictures.
import { spawn } from "node:child_process";
import { createRequire } from "node:module";
import { createServer } from "node:net";
import { dirname, join } from "node:path";
import { createInterface } from "node:readline";
import { fileURLToPath } from "node:url";

export const root = join(dirname(fileURLToPath(import.meta.url)), "../..");
const { chromium } = createRequire(join(root, "components/bridge/web/package.json"))("playwright-core");
const bin = process.env.HANDSEL_BIN ?? join(root, "build/release/bin");
const flags = ["--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"];
export const kSoftwareGl = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
export const kNoGl = ["--disable-gpu", "--disable-webgl", "--disable-webgl2", "--disable-3d-apis"];

for (const signal of ["SIGTERM", "SIGINT"]) process.on(signal, () => process.exit(1));  // nothing started here stays behind

// A program whose lines are looked at as they come.
export class Program {
  constructor(name, args) {
    this.lines = [];
    this.waiting = [];
    this.child = spawn(join(bin, name), args, { stdio: ["ignore", "pipe", "pipe"] });
    this.ended = new Promise((resolve) => this.child.on("exit", resolve));
    process.on("exit", () => this.child.kill("SIGINT"));
    for (const stream of [this.child.stdout, this.child.stderr]) createInterface({ input: stream }).on("line", (line) => this.take(line));
    void this.ended.then((code) => {
      for (const { reject, pattern } of this.waiting) reject(new Error(`${name} ended (${code}) before ${pattern}:\n${this.lines.slice(-5).join("\n")}`));
    });
  }
  take(line) {
    this.lines.push(line);
    this.onLine?.(line);
    this.waiting = this.waiting.filter(({ pattern, resolve }) => {
      const match = line.match(pattern);
      if (match) resolve(match);
      return !match;
    });
  }
  line(pattern) {
    for (const line of this.lines) if (pattern.test(line)) return Promise.resolve(line.match(pattern));
    return new Promise((resolve, reject) => this.waiting.push({ pattern, resolve, reject }));
  }
  async end() {
    this.child.kill("SIGINT");
    await this.ended;
  }
}

async function freePort() {
  const server = createServer();
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  const { port } = server.address();
  await new Promise((resolve) => server.close(resolve));
  return String(port);
}

// `handsel <command> …` with its page, once it is ready; `address` is where the page is, `token` who may command.
export async function startSystem(command, domain, ...options) {
  const system = new Program("handsel", [command, "--scenario", "give_mug", "--headless", "--domain", domain, "--port", await freePort(), ...options]);
  const [, address, token] = await system.line(/watch it at (http:[^#\s]+)#token=(\S+)/);
  return { system, address, token };
}

// Waits for a condition in the page.
export const until = (page, condition, argument, timeout = 60_000) => page.waitForFunction(condition, argument, { polling: 50, timeout });

// Waits until the browser has compiled what it draws with: from then on it draws several pictures a second.
export const settled = (page) => until(page, async () => {
  const begin = performance.now();
  for (let i = 0; i < 5; ++i) await new Promise(requestAnimationFrame);
  return performance.now() - begin < 1000;
});

export function launchBrowser(gl = kSoftwareGl) {
  return chromium.launch({ executablePath: join(root, "tests/web/niced_chromium.sh"), args: [...flags, ...gl] });
}

const decoders = new Map();  // by browser: an empty page that decodes pictures

async function decoder(page) {
  const browser = page.context().browser();
  if (!decoders.has(browser)) decoders.set(browser, await browser.newPage());
  return decoders.get(browser);
}

// The part of the page in `region` as PNG, base64.
export async function picture(page, region) {
  const clip = { x: Math.floor(region.x), y: Math.floor(region.y), width: Math.ceil(region.width), height: Math.ceil(region.height) };
  return (await page.screenshot({ clip })).toString("base64");
}

// Share of the pixels of two pictures of one region that clearly differ.
export async function difference(page, first, second) {
  return (await decoder(page)).evaluate(async (pictures) => {
    const [a, b] = await Promise.all(pictures.map(async (data) => {
      const image = new Image();
      image.src = `data:image/png;base64,${data}`;
      await image.decode();
      const canvas = document.createElement("canvas");
      [canvas.width, canvas.height] = [image.width, image.height];
      const context = canvas.getContext("2d");
      context.drawImage(image, 0, 0);
      return context.getImageData(0, 0, image.width, image.height).data;
    }));
    let differing = 0;
    for (let i = 0; i < a.length; i += 4) if (Math.abs(a[i] - b[i]) + Math.abs(a[i + 1] - b[i + 1]) + Math.abs(a[i + 2] - b[i + 2]) > 24) ++differing;
    return differing / (a.length / 4);
  }, [first, second]);
}
