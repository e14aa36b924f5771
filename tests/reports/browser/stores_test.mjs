// The pages of six kinds of stores, as a reader meets them: stores_test.mjs SOURCE_DIR MAKE_REPORT WORK_DIR [MOMA]
// In three widths, light and dark, and on paper. With the program MOMA, what the tables say is compared with `moma query STORE @summary`.
// Exit 0: passed; 1: failed; 77: left out, since node's packages, python3, chromium, librsvg2-bin or poppler-utils are missing.
import { execFileSync } from 'node:child_process';
import { statSync } from 'node:fs';
import { join } from 'node:path';

import { check, end, figuresFollow, launch, legible, needs, noOverflow, noteLetters, opener, workshop } from './kit.mjs';
import { figuresAreSaved, pairedIsSquare, textsOf } from './paper_kit.mjs';

const [, , source, makeReport, work, moma] = process.argv;
needs('python3', 'pdftotext', 'pdftoppm', 'rsvg-convert');
const { makeErrors, makeStore, makePage } = workshop(source, makeReport, work);
const browser = await launch(source);
const open = opener(browser);

// A page holds its script, style and fonts, and some 800 bytes a trial. Its elements follow from controllers and families, never
// from the number of trials.
const kinds = {
  demo: { store: () => makeStore('demo', 'demo', 60, 4), most: { megabytes: 3, nodes: 2000 } },
  sweep: { store: () => makeStore('sweep', 'sweep', 40, 2, 0, '--search'), most: { megabytes: 3, nodes: 3500 } },
  twelve: { store: () => makeStore('twelve', 'many', 30, 1, 0, '--controllers', '12'), most: { megabytes: 3, nodes: 3000 } },
  one: { store: () => makeStore('one', 'one', 1), most: { megabytes: 3, nodes: 1400 } },
  errors: { store: () => makeErrors('errors', 24), most: { megabytes: 3, nodes: 2000 } },
  large: { store: () => makeStore('large', 'demo', 1200, 2), most: { megabytes: 4, nodes: 2000 } },
};

/** A number as the page writes it, with so many decimals. */
const fixed = (value, decimals) => Number(value).toFixed(decimals);
const spaceless = (text) => text.replace(/\s/g, '');

/** Each row of the program's summary, its numbers found in the page's table of results. */
const equalsProgram = async (page, db, what) => {
  const summary = JSON.parse(execFileSync(moma, ['query', db, '@summary', '-f', 'json'], { encoding: 'utf8' })).filter((row) => row.n > 0);
  const shown = await page.locator('.summary tbody').evaluateAll((groups) => groups.flatMap((group) => [...group.querySelectorAll('tr')].slice(1).map((row) => [group.querySelector('.group').textContent, ...[...row.children].map((cell) => cell.innerText)])));
  check(summary.length > 0 && shown.length >= summary.length, `${what}: ${shown.length} rows of ${summary.length} in the table of results`);
  for (const row of summary) {
    const cells = shown.find(([family, name]) => family === row.family && spaceless(name) === spaceless(`${row.controller}${row.point}`))?.map(spaceless);
    const wanted = [String(row.n), ...['success', 'collision'].map((of) => [row[`${of}_rate`], row[`${of}_low`], row[`${of}_high`]].map((share) => fixed(100 * share, 1)))];
    const ends = cells?.slice(3, 5).map((cell) => (cell.match(/[\d.]+/g) ?? []).slice(0, 3).map((share) => fixed(share, 1)));
    check(cells !== undefined && parseInt(cells[2], 10) === row.n && ends.join() === wanted.slice(1).join(), `${what}: ${row.controller} ${row.point} in ${row.family} is ${wanted} by the program, ${cells} on the page`);
  }
};

/** Texts of the head of the page that lie over one another. */
const overlaps = (page) => page.evaluate(() => {
  const texts = [];
  const walk = document.createTreeWalker(document.querySelector('.masthead'), NodeFilter.SHOW_TEXT);
  while (walk.nextNode()) {
    const range = document.createRange();
    range.selectNodeContents(walk.currentNode);
    for (const box of range.getClientRects()) if (box.width > 0 && walk.currentNode.textContent.trim() !== '') texts.push([walk.currentNode.textContent, box]);
  }
  return texts.flatMap(([a, r], i) => texts.slice(i + 1).filter(([, s]) => Math.min(r.right, s.right) - Math.max(r.left, s.left) > 1 && Math.min(r.bottom, s.bottom) - Math.max(r.top, s.top) > 0.4 * Math.min(r.height, s.height)).map(([b]) => `"${a}" over "${b}"`));
});

/** What each figure shows: its letters, or the sentence that says why it is empty. */
const figuresOf = (page) => page.locator('.figure').evaluateAll((all) => all.map((figure) => {
  const layers = [...figure.querySelectorAll('canvas')];
  return { id: figure.id.replace('figure-', ''), empty: figure.querySelector('.empty')?.textContent, width: layers[0]?.width, height: layers[0]?.height, letters: layers.flatMap((layer) => layer.letters ?? []) };
}));

/** Where each width and each scheme is seen once: words lie where they lie, whatever their colours. */
const views = [[1280, 'light'], [390, 'dark'], [1920, 'dark']];

for (const [kind, { store, most }] of Object.entries(kinds)) {
  const db = store();
  const html = makePage(db);
  const megabytes = statSync(html).size / 1e6;
  check(megabytes < most.megabytes, `${kind}: the page is ${megabytes.toFixed(1)} MB`);
  const { context, page } = await open(html, { near: true, init: noteLetters });
  let drawnAtFirst;
  for (const [width, colorScheme] of views) {
    const what = `${kind}, ${width}, ${colorScheme}`;
    await Promise.all([page.emulateMedia({ colorScheme }), page.setViewportSize({ width, height: 900 })]);   // figures are drawn once for both
    await page.waitForFunction(([wanted, scheme]) => innerWidth === wanted && document.documentElement.dataset.theme === scheme, [width, colorScheme]);
    await figuresFollow(page);
    await noOverflow(page, what);
    const over = await overlaps(page);
    check(over.length === 0, `${what}: at the head of the page ${over.slice(0, 3)}`);
    const figures = await figuresOf(page);
    const ids = figures.filter(({ letters }) => letters.length > 0).map(({ id }) => id);
    drawnAtFirst ??= ids;
    check(ids.length >= (kind === 'one' ? 5 : 9) && ids.join() === drawnAtFirst.join(), `${what}: ${ids.length} figures are drawn, the same as at first: ${ids}`);
    for (const figure of figures) {
      if (figure.empty === undefined) legible(figure, `${what}, ${figure.id}`);
      else check(/^[A-Z].*\.$/.test(figure.empty), `${what}: ${figure.id} says why it is empty: ${figure.empty}`);
    }
  }
  if (moma !== undefined) await equalsProgram(page, db, kind);
  const nodes = await page.evaluate(() => document.querySelectorAll('*').length);
  check(nodes < most.nodes, `${kind}: ${nodes} elements`);
  const words = await page.locator('#app').innerText();
  check(!/NaN|undefined|\[object/.test(words), `${kind}: ${/.{0,40}(NaN|undefined|\[object).{0,40}/.exec(words)?.[0]}`);
  if (kind === 'errors') check(/ended by an error; they count as failed/.test(words) && /without errors/.test(words), 'errors are told, and the rate without them');
  const saved = join(work, `figures-${kind}`);
  if (kind === 'demo' || kind === 'sweep') await figuresAreSaved(page, saved, kind);
  if (kind === 'demo') pairedIsSquare(join(saved, 'paired.svg'));
  else {   // that one is printed by paper_test.mjs
    const pdf = join(work, `${kind}.pdf`);
    await page.pdf({ path: pdf, format: 'A4' });
    const sheets = textsOf(pdf);
    const print = sheets.join('\n');
    check(sheets.length < 25 && sheets.every((text) => text.trim() !== ''), `${kind}: a print of ${sheets.length} sheets, none of them empty`);
    for (const part of ['Results', 'Failures', 'Replay', 'Provenance']) check(print.includes(part), `${kind}: the print has ${part}`);
  }
  await context.close();
}
await browser.close();
end('the pages of all kinds of stores');
