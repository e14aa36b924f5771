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

/** Column of a replay's samples, decoded independently of the page. */
const column = (replay, name) => {
  const planes = inflateSync(Buffer.from(replay.data, 'base64'));
  const count = replay.n * replay.columns.length;
  const bytes = Buffer.alloc(4 * count);
  for (let k = 0; k < 4; ++k) for (let i = 0; i < count; ++i) bytes[4 * i + k] = planes[k * count + i];
  const at = replay.columns.indexOf(name);
  return Array.from({ length: replay.n }, (_, i) => bytes.readFloatLE(4 * (at * replay.n + i)));
};
/** The page's forward kinematics against the stored errors, which the simulation computed. */
const checkKinematics = async (page, pageData) => {
  for (const [i, replay] of pageData.replays.entries()) {
    await page.locator('.shelf button').nth(i).click();
    await page.waitForFunction((trial) => document.querySelector('.stage-box').dataset.trial === trial, replay.trial);
    const shown = Number(await page.locator('.stage-box').getAttribute('data-position-error'));
    const stored = column(replay, 'error_position')[0];
    check(near(shown, stored, 1e-5), `trial ${replay.trial}: end effector ${shown} m from the goal, stored ${stored} m`);
    await page.locator('.transport input[type=range]').evaluate((input) => {
      input.value = input.max;
      input.dispatchEvent(new Event('input', { bubbles: true }));
    });
    const end = Number(await page.locator('.stage-box').getAttribute('data-position-error-now'));
    const last = column(replay, 'error_position').pop();
    check(near(end, last, 1e-5), `trial ${replay.trial}: at the end ${end} m from the goal, stored ${last} m`);
  }
};
// ---- trials that moma simulated: robots, worlds and samples as the program writes them -----------------------------
const suites = [['frankie', 'robots/frankie.yaml', 'clutter', '{}'], ['tiago', 'robots/examples/tiago.yaml', 'moving', '{}'],
  ['rows', 'robots/frankie.yaml', 'moving', join(source, 'configs/controllers/moma.yaml')]];
for (const [name, robot, family, controller] of moma === undefined ? [] : suites) {
  const suite = join(work, `${name}.yaml`);
  writeFileSync(suite, `name: ${name}\nrobot: ${join(source, 'configs', robot)}\ncontrollers: {moma: ${controller}}\nworlds: {seed: 5, families: `
    + `{${family}: {weight: 1}}}\nsimulation: {mode: kinematic, time_limit: 8}\ntrials: 3\nsamples: all\n`);
  execFileSync(moma, ['run', suite, '-o', join(work, `${name}.db`), '--quiet'], { stdio: ['ignore', 'ignore', 'inherit'] });
  execFileSync(makeReport, [join(work, `${name}.db`), join(work, `${name}.html`)], { stdio: 'inherit' });
  const html = join(work, `${name}.html`);
  const { context, page } = await open(html);
  await page.locator('#replay').scrollIntoViewIfNeeded();
  check(dataOf(html).replays.length === 3, `${name}: all trials can be played`);
  await checkKinematics(page, dataOf(html));
  // Collision rows follow from poses and commands in the page; the controller stored the least distance and how many
  // constraints were active.
  let [seen, active, ends, passing] = [0, 0, 0, 0];
  for (const [i, replay] of dataOf(html).replays.entries()) {
    await page.locator('.shelf button').nth(i).click();
    await page.waitForFunction((trial) => document.querySelector('.stage-box').dataset.trial === trial, replay.trial);
    const [times, least, rows, fallback, status] = ['t', 'least_distance', 'active_rows', 'fallback', 'status'].map((column_) => column(replay, column_));
    for (let k = 0; k < replay.n; k += 7) {
      const shown = await page.evaluate((t) => {
        const input = document.querySelector('.transport input[type=range]');
        input.value = t;
        input.dispatchEvent(new Event('input', { bubbles: true }));
        const box = document.querySelector('.stage-box').dataset;
        return { least: box.leastDistance === '' ? Infinity : Number(box.leastDistance), active: Number(box.activeRows), room: Number(box.leastRoom), ends: Number(box.ends), passing: Number(box.passing) };
      }, times[k]);
      if (least[k] < 0.29) {
        seen += 1;
        check(near(shown.least, least[k], 1e-5), `${name}: at ${times[k]} s the nearest object is ${shown.least} m away, stored ${least[k]} m`);
      }
      if (fallback[k] === 0) check(shown.active <= rows[k], `${name}: at ${times[k]} s ${shown.active} active collision rows of ${rows[k]} active constraints`);
      active += shown.active;
      ends += shown.ends;
      passing += shown.passing;
      // The solver kept its rows: were those of the page others, the command would break some.
      if (fallback[k] === 0 && status[k] === 0 && k + 1 < replay.n) check(shown.room > -3e-3, `${name}: at ${times[k]} s a row is broken by ${-shown.room} m/s`);
    }
  }
  if (name === 'rows') check(ends > 0 && passing > 0, `${name}: ${ends} rows of ends, ${passing} of passing objects`);
  else check(seen > 5 && active > 0, `${name}: ${seen} distances compared, ${active} active rows`);
  if (screenshots !== undefined) await page.locator('.replay').screenshot({ path: join(screenshots, `replay-${name}.png`) });
  await context.close();
}

// ---- disturbances: what points differ by, and failures for want of sight --------------------------------------------
if (moma !== undefined) {
  const suite = join(work, 'sight.yaml');
  writeFileSync(suite, `name: sight\nrobot: ${join(source, 'configs/robots/frankie.yaml')}\ncontrollers: {one: {}, two: ${join(source, 'configs/controllers/moma.yaml')}}\n`
    + 'worlds: {seed: 12, families: {clutter: {weight: 1}}}\nsimulation: {mode: kinematic, time_limit: 6}\ntrials: 8\nsamples: failures\n'
    + `sweep: {axes: {disturbances: [none, {objects: {range: 0.3}}, ${join(source, 'configs/disturbances/realistic.yaml')}]}}\n`);
  execFileSync(moma, ['run', suite, '-o', join(work, 'sight.db'), '--quiet'], { stdio: ['ignore', 'ignore', 'inherit'] });
  execFileSync(moma, ['report', join(work, 'sight.db'), '-o', join(work, 'sight.html')], { stdio: 'ignore' });
  const told = dataOf(join(work, 'sight.html'));
  check(told.points.map((p) => Object.keys(p.disturbances).length > 0).join() === 'false,true,true,false,true,true', 'points say what disturbs them');
  const { context, page } = await open(join(work, 'sight.html'));
  check(/Disturbances\s+none/.test(await page.locator('.facts').innerText()), 'the top names the disturbances');
  check((await page.locator('.verdict').count()) === 6, 'a verdict for each controller under each condition');
  const failed = told.trials.columns.outcome.codes.filter((code) => told.trials.columns.outcome.values[code] !== 'success').length;
  await page.locator('#failures').scrollIntoViewIfNeeded();
  await page.waitForSelector('#causes tbody tr');
  const counts = await page.locator('#causes td .share').evaluateAll((cells) => cells.map((cell) => Number(cell.firstChild.textContent)));
  check(counts.reduce((sum, n) => sum + n, 0) === failed, `the causes of ${failed} failures: ${counts}`);
  const known = told.trials.columns.known_before_contact_s ?? [];
  check(known.some((seconds) => seconds !== null && seconds < 1), 'objects are hit before they are known');
  check((await page.locator('#causes').innerText()).includes('late detection'), 'late detection is a cause');
  await page.locator('.toolbar').getByRole('group', { name: 'disturbances' }).getByText('realistic').click();
  check((await page.locator('.verdict').count()) === 2, 'one condition, two verdicts');
  check(page.url().includes('at=0.2'), 'the address keeps the condition');
  check((await page.locator('.paired-words').count()) === 1, 'under one condition they are compared');
  check(/objects\.range/.test(await page.locator('#provenance').innerText()), 'provenance lists the values');
  await noOverflow(page, 'conditions');
  await context.close();
}

if (screenshots !== undefined) {
  for (const [width, scheme] of [[1280, 'light'], [1280, 'dark'], [390, 'light']]) {
    const { context, page } = await open(demo, { width, scheme });
    await scrollThrough(page);
    await page.evaluate(() => scrollTo({ top: 0, behavior: 'instant' }));
    await page.waitForTimeout(800);
    await page.screenshot({ path: join(screenshots, `report-${width}-${scheme}.png`), fullPage: true });
    await context.close();
  }
}
await browser.close();
console.log(failures === 0 ? 'the page passed' : `${failures} checks failed`);
process.exit(failures === 0 ? 0 : 1);
