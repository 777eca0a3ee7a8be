// Writes the licences of all packages of the bundle into one file beside it; equal texts stand once.

import { existsSync, readFileSync, writeFileSync } from "node:fs";

const lock = JSON.parse(readFileSync("package-lock.json", "utf8"));
const packages = Object.entries(lock.packages).filter(([path]) => path && !path.includes("esbuild"));
const byText = new Map();
for (const [path, { version, license }] of packages) {
  if (!existsSync(`${path}/LICENSE`)) throw new Error(`${path} has no LICENSE`);
  const text = readFileSync(`${path}/LICENSE`, "utf8").trim();
  const name = `${path.replace(/^.*node_modules\//, "")} ${version} (${license})`;
  byText.set(text, [...(byText.get(text) ?? []), name]);
}
const parts = [...byText].map(([text, names]) => `${names.join("\n")}\n\n${text}\n`);
writeFileSync("../static/vendor/LICENSE-codemirror.txt", parts.join(`\n${"-".repeat(79)}\n\n`));
