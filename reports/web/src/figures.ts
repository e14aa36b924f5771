// Draws every figure that has something to show as SVG and PDF, without a browser: node figures.js PAGE.json FOLDER
// Entry point of `moma report --figures`. The figures are those of the page, as its buttons save them.

import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

import { svgOf } from './paper';
import { pdfOf } from './pdf';
import { Model, type PageData } from './data';
import { kFigures } from './figures/all';
import { showSlice, startView } from './view';

function fileName(text: string): string {
  return text.replace(/[^\w.-]+/g, '-').replace(/^[-.]+|-+$/g, '').slice(0, 80);
}

async function main(file: string, folder: string): Promise<void> {
  const model = new Model(JSON.parse(readFileSync(file, 'utf8')) as PageData);
  startView(model);
  const tuned = new Set([...kFigures.tuning(model), ...kFigures.risk(model)].map((spec) => spec.id));
  for (const [place, slice] of model.slices.entries()) {
    showSlice(slice.id);
    const prefix = model.slices.length > 1 ? `${place + 1}-${fileName(slice.id)}-` : '';
    for (const spec of Object.values(kFigures).flatMap((specs) => specs(model))) {
      if (tuned.has(spec.id) && place > 0) continue;   // of the store, not of a suite
      const svg = svgOf(spec);
      if (svg === null) continue;
      const name = join(folder, `${tuned.has(spec.id) ? '' : prefix}${spec.id}`);
      writeFileSync(`${name}.svg`, svg);
      writeFileSync(`${name}.pdf`, await pdfOf(svg));
    }
  }
}

const [, , file, folder] = process.argv;
if (file === undefined || folder === undefined) throw new Error('usage: node figures.js PAGE.json FOLDER');
await main(file, folder);
