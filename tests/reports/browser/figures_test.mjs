// Figures of many points and of a search for gains, as they are drawn: figures_test.mjs SOURCE_DIR MAKE_REPORT WORK_DIR
// What stands on their canvases is read letter by letter and pixel by pixel, at both pixel ratios, light and dark, on a
// phone; from the print by the lines that are printed.
// Exit 0: passed; 1: failed; 77: left out, since node's packages, python3 or chromium are missing.

import { execFileSync } from 'node:child_process';
import { join } from 'node:path';

import { accessible, check, dataOf, drawn, end, launch, legible, near, needs, noOverflow, noteLetters, opener, saved, workshop } from './kit.mjs';

const [, , source, makeReport, work] = process.argv;
needs('python3');
const { makeStore, makePage, sql } = workshop(source, makeReport, work);
const browser = await launch(source);
const open = opener(browser);

/** The letters on the canvas of a figure, and its size. */
const lettersOf = async (page, id) => {
  await page.locator(`#figure-${id}`).scrollIntoViewIfNeeded();
  await page.waitForSelector(`#figure-${id} canvas`);
  await drawn(page);
  return page.locator(`#figure-${id} .plot`).evaluate((plot) => {
    const layers = [...plot.querySelectorAll('canvas')];   // one over the other
    const { width, height } = layers[0];
    return { width, height, letters: layers.flatMap((layer) => layer.letters ?? []) };
  });
};

/** The same with its pixels: `at` gives red, green, blue and opacity. Reading them takes its time. */
const read = async (page, id) => {
  const { width, height, letters } = await lettersOf(page, id);
  const pixels = await page.locator(`#figure-${id} .plot`).evaluate((plot) => {
    const layers = [...plot.querySelectorAll('canvas')];
    const { width, height } = layers[0];
    const all = Object.assign(document.createElement('canvas'), { width, height }).getContext('2d', { willReadFrequently: true });
    for (const layer of layers) all.drawImage(layer, 0, 0);
    const { data } = all.getImageData(0, 0, width, height);
    let text = '';
    for (let i = 0; i < data.length; i += 32768) text += String.fromCharCode(...data.subarray(i, i + 32768));
    return btoa(text);
  });
  const bytes = Buffer.from(pixels, 'base64');
  return { width, height, letters, at: (x, y) => [...bytes.subarray(4 * (Math.round(y) * width + Math.round(x)), 4 * (Math.round(y) * width + Math.round(x)) + 4)] };
};
const rgb = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));
const like = (a, b, tolerance) => a.slice(0, 3).every((v, i) => near(v, b[i], tolerance));
const luminance = (of) => of.slice(0, 3).map((v) => (v / 255 <= 0.04045 ? v / 255 / 12.92 : ((v / 255 + 0.055) / 1.055) ** 2.4)).reduce((sum, v, i) => sum + [0.2126, 0.7152, 0.0722][i] * v, 0);
const contrast = (a, b) => { const [high, low] = [luminance(a), luminance(b)].sort((x, y) => y - x); return (high + 0.05) / (low + 0.05); };

const csv = async (page, id) => {
  const [head, ...lines] = (await saved(page, page.locator(`#figure-${id}`).getByText('Data CSV'))).trim().split('\n').map((line) => (line.match(/("([^"]|"")*"|[^,]*)(,|$)/g) ?? []).map((cell) => cell.replace(/,$/, '').replace(/^"|"$/g, '')));
  return lines.map((line) => Object.fromEntries(head.map((name, i) => [name, line[i]])));
};
const percent = (share) => `${share === 0 || share === 1 ? (100 * share).toFixed(0) : (100 * share).toFixed(1)} %`;

const swept = makePage(makeStore('sweep', 'sweep', 80, 0, 0, '--search'));
const all = dataOf(swept);
const [search] = all.tuning;
// The search's own suite has no trials.
const [points, overall] = [all.points, all.overall].map((of) => of.filter((one) => one.suite === 'courier-clutter'));
const short = (key) => key.replace(/^controllers?\./, '');

/** Success over two gains: a bar of colours with its ends written, cells of its colours with rate and interval in them. */
const heat = async (page, what, ratio) => {
  const seen = await read(page, 'heat');
  legible(seen, `${what}, heat map`);
  const rates = overall.map((row) => row.success_rate);
  const [low, high] = [Math.min(...rates), Math.max(...rates)];
  const bar = seen.letters.filter((letter) => letter.y < 40 * ratio).sort((a, b) => a.left - b.left);
  check(bar.map((letter) => letter.text).join() === [low, high].map(percent).join(), `${what}: the ends of the bar of colours are written: ${bar.map((letter) => letter.text)}`);
  if (bar.length !== 2) return;
  // Within the bar, which lies between its ends' names.
  const row = Array.from({ length: Math.floor(bar[1].left - bar[0].right) }, (_, i) => seen.at(bar[0].right + i, bar[0].y));
  const filled = row.map((pixel, i) => ({ pixel, i })).filter(({ pixel }) => pixel[3] === 255);
  const colours = filled.map(({ pixel }) => pixel);
  check(colours.length > 60 * ratio, `${what}: the bar is ${colours.length} pixels long`);
  if (colours.length === 0) return;
  const tenths = Array.from({ length: 9 }, (_, i) => luminance(colours[Math.round((0.1 + 0.1 * i) * (colours.length - 1))]));
  check(new Set(tenths.slice(1).map((of, i) => Math.sign(of - tenths[i]))).size === 1, `${what}: the bar goes one way, from light to dark or back`);
  for (const of of overall) {
    const [rate, interval] = [percent(of.success_rate), `${(100 * of.success_low).toFixed(1)}\u2013${(100 * of.success_high).toFixed(1)} %`];
    const inside = seen.letters.filter((letter) => letter.y > 40 * ratio && letter.text === interval);
    check(inside.length > 0, `${what}: a cell has the interval ${interval}`);
    for (const letter of inside) {
      const above = seen.letters.filter((other) => other.text === rate && Math.abs(other.left + other.right - letter.left - letter.right) < 6 * ratio && letter.y - other.y > 6 * ratio && letter.y - other.y < 20 * ratio);
      check(above.length === 1, `${what}: above ${interval} stands ${rate}`);
      const ground = seen.at(letter.left - 2 * ratio, letter.y);
      const wanted = colours[Math.round(((of.success_rate - low) / (high - low)) * (colours.length - 1))];
      check(like(ground, wanted, 8), `${what}: the cell of ${rate} is ${ground}, the bar there ${wanted}`);
      check(contrast(rgb(letter.colour.length === 4 ? `#${[...letter.colour.slice(1)].map((c) => c + c).join('')}` : letter.colour), ground) >= 4.5, `${what}: ${letter.colour} on ${ground} can be read`);
    }
  }
};

/** A plot of its own for each of `names`, in their order. */
const apart = async (page, id, names, what, ratio) => {
  const seen = await read(page, id);
  legible(seen, `${what}, ${id}`);
  const titles = seen.letters.filter((letter) => names.includes(letter.text)).sort((a, b) => (Math.abs(a.y - b.y) > 4 * ratio ? a.y - b.y : a.left - b.left));
  check(titles.map((letter) => letter.text).join('|') === names.join('|'), `${what}: ${id} has a plot each of ${names.join('|')}: ${titles.map((letter) => letter.text).join('|')}`);
  // Below each title something is drawn that is neither a line of the grid nor text.
  for (const title of titles) {
    let marks = 0;
    for (let y = title.y + 14 * ratio; y < Math.min(seen.height, title.y + 130 * ratio); y += 1) {
      for (let x = title.left; x < Math.min(seen.width, title.left + 120 * ratio); x += 2) {
        const [r, g, b, a] = seen.at(x, y);
        if (a > 150 && Math.max(r, g, b) - Math.min(r, g, b) > 50) marks += 1;
      }
    }
    check(marks > 50 * ratio, `${what}: the plot of ${title.text} in ${id} shows ${marks} pixels in colour`);
  }
  return seen;
};

const views = [
  ['light', { width: 1440, height: 900, ratio: 1 }], ['dark', { width: 960, height: 480, ratio: 2, scheme: 'dark' }], ['phone', { width: 390, height: 600, ratio: 2, touch: true }],
];
const levels = [...new Set(points.flatMap((point) => Object.keys(point.params)))];
const best = [...overall].sort((a, b) => b.success_rate - a.success_rate);
for (const [what, view] of views) {
  const { context, page } = await open(swept, { ...view, init: noteLetters });
  const { ratio } = view;
  await heat(page, what, ratio);
  await apart(page, 'slices', levels.map(short), what, ratio);
  // A slice for each gain, the one that explains most first; the value that was found stands below its line.
  const ranked = [...search.variables].sort((a, b) => b.importance - a.importance);
  const slices = await apart(page, 'sensitivity', ranked.map((v) => short(v.key)), what, ratio);
  for (const v of ranked) check(slices.letters.some((letter) => letter.text === String(Number(v.found.toPrecision(3)))), `${what}: the value found for ${v.key} is a mark of its axis`);
  // More controllers than can be told apart in one plot.
  const shown = (await csv(page, 'difficulty')).map((row) => Object.values(row).slice(0, 2).join());
  const named = [...new Set(shown)].map((name) => points.find((point) => `${point.controller},${point.point}` === name.replace(/"/g, '')).point.replace(/\S+=/g, '').replace(' ', ', '));
  check(named.length === 6, `${what}: the best few are six: ${named}`);
  await apart(page, 'difficulty', named, what, ratio);
  if (what === 'light') await apart(page, 'timing', named, what, ratio);
  for (const id of what === 'light' ? ['pareto', 'forest', 'heldout', 'search', 'arrival', 'paired'] : what === 'phone' ? ['heldout', 'pareto', 'forest', 'outcomes', 'timing'] : []) legible(await lettersOf(page, id), `${what}, ${id}`);
  await noOverflow(page, what);
  await accessible(page, source, what, { parts: '#tuning, #difficulty, #sweep', view: what !== 'light' });
  if (what === 'light') {
    // A plot for each metric that was compared on held-out worlds, under its name.
    const compared = [...new Set(search.comparisons.filter((one) => one.difference !== null).map((one) => one.metric))].map((key) => {
      const { name = key, unit = '' } = all.metrics.find((one) => one.key === key) ?? (key === 'objective' ? {} : { name: `${key} rate`, unit: 'points' });
      return unit === '' ? name : `${name} [${unit}]`;
    });
    const texts = (await lettersOf(page, 'heldout')).letters.map((letter) => letter.text);
    check(compared.length > 2 && compared.every((name) => texts.includes(name)), `light: heldout has a plot each of ${compared.join('|')}: ${texts.join('|')}`);
    // The front, found by comparing all with all, for both costs.
    for (const [cost, key] of [['command_change_mean', 'command_change_mean'], ['collision_rate', 'collision_rate']]) {
      await page.locator('#figure-pareto select').selectOption(cost);
      const pairs = overall.map((row) => [row[key], row.success_rate]);
      const beats = (a, b) => a[0] <= b[0] && a[1] >= b[1] && (a[0] < b[0] || a[1] > b[1]);
      const front = new Set(pairs.filter((point) => !pairs.some((other) => beats(other, point))).map(String)).size;
      check((await page.locator('#figure-pareto .note').innerText()).includes(`${front}\u00a0point`), `${front} points on the front of ${cost}: ${await page.locator('#figure-pareto .note').innerText()}`);
    }
    // Sorted, and the best against the baseline, everywhere.
    const table = await page.locator('.summary tbody').last().locator('tr td:nth-child(3) b').allInnerTexts();
    check(table.map((cell) => cell.replace(/\s/g, ' ')).join() === best.map((row) => percent(row.success_rate)).join(), `the table is sorted by success: ${table}`);
    const top = await page.locator('.paired-words').last().innerText();
    check(top.includes(points[0].point) && top.includes(best[0].point), `the best is compared with the baseline ${points[0].point}: ${top}`);
    const [a, b] = await page.locator('#figure-paired').evaluate((figure) => [...figure.querySelectorAll('label.choice')].filter((label) => /^Along/.test(label.textContent)).map((label) => label.querySelector('select').selectedOptions[0].textContent));
    check(a === '0.001, 0.25' && b === best[0].point.replace(/\S+=/g, '').replace(' ', ', '), `and in the paired plot: ${a} with ${b}`);
    check(/looks better on the worlds that chose it/.test(await page.locator('#figure-forest .note').innerText()), 'the best of many carries its warning');
    // Names in cards and lists are never cut off, so none looks like another.
    await page.locator('#failures').scrollIntoViewIfNeeded();
    await page.waitForSelector('.atlas .who');
    check((await page.locator('.atlas .who').evaluateAll((all) => all.filter((who) => who.scrollWidth > who.clientWidth + 1).map((who) => who.textContent))).length === 0, 'no name of a card is cut off');
    const words = await page.locator('#app').innerText();
    check(/: better\./.test(words) && /success rate \+12\.0 points/.test(words) && !/no trials here yet/i.test(words), 'a page with a search begins with its verdict, and on a suite that has trials');
    check(!/NaN|undefined|\[object/.test(words), `sweep: ${/.{0,40}(NaN|undefined|\[object).{0,40}/.exec(words)?.[0]}`);
  }
  if (what === 'phone') {
    // On paper: the same words, as lines.
    await page.setViewportSize({ width: 800, height: 900 });
    await page.evaluate(() => dispatchEvent(new Event('beforeprint')));
    await page.emulateMedia({ media: 'print' });
    const printed = (id) => page.locator(`#figure-${id} .on-paper svg text`).allTextContents();
    const cells = (await printed('heat')).map((text) => text.replace(/\s/g, ' '));
    for (const row of overall) check(cells.includes(percent(row.success_rate)) && cells.some((text) => text === `${(100 * row.success_low).toFixed(1)}\u2013${(100 * row.success_high).toFixed(1)} %`), `print: ${percent(row.success_rate)} and its interval in ${cells}`);
    for (const [id, names] of [['sensitivity', ranked.map((v) => short(v.key))], ['slices', levels.map(short)], ['difficulty', named]]) {
      const texts = await printed(id);
      check(names.every((name) => texts.includes(name)), `print: ${id} names ${names}: ${texts}`);
    }
    // As wide as A4 between its margins: no table goes on beyond the paper.
    await page.setViewportSize({ width: 695, height: 900 });
    const wide = await page.evaluate(() => [...document.querySelectorAll('main table')].map((table) => [table.className, Math.round(table.getBoundingClientRect().right)]).filter(([, right]) => right > innerWidth));
    check(wide.length === 0, `print: beyond the paper: ${JSON.stringify(wide)}`);
    const torn = await page.evaluate(() => [...document.querySelectorAll('.summary .ci')].filter((ci) => ci.getClientRects().length !== 1 || ci.offsetHeight > 1.9 * parseFloat(getComputedStyle(ci).fontSize)).map((ci) => ci.textContent));
    check(torn.length === 0, `print: intervals in more than one line: ${torn}`);
    await accessible(page, source, 'print of a sweep', { parts: '#tuning, #difficulty, #sweep', view: true });
  }
  await context.close();
}

// ---- four controllers in two families on a phone: every name is whole, no number lies over another; and wide, where curves bear their names -------
{
  const html = join(work, 'both.html');
  execFileSync(makeReport, [...['before', 'after'].map((name) => makeStore(name, 'demo', 20, 0)), html], { stdio: 'inherit' });
  const { overall: rows } = dataOf(html);
  const { context, page } = await open(html, { width: 390, height: 844, ratio: 2, touch: true, scheme: 'dark', init: noteLetters });
  const families = ['clutter', 'open'];
  // The bar that stays on top is two lines, however much there is to choose from, and no section begins behind it.
  const bar = await page.locator('.toolbar').boundingBox();
  check(bar.height < 92, `the bar takes ${bar.height} of a phone's 844`);
  await page.getByRole('navigation').getByText('Time').click();
  check(await page.waitForFunction(() => {
    const [over, title] = ['.toolbar', '#time h2'].map((one) => document.querySelector(one).getBoundingClientRect());
    return over.top === 0 && title.top >= over.bottom && title.top < innerHeight / 2;
  }, null, { timeout: 20000 }).then(() => true, () => false), 'phone: a section that is gone to begins below the bar');
  for (const [id, places] of [['forest', [...families, 'all worlds']], ['outcomes', families], ['manipulability', families], ['arrival', null], ['difficulty', null], ['timing', null]]) {
    const seen = await lettersOf(page, id);
    legible(seen, `phone, ${id} of four`);
    check(seen.letters.every((letter) => !/\u2026|\.{3}/.test(letter.text)), `phone: words of ${id} are cut: ${seen.letters.map((letter) => letter.text).filter((text) => /\u2026|\.{3}/.test(text))}`);
    const count = (text) => seen.letters.filter((letter) => letter.text === text).length;
    for (const { controller } of rows) check(count(controller) === (places?.length ?? 1), `phone: ${id} names ${controller} ${count(controller)} times`);
    for (const place of places ?? []) check(count(place) === rows.length, `phone: ${id} names ${place} ${count(place)} times`);
    const shares = seen.letters.filter((letter) => /^(0|50|100) %$/.test(letter.text)).length;
    check(id === 'manipulability' || shares >= 3, `phone: ${id} has ${shares} of three shares at its axis`);
  }
  // The names stay while the numbers scroll; where rows end between pixels, they would cover the lines.
  const lines = await page.locator('.summary tbody tr > :first-child').evaluateAll((cells) => cells.map((cell) => [getComputedStyle(cell).position, cell.parentElement.getBoundingClientRect().height, cell.getBoundingClientRect().height]));
  check(lines.filter(([position]) => position === 'sticky').length === 12 && lines.every(([, row, cell]) => row === cell && Number.isInteger(row)), `phone: rows of the table end on whole pixels: ${JSON.stringify(lines)}`);
  const few = await page.locator('#figure-manipulability .note').innerText();
  check(/Fewer than 30 trials: each is a dot/.test(few) && !/density/.test(few), `of ten trials there is no density: ${few}`);
  await noOverflow(page, 'four on a phone');
  // Beside their curves, and clear of every mark.
  await page.setViewportSize({ width: 900, height: 700 });
  for (const id of ['arrival', 'difficulty']) {
    const seen = await read(page, id);
    legible(seen, `wide, ${id} of four`);
    const names = seen.letters.filter((letter) => rows.some(({ controller }) => controller === letter.text));
    check(names.length === rows.length && names.every((name) => name.left > 0.6 * seen.width), `wide: curves of ${id} bear their names`);
    for (const name of names) {
      let inked = 0;
      for (let y = name.y - 10; y < name.y + 10; y += 1) for (let x = name.left - 5; x < name.left - 1; x += 1) if (seen.at(x, y)[3] > 120) inked += 1;
      check(inked === 0, `wide: left of ${name.text} in ${id} is a mark of ${inked} pixels`);
    }
  }
  await context.close();
}

// ---- conditions on a phone: names of controller, condition and family stand in lines of their own, whole ------------------
{
  const db = makeStore('conditions', 'demo', 20, 0);
  sql(db, "UPDATE point SET label = 'disturbances=' || iif(controller = 'holistic', 'realistic', 'none'), params = json_object('disturbances', iif(controller = 'holistic', 'realistic', 'none'))");
  const { context, page } = await open(makePage(db), { width: 390, height: 844, ratio: 2, touch: true, init: noteLetters });
  for (const id of ['forest', 'outcomes', 'manipulability']) {
    const seen = await lettersOf(page, id);
    legible(seen, `conditions on a phone, ${id}`);
    for (const name of ['moma', 'holistic', 'disturbances: realistic', 'disturbances: none', 'clutter', 'open']) check(seen.letters.some((letter) => letter.text === name), `conditions on a phone: ${id} names ${name}: ${seen.letters.map((letter) => letter.text)}`);
  }
  // Wide, the bar has more than one line: the button for light or dark ends the first. Cards name controller and condition whole.
  await page.setViewportSize({ width: 1280, height: 900 });
  const [nav, button] = await Promise.all(['nav', '.inner > button'].map((part) => page.locator(`.toolbar ${part}`).boundingBox()));
  check(button.y < nav.y + nav.height && button.x > nav.x + nav.width, `conditions: the button for light or dark is at ${JSON.stringify(button)}, the sections at ${JSON.stringify(nav)}`);
  await page.locator('#failures').scrollIntoViewIfNeeded();
  await page.waitForSelector('.atlas .who');
  const names = await page.locator('.atlas .who').evaluateAll((all) => all.map((who) => [who.textContent, who.scrollWidth > who.clientWidth + 1]));
  check(names.some(([name]) => /holistic.*realistic/.test(name)) && names.every(([, cut]) => !cut), `conditions: names on cards, cut off or not: ${JSON.stringify(names)}`);
  await context.close();
}

// ---- forty controllers: the best first, against the first one; many names do not push the verdict off the screen ----------
{
  const many = makePage(makeStore('many', 'many', 8, 0));
  const { overall: rows } = dataOf(many);
  const { context, page } = await open(many, { width: 1440, height: 900, init: noteLetters });
  await page.waitForSelector('.paired-words:not(.found):not(.soon) p');
  const verdicts = await page.locator('.verdict h2').allInnerTexts();
  const rate = (name) => rows.find((row) => row.controller === name).success_rate;
  const rates = rows.map((row) => row.success_rate).sort((a, b) => b - a);
  check(verdicts.length === 3 && verdicts.every((name, i) => rate(name) === rates[i]), `the best three of forty, the best first: ${verdicts}`);
  check(/of 40.controllers.*confirm them/s.test(await page.locator('.verdicts .aside').innerText()), 'the best of forty carry their warning');
  check((await page.locator('.paired-words:not(.found)').innerText()).includes('controller00'), 'and are compared with the first');
  check(/and 37 others/.test(await page.locator('.facts').innerText()), 'of forty names a few are written');
  const box = await page.locator('.forest').boundingBox();
  check(box.y + box.height < 900, `the axis of the verdicts is on the first screen: it ends at ${box.y + box.height}`);
  const forest = await lettersOf(page, 'forest');
  legible(forest, 'forty controllers');
  const names = forest.letters.filter((letter) => /^controller/.test(letter.text)).sort((a, b) => a.y - b.y).map((letter) => letter.text);
  check(names.length === 40 && names.every((name, i) => rate(name) === rates[i]), `forty rows, the best first: ${names}`);
  await noOverflow(page, 'forty controllers');
  await context.close();
}
await browser.close();
end('figures of many points');
