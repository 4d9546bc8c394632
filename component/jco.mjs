// Components by the tools of jco: node jco.mjs wrap MODULE COMPONENT, or node jco.mjs transpile COMPONENT FOLDER.
import { generate, $init } from "@bytecodealliance/jco-transpile/component";
import { componentEmbed, componentNew } from "@bytecodealliance/jco-transpile/wasm-tools";
import { mkdirSync, readdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";

const [task, from, to] = process.argv.slice(2);

/** The WIT of the standard as one text of one package. */
function wit() {
  const folder = join(import.meta.dirname, "wit");
  const files = readdirSync(folder).filter((name) => name.endsWith(".wit"));
  const texts = files.sort().map((name) => readFileSync(join(folder, name), "utf8"));
  const [head] = texts[0].match(/^package .*;$/m);
  return [head, ...texts.map((text) => text.replace(head, ""))].join("\n");
}

if (task === "wrap") {
  const typed = await componentEmbed({ binary: readFileSync(from), witSource: wit(), world: "co-simulation-fmu" });
  writeFileSync(to, await componentNew(typed, []));
} else {
  await $init;
  const { files } = generate(readFileSync(from), {
    name: "fmu",
    instantiation: { tag: "async" },
    noTypescript: true,
    noNodejsCompat: true,
    base64Cutoff: 0,
  });
  mkdirSync(to, { recursive: true });
  for (const [name, content] of files) writeFileSync(join(to, name), content);
}
