// How quick the report page is: node bench/report_page.mjs MOMA STORE.db [FOLDER]
// Writes the store's report into FOLDER (default: beside the store), opens it in chromium, then serves the same store with
// `moma view`. Prints medians of five loads or twenty key strokes. Needs chromium and the npm packages of reports/web.
import { execFileSync, spawn } from 'node:child_process';
import { existsSync, statSync } from 'node:fs';
import { createRequire } from 'node:module';
import { basename, dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

const [, , moma, store, folder = dirname(resolve(store ?? '.'))] = process.argv;
if (moma === undefined || store === undefined) {
  console.error('usage: node bench/report_page.mjs MOMA STORE.db [FOLDER]');
  process.exit(2);
}
const require = createRequire(join(dirname(fileURLToPath(import.meta.url)), '../reports/web/package.json'));
const { chromium } = require('playwright-core');
const executablePath = ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'].find(existsSync);
const browser = await chromium.launch({ executablePath, args: ['--no-sandbox', '--enable-unsafe-swiftshader', '--use-angle=swiftshader'] });
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
  await page.waitForFunction(() => window.seen.built > 0);
  const times = await page.evaluate(() => ({ paint: performance.getEntriesByName('first-contentful-paint')[0]?.startTime ?? NaN, ...window.seen }));
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

const measure = async (address) => {
  const all = [];
  let last;
  for (let i = 0; i < kLoads; ++i) {
    await last?.close();
    const { page, times } = await load(address);
    all.push(times);
    last = page;
  }
  for (const [name, what] of [['paint', 'first paint'], ['verdict', 'verdict painted'], ['built', 'all sections built']]) console.log(`  ${what}: ${ms(all.map((t) => t[name]))}`);
  await last.locator('#trials').scrollIntoViewIfNeeded();
  // Figures are drawn while nothing happens.
  await last.waitForFunction(() => [...document.querySelectorAll('.figure .plot')].every((plot) => plot.children.length > 0));
  await last.waitForTimeout(500);
  const told = await last.locator('#trials footer .note').innerText();
  const typed = [];
  for (const word of ['stuck', 'object4']) for (let i = 1; i <= word.length; ++i) typed.push((await change(last, ['type', word.slice(0, i)]))[1]);
  for (const word of ['world:1', 'object', 'hand', 's', '']) typed.push((await change(last, ['type', word]))[1]);
  console.log(`  filter, per key stroke until shown (${told}): ${ms(typed)}`);
  const sorted = [];
  const heads = await last.locator('#trials .row.head button').count();
  for (let i = 0; i < heads; ++i) sorted.push((await change(last, ['click', ['#trials .row.head button', i]]))[1]);
  console.log(`  sort by a column: ${ms(sorted)}`);
  const families = await last.locator('.segments button').count();
  const chosen = [];
  for (let i = 1; i <= families; ++i) chosen.push((await change(last, ['click', ['.segments button', i % families]]))[1]);
  if (chosen.length > 0) console.log(`  whole page to another family: ${ms(chosen)}`);
  await last.close();
};

const html = join(folder, `${basename(store, '.db')}-page.html`);
let began = performance.now();
execFileSync(moma, ['report', store, '-o', html], { stdio: ['ignore', 'ignore', 'inherit'] });
console.log(`moma report: ${((performance.now() - began) / 1000).toFixed(1)} s, ${(statSync(html).size / 1e6).toFixed(1)} MB`);
await measure(`file://${resolve(html)}`);

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
await measure(address);
await browser.close();
server.kill('SIGTERM');
