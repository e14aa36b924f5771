// How quick the report page is: node bench/report_page.mjs MOMA STORE.db [FOLDER]
//                           or: node bench/report_page.mjs PAGE.html PAGE.html...   written pages, against the first of them
// Writes the store's report into FOLDER (default: beside the store), opens it in chromium, then serves the same store with
// `moma view`. Prints medians of five loads or twenty key strokes. Needs chromium and the npm packages of reports/web.
import { execFileSync, spawn } from 'node:child_process';
import { existsSync, statSync } from 'node:fs';
import { createRequire } from 'node:module';
import { basename, dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

const [, , moma, store, folder = dirname(resolve(store ?? '.'))] = process.argv;
if (moma === undefined || store === undefined) {
  console.error('usage: node bench/report_page.mjs MOMA STORE.db [FOLDER], or PAGE.html PAGE.html...');
  process.exit(2);
}
const require = createRequire(join(dirname(fileURLToPath(import.meta.url)), '../reports/web/package.json'));
const { chromium } = require('playwright-core');
const executablePath = ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'].find(existsSync);
const browser = await chromium.launch({ executablePath, args: ['--no-sandbox', '--enable-unsafe-swiftshader', '--use-angle=swiftshader-webgl'] });
const median = (values) => [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];
const ms = (values) => `${median(values).toFixed(0)} ms (longest ${Math.max(...values).toFixed(0)})`;
const kLoads = 5;

/** Times in the page, from the start of its navigation: first paint, verdict painted, all sections built. */
const load = async (address) => {
  const page = await browser.newPage({ viewport: { width: 1280, height: 900 } });
  page.setDefaultTimeout(300000);
  await page.addInitScript(() => {
    window.seen = {};
    const look = () => {
      for (const [name, selector] of [['verdict', '.verdict'], ['built', 'main']]) {
        if (!(name in window.seen) && document.querySelector(selector) !== null) {
          window.seen[name] = NaN;
          setTimeout(() => { window.seen[name] = performance.now(); });   // after the frame that shows it
        }
      }
      if (!('built' in window.seen)) requestAnimationFrame(look);
    };
    requestAnimationFrame(look);
  });
  await page.goto(address);
  await page.waitForFunction(() => window.seen.built > 0 && performance.getEntriesByName('first-contentful-paint').length > 0);
  const times = await page.evaluate(() => ({ paint: performance.getEntriesByName('first-contentful-paint')[0].startTime, ...window.seen }));
  return { page, times };
};

/** From a change to the end of the frame that shows it. */
const change = (page, act) => page.evaluate(([name, value]) => new Promise((done) => {
  const began = performance.now();
  if (name === 'type') {
    const box = document.querySelector('#trials input[type=search]');
    box.value = value;
    box.dispatchEvent(new Event('input', { bubbles: true }));
  } else {
    document.querySelectorAll(value[0])[value[1]]?.click();
  }
  const handled = performance.now() - began;
  requestAnimationFrame(() => setTimeout(() => done([handled, performance.now() - began])));
}), act);

/** Loads of each address in turn, so that what else the machine does meets all of them; then changes of the last ones. */
const measure = async (addresses) => {
  const all = addresses.map(() => []);
  const last = [];
  for (let i = 0; i < kLoads; ++i) {
    for (const [k, address] of addresses.entries()) {
      await last[k]?.close();
      const { page, times } = await load(address);
      all[k].push(times);
      last[k] = page;
    }
  }
  const found = addresses.map(() => []);
  const tell = (what, values) => values.forEach((of, k) => found[k].push([what, of]));
  for (const [name, what] of [['paint', 'first paint'], ['verdict', 'verdict painted'], ['built', 'all sections built']]) tell(what, all.map((times) => times.map((t) => t[name])));
  const each = async (act) => { const out = []; for (const page of last) { await page.bringToFront(); out.push(await act(page)); } return out; };
  // Figures are drawn while nothing happens.
  await each(async (page) => {
    await page.locator('#trials').scrollIntoViewIfNeeded();
    await page.waitForFunction(() => [...document.querySelectorAll('.figure .plot')].every((plot) => plot.children.length > 0));
    await page.waitForTimeout(500);
  });
  const words = [...['stuck', 'object4'].flatMap((word) => Array.from(word, (_, i) => word.slice(0, i + 1))), 'world:1', 'object', 'hand', 's', ''];
  const turns = async (changes) => { const out = last.map(() => []); for (const act of changes) (await each(async (page) => (await change(page, act))[1])).forEach((t, k) => out[k].push(t)); return out; };
  tell('filter, per key stroke until shown', await turns(words.map((word) => ['type', word])));
  const heads = await last[0].locator('#trials .row.head button').count();
  tell('sort by a column', await turns(Array.from({ length: heads }, (_, i) => ['click', ['#trials .row.head button', i]])));
  const families = await last[0].locator('.segments button').count();
  if (families > 0) tell('whole page to another family', await turns(Array.from({ length: families }, (_, i) => ['click', ['.segments button', (i + 1) % families]])));
  for (const page of last) await page.close();
  return found;
};
const print = (found) => { for (const [what, values] of found) console.log(`  ${what}: ${ms(values)}`); };

if (/\.html$/.test(moma)) {   // pages that are there, against the first of them
  const pages = process.argv.slice(2).map((page) => resolve(page));
  const found = await measure(pages.map((page) => `file://${page}`));
  pages.forEach((page, k) => {
    console.log(`${process.argv[2 + k]}: ${(statSync(page).size / 1e6).toFixed(2)} MB, ${(statSync(page).size / statSync(pages[0]).size).toFixed(2)} of the first`);
    for (const [i, [what, values]] of found[k].entries()) console.log(`  ${what}: ${ms(values)}, ${(median(values) / median(found[0][i][1])).toFixed(2)} of the first`);
  });
  await browser.close();
  process.exit(0);
}
const html = join(folder, `${basename(store, '.db')}-page.html`);
let began = performance.now();
execFileSync(moma, ['report', store, '-o', html], { stdio: ['ignore', 'ignore', 'inherit'] });
console.log(`moma report: ${((performance.now() - began) / 1000).toFixed(1)} s, ${(statSync(html).size / 1e6).toFixed(1)} MB`);
print((await measure([`file://${resolve(html)}`]))[0]);

began = performance.now();
const server = spawn(moma, ['view', store, '--port', '0'], { stdio: ['ignore', 'pipe', 'pipe'] });
process.once('exit', () => server.kill('SIGKILL'));
const address = await new Promise((done) => {
  let text = '';
  const look = (part) => {
    text += part;
    const found = /http:\/\/[\w.]+:\d+\//.exec(text);
    if (found !== null) done(found[0]);
  };
  server.stdout.on('data', look);
  server.stderr.on('data', look);
});
console.log(`moma view: serves after ${((performance.now() - began) / 1000).toFixed(2)} s`);
began = performance.now();
const answer = await fetch(`${address}data.json`);
const size = (await answer.arrayBuffer()).byteLength;
console.log(`  its data, the first time: ${((performance.now() - began) / 1000).toFixed(1)} s, ${(size / 1e6).toFixed(1)} MB`);
print((await measure([address]))[0]);
await browser.close();
server.kill('SIGTERM');
