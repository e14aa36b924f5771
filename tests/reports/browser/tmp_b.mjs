// The report page in a real browser, offline: page_test.mjs SOURCE_DIR MAKE_REPORT WORK_DIR [MOMA]
// With the program MOMA, also pages of trials that it simulates. MOMA_SCREENSHOTS=DIR writes screenshots there.
// Exit 0: passed; 1: failed; 77: left out, since node's packages, python3 or chromium are missing.
import { execFileSync, spawn } from 'node:child_process';
import { existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { inflateSync } from 'node:zlib';

const [, , source, makeReport, work, moma] = process.argv;
const screenshots = process.env.MOMA_SCREENSHOTS;
const skip = (why) => {
  console.log(`skipped: ${why}; scripts/setup.sh installs what is missing`);
  process.exit(77);
};
const chromiumPath = ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'].find(existsSync);
if (chromiumPath === undefined) skip('there is no chromium');
const require = createRequire(join(source, 'reports/web/package.json'));
let chromium;
try {
  ({ chromium } = require('playwright-core'));
} catch {
  skip('playwright-core is not in reports/web/node_modules');
}

let failures = 0;
const check = (ok, what) => {
  if (!ok) {
    failures += 1;
    console.log(`FAILED: ${what}`);
  }
};
const near = (a, b, tolerance) => Math.abs(a - b) <= tolerance;

rmSync(work, { recursive: true, force: true });
mkdirSync(work, { recursive: true });
const makePage = (kind, worlds) => {
  const db = join(work, `${kind}.db`);
  const html = join(work, `${kind}.html`);
  execFileSync('python3', [join(source, 'tests/tools/make_store.py'), join(source, 'eval/store'), db,
    '--kind', kind, '--worlds', String(worlds), '--samples', '8'], { stdio: 'inherit' });
  execFileSync(makeReport, [db, html], { stdio: 'inherit' });
  return html;
};
const dataOf = (html) => JSON.parse(readFileSync(html, 'utf8').split('id="moma-data">')[1].split('</script')[0]);

const browser = await chromium.launch({
  executablePath: chromiumPath, headless: true,
  args: ['--no-sandbox', '--enable-unsafe-swiftshader', '--use-angle=swiftshader', '--disable-background-networking',
    '--disable-component-update', '--disable-sync', '--no-first-run'],
});

/** Opens a page and notes everything it must not do. */
const open = async (html, { width = 1280, hash = '', scheme = 'light', served = false, allowed = () => false } = {}) => {
  const context = await browser.newContext({ viewport: { width, height: 900 }, offline: !served, colorScheme: scheme, acceptDownloads: true });
  const page = await context.newPage();
  page.setDefaultTimeout(60000);
  page.on('console', (message) => { if (message.type() === 'error' && !allowed(message.text())) check(false, `console error: ${message.text()}`); });
  page.on('pageerror', (error) => check(false, `page error: ${error.stack}`));
  page.on('dialog', (dialog) => { check(false, 'a dialog opened'); void dialog.dismiss(); });
  page.on('request', (request) => { if (!/^(file|data|blob):/.test(request.url()) && !(served && request.url().startsWith(html))) check(false, `request to ${request.url()}`); });
  await page.goto(served ? `${html}${hash}` : `file://${html}${hash}`);
  await page.waitForSelector('main');   // built after the first paint
  return { context, page };
};

/** Everything is drawn only where it is seen. */
const scrollThrough = async (page) => {
  const height = await page.evaluate(() => document.documentElement.scrollHeight);
  for (let y = 0; y < height; y += 600) {
    await page.evaluate((top) => scrollTo({ top, behavior: 'instant' }), y);
    await page.waitForTimeout(60);
  }
};

const noOverflow = async (page, what) => {
  const [wide, inner] = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
  check(wide <= inner, `${what}: the page is ${wide} wide in a window of ${inner}`);
};

const textOf = (download) => download.path().then((path) => readFileSync(path, 'utf8'));

const demo = makePage('demo', 60);
const data = dataOf(demo);
/** Clicks marks of a figure, as a reader could, until one does something; false where none does. */
const clickMark = async (page, id) => {
  await page.locator(`#${id}`).scrollIntoViewIfNeeded();
  await page.waitForSelector(`#${id} canvas`);
  // Marks grow into place: until one is found.
  return page.waitForFunction((figure) => {
    const canvas = document.querySelector(`#${figure} canvas`);
    const box = canvas.getBoundingClientRect();
    const send = (type, clientX, clientY) => canvas.dispatchEvent(new MouseEvent(type, { clientX, clientY, bubbles: true, view: window }));
    for (let y = box.top + 60; y < box.bottom - 40; y += 4) {
      for (let x = box.left + 80; x < box.right - 20; x += 4) {
        send('mousemove', x, y);
        if (canvas.parentElement.style.cursor !== 'pointer') continue;
        const before = location.hash;
        for (const type of ['mousedown', 'mouseup', 'click']) send(type, x, y);
        if (location.hash !== before) return true;
      }
    }
    return false;
  }, id, { polling: 500 }).then(() => true, () => false);
};
{
  const inPage = new Set(data.replays.map((replay) => replay.trial));
  for (const id of ['figure-scatter', 'figure-paired', 'figure-course']) {
    const { context, page } = await open(demo);
    check(await clickMark(page, id), `${id} has a mark to click`);
    await page.waitForFunction(() => location.hash.includes('trial='));
    const trial = new URLSearchParams(new URL(page.url()).hash.slice(1)).get('trial');
    if (inPage.has(trial)) await page.waitForSelector(`.stage-box[data-trial="${trial}"]`);
    else check((await page.locator('.detail code').innerText()).endsWith(trial), `${id}: the command that plays ${trial}`);
    check(id !== 'figure-course' || inPage.has(trial), 'a line of the motions is a trial that can be played');
    await context.close();
  }
  const { context, page } = await open(demo);
  check(await clickMark(page, 'figure-outcomes'), 'outcomes have bars to click');
  await page.waitForFunction(() => location.hash.includes('outcome='));
  check(/^\d+ of 120/.test((await page.locator('#trials footer .note').innerText()).replace(/\s/g, ' ')), 'a bar lists its trials');
  await context.close();
}

// ---- served by moma view, while a run goes on -----------------------------------------------------------------------
{
  const db = join(work, 'served.db');
  execFileSync('python3', [join(source, 'tests/tools/make_store.py'), join(source, 'eval/store'), db, '--kind', 'demo', '--worlds', '20', '--samples', '3']);
  const sql = (text) => execFileSync('python3', ['-c', `import sqlite3; db = sqlite3.connect(${JSON.stringify(db)}); db.executescript(${JSON.stringify(text)}); db.close()`]);
  sql("UPDATE invocation SET status = 'running'; CREATE TABLE kept AS SELECT * FROM point_trial WHERE world_index >= 15; DELETE FROM point_trial WHERE world_index >= 15;");
  const server = spawn(makeReport, ['--view', db], { stdio: ['ignore', 'pipe', 'inherit'] });
  const address = await new Promise((done) => server.stdout.once('data', (text) => done(String(text).trim())));
  const ended = new Promise((done) => server.once('exit', done));
  process.once('exit', () => server.kill('SIGKILL'));   // whatever fails below
  let stopped = false;
  const allowed = (error) => stopped && error.includes('ERR_CONNECTION_REFUSED');   // the page goes on asking
  const { context, page } = await open(address, { served: true, allowed });
  check((await page.locator('.live').innerText()).includes('30'), 'the page says that it is live');
  check((await page.locator('#trials footer .note').innerText()).startsWith('30'), 'the trials so far');
  await page.locator('.atlas .play').first().click();
  await page.waitForSelector('.stage-box[data-trial]');
  await page.waitForFunction(() => Number(document.querySelector('.transport input[type=range]').value) > 0.05);
  await page.locator('.transport .play').click();
  sql("INSERT INTO point_trial SELECT * FROM kept; DROP TABLE kept; UPDATE invocation SET status = 'finished';");
  await page.waitForFunction(() => document.querySelector('#trials footer .note').textContent.startsWith('40'));
  check((await page.locator('.summary tbody tr').last().locator('td').first().innerText()) === '20', 'the summary has followed');
  check((await page.locator('.live').innerText()).includes('no run is going on'), 'the end of the run is told');
  stopped = true;
  server.kill('SIGTERM');
  check((await ended) === 0, 'the server ends cleanly');
  await page.waitForFunction(() => document.querySelector('.live').textContent.startsWith('moma view has ended'));
  await context.close();
}

await browser.close(); console.log(failures); process.exit(failures);
