// From a drawing to the sheet of the first choice:  node design.mjs bracket.dxf [http://127.0.0.1:8000]

import { readFile, writeFile } from "node:fs/promises";
import { basename } from "node:path";
import { Workhold, words } from "./workhold.mjs";

const TOOLKIT = { kind: "vise", pitch: [10, 10], columns: 2, peg_radius: 3 }; // mm
const [drawing, server] = process.argv.slice(2);
const workhold = new Workhold(server, process.env.WORKHOLD_TOKEN);

let told = "";

/** Print a state, unless its words are those of the one before. */
function tell(state) {
  const now = `${state.state}: ${state.found} fixtures`;
  if (now !== told) console.error(now);
  told = now;
}

try {
  const part = await workhold.read(await readFile(drawing), basename(drawing));
  const { job, rows } = await workhold.design(part, TOOLKIT, tell);
  for (const row of rows) console.log(words(row));
  if (rows.length) {
    const sheet = await workhold.sheet(job, 1);
    await writeFile(drawing.replace(/\.\w+$/, ".pdf"), Buffer.from(await sheet.arrayBuffer()));
  }
  await workhold.forget(job);
} catch (error) {
  // Of the network it is a TypeError, with the cause behind it.
  console.error(error instanceof TypeError ? `The server does not answer: ${error.message}` : error.message);
  process.exitCode = 1;
}
