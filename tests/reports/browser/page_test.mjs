// The report page in a real browser, offline: page_test.mjs SOURCE_DIR MAKE_REPORT WORK_DIR [MOMA]
// With the program MOMA, also pages of trials that it simulates. MOMA_SCREENSHOTS=DIR writes screenshots there.
// Exit 0: passed; 1: failed; 77: left out, since node's packages, python3 or chromium are missing.
import { execFileSync, spawn } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { inflateSync } from 'node:zlib';

import { accessible, check, dataOf, end, launch, near, noOverflow, opener, scrollThrough, workshop } from './kit.mjs';

const [, , source, makeReport, work, moma] = process.argv;
const screenshots = process.env.MOMA_SCREENSHOTS;
const { makeStore, makePage: pageOf } = workshop(source, makeReport, work);
const makePage = (kind, worlds) => pageOf(makeStore(kind, kind, worlds));
const browser = await launch(source);
const open = opener(browser);

const textOf = (download) => download.path().then((path) => readFileSync(path, 'utf8'));

// ---- what every reader sees ---------------------------------------------------------------------------------------
const demo = makePage('demo', 60);
const data = dataOf(demo);
{
  const { context, page } = await open(demo);
  await page.waitForSelector('.verdict');
  const verdicts = await page.locator('.verdict').allInnerTexts();
  check(verdicts.length === 2, 'two controllers, two verdicts');
  data.overall.forEach((row, i) => {
    check(verdicts[i].includes((100 * row.success_rate).toFixed(1)), `verdict ${i} names the success rate`);
    check(verdicts[i].includes(`${(100 * row.success_low).toFixed(1)}\u2013${(100 * row.success_high).toFixed(1)}`), `verdict ${i} names the interval`);
  });
  for (const row of [...data.summary, ...data.overall]) {
    const cells = await page.locator('.summary tbody tr').filter({ has: page.locator('td') }).allInnerTexts();
    const wanted = [String(row.n), String(Number(row.manip_mean.toPrecision(3))), `${(100 * row.success_low).toFixed(1)}\u2013${(100 * row.success_high).toFixed(1)}`];
    check(cells.some((text) => text.includes(row.controller) && wanted.every((part) => text.includes(part))), `summary row ${JSON.stringify(row)}`);
  }
  await noOverflow(page, '1280');

  // By how much, world by world, and where the one that is behind fails; counted here anew.
  const text = (name) => data.trials.columns[name].codes.map((code) => data.trials.columns[name].values[code] ?? null);
  const [who, what, where, world] = ['controller', 'outcome', 'family', 'world_key'].map(text);
  const lines = await page.locator('.forest-row .difference').allInnerTexts();
  ['', 'clutter', 'open'].forEach((family, i) => {
    const won = (name) => new Map(who.flatMap((c, row) => (c === name && (family === '' || where[row] === family) ? [[world[row], what[row] === 'success']] : [])));
    const [a, b] = [won('holistic'), won('moma')];
    const points = (100 * [...a].reduce((sum, [key, ok]) => sum + Number(b.get(key)) - Number(ok), 0)) / a.size;
    check(lines[i].startsWith(`${points > 0 ? '+' : ''}${points.toFixed(1).replace('-', '\u2212')} points`), `difference in ${family || 'all'}: ${points} points, shown ${lines[i]}`);
    check(/\d to .*p\s[=<]\s/.test(lines[i]), `an interval and p: ${lines[i]}`);
  });
  await page.waitForFunction(() => document.querySelector('.fails').textContent !== '');
  const failures = who.filter((c, row) => c === 'holistic' && what[row] !== 'success').length;
  check(new RegExp(`^holistic fails .* of ${failures}.failures\\.$`).test(await page.locator('.fails').innerText()), `where it fails: ${await page.locator('.fails').innerText()}`);

  // The table of results sorts by any column.
  const first = async () => (await page.locator('.summary tbody').last().locator('tr').nth(1).innerText());
  await page.locator('.summary').getByRole('button', { name: 'Success' }).click();
  const best = data.overall.reduce((a, b) => (a.success_rate >= b.success_rate ? a : b)).controller;
  check((await first()).includes(best), 'sorted by success, the best is first');
  check((await page.locator('.summary th[aria-sort]').getAttribute('aria-sort')) === 'descending', 'the column says how it is sorted');
  await page.locator('.summary').getByRole('button', { name: 'Success' }).click();
  check(!(await first()).includes(best), 'once more, and it is last');
  await page.locator('.summary').getByRole('button', { name: 'Success' }).click();

  // Figures: each saves itself as SVG and its data as CSV, and says its n.
  await scrollThrough(page);
  for (const id of await page.locator('.figure').evaluateAll((all) => all.map((f) => f.id))) {
    const figure = page.locator(`#${id}`);
    await figure.scrollIntoViewIfNeeded();
    await page.waitForTimeout(250);   // Chromium drops a page's downloads past ten in a second, silently
    await page.waitForFunction((name) => document.querySelector(`#${name} canvas`) !== null, id);
    check(/n = \d/.test(await figure.locator('.note').innerText()), `${id} states n`);
    const [svg] = await Promise.all([page.waitForEvent('download'), figure.getByText('Save SVG').click()]);
    const drawing = await textOf(svg);
    check(drawing.startsWith('<svg') && drawing.includes('<path') && drawing.length > 2000, `${id} saves an SVG`);
    const [table] = await Promise.all([page.waitForEvent('download'), figure.getByText('Data CSV').click()]);
    check((await textOf(table)).split('\n').length > 3, `${id} saves its data`);
    if (id === 'figure-arrival') {
      const lines = (await textOf(table)).trim().split('\n').slice(1).map((line) => line.split(','));
      for (const row of data.overall) {
        const last = lines.filter((line) => line[0] === row.controller).pop();
        check(near(Number(last[3]), row.success_rate, 1e-12) && near(Number(last[4]), row.success_low, 1e-12)
          && near(Number(last[5]), row.success_high, 1e-12), `${row.controller}'s curve ends at its success rate`);
      }
    }
  }

  // The table of trials.
  const outcomes = data.trials.columns.outcome;
  const stuck = outcomes.codes.filter((code) => outcomes.values[code] === 'stuck').length;
  const note = page.locator('#trials footer .note');
  await page.locator('#trials input[type=search]').fill('stuck');
  check((await note.innerText()).startsWith(`${stuck} of 120`), `filter finds ${stuck} stuck trials: ${await note.innerText()}`);
  check(page.url().includes('q=stuck'), 'the address keeps the filter');
  await page.locator('#trials').getByText('To goal [s]').click();
  await page.locator('#trials').getByText('Clear', { exact: true }).click();
  check((await note.innerText()).replace(/\s/g, ' ').startsWith('120 trials'), 'cleared filter shows all');
  await page.locator('#trials').getByText('To goal [s]').click();
  const shown = await page.locator('#trials .rows .row').first().getAttribute('data-trial');
  const times = data.trials.columns.time_to_goal_s;
  const fastest = times.indexOf(Math.min(...times.filter((t) => t !== null)));
  check(data.trials.columns.trial.values[data.trials.columns.trial.codes[fastest]] === shown, 'sorted by time, the fastest is first');

  // Keyboard: arrows choose, the detail names the command that plays it.
  await page.locator('#trials .grid-scroll').focus();
  await page.keyboard.press('ArrowDown');
  const chosen = await page.locator('#trials .row.chosen').getAttribute('data-trial');
  check(chosen !== null, 'an arrow chooses a trial');
  check((await page.locator('.detail code').innerText()) === `moma replay demo.db ${chosen}`, 'the detail has the replay command');
  const address = page.url();

  // The same address opens the same view.
  const again = await open(demo, { hash: new URL(address).hash });
  await again.page.waitForSelector('.row.chosen', { state: 'attached' });
  check((await again.page.locator('#trials .row.chosen').getAttribute('data-trial')) === chosen, 'the address opens the same trial');
  await again.context.close();

  // A family only: the verdict is that family's.
  await page.locator('.segments').getByText('clutter').click();
  const clutter = data.summary.find((s) => s.family === 'clutter' && s.controller === 'moma');
  check((await page.locator('.verdict').nth(1).innerText()).includes((100 * clutter.success_rate).toFixed(1)), 'verdict of a family');
  await page.locator('.segments').getByText('all worlds').click();

  // Light and dark.
  const before = await page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  await page.locator('.toolbar').getByText('Dark').click();
  check((await page.evaluate(() => getComputedStyle(document.body).backgroundColor)) !== before, 'dark differs from light');
  await context.close();
}

/** Clicks marks of a figure, as a reader could, until one does something; false where none does. */
const clickMark = async (page, id) => {
  await page.locator(`#${id}`).scrollIntoViewIfNeeded();
  await page.waitForSelector(`#${id} canvas`);
  // Marks grow into place: until one is found.
  return page.waitForFunction((figure) => {
    const canvas = document.querySelector(`#${figure} canvas`);
    const box = canvas.getBoundingClientRect();
    const send = (type, clientX, clientY) => canvas.dispatchEvent(new MouseEvent(type, { clientX, clientY, bubbles: true, view: window }));
    // Evenly spread (van der Corput in bases 2 and 3), so that a mark is soon met.
    const spread = (i, base) => { let [out, part] = [0, 1]; for (let k = i; k > 0; k = Math.floor(k / base)) out += (k % base) * (part /= base); return out; };
    for (let i = 1; i < 6000; ++i) {
      const [x, y] = [box.left + 80 + spread(i, 2) * (box.width - 100), box.top + 60 + spread(i, 3) * (box.height - 100)];
      send('mousemove', x, y);
      if (canvas.parentElement.style.cursor !== 'pointer') continue;
      const before = location.hash;
      for (const type of ['mousedown', 'mouseup', 'click']) send(type, x, y);
      if (location.hash !== before) return true;
    }
    return false;
  }, id, { polling: 500 }).then(() => true, () => false);
};
{
  const inPage = new Set(data.replays.map((replay) => replay.trial));
  const { context, page } = await open(demo);
  for (const id of ['figure-scatter', 'figure-paired', 'figure-course']) {
    await page.evaluate(() => { location.hash = ''; });
    check(await clickMark(page, id), `${id} has a mark to click`);
    await page.waitForFunction(() => location.hash.includes('trial='));
    const trial = new URLSearchParams(new URL(page.url()).hash.slice(1)).get('trial');
    if (inPage.has(trial)) await page.waitForSelector(`.stage-box[data-trial="${trial}"]`);
    else check((await page.locator('.detail code').innerText()).endsWith(trial), `${id}: the command that plays ${trial}`);
    check(id !== 'figure-course' || inPage.has(trial), 'a line of the motions is a trial that can be played');
    await page.locator('.transport .play').filter({ hasText: 'Pause' }).click({ timeout: 500 }).catch(() => undefined);
  }
  await page.evaluate(() => { location.hash = ''; });
  check(await clickMark(page, 'figure-outcomes'), 'outcomes have bars to click');
  await page.waitForFunction(() => location.hash.includes('outcome='));
  check(/^\d+ of 120/.test((await page.locator('#trials footer .note').innerText()).replace(/\s/g, ' ')), 'a bar lists its trials');
  await context.close();
}

// ---- replay -------------------------------------------------------------------------------------------------------
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
    const [shown, end] = (await page.locator('.transport input[type=range]').evaluate((input) => {
      input.value = input.max;
      input.dispatchEvent(new Event('input', { bubbles: true }));
      const box = document.querySelector('.stage-box').dataset;
      return [box.positionError, box.positionErrorNow];
    })).map(Number);
    const stored = column(replay, 'error_position')[0];
    check(near(shown, stored, 1e-5), `trial ${replay.trial}: end effector ${shown} m from the goal, stored ${stored} m`);
    const last = column(replay, 'error_position').pop();
    check(near(end, last, 1e-5), `trial ${replay.trial}: at the end ${end} m from the goal, stored ${last} m`);
  }
};
{
  const { context, page } = await open(demo);
  await page.locator('.atlas .play').first().click();
  await page.waitForSelector('.stage-box[data-trial]');
  const time = async () => Number(await page.locator('.transport input[type=range]').inputValue());
  await page.waitForFunction(() => Number(document.querySelector('.transport input[type=range]').value) > 0.05);
  check((await time()) > 0, 'a failure plays');
  await page.locator('.transport .play').click();
  await page.locator('.transport input[type=range]').evaluate((input) => {
    input.value = '1';
    input.dispatchEvent(new Event('input', { bubbles: true }));
  });
  check((await page.locator('.clock').innerText()).startsWith('1.00 of'), 'the time line scrubs');
  await page.locator('.stage').focus();
  await page.keyboard.press('ArrowRight');
  check((await page.locator('.clock').innerText()).startsWith('1.10 of'), 'an arrow steps');
  const colours = await page.locator('.stage').evaluate((canvas) => {
    const copy = document.createElement('canvas');
    copy.width = canvas.width;
    copy.height = canvas.height;
    return new Promise((done) => requestAnimationFrame(() => {
      document.querySelector('.transport input[type=range]').dispatchEvent(new Event('input', { bubbles: true }));   // draws with the next frame
      requestAnimationFrame(() => {   // in which this comes after it
        copy.getContext('2d').drawImage(canvas, 0, 0);
        const pixels = copy.getContext('2d').getImageData(0, 0, copy.width, copy.height).data;
        const found = new Set();
        for (let i = 0; i < pixels.length; i += 404) found.add(`${pixels[i] >> 3},${pixels[i + 1] >> 3},${pixels[i + 2] >> 3}`);
        done(found.size);
      });
    }));
  });
  check(colours > 20, `the scene shows ${colours} colours`);

  await checkKinematics(page, data);
  await context.close();
}

// ---- a phone, accessibility, odd stores ---------------------------------------------------------------------------
{
  const { context, page } = await open(demo);
  await scrollThrough(page);
  for (const scheme of ['light', 'dark']) {
    if (scheme === 'dark') await page.locator('.toolbar').getByText('Dark').click();
    check((await page.evaluate(() => document.documentElement.dataset.theme)) === scheme, `the page is ${scheme}`);
    await accessible(page, source, scheme);
  }
  await page.setViewportSize({ width: 390, height: 900 });
  await page.waitForFunction(() => innerWidth === 390);
  await noOverflow(page, '390');
  await context.close();
}
{
  const html = makePage('hostile', 24);
  const { context, page } = await open(html);
  await scrollThrough(page);
  check((await page.title()).startsWith('</script><script>document.title="taken"</script>'), `hostile names are the title's text: ${await page.title()}`);
  check((await page.locator('h1').innerText()).includes('</script><script>'), 'hostile suite shows as text');
  check((await page.locator('.verdict h2').nth(1).innerText()) === 'quo"te\'s & <b>bold</b>', 'hostile controller shows as text');
  check((await page.locator('.facts').innerText()).includes('机器人'), 'names that are not ASCII show');
  check((await page.locator('#app b').allInnerTexts()).every((text) => text !== 'bold'), 'no markup from names');
  await page.locator('#figure-outcomes canvas').hover({ position: { x: 500, y: 60 } });
  await page.waitForTimeout(200);
  check((await page.evaluate(() => [...document.querySelectorAll('b')].some((b) => b.textContent === 'bold'))) === false, 'no markup in tooltips');
  await context.close();
}
for (const [kind, worlds] of [['empty', 0], ['one', 1], ['failures', 16], ['sweep', 12], ['tuned', 12]]) {
  const { context, page } = await open(makePage(kind, worlds));
  await scrollThrough(page);
  await noOverflow(page, kind);
  const text = await page.locator('#app').innerText();
  check(!/NaN|undefined|\[object/.test(text), `${kind}: ${/.{0,40}(NaN|undefined|\[object).{0,40}/.exec(text)?.[0]}`);
  if (kind === 'empty') check(text.includes('holds no trials yet'), 'an empty store says so');
  if (kind === 'tuned') check(/judged|: better\./.test(await page.locator('#top').innerText()) && /success rate \+12\.0 points/.test(await page.locator('#top').innerText()), `a search begins with its verdict: ${await page.locator('#top').innerText()}`);
  if (kind === 'tuned') check(!/no trials here yet/i.test(text) && (await page.locator('.verdict').count()) === 2, 'a search opens on a suite that has trials');
  if (kind === 'failures') check(/neither \w+ nor \w+ reached a goal: nothing tells them apart/.test(text) && !/p\s=\s1\.000/.test(await page.locator('#top').innerText()), 'nobody reached anything, in plain words');
  if (kind === 'tuned') check(/0\.31/.test(await page.locator('#tuning').innerText()), 'the found gain is named');
  if (kind === 'failures') check(text.includes('No trial reached its goal'), 'only failures: the arrival figure says so');
  await context.close();
}

// ---- more trials than a page carries --------------------------------------------------------------------------------
if (moma !== undefined) {
  const html = join(work, 'part.html');
  execFileSync(moma, ['report', join(work, 'demo.db'), '-o', html, '--trials', '31'], { stdio: 'ignore' });
  const { context, page } = await open(html);
  check((await page.locator('.notices').innerText()).replace(/\s/g, ' ').includes('Of 120 trials the page shows 30 one by one'), 'a part of the trials is called one');
  check((await page.locator('.summary tbody tr').last().innerText()).includes('60'), 'the summary is over all');
  await context.close();
}

// ---- several stores in one page ------------------------------------------------------------------------------------
{
  const [before, after, html] = ['before.db', 'after.db', 'both.html'].map((name) => join(work, name));
  for (const [kind, db] of [['demo', before], ['demo', after]]) {
    execFileSync('python3', [join(source, 'tests/tools/make_store.py'), process.env.MOMA_STORE_DEFINITION, db, '--kind', kind, '--worlds', '20', '--samples', '2']);
  }
  execFileSync('python3', ['-c', `import sqlite3; db = sqlite3.connect(${JSON.stringify(after)}); db.execute("UPDATE suite SET name = 'later'"); `
    + 'db.execute("UPDATE trial SET outcome = \'success\', time_to_goal_s = 5.0"); db.commit(); db.close()']);
  execFileSync(makeReport, [before, after, html], { stdio: 'inherit' });
  const both = dataOf(html);
  const { context, page } = await open(html);
  check((await page.locator('h1').innerText()) === 'courier-clutter + later', 'two suites, one title');
  check((await page.locator('.verdict').count()) === 4, 'four controllers of two stores, four verdicts');
  await page.locator('#comparison').scrollIntoViewIfNeeded();
  await page.waitForSelector('#comparison tbody tr');
  const rows = await page.locator('#comparison tbody tr').allInnerTexts();
  const cells = both.trials.columns;
  const texts = (name) => cells[name].codes.map((code) => cells[name].values[code] ?? null);
  const [controllers, outcomes, worlds] = ['controller', 'outcome', 'world_key'].map(texts);
  const successes = (who) => new Map(controllers.flatMap((c, i) => (c === who ? [[worlds[i], outcomes[i] === 'success']] : [])));
  const base = successes('holistic (before)');
  for (const who of ['moma (before)', 'holistic (after)', 'moma (after)']) {
    const theirs = successes(who);
    const points = (100 * [...base].reduce((sum, [world, ok]) => sum + Number(theirs.get(world)) - Number(ok), 0)) / base.size;
    const wanted = `${points > 0 ? '+' : ''}${points.toFixed(1).replace('-', '\u2212')}`;
    check(rows.some((row) => row.includes(who) && row.includes(wanted)), `paired difference of ${who}: ${wanted} points, in ${JSON.stringify(rows)}`);
  }
  await page.locator('#trials input[type=search]').fill('after');
  await page.locator('#trials .rows .row').first().click();
  check(/^moma replay (before|after)\.db /.test(await page.locator('.detail code').innerText()), 'the command names a store that holds the trial');
  await context.close();
}

// ---- served by moma view, while a run goes on -----------------------------------------------------------------------
{
  const db = join(work, 'served.db');
  execFileSync('python3', [join(source, 'tests/tools/make_store.py'), process.env.MOMA_STORE_DEFINITION, db, '--kind', 'demo', '--worlds', '20', '--samples', '3']);
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
  // Whether a run that never said how it ended goes on: its program holds the store's lock, or does not.
  const lock = `${db}-lock`;
  writeFileSync(lock, '');
  await page.waitForFunction(() => /was killed/.test(document.querySelector('.live').textContent));
  check(!(await page.locator('.live').getAttribute('class')).includes('running'), 'a killed run is not called live');
  check(/The last run was killed/.test(await page.locator('.notices').innerText()), `the notices say so: ${await page.locator('.notices').innerText()}`);
  const holder = spawn('python3', ['-c', `import fcntl, sys; f = open(${JSON.stringify(lock)}); fcntl.flock(f, fcntl.LOCK_EX); print("held", flush=True); sys.stdin.read()`], { stdio: ['pipe', 'pipe', 'inherit'] });
  await new Promise((done) => holder.stdout.once('data', done));
  await page.waitForFunction(() => /30 of 40\strials \(75\s%\).*a run goes on/.test(document.querySelector('.live').textContent));
  check(/interim/.test(await page.locator('.notices').innerText()), 'what is shown before the end is called interim');
  check((await page.locator('#trials footer .note').innerText()).startsWith('30'), 'the trials so far');
  await page.locator('.atlas .play').first().click();
  await page.waitForSelector('.stage-box[data-trial]');
  await page.waitForFunction(() => Number(document.querySelector('.transport input[type=range]').value) > 0.05);
  await page.locator('.transport .play').click();
  sql("INSERT INTO point_trial SELECT * FROM kept; DROP TABLE kept; UPDATE invocation SET status = 'finished';");
  holder.stdin.end();
  await page.waitForFunction(() => document.querySelector('#trials footer .note').textContent.startsWith('40'));
  check((await page.locator('.summary tbody tr').last().locator('td').first().innerText()) === '20', 'the summary has followed');
  check((await page.locator('.live').innerText()).includes('no run is going on'), 'the end of the run is told');
  stopped = true;
  server.kill('SIGTERM');
  check((await ended) === 0, 'the server ends cleanly');
  await page.waitForFunction(() => document.querySelector('.live').textContent.startsWith('moma view has ended'));
  await context.close();
}

// ---- trials that moma simulated: robots, worlds and samples as the program writes them -----------------------------
const suites = [['frankie', 'robots/frankie.yaml', 'clutter', '{}'], ['tiago', 'robots/examples/tiago.yaml', 'moving', '{}'],
  ['rows', 'robots/frankie.yaml', 'moving', join(source, 'configs/controllers/moma-reactive.yaml')]];
for (const [name, robot, family, controller] of moma === undefined ? [] : suites) {
  const suite = join(work, `${name}.yaml`);
  writeFileSync(suite, `name: ${name}\nrobot: ${join(source, 'configs', robot)}\ncontrollers: {moma: ${controller}}\nworlds: {seed: 5, families: `
    + `{${family}: {weight: 1}}}\nsimulation: {mode: kinematic, time_limit: 8}\ntrials: 3\nsamples: all\n`);
  execFileSync(moma, ['run', suite, '-o', join(work, `${name}.db`), '--quiet'], { stdio: ['ignore', 'ignore', 'inherit'] });
  execFileSync(moma, ['report', join(work, `${name}.db`), '-o', join(work, `${name}.html`)], { stdio: 'ignore' });
  const html = join(work, `${name}.html`);
  const { context, page } = await open(html, { ratio: name === 'rows' ? 2 : 1 });
  await page.locator('#replay').scrollIntoViewIfNeeded();
  // A robot whose URDF has visual meshes is shown as these, or as its shapes.
  const looks = Object.values(dataOf(html).looks);
  check(looks.length === (name === 'tiago' ? 1 : 0), `${name}: ${looks.length} looks`);
  await page.waitForSelector('.stage-box[data-triangles]');
  const triangles = async () => Number(await page.locator('.stage-box').getAttribute('data-triangles'));
  const switched = page.locator('.transport label', { hasText: 'shapes' });
  check((await switched.isVisible()) === (looks.length > 0), `${name}: shapes are a switch where there is something else`);
  if (looks.length > 0) {
    const seen = await triangles();
    check(seen > 5000 && seen < 26000, `${name}: ${seen} triangles of its meshes`);
    await switched.click();
    const plain = await triangles();
    check(plain !== seen, `${name}: as shapes ${plain} triangles, else ${seen}`);
    await switched.click();
    check((await triangles()) === seen, `${name}: and back`);
    if (screenshots !== undefined) await page.locator('.replay').screenshot({ path: join(screenshots, 'replay-meshes.png') });
  }
  check(dataOf(html).replays.length === 3, `${name}: all trials can be played`);
  await checkKinematics(page, dataOf(html));
  // Collision rows follow from poses and commands in the page; the controller stored the least distance and how many
  // constraints were active.
  let [seen, active, ends, passing] = [0, 0, 0, 0];
  for (const [i, replay] of dataOf(html).replays.entries()) {
    await page.locator('.shelf button').nth(i).click();
    await page.waitForFunction((trial) => document.querySelector('.stage-box').dataset.trial === trial, replay.trial);
    const [times, least, rows, fallback, status] = ['t', 'least_distance', 'active_rows', 'fallback', 'status'].map((column_) => column(replay, column_));
    const looks = Array.from({ length: Math.ceil(replay.n / 7) }, (_, i_) => 7 * i_);
    const all = await page.evaluate((moments) => moments.map((t) => {
      const input = document.querySelector('.transport input[type=range]');
      input.value = t;
      input.dispatchEvent(new Event('input', { bubbles: true }));
      const box = document.querySelector('.stage-box').dataset;
      return { least: box.leastDistance, active: Number(box.activeRows), room: Number(box.leastRoom), ends: Number(box.ends), passing: Number(box.passing) };
    }), looks.map((k) => times[k]));
    for (const [at, k] of looks.entries()) {
      const shown = { ...all[at], least: all[at].least === '' ? Infinity : Number(all[at].least) };
      if (least[k] < 0.29) {
        seen += 1;
        check(near(shown.least, least[k], 1e-5), `${name}: at ${times[k]} s the nearest object is ${shown.least} m away, stored ${least[k]} m`);
      }
      if (fallback[k] === 0) check(shown.active <= rows[k], `${name}: at ${times[k]} s ${shown.active} active collision rows of ${rows[k]} active constraints`);
      active += shown.active;
      ends += shown.ends;
      passing += shown.passing;
      // The solver kept its rows of ends and of passing objects: were those of the page others, the command would break some.
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
  writeFileSync(suite, `name: sight\nrobot: ${join(source, 'configs/robots/frankie.yaml')}\ncontrollers: {one: {}, two: ${join(source, 'configs/controllers/moma-reactive.yaml')}}\n`
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
  await page.waitForSelector('.paired-words:not(.found):not(.soon) p', { timeout: 20000 }).catch(() => undefined);
  check((await page.locator('.paired-words:not(.found):not(.soon)').count()) === 1, 'under one condition they are compared');
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
end('the page');
