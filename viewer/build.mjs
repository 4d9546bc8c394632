// Makes one HTML file of the page: script, style and licences in it; the package fills in the data (<!-- DATA -->).
// node build.mjs FILE.html

import { readFile, writeFile } from "node:fs/promises";
import { build } from "esbuild";

const target = process.argv[2];
if (!target) throw new Error("build.mjs must be told the file to write: node build.mjs FILE.html");

async function bundled(entry) {
  const { outputFiles } = await build({
    entryPoints: [entry],
    bundle: true,
    minify: true,
    format: "esm",
    target: "es2022",
    legalComments: "none",
    write: false,
  });
  return outputFiles[0].text;
}

async function licences() {
  const names = Object.keys(JSON.parse(await readFile("package.json", "utf8")).dependencies);
  const texts = await Promise.all(names.map((name) => readFile(`node_modules/${name}/LICENSE`, "utf8")));
  return `<!--\n${names.map((name, n) => `${name}\n\n${texts[n].trim()}`).join("\n\n")}\n-->\n`;
}

// in a script "</script" and "<!--" would end or change it
const script = (await bundled("src/main.ts")).replaceAll("</script", "<\\/script").replaceAll("<!--", "<\\!--");
const style = await bundled("src/style.css");
const page = (await readFile("src/index.html", "utf8"))
  .replace("/* STYLE */", () => style)
  .replace("/* SCRIPT */", () => script);
await writeFile(target, page + (await licences()));
