// Motions in the page, in a real browser: of made-up trials, of a store that grows while it is looked at, of trials that
// moma simulates: replay_test.mjs SOURCE_DIR MAKE_REPORT WORK_DIR [MOMA]
// Exit 0: passed; 1: failed; 77: left out, since node's packages, python3 or chromium are missing.
import { execFileSync, spawn } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { deflateSync, inflateSync } from 'node:zlib';

import { accessible, check, coloursOf, dataOf, drawn, end, kPython, launch, near, opener, packagesOf, picture, workshop } from './kit.mjs';

const [, , source, makeReport, work, moma] = process.argv;
const { makeStore, makePage, sql } = workshop(source, makeReport, work);
const browser = await launch(source);
const open = opener(browser);

// ---- the page's own motions -------------------------------------------------------------------------------------------------------
/** Scenes are built and moved, and drawn no more: for what is told in numbers. */
const hideScene = (page) => page.addStyleTag({ content: '.stage { display: none !important; }' });
/** Column of a replay's samples, decoded independently of the page. */
const column = (replay, name) => {
  const planes = inflateSync(Buffer.from(replay.data, 'base64'));
  const count = replay.n * replay.columns.length;
  const bytes = Buffer.alloc(4 * count);
  for (let k = 0; k < 4; ++k) for (let i = 0; i < count; ++i) bytes[4 * i + k] = planes[k * count + i];
  const at = replay.columns.indexOf(name);
  return Array.from({ length: replay.n }, (_, i) => bytes.readFloatLE(4 * (at * replay.n + i)));
};
/** Rows of numbers as reports/render packs them: column by column, in planes of bytes. */
const packed = (Kind, rows) => {
  const values = Kind.from(rows[0].flatMap((_, column_) => rows.map((row) => row[column_])));
  const [bytes, size] = [Buffer.from(values.buffer), Kind.BYTES_PER_ELEMENT];
  return deflateSync(Buffer.from([...Array(size).keys()].flatMap((k) => [...values.keys()].map((i) => bytes[size * i + k])))).toString('base64');
};
/** Chooses a motion of the list and moves its time line to each of `times`; what the scene tells then. */
const tellAt = (page, i, trial, times) => page.evaluate(async ([place, name, moments]) => {
  document.querySelectorAll('.shelf button')[place].click();
  const box = document.querySelector('.stage-box');
  while (box.dataset.trial !== name) await new Promise((done) => { setTimeout(done); });
  const input = document.querySelector('.transport input[type=range]');
  return moments.map((t) => {
    input.value = t;   // no further than its end
    input.dispatchEvent(new Event('input', { bubbles: true }));
    return { ...box.dataset };
  });
}, [i, trial, times]);
/** Distances at arrows never lie over each other, or outside of the scene; which motion ends with most of them. */
const checkLabels = async (page, pageData) => {
  let labels = 0;
  let most = [-1, 0];
  for (const [i, replay] of pageData.replays.entries()) {
    await tellAt(page, i, replay.trial, [1e6]);
    await drawn(page);
    const shown = await page.locator('.stage-box').evaluate((box) => {
      const of = (element) => { const { left, top, right, bottom } = element.getBoundingClientRect(); return { left, top, right, bottom }; };
      return { scene: of(box), labels: [...box.querySelectorAll('.row-labels span')].map(of) };
    });
    labels += shown.labels.length;
    if (shown.labels.length > most[1]) most = [i, shown.labels.length];
    shown.labels.forEach((a, k) => {
      const middle = [(a.left + a.right) / 2, (a.top + a.bottom) / 2];
      check(middle[0] > shown.scene.left && middle[0] < shown.scene.right && middle[1] > shown.scene.top && middle[1] < shown.scene.bottom, `trial ${replay.trial}: a label at ${middle}`);
      for (const b of shown.labels.slice(k + 1)) check(a.right <= b.left || b.right <= a.left || a.bottom <= b.top || b.bottom <= a.top, `trial ${replay.trial}: labels lie over each other: ${JSON.stringify([a, b])}`);
    });
  }
  check(labels > 0, `${labels} labels looked at`);
  return most[0];
};
/** The page's forward kinematics against the stored errors, which the simulation computed. */
const checkKinematics = async (page, pageData) => {
  for (const [i, replay] of pageData.replays.entries()) {
    const [begin, end] = await tellAt(page, i, replay.trial, [0, 1e6]);
    const stored = column(replay, 'error_position')[0];
    check(near(Number(begin.positionError), stored, 1e-5), `trial ${replay.trial}: end effector ${begin.positionError} m from the goal, stored ${stored} m`);
    const last = column(replay, 'error_position').pop();
    check(near(Number(end.positionErrorNow), last, 1e-5), `trial ${replay.trial}: at the end ${end.positionErrorNow} m from the goal, stored ${last} m`);
  }
};
/** The map and the sensors' fields: what is in the scene when, which switches there are, and that each draws. */
const checkLayers = async (page, pageData, mapped) => {
  const switches = page.locator('.transport label', { hasText: /^ (occupied|unseen|sensor fields)$/ });
  const offered = async () => (await switches.allInnerTexts()).map((text) => text.trim()).join();
  check((await offered()).endsWith('sensor fields') && !(await switches.first().isVisible()), `a motion without a map has the switch of its sensors alone: ${await offered()}`);
  const told = await tellAt(page, mapped, pageData.replays[mapped].trial, [0, 0.24, 0.25, 1e6]);
  const boxes = told.map(({ occupied, unseen }) => `${occupied} ${unseen}`).join();
  check(boxes === '1 1,1 1,2 0,2 0', `boxes of occupied and unseen cells at four times: ${boxes}`);
  const lit = async () => (await switches.locator('input').evaluateAll((inputs) => inputs.map((input) => Number(input.checked)))).join('');
  check((await switches.count()) === 3 && (await lit()) === '110', `the map is shown, fields are not: ${await lit()}`);
  await tellAt(page, mapped, pageData.replays[mapped].trial, [0]);
  const names = ['occupied cells of the map', 'unseen cells', 'what a sensor can see'];
  const shown = async () => ({ pixels: await picture(page), legend: await page.locator('.replay-legend').innerText() });
  await switches.last().locator('input').check();
  const all = await shown();
  for (const [i, words] of names.entries()) {
    await switches.nth(i).locator('input').uncheck();
    const { pixels, legend } = await shown();
    await switches.nth(i).locator('input').check();
    const differ = pixels.filter((pixel, at) => pixel.some((v, c) => Math.abs(v - all.pixels[at][c]) > 8)).length;
    check(differ > 200, `${words} are ${differ} pixels`);
    check(all.legend.includes(words) && !legend.includes(words), `the legend with and without ${words}: ${all.legend}; ${legend}`);
  }
};
/** Pixels in the goal's colour, which nothing else in a world without objects has. */
const golden = (pixels) => pixels.filter(([r, g, b]) => {
  const hue = (60 * (g - b)) / (r - b);
  return r > g && g > b && r - b > 24 && hue > 38 && hue < 48;
}).length;
/** The lines at what counts as arrived: dashed, at their height, in the traces of the two errors and in no other. */
const checkTolerances = async (page, pageData, replay, dark, ratio) => {
  const { point, controller } = Object.fromEntries(['point', 'controller'].map((name) => [name, pageData.trials.columns[name].values[pageData.trials.columns[name].codes[pageData.trials.columns.trial.codes.findIndex((code) => pageData.trials.columns.trial.values[code] === replay.trial)]] ?? '']));
  const { success_position_m: position, success_orientation_rad: rotation } = pageData.points.find((one) => one.point === point && one.controller === controller);
  await drawn(page);
  const rows = await page.locator('.timeline').evaluate((canvas, [r, g, b]) => {
    const { width, height } = canvas;
    const { data } = canvas.getContext('2d').getImageData(0, 0, width, height);
    const out = [];
    for (let y = 0; y < height; y += 1) {
      let count = 0;
      for (let x = 0; x < width; x += 1) { const i = 4 * (y * width + x); if (data[i + 3] > 100 && Math.abs(data[i] - r) + Math.abs(data[i + 1] - g) + Math.abs(data[i + 2] - b) < 40) count += 1; }
      out.push(count / width);
    }
    return out;
  }, dark ? [0x56, 0xad, 0x8d] : [0x4c, 0x9a, 0x7d]);
  // The trace hides dashes where it lies over the line.
  const dashed = (from, to) => rows.slice(Math.round(from * ratio), Math.round(to * ratio)).map((share, i) => ({ share, y: from + i / ratio })).filter(({ share }) => share > 0.1 && share < 0.75);
  [['error_position', position], ['error_rotation', rotation]].forEach(([name, limit], track) => {
    const most = Math.max(...column(replay, name));
    const wanted = 40 * track + 35 - (limit / most) * 30;
    const found = dashed(40 * track, 40 * track + 40);
    check(limit < most, `${name} of trial ${replay.trial} begins above its tolerance`);
    check(found.length > 0 && found.every(({ y }) => near(y, wanted, 1.6)), `the line at the tolerance of ${name} is at ${found.map(({ y }) => y)}, wanted ${wanted}`);
  });
  check(dashed(80, 200).length === 0, 'no other trace has such a line');
};

/** The replay at a phone's pixel ratio: as fine as its pixels, in the page's colours, its words and controls whole and apart. */
const replayOnPhone = async (page, scheme) => {
  const what = `replay on a phone, ${scheme}`;
  const told = await page.evaluate(() => {
    const of = (element) => { const { left, top, right, bottom } = element.getBoundingClientRect(); return { what: (element.textContent || element.type || element.className).slice(0, 20), left, top, right, bottom }; };
    const seen = (selector) => [...document.querySelectorAll(selector)].filter((element) => element.getClientRects().length > 0).map(of);
    return {
      ratios: ['.stage', '.timeline'].flatMap((name) => { const c = document.querySelector(name); return [c.width / c.clientWidth, c.height / c.clientHeight]; }),
      scene: of(document.querySelector('.stage-box')), over: seen('.stage-box .row-labels span, .stage-box .replay-caption'),
      controls: seen('.transport button, .transport select, .transport input'), width: innerWidth,
    };
  });
  check(told.ratios.every((ratio) => Math.abs(ratio - 2) < 0.01), `${what}: canvases have so many pixels for each of the page's: ${told.ratios}`);
  check(told.over.length > 1 && told.over.every((box) => box.left >= told.scene.left && box.right <= told.scene.right && box.top >= told.scene.top && box.bottom <= told.scene.bottom), `${what}: caption and distances lie in the scene: ${JSON.stringify(told.over)}`);
  check(told.controls.length >= 9, `${what}: ${told.controls.length} controls`);
  for (const all of [told.over, told.controls]) {
    all.forEach((a, i) => {
      check(a.left >= 0 && a.right <= told.width, `${what}: ${a.what} from ${a.left} to ${a.right}`);
      for (const b of all.slice(i + 1)) check(a.right <= b.left || b.right <= a.left || a.bottom <= b.top || b.bottom <= a.top, `${what}: ${a.what} and ${b.what} lie over each other`);
    });
  }
  const pixels = await picture(page);
  const light = pixels.reduce((sum, [r, g, b]) => sum + 0.2126 * r + 0.7152 * g + 0.0722 * b, 0) / pixels.length / 255;
  check(coloursOf(pixels) > 30 && (scheme === 'dark' ? light < 0.25 : light > 0.6), `${what}: ${coloursOf(pixels)} colours, ${light.toFixed(2)} of white on average`);
  const lines = await page.locator('.timeline').evaluate((canvas, dark) => {
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    let count = 0;
    for (let i = 0; i < data.length; i += 4) if (data[i + 3] > 200 && (dark ? Math.max(data[i], data[i + 1], data[i + 2]) > 150 : Math.min(data[i], data[i + 1], data[i + 2]) < 110)) count += 1;
    return count;
  }, scheme === 'dark');
  check(lines > 2000, `${what}: lines and words of the time line are ${lines} pixels`);
};

// ---- parts of the scene without drawing: wheels, the hand at the goal, the path's colours -----------------------------------
{
  const { outputFiles } = await packagesOf(source)('esbuild').build({
    stdin: { contents: ['robot', 'look', 'map', 'marks', 'captioned_picture', 'trace', 'rows'].map((name) => `export * from './replay/${name}';`).join('') + "export * as three from 'three';", resolveDir: join(source, 'reports/web/src'), loader: 'ts' },
    bundle: true, write: false, format: 'iife', globalName: 'parts', target: 'es2022',
  });
  const context = await browser.newContext();
  const page = await context.newPage();
  page.on('pageerror', (error) => check(false, `parts of the scene: ${error.stack}`));
  await page.addScriptTag({ content: outputFiles[0].text });
  const urdf = '<robot name="r"><link name="a"/><joint name="j0" type="revolute"><parent link="a"/><child link="b"/><origin xyz="0 0 0.3"/><axis xyz="0 0 1"/><limit lower="-3" upper="3"/></joint>'
    + '<joint name="j1" type="revolute"><parent link="b"/><child link="c"/><origin xyz="0.1 0 0.3" rpy="0.4 0 0"/><axis xyz="0 1 0"/><limit lower="-2" upper="2"/></joint>'
    + '<joint name="j2" type="revolute"><parent link="c"/><child link="d"/><origin xyz="0.3 0 0" rpy="0 0.2 0"/><axis xyz="1 0 0"/><limit lower="-2" upper="2"/></joint>'
    + '<joint name="f" type="fixed"><parent link="d"/><child link="e"/><origin xyz="0.1 0.02 0" rpy="0 0 0.7"/></joint></robot>';
  const shape = (link, kind, size, position) => ({ link, shape: kind, size, position, rpy: [0, 0, 0] });
  const robot = {
    name: 'r', urdf_text: urdf, base: { mount: { position: [0.1, 0, 0.2] }, wheels: { radius: 0.11, separation: 0.5, wheelbase: 0.4 } },
    arm: { tip: 'e', tool: { position: [0, 0, 0.05], rpy: [0.3, 0, 0] } },
    collision: {
      shapes: [shape('@base', 'box', [0.6, 0.4, 0.2], [0, 0, 0.1]), shape('b', 'capsule', [0.06, 0.1], [0, 0, 0]), shape('c', 'sphere', [0.05], [0.1, 0, 0]), shape('d', 'box', [0.05, 0.08, 0.1], [0.02, 0, 0]), shape('e', 'sphere', [0.04], [0, 0.03, 0]), shape('a', 'sphere', [0.1], [0, 0, 0])],
    },
  };
  const told = await page.evaluate((json) => {
    const { Robot, skins, wheels, fieldMark, gazeAt, goalMark, handPath, poseAt, Trace, carried, three } = window.parts;
    const robot = new Robot(json);
    const columns = ['t', 'base_x', 'base_y', 'base_phi', 'q0', 'q1', 'q2'];
    const values = [[0, 0.5, 1, 2, 4], [0, 0.1, 0.3, 0.8, 1], [0, 0, -0.2, -0.4, -0.5], [0, 0.2, 0.5, 0.9, 1.4], [0, 0.3, 0.1, -0.8, -1], [0.5, 0.4, 0, -0.3, -1], [0, 0.9, 1.1, 0.3, -1.2]];
    const trace = new Trace({ n: 5, columns }, Float32Array.from(values.flat()));
    // A frame to take along, of a narrow scene: every word of it whole, none over another.
    const stage = document.body.appendChild(Object.assign(document.createElement('canvas'), { width: 640, height: 480 }));
    Object.assign(stage.style, { width: '320px', height: '240px' });
    const written = [];
    const { fillText } = CanvasRenderingContext2D.prototype;
    CanvasRenderingContext2D.prototype.fillText = function note(text, x, y) { written.push({ text, left: x, right: x + this.measureText(text).width, y }); };
    window.parts.drawCaptioned(document.createElement('canvas'), stage, { dark: false, ink: '#111', muted: '#555', scene: { hit: '#f00' } }, {
      outcome: 'collision', colour: '#a00', caption: 'holistic disturbances=realistic \u00b7 clutter world 69 \u00b7 panel_link7 against object_of_a_long_name', clock: '0.50 of 0.66 s',
      labels: [{ x: 318, y: 120, text: '203 mm', active: true }, { x: 60, y: 20, text: '5 mm', active: false }, { x: 250, y: 236, text: '61 mm', active: false }],
    });
    CanvasRenderingContext2D.prototype.fillText = fillText;
    const boxes = wheels(robot, []).map(({ surface, local }) => {
      surface.computeBoundingBox();
      const { min, max } = surface.boundingBox.clone().applyMatrix4(local);
      return [min.toArray(), max.toArray()];
    });
    poseAt(robot, trace, 0);
    const mark = goalMark(robot, skins(robot, []), 0.02, '#ffcc00');
    const balls = mark.children.filter((child) => child.geometry?.type === 'SphereGeometry' && child.name === '').map((child) => child.geometry.parameters.radius);
    const hands = mark.children.filter((child) => child.name.startsWith('hand: '));
    // The mark set to where the hand comes to at another time: its parts must lie where the hand's own then are.
    let apart = 0;
    poseAt(robot, trace, 3);
    robot.tipPose(new three.Matrix4()).decompose(mark.position, mark.quaternion, mark.scale);
    mark.updateMatrixWorld(true);
    const own = skins(robot, []).filter(({ link }) => robot.inHand(link));
    own.forEach(({ link, local }, i) => {
      const wanted = robot.pose(link).clone().multiply(local);
      hands[i].matrixWorld.elements.forEach((v, k) => { apart = Math.max(apart, Math.abs(v - wanted.elements[k])); });
    });
    // A row a little later: its ends go with what they are on.
    const turned = { then: new three.Matrix4(), now: new three.Matrix4().makeRotationZ(Math.PI / 2).setPosition(1, 0, 0) };
    const lifted = { then: new three.Matrix4().setPosition(5, 5, 5), now: new three.Matrix4().setPosition(5, 5, 6) };
    const [row] = carried([{ kind: 'object', link: 'd', other: 'ball', d: 0, active: false, first: new three.Vector3(1, 0, 0), second: new three.Vector3(0, 2, 0) }], (name, when) => (name === 'd' ? turned : lifted)[when]);
    const ends = [row.first, row.second].map((point) => point.toArray());
    // Directions of the outermost corners of two fields, and where a camera that pans looks.
    const sensor = { link: 'd', position: [0.1, 0.2, 0.3], rpy: [0, 0.5, 0], field_of_view: [1.2, 0.8], range: 2, head: { axes: [0.1, 0, 0.3] } };
    const fields = [sensor, { field_of_view: [4.7, 0], range: 5 }].map((of) => {
      const corners = fieldMark(of, '#0000ff').children[0].geometry.getAttribute('position');
      const points = [...Array(corners.count).keys()].map((i) => new three.Vector3().fromBufferAttribute(corners, i)).filter((point) => point.length() > 0);
      return [(point) => Math.abs(Math.atan2(point.y, point.x)), (point) => Math.abs(Math.asin(point.z / point.length())), (point) => point.length()].map((of_) => Math.max(...points.map(of_)));
    });
    const looked = { looks: [undefined, [{ t: 1, pan: 0, tilt: 0.4 }, { t: 2, pan: 1.4, tilt: 0 }]] };
    const gazes = [0, 1.5, 3].map((t) => gazeAt(looked, 1, t)).concat(gazeAt(looked, 0, 1), gazeAt(null, 0, 1)).map(({ pan, tilt }) => [pan, tilt]);
    const seenAt = [{ pan: 0.7, tilt: 0.3 }, { pan: 0, tilt: 0 }].map((gaze) => robot.pose('d').clone().invert().multiply(robot.sensorPose(sensor, gaze)).elements);
    const { all, travelled } = handPath(robot, trace, '#ff0000', '#0000ff');
    const shades = all.geometry.getAttribute('instanceColorStart');
    const lineEnd = all.geometry.getAttribute('instanceColorEnd');
    return {
      fields, gazes, seenAt, written, boxes, balls, hands: hands.map((child) => child.name), links: own.map(({ link }) => link), apart, ends,
      reds: [...Array(shades.count).keys()].map((i) => shades.getX(i)).concat(lineEnd.getX(lineEnd.count - 1)), pieces: travelled.geometry.getAttribute('instanceStart').count,
    };
  }, robot);
  check(told.written.length >= 7 && told.written.map(({ text }) => text).join(' ').includes('object_of_a_long_name'), `a frame's words: ${JSON.stringify(told.written)}`);
  told.written.forEach((a, i) => {
    check(a.left >= 0 && a.right <= 320 && a.y > 6 && a.y < 234, `"${a.text}" is in the frame: ${JSON.stringify(a)}`);
    for (const b of told.written.slice(i + 1)) check(a.right <= b.left || b.right <= a.left || Math.abs(a.y - b.y) > 13, `"${a.text}" and "${b.text}" lie over each other in a frame`);
  });
  const wanted = [[-0.2, -0.25], [-0.2, 0.25], [0.2, -0.25], [0.2, 0.25]].map(([x, y]) => [[x - 0.11, y - 0.025, 0], [x + 0.11, y + 0.025, 0.22]]);
  check(told.boxes.length === 4 && told.boxes.flat(2).every((v, i) => near(v, wanted.flat(2)[i], 1e-3)), `four wheels on their axles and on the floor: ${JSON.stringify(told.boxes)}`);
  check(told.balls.join() === '0.02', `a ball as large as the tolerance: ${told.balls}`);
  check(told.hands.join() === 'hand: d,hand: e' && told.links.join() === 'd,e', `the hand at the goal is what the last joint moves: ${told.hands}`);
  check(told.fields.flat().every((v, i) => near(v, [0.6, 0.4, 2, 2.35, 0, 5][i], 1e-6)), `azimuth, elevation and range of fields: ${JSON.stringify(told.fields)}`);
  check(told.gazes.flat().every((v, i) => near(v, [0, 0.4, 0.7, 0.2, 1.4, 0, 0, 0, 0, 0][i], 1e-9)), `where a head looks before, between and after its frames, and one that does not turn: ${JSON.stringify(told.gazes)}`);
  for (const [i, [pan, down]] of [[0.7, 0.8], [0, 0.5]].entries()) {
    const e = told.seenAt[i];
    const wanted_ = [Math.cos(down) * Math.cos(pan), Math.cos(down) * Math.sin(pan), -Math.sin(down), 0.1 - 0.2 * Math.sin(pan), 0.2 * Math.cos(pan), 0.3];
    check([e[0], e[1], e[2], e[12], e[13], e[14]].every((v, k) => near(v, wanted_[k], 1e-6)), `a camera that looks ${pan} to its side and ${down} down: along ${e.slice(0, 3)} from ${e.slice(12, 15)}`);
  }
  check(told.apart < 1e-5, `the hand at the goal is the hand as it arrives, within ${told.apart}`);
  check([[1, 1, 0], [0, 2, 1]].every((wanted_, i) => wanted_.every((v, k) => near(v, told.ends[i][k], 1e-9))), `ends of rows go with what they are on: ${JSON.stringify(told.ends)}`);
  check(told.reds.every((red, i) => near(red, 1 - [0, 0.5, 1, 2, 4][i] / 4, 0.01)) && told.pieces === 4, `the path is coloured by time: ${told.reds}`);
  await context.close();
}
{
  const demo = makePage(makeStore('demo', 'demo', 60));
  const data = dataOf(demo);
  const { context, page } = await open(demo, { width: 420, height: 500, scene: true });
  await page.locator('#failures').scrollIntoViewIfNeeded();
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
  const colours = coloursOf(await picture(page));
  check(colours > 20, `the scene shows ${colours} colours`);

  // In a small picture of a world without objects: the hand at the goal, pale, and the wheels, against the same page without.
  const families = data.trials.columns.family.codes.map((code) => data.trials.columns.family.values[code]);
  const rowOf = (trial) => data.trials.columns.trial.codes.findIndex((code) => data.trials.columns.trial.values[code] === trial);
  const empty = data.replays.findIndex(({ trial }) => families[rowOf(trial)] === 'open');
  const bare = demo.replace('demo.html', 'bare.html');
  // Without wheels, with two sensors, and with a map of one motion: two boxes of occupied cells, of which one comes later, and one of
  // unseen cells that goes.
  const mapped = (empty + 1) % data.replays.length;
  const changed = structuredClone(data);
  for (const robot of Object.values(changed.robots)) {
    robot.base.wheels = {};
    robot.sensors = [{ name: 'camera', link: '', position: [0.2, 0, 1], rpy: [0, 0.5, 0], field_of_view: [1.2, 0.9], range: 2, head: { pan: [-1, 1] } }, { name: 'scanner', field_of_view: [4.7, 0], range: 4 }];
  }
  changed.replays[mapped].map = { cell: 0.05, hz: 4, looks: { n: 2, data: packed(Float32Array, [[0, 0, 0, 0], [0, 1, 0.8, 0.1]]) }, data: packed(Int16Array, [[0, 9, 1, -20, -20, 0, 40, 16, 16], [0, 1, 0, -20, 30, 0, 40, 16, 16], [1, 9, 1, -50, 0, 0, 16, 16, 16]]) };
  writeFileSync(bare, readFileSync(demo, 'utf8').replace(/(id="moma-data">).*?(<\/script)/s, (_, head, tail) => head + JSON.stringify(changed).replaceAll('<', '\\u003c') + tail));
  const seen = async (where) => {
    await where.locator('.stage').scrollIntoViewIfNeeded();
    await tellAt(where, empty, data.replays[empty].trial, [0]);
    return picture(where);
  };
  const small = await seen(page);
  check(golden(small) > 60, `the hand at the goal is ${golden(small)} pixels of ${small.length}`);
  const other = await open(bare, { width: 420, height: 500, scene: true });
  await other.page.locator('#replay').scrollIntoViewIfNeeded();
  await other.page.waitForSelector('.stage-box[data-trial]');
  const without = await seen(other.page);
  const darker = small.filter((pixel, i) => without[i] !== undefined && pixel[0] + pixel[1] + pixel[2] < without[i][0] + without[i][1] + without[i][2] - 60).length;
  check(small.length === without.length && darker > 30, `the wheels are ${darker} pixels, of ${small.length} and ${without.length}`);
  await checkLayers(other.page, changed, mapped);
  await other.context.close();
  await hideScene(page);
  await checkTolerances(page, data, data.replays[empty], false, 1);
  // Any other signal of the samples on the same time line: as its numbers go, negative ones below the rest line.
  const height = () => page.locator('.timeline').evaluate((canvas) => canvas.clientHeight);
  const before = await height();
  await page.getByLabel('Signal', { exact: true }).selectOption('command0');
  await drawn(page);
  check((await height()) === before + 40, `a signal has a trace of its own: ${before}, then ${await height()}`);
  const offered = await page.getByLabel('Signal', { exact: true }).locator('option').allInnerTexts();
  check(data.replays[empty].columns.filter((name) => /^(q|qdot|command)\d+$/.test(name)).length <= offered.filter((name) => /^(q|qdot|command) /.test(name)).length && offered.some((name) => name === 'q joint1'), `signals to choose from: ${offered}`);
  await page.locator('.shelf button').nth(3).click();
  await page.waitForFunction((trial) => document.querySelector('.stage-box').dataset.trial === trial, data.replays[3].trial);
  check((await page.getByLabel('Signal', { exact: true }).inputValue()) === 'command0', 'the signal stays with the next motion');
  check((await page.locator('.transport .play').innerText()) === 'Pause', 'a motion chosen from the list plays');
  await checkKinematics(page, data);
  await context.close();
}

// ---- served by moma view, while a run goes on -----------------------------------------------------------------------
{
  const db = makeStore('served', 'demo', 20, 3);
  sql(db, "UPDATE invocation SET status = 'running'; CREATE TABLE kept AS SELECT * FROM point_trial WHERE world_index >= 15; DELETE FROM point_trial WHERE world_index >= 15;");
  const server = spawn(makeReport, ['--view', db], { stdio: ['ignore', 'pipe', 'inherit'] });
  const address = await new Promise((done) => server.stdout.once('data', (text) => done(String(text).trim())));
  const ended = new Promise((done) => server.once('exit', done));
  process.once('exit', () => server.kill('SIGKILL'));   // whatever fails below
  let stopped = false;
  const allowed = (error) => stopped && error.includes('ERR_CONNECTION_REFUSED');   // the page goes on asking
  // The page asks the server every three seconds; here ten times as often.
  const hurry = () => {
    const wait = window.setTimeout;
    window.setTimeout = (call, pause) => wait(call, pause === 3000 ? 300 : pause);
  };
  const { context, page } = await open(address, { served: true, allowed, init: hurry });
  check((await page.locator('.live').innerText()).includes('30'), 'the page says that it is live');
  // Whether a run that never said how it ended goes on: its program holds the store's lock, or does not.
  const lock = `${db}-lock`;
  writeFileSync(lock, '');
  await page.waitForFunction(() => /was killed/.test(document.querySelector('.live').textContent));
  check(!(await page.locator('.live').getAttribute('class')).includes('running'), 'a killed run is not called live');
  check(/The last run was killed/.test(await page.locator('.notices').innerText()), `the notices say so: ${await page.locator('.notices').innerText()}`);
  const holder = spawn(kPython, ['-c', `import fcntl, sys; f = open(${JSON.stringify(lock)}); fcntl.flock(f, fcntl.LOCK_EX); print("held", flush=True); sys.stdin.read()`], { stdio: ['pipe', 'pipe', 'inherit'] });
  await new Promise((done) => holder.stdout.once('data', done));
  await page.waitForFunction(() => /30 of 40\strials \(75\s%\).*a run goes on/.test(document.querySelector('.live').textContent));
  check(/interim/.test(await page.locator('.notices').innerText()), 'what is shown before the end is called interim');
  sql(db, 'INSERT INTO point_trial SELECT * FROM kept WHERE world_index = 15; DELETE FROM kept WHERE world_index = 15;');
  await page.waitForFunction(() => / left;/.test(document.querySelector('.live').textContent));
  const pace = /^32 of 40\strials \(80\s%\), ([\d.]+) a second, about ([\d.]+)\s(s|min) left;/.exec(await page.locator('.live').innerText());
  check(pace !== null && near(Number(pace[2]) * (pace[3] === 'min' ? 60 : 1), 8 / Number(pace[1]), pace[3] === 'min' ? 45 : 0.5 + 8 * 0.05 / Number(pace[1]) ** 2), `a rate and the time left: ${await page.locator('.live').innerText()}`);
  await page.waitForFunction(() => document.querySelector('#trials footer .note').textContent.startsWith('32'));   // the trials so far
  await page.locator('#failures').scrollIntoViewIfNeeded();
  await page.locator('.atlas .play').first().click();
  await page.waitForSelector('.stage-box[data-trial]');
  await page.waitForFunction(() => Number(document.querySelector('.transport input[type=range]').value) > 0.05);
  await page.locator('.transport .play').click();
  sql(db, "INSERT INTO point_trial SELECT * FROM kept; DROP TABLE kept; UPDATE invocation SET status = 'finished';");
  holder.stdin.end();
  await page.waitForFunction(() => document.querySelector('#trials footer .note').textContent.startsWith('40'));
  check((await page.locator('.summary tbody tr').last().locator('td').first().innerText()) === '20', 'the summary has followed');
  await page.waitForFunction(() => document.querySelector('.live').textContent.includes('no run is going on'));   // the end of the run is told
  stopped = true;
  server.kill('SIGTERM');
  check((await ended) === 0, 'the server ends cleanly');
  await page.waitForFunction(() => document.querySelector('.live').textContent.startsWith('moma view has ended'));
  await context.close();
}

// ---- trials that moma simulated: robots, worlds and samples as the program writes them -----------------------------
const suites = [['frankie', 'robots/frankie.yaml', 'clutter', 5, '{}'], ['tiago', 'robots/examples/tiago.yaml', 'moving', 5, '{}'],
  ['rows', 'robots/frankie.yaml', 'moving', 6, join(source, 'configs/controllers/moma-reactive.yaml')]];
for (const [name, robot, family, seed, controller] of moma === undefined ? [] : suites) {
  const suite = join(work, `${name}.yaml`);
  writeFileSync(suite, `name: ${name}\nrobot: ${join(source, 'configs', robot)}\ncontrollers: {moma: ${controller}}\nworlds: {seed: ${seed}, families: `
    + `{${family}: {weight: 1}}}\nsimulation: {mode: kinematic, time_limit: 8}\ntrials: 3\nsamples: all\n`);
  execFileSync(moma, ['run', suite, '-o', join(work, `${name}.db`), '--quiet'], { stdio: ['ignore', 'ignore', 'inherit'] });
  execFileSync(moma, ['report', join(work, `${name}.db`), '-o', join(work, `${name}.html`)], { stdio: 'ignore' });
  const html = join(work, `${name}.html`);
  const { context, page } = await open(html, { ratio: name === 'tiago' ? 1 : 2, scheme: name === 'rows' ? 'dark' : 'light', scene: name === 'frankie', ...(name === 'frankie' ? { width: 390, height: 844, touch: true } : {}) });
  await page.locator('#replay').scrollIntoViewIfNeeded();
  // A robot whose URDF has visual meshes is shown as these, or as its shapes.
  const looks = Object.values(dataOf(html).looks);
  check(looks.length === (name === 'tiago' ? 1 : 0), `${name}: ${looks.length} looks`);
  await page.waitForSelector('.stage-box[data-triangles]');
  const triangles = async () => Number(await page.locator('.stage-box').getAttribute('data-triangles'));
  const switched = page.locator('.transport label', { hasText: 'shapes' });
  const switchable = await switched.isVisible();
  check(switchable === (looks.length > 0), `${name}: shapes are a switch where there is something else: ${switchable} with ${looks.length} looks`);
  if (switchable) {
    const seen = await triangles();
    check(seen > 5000 && seen < 26000, `${name}: ${seen} triangles of its meshes`);
    await switched.click();
    const plain = await triangles();
    check(plain !== seen, `${name}: as shapes ${plain} triangles, else ${seen}`);
    await switched.click();
    check((await triangles()) === seen, `${name}: and back`);
  }
  check(dataOf(html).replays.length === 3, `${name}: all trials can be played`);
  if (name === 'frankie') {
    const told = dataOf(html);
    const place = await checkLabels(page, told);
    for (const scheme of ['light', 'dark']) {
      await page.emulateMedia({ colorScheme: scheme });
      await page.waitForFunction((wanted) => document.documentElement.dataset.theme === wanted, scheme);
      await tellAt(page, place, told.replays[place].trial, [1e6]);
      await drawn(page);
      await replayOnPhone(page, scheme);
      await accessible(page, source, `replay on a phone, ${scheme}`, { parts: '#replay', view: scheme === 'dark' });
    }
  }
  await hideScene(page);
  await checkKinematics(page, dataOf(html));
  // Collision rows are the controller's own: the stored least distance and number of active constraints are theirs, and so is
  // what `moma solve` says of the same step.
  const { points: [{ control_period_s: period }] } = dataOf(html);
  const solved = (trial, t) => JSON.parse(execFileSync(moma, ['solve', join(work, `${name}.db`), trial, '--step', String(Math.round(t / period))],
    { maxBuffer: 1 << 26, stdio: 'pipe' }));
  let [seen, active] = [0, 0];
  for (const [i, replay] of dataOf(html).replays.entries()) {
    const [times, least, rows, fallback] = ['t', 'least_distance', 'active_rows', 'fallback'].map((column_) => column(replay, column_));
    const looks = Array.from({ length: Math.ceil(replay.n / 7) }, (_, i_) => 7 * i_);
    const all = (await tellAt(page, i, replay.trial, looks.map((k) => times[k])))
      .map((box) => ({ least: box.leastDistance, active: Number(box.activeRows), arrows: Number(box.arrows) }));
    for (const [at, k] of looks.entries()) {
      const shown = { ...all[at], least: all[at].least === '' ? Infinity : Number(all[at].least) };
      if (least[k] < 0.29) {
        seen += 1;
        check(near(shown.least, least[k], 1e-4), `${name}: at ${times[k]} s the nearest object is ${shown.least} m away, stored ${least[k]} m`);
      }
      if (fallback[k] === 0) check(shown.active <= rows[k], `${name}: at ${times[k]} s ${shown.active} active collision rows of ${rows[k]} active constraints`);
      active += shown.active;
      if (at % 6 !== 1 || k + 1 >= replay.n) continue;
      const said = solved(replay.trial, times[k]).rows.filter((row) => /^(object|floor|self)\//.test(row));
      check(shown.arrows === said.length, `${name}: at ${times[k]} s ${shown.arrows} arrows, of ${said}`);
    }
  }
  if (name === 'rows') {
    await tellAt(page, 0, dataOf(html).replays[0].trial, [0]);
    await checkTolerances(page, dataOf(html), dataOf(html).replays[0], true, 2);
  }
  check(seen > 5 && active > 0, `${name}: ${seen} distances compared, ${active} active rows`);
  await context.close();
}

// ---- a controller that is told by depth: the boxes of its map are where the world's objects are -----------------------
if (moma !== undefined) {
  const [db, html] = ['depth.db', 'depth.html'].map((name) => join(work, name));
  execFileSync(moma, ['run', join(source, 'configs/suites/depth.yaml'), '-o', db, '--trials', '1', '--quiet', ...['samples=all', 'simulation={mode: kinematic, time_limit: 0.6}'].flatMap((set) => ['--set', set])],
    { stdio: ['ignore', 'ignore', 'inherit'] });
  execFileSync(moma, ['report', db, '-o', html], { stdio: 'ignore' });
  const { replays: [{ map, world, robot }], robots } = dataOf(html);
  check(robots[robot].sensors.length === 6, 'the robot comes with its sensors');
  const planes = inflateSync(Buffer.from(map.data, 'base64'));
  const count = planes.length / 18;
  const boxes = Array.from({ length: count }, (_, i) => Array.from({ length: 9 }, (_column, c) => ((planes[c * count + i] | (planes[(9 + c) * count + i] << 8)) << 16) >> 16));
  const occupied = boxes.filter((box) => box[2] === 1);
  check(map.cell === 0.05 && map.hz === 4 && occupied.length > 50 && boxes.length > occupied.length, `${occupied.length} of ${boxes.length} boxes are of occupied cells`);
  check(boxes.every(([from, to, , , , , ...edges]) => from >= 0 && from < to && to <= 3 && edges.every((edge) => edge >= 1 && edge <= 16)), 'boxes have a time and edges');
  const gap = (box, { position, shape, size }) => Math.hypot(...position.map((p, k) => Math.max(0, map.cell * box[3 + k] - p, p - map.cell * (box[3 + k] + box[6 + k])))) - Math.hypot(...size) / (shape === 'box' ? 2 : 1);
  const strays = occupied.filter((box) => world.objects.every((object) => gap(box, object) > 0.1));
  check(strays.length === 0, `boxes where no object is: ${JSON.stringify(strays)}`);
}

// ---- a controller that looks ahead, its path on the floor and its reasons in words; one that makes detours -----------
if (moma !== undefined) {
  const suite = join(work, 'ahead.yaml');
  writeFileSync(suite, `name: ahead\nrobot: ${join(source, 'configs/robots/frankie.yaml')}\ncontrollers: {ahead: ${join(source, 'configs/controllers/moma-ahead.yaml')}, reactive: ${join(source, 'configs/controllers/moma-reactive.yaml')}}\n`
    + 'worlds: {seed: 4244, families: {clutter: {weight: 1}, moving: {weight: 1}}}\nsimulation: {mode: kinematic, time_limit: 8}\ntrials: 4\nsamples: all\n');
  execFileSync(moma, ['run', suite, '-o', join(work, 'ahead.db'), '--quiet'], { stdio: ['ignore', 'ignore', 'inherit'] });
  execFileSync(moma, ['report', join(work, 'ahead.db'), '-o', join(work, 'ahead.html'), '--replays', '8'], { stdio: 'ignore' });
  const html = join(work, 'ahead.html');
  const { context, page } = await open(html);
  await page.locator('#replay').scrollIntoViewIfNeeded();
  await page.waitForSelector('.stage-box[data-triangles]');
  const words = page.locator('.plan-now');
  let [paths, detours] = [0, 0];
  for (const [i, replay] of dataOf(html).replays.entries()) {
    if (!replay.columns.includes('detour')) continue;
    const plans = replay.columns.includes('plan_mode');
    const [times, detour] = ['t', 'detour'].map((name) => column(replay, name));
    const [mode, attempts] = ['plan_mode', 'plan_attempts'].map((name) => (plans ? column(replay, name) : times.map(() => 0)));
    const first = mode.indexOf(1);
    if (first >= 0) {
      let end = first;
      while (end < replay.n && mode[end] === 1 && attempts[end] === attempts[first]) end += 1;
      const [shown] = await tellAt(page, i, replay.trial, [times[first]]);
      check(Number(shown.planned) === end - first + 1, `trial ${replay.trial}: ${shown.planned} places of a path of ${end - first} samples and its end`);
      check(/follows a path: .* of .* s, .* m behind/.test(await words.innerText()), `trial ${replay.trial}: ${await words.innerText()}`);
      paths += 1;
    }
    const away = detour.findIndex((value, k) => value !== 0 && mode[k] !== 1);
    if (away >= 0) {
      const [shown] = await tellAt(page, i, replay.trial, [times[away]]);
      check(shown.planned === '2', `trial ${replay.trial}: ${shown.planned} places of a detour`);
      detours += 1;
    }
  }
  check(paths > 0 && detours > 0, `${paths} paths and ${detours} detours`);
  await context.close();
}

await browser.close();
end('the replay');
