// The report page in a real browser, offline: page_test.mjs SOURCE_DIR MAKE_REPORT WORK_DIR [MOMA]
// With the program MOMA, also pages of trials that it simulates.
// Exit 0: passed; 1: failed; 77: left out, since node's packages, python3 or chromium are missing.
import { execFileSync, spawnSync } from 'node:child_process';
import { existsSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

import { accessible, check, dataOf, end, figuresFollow, figuresStand, launch, near, noOverflow, opener, saved, showTip, workshop } from './kit.mjs';

const [, , source, makeReport, work, moma] = process.argv;
const { makeStore, makePage: pageOf, sql } = workshop(source, makeReport, work);
const makePage = (kind, worlds) => pageOf(makeStore(kind, kind, worlds, kind === 'demo' ? 8 : 2));
const browser = await launch(source);
const open = opener(browser);

// ---- what every reader sees ---------------------------------------------------------------------------------------
const demo = makePage('demo', 60);
const data = dataOf(demo);
const text = (name) => data.trials.columns[name].codes.map((code) => data.trials.columns[name].values[code] ?? null);
const { context: first, page } = await open(demo, { idle: true });
{
  await page.waitForSelector('.verdict');
  const verdicts = await page.locator('.verdict').allInnerTexts();
  check(verdicts.length === 2, 'two controllers, two verdicts');
  data.overall.forEach((row, i) => {
    check(verdicts[i].includes((100 * row.success_rate).toFixed(1)), `verdict ${i} names the success rate`);
    check(verdicts[i].includes(`${(100 * row.success_low).toFixed(1)}\u2013${(100 * row.success_high).toFixed(1)}`), `verdict ${i} names the interval`);
  });
  for (const row of [...data.summary, ...data.overall]) {
    const cells = await page.locator('.summary tbody tr').filter({ has: page.locator('td') }).allInnerTexts();
    const wanted = [String(row.n), row.manip_mean.toFixed(4), `${(100 * row.success_low).toFixed(1)}\u2013${(100 * row.success_high).toFixed(1)}`];
    check(cells.some((text) => text.includes(row.controller) && wanted.every((part) => text.includes(part))), `summary row ${JSON.stringify(row)}`);
  }
  await noOverflow(page, '1280');

  // By how much, world by world, and where the one that is behind fails; counted here anew.
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
  const fails = await page.locator('.fails').boundingBox();
  check(fails.y + fails.height < 900, `the verdict, its axis and where the one behind fails are on the first screen: they end at ${fails.y + fails.height}`);
  // One name for a section, in the bar and over it; the best value is bold, and in no controller's colour.
  const names = await page.evaluate(() => [[...document.querySelectorAll('nav a')], [...document.querySelectorAll('main > section > h2')]].map((all) => all.map((one) => one.textContent)));
  check(names[0].length > 8 && names[0].join() === names[1].join(), `sections are called ${names[1]}, and ${names[0]} in the bar`);
  const cells = await page.locator('.summary td:nth-child(3) b').evaluateAll((all) => all.map((b) => ({ best: b.closest('tr').classList.contains('best'), weight: Number(getComputedStyle(b).fontWeight), colour: getComputedStyle(b).color })));
  check(cells.filter(({ best }) => best).length === 3 && cells.every(({ best, weight }) => (weight > 600) === best) && new Set(cells.map(({ colour }) => colour)).size === 1, `the best of each group is bold, in the colour of all: ${JSON.stringify(cells)}`);
  check(new RegExp(`^holistic fails .* of ${failures}.failures\\.$`).test(await page.locator('.fails').innerText()), `where it fails: ${await page.locator('.fails').innerText()}`);

  // The table of results sorts by any column.
  const top = async () => (await page.locator('.summary tbody').last().locator('tr').nth(1).innerText());
  await page.locator('.summary').getByRole('button', { name: 'Success' }).click();
  const best = data.overall.reduce((a, b) => (a.success_rate >= b.success_rate ? a : b)).controller;
  check((await top()).includes(best), 'sorted by success, the best is first');
  check((await page.locator('.summary th[aria-sort]').getAttribute('aria-sort')) === 'descending', 'the column says how it is sorted');
  await page.locator('.summary').getByRole('button', { name: 'Success' }).click();
  check(!(await top()).includes(best), 'once more, and it is last');
  await page.locator('.summary').getByRole('button', { name: 'Success' }).click();

  // Figures are drawn though nobody scrolls. Each saves itself as SVG and its data as CSV, and says its n.
  await figuresStand(page);
  const [download] = await Promise.all([page.waitForEvent('download'), page.locator('#figure-forest').getByText('Data CSV').click()]);
  const file = readFileSync(await download.path(), 'utf8');
  check(download.suggestedFilename() === 'forest.csv', `a file of the figure's name: ${download.suggestedFilename()}`);
  check(file === await saved(page, page.locator('#figure-forest').getByText('Data CSV')), 'with what the page gives');
  for (const id of await page.locator('.figure').evaluateAll((all) => all.map((f) => f.id))) {
    const figure = page.locator(`#${id}`);
    check((await figure.locator('canvas').count()) > 0, `${id} is drawn`);
    check(/n = \d/.test(await figure.locator('.note').innerText()), `${id} states n`);
    const drawing = await saved(page, figure.getByText('Save SVG'));
    check(drawing.startsWith('<svg') && drawing.includes('<path') && drawing.length > 2000, `${id} saves an SVG`);
    const table = await saved(page, figure.getByText('Data CSV'));
    check(table.split('\n').length > 3, `${id} saves its data`);
    if (id === 'figure-arrival') {
      const lines = table.trim().split('\n').slice(1).map((line) => line.split(','));
      for (const row of data.overall) {
        const last = lines.filter((line) => line[0] === row.controller).pop();
        check(near(Number(last[3]), row.success_rate, 1e-12) && near(Number(last[4]), row.success_low, 1e-12)
          && near(Number(last[5]), row.success_high, 1e-12), `${row.controller}'s curve ends at its success rate`);
      }
    }
  }

  // A title names the metric that is chosen, as the axis does.
  const quality = page.locator('#figure-manipulability');
  await quality.locator('select').selectOption('path_ee_m');
  check((await quality.locator('h3').innerText()) === 'Path of the end effector', `a title names its metric: ${await quality.locator('h3').innerText()}`);
  check((await saved(page, quality.getByText('Save SVG'))).includes('>path of the end effector [m]<'), 'and so does the axis');
  await quality.locator('select').selectOption('manip_mean');

  // The table of trials.
  const outcomes = data.trials.columns.outcome;
  const stuck = outcomes.codes.filter((code) => outcomes.values[code] === 'stuck').length;
  const note = page.locator('#trials footer .note');
  await page.locator('#trials input[type=search]').fill('stuck');
  check((await note.innerText()).startsWith(`${stuck} of 120`), `filter finds ${stuck} stuck trials: ${await note.innerText()}`);
  check(page.url().includes('q=stuck'), 'the address keeps the filter');
  // Words that find more and fewer from one to the next, by the data row by row: how many, and those that are drawn in their order.
  const columns = data.trials.columns;
  const texts = Array.from({ length: 120 }, (_, row) => [
    ...['trial', 'controller', 'point', 'family', 'outcome', 'link', 'object', 'reason'].map((key) => columns[key]?.values[columns[key].codes[row]] ?? ''), `world:${columns.world[row]}`,
  ].map((text) => text.toLowerCase()));
  const byWorld = texts.map((_, row) => row).sort((a, b) => columns.world[a] - columns.world[b] || columns.controller.codes[a] - columns.controller.codes[b]);
  const part = texts[7][0].slice(-5);
  for (const query of ['s', 'ST', 'stu', 'world:1', '1', 'o', 'ob', `stuck ${part}`, part, 'world:2 tim', 'nothing has this', 'success world:3', 'succ']) {
    await page.locator('#trials input[type=search]').fill(query);
    const rows = byWorld.filter((row) => query.toLowerCase().split(' ').every((word) => texts[row].some((text) => text.includes(word))));
    const names = await page.locator('#trials .rows .row').evaluateAll((lines) => lines.map((line) => [line.style.top, line.dataset.trial, line.children[0].textContent.slice(0, line.dataset.trial.length)].join(' ')));
    const expected = rows.slice(0, names.length).map((row, i) => { const name = columns.trial.values[columns.trial.codes[row]]; return `${34 * i}px ${name} ${name}`; });
    check((await note.innerText()).replace(/\s/g, ' ').startsWith(rows.length === 120 ? '120 trials' : `${rows.length} of 120`), `"${query}" finds ${rows.length}: ${await note.innerText()}`);
    check(names.length >= Math.min(rows.length, 14) && names.join() === expected.join(), `and draws them: ${names} for ${expected}`);
  }
  await page.locator('#trials .grid-scroll').evaluate((box) => { box.scrollTop = 1000; });
  await page.waitForFunction(() => document.querySelector('#trials .rows .row').style.top !== '0px');
  const tops = await page.locator('#trials .rows .row').evaluateAll((lines) => lines.map((line) => parseFloat(line.style.top)));
  check(tops[0] <= 1000 && tops.at(-1) >= 1000 + 420 - 34 && tops.every((top, i) => top === tops[0] + 34 * i), `rows follow the scroll: ${tops}`);
  await page.locator('#trials input[type=search]').fill('stuck');
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
  for (const id of ['figure-scatter', 'figure-paired']) {
    await page.evaluate(() => { location.hash = ''; });
    check(await clickMark(page, id), `${id} has a mark to click`);
    await page.waitForFunction(() => location.hash.includes('trial='));
    const trial = new URLSearchParams(new URL(page.url()).hash.slice(1)).get('trial');
    if (inPage.has(trial)) await page.waitForSelector(`.stage-box[data-trial="${trial}"]`);
    else check((await page.locator('.detail code').innerText()).endsWith(trial), `${id}: the command that plays ${trial}`);
    check(id !== 'figure-paired' || text('world_key')[text('trial').indexOf(new URLSearchParams(new URL(page.url()).hash.slice(1)).get('beside'))] === text('world_key')[text('trial').indexOf(trial)], 'a paired dot opens both trials of its world');
    // A trial that is chosen stands out, wherever that happened, until it is chosen no more.
    const picture = await page.locator(`#${id} canvas`).evaluate((canvas) => canvas.toDataURL());
    await page.evaluate(() => { location.hash = location.hash.replace(/trial=[^&]*/, ''); });
    check(await page.waitForFunction(([figure, marked]) => document.querySelector(`#${figure} canvas`).toDataURL() !== marked, [id, picture], { timeout: 20000 }).then(() => true, () => false), `the chosen trial is marked in ${id}`);
    await page.evaluate(() => { const button = document.querySelector('.transport .play'); if (button.textContent === 'Pause') button.click(); });
  }
  await page.evaluate(() => { location.hash = ''; });
  check(await clickMark(page, 'figure-outcomes'), 'outcomes have bars to click');
  await page.waitForFunction(() => location.hash.includes('outcome='));
  check(/^\d+ of 120/.test((await page.locator('#trials footer .note').innerText()).replace(/\s/g, ' ')), 'a bar lists its trials');
}

// ---- light, dark, narrow ----------------------------------------------------------------------------------------------
{
  const surface = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  const light = await surface();
  for (const scheme of ['light', 'dark']) {
    if (scheme === 'dark') await page.locator('.toolbar').getByText('Dark').click();
    await figuresStand(page); // drawn anew for each
    check((await page.evaluate(() => document.documentElement.dataset.theme)) === scheme, `the page is ${scheme}`);
    // A tooltip is in the page's colours, and is looked at with it.
    const tip = await showTip(page, 'figure-outcomes');
    check(tip !== null, `${scheme}: a figure has a tooltip`);
    const ink = await page.evaluate(() => getComputedStyle(document.body).color);
    check(tip === ink, `${scheme}: the tooltip's text is ${tip}, the page's ${ink}`);
    await accessible(page, source, scheme, { view: scheme === 'dark' });
  }
  check((await surface()) !== light, 'dark differs from light');
  await page.setViewportSize({ width: 390, height: 900 });
  await page.waitForFunction(() => innerWidth === 390);
  await noOverflow(page, '390');
  await first.close();
}

// ---- odd stores -------------------------------------------------------------------------------------------------------
for (const [kind, worlds] of [['empty', 0], ['failures', 16]]) {
  const { context, page } = await open(makePage(kind, worlds), { near: true });
  for (const width of [1280, 390]) {
    await page.setViewportSize({ width, height: 900 });
    await page.waitForFunction((wanted) => innerWidth === wanted, width);
    await figuresFollow(page);
    await noOverflow(page, `${kind}, ${width}`);
  }
  const text = await page.locator('#app').innerText();
  check(!/NaN|undefined|\[object/.test(text), `${kind}: ${/.{0,40}(NaN|undefined|\[object).{0,40}/.exec(text)?.[0]}`);
  if (kind === 'empty') check(text.includes('holds no trials yet'), 'an empty store says so');
  if (kind === 'failures') check(/neither \w+ nor \w+ reached a goal: nothing tells them apart/.test(text) && !/p\s=\s1\.000/.test(await page.locator('#top').innerText()), 'nobody reached anything, in plain words');
  if (kind === 'failures') check(text.includes('No trial reached its goal'), 'only failures: the arrival figure says so');
  await context.close();
}

// ---- more trials than a page carries, of a robot that was read leniently ---------------------------------------------------
if (moma !== undefined) {
  const html = join(work, 'part.html');
  writeFileSync(join(work, 'notes.md'), 'Seen **twice**.\n\n<b>no markup</b>');
  execFileSync(moma, ['report', join(work, 'demo.db'), '-o', html, '--trials', '31', '--notes', join(work, 'notes.md')], { stdio: 'ignore' });
  writeFileSync(html, readFileSync(html, 'utf8').replaceAll('"left_out":[]', '"left_out":["link arm, collision 1: sphere radius=0,5"]'));
  const { context, page } = await open(html);
  const notices = (await page.locator('.notices').innerText()).replace(/\s/g, ' ');
  check((await page.locator('.notes strong').innerText()) === 'twice' && (await page.locator('.notes b').count()) === 0, `what its author writes: ${await page.locator('.notes').innerText()}`);
  check(notices.includes('Of 120 trials the page shows 30 one by one'), 'a part of the trials is called one');
  check(notices.includes('left out (--lenient), so that nothing can collide with what is missing: link arm, collision 1'), 'what was left out of a robot is told');
  check((await page.locator('.summary tbody tr').last().innerText()).includes('60'), 'the summary is over all');
  await context.close();
}

// ---- several stores in one page ------------------------------------------------------------------------------------
{
  const [before, after, html] = ['before.db', 'after.db', 'both.html'].map((name) => join(work, name));
  for (const name of ['before', 'after']) makeStore(name, 'demo', 20, 2);
  sql(after, "UPDATE suite SET name = 'later'; UPDATE trial SET outcome = 'success', time_to_goal_s = 5.0");
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

// ---- disturbances: what points differ by, and failures for want of sight --------------------------------------------
if (moma !== undefined) {
  const suite = join(work, 'sight.yaml');
  writeFileSync(suite, `name: sight\nrobot: ${join(source, 'configs/robots/frankie.yaml')}\ncontrollers: {one: {}, two: ${join(source, 'configs/controllers/moma-reactive.yaml')}}\n`
    + 'worlds: {seed: 12, families: {clutter: {weight: 1}}}\nsimulation: {mode: kinematic, time_limit: 6}\ntrials: 8\nsamples: failures\n'
    + `sweep: {axes: {disturbances: [none, {objects: {range: 0.3}}, ${join(source, 'configs/disturbances/realistic.yaml')}]}}\n`);
  execFileSync(moma, ['run', suite, '-o', join(work, 'sight.db'), '--quiet'], { stdio: ['ignore', 'ignore', 'inherit'] });
  execFileSync(moma, ['report', join(work, 'sight.db'), '-o', join(work, 'sight.html')], { stdio: 'ignore' });
  const told = dataOf(join(work, 'sight.html'));
  // A page, written and handed to the reader's browser; no file of the reader's is replaced.
  const [browserOf, opened] = [join(work, 'browser.sh'), join(work, 'opened')];
  writeFileSync(browserOf, `#!/bin/sh\nprintf %s "$1" > '${opened}'\n`, { mode: 0o755 });
  const [store, written] = ['before.db', 'before.html'].map((name) => join(work, name));   // a small one
  const openStore = () => spawnSync(moma, ['open', store], { env: { ...process.env, BROWSER: browserOf }, encoding: 'utf8' });
  check(openStore().status === 0 && readFileSync(opened, 'utf8') === written && dataOf(written).points.length === 2, 'moma open writes the page and opens it');
  rmSync(opened);
  writeFileSync(written, 'notes of mine');
  check(openStore().status === 2 && readFileSync(written, 'utf8') === 'notes of mine' && !existsSync(opened), 'moma open replaces nothing but a page');
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
  await page.waitForSelector('.paired-words:not(.found):not(.soon) p');
  check((await page.locator('.paired-words:not(.found):not(.soon)').count()) === 1, 'under one condition they are compared');
  const origin = await page.locator('#provenance').innerText();
  check(/objects\.range/.test(origin), 'provenance lists the values');
  check(/urdfdom \d/.test(origin) && !/ ,/.test(origin), `every library has its version: ${/Libraries.*/s.exec(origin)?.[0].slice(0, 200)}`);
  await noOverflow(page, 'conditions');
  await context.close();
}

await browser.close();
end('the page');
