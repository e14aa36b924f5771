// Parts of the page that need no browser: units_test.mjs SOURCE_DIR
import { check, end, near, packagesOf, skip } from './kit.mjs';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

const [, , source] = process.argv;
let esbuild;
try {
  esbuild = packagesOf(source)('esbuild');
} catch {
  skip('esbuild is not in reports/web/node_modules');
}
const load = async (...names) => {
  const contents = names.map((name) => `export * from './${name}';`).join('\n');
  const { outputFiles } = await esbuild.build({ stdin: { contents, resolveDir: join(source, 'reports/web/src'), loader: 'ts' }, bundle: true, write: false, format: 'esm', platform: 'node', target: 'node18', loader: { '.woff': 'binary' } });
  return import(`data:text/javascript;base64,${Buffer.from(outputFiles[0].contents).toString('base64')}`);
};

// ---- colours: told apart without red or green, text read on them ----------------------------------------------------
const { kPalettes, inkOn, contrast, along, readable } = await load('theme', 'colour');
/** CIELAB (D65) of what a person sees: all cones, or none for red or for green (Machado et al., IEEE TVCG 15(6), 2009). */
const kSeen = {
  'all cones': [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
  deuteranopia: [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.01182, 0.04294, 0.968881]],
  protanopia: [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
};
const linear = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255).map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4));
const lab = (hex, matrix) => {
  const rgb = linear(hex);
  const [r, g, b] = matrix.map((row) => Math.min(1, Math.max(0, row[0] * rgb[0] + row[1] * rgb[1] + row[2] * rgb[2])));
  const [x, y, z] = [(0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.95047, 0.2126 * r + 0.7152 * g + 0.0722 * b, (0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.08883]
    .map((t) => (t > 0.008856 ? Math.cbrt(t) : 7.787 * t + 16 / 116));
  return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
};
const kCommon = ['success', 'collision', 'timeout', 'stuck'];
for (const palette of kPalettes) {
  const name = palette.dark ? 'dark' : 'light';
  for (const [what, colours] of [['outcomes', Object.entries(palette.outcomes)], ['series', Object.entries(palette.series)]]) {
    for (const [eye, matrix] of Object.entries(kSeen)) {
      colours.forEach(([a, first], i) => colours.slice(i + 1).forEach(([b, second]) => {
        const [p, q] = [lab(first, matrix), lab(second, matrix)];
        const apart = Math.hypot(...p.map((v, k) => v - q[k]));
        // 2.3 is just seen; outcomes that most stores have lie beside each other in every bar.
        const least = kCommon.includes(a) && kCommon.includes(b) ? 34 : 18;
        check(apart > least, `${name}, ${eye}: ${what} ${a} and ${b} are ${apart.toFixed(1)} apart`);
      }));
    }
  }
  for (const colour of [...Object.values(palette.outcomes), ...palette.series]) {
    check(contrast(inkOn(colour), colour) >= 4.5, `${name}: text on ${colour}`);
    check(contrast(readable(colour, palette.ink, palette.surface), palette.surface) >= 4.5, `${name}: text in ${colour}`);
  }
  for (const text of ['ink', 'muted', 'faint']) check(contrast(palette[text], palette.surface) >= 4.5, `${name}: ${text} text has a contrast of ${contrast(palette[text], palette.surface).toFixed(1)}`);
}
for (let i = 0; i <= 20; ++i) {
  const colour = along(['#f3f1ea', '#c9dbe2', '#86b3c9', '#41799f', '#173d63'], i / 20);
  check(contrast(inkOn(colour), colour) >= 4.5, `text on a cell of the colour ${colour}`);
}
check(along(['#000000', '#ffffff'], 0.5) === '#808080' && along(['#000000', '#ffffff'], 1) === '#ffffff', 'steps of a ramp');
check(near(contrast('#767676', '#ffffff'), 4.54, 0.005), 'the contrast of #767676 on white is 4.54');

// ---- shares: none and all are told from nearly so, ends of an interval from each other, halves are rounded up -----------
{
  const { percent, percentRange } = await load('format');
  const told = (text) => text.replace('\u00a0', ' ').replace('\u2013', '-');
  for (const [share, text] of [[0, '0 %'], [1, '100 %'], [1e-4, '0.01 %'], [0.9999, '99.99 %'], [0.8235, '82.4 %'], [1 - 0.1765, '82.4 %'], [0.8225, '82.3 %'], [0.635, '63.5 %'], [NaN, '\u2013']]) {
    check(told(percent(share)) === told(text), `${share} is written ${percent(share)}, wanted ${text}`);
  }
  for (const [low, high, text] of [[0, 0.000384, '0.00-0.04 %'], [0.999616, 1, '99.96-100.00 %'], [0.567, 0.699, '56.7-69.9 %'], [0, 0, '0.0-0.0 %']]) {
    check(told(percentRange(low, high)) === text, `${low} to ${high} is written ${percentRange(low, high)}, wanted ${text}`);
  }
}

// ---- signs of differences ----------------------------------------------------------------------------------------------
const { fixed, signed } = await load('format');
check([0.004, -0.004, 0, 0.02, -0.02].map((v) => signed(v, (x) => fixed(x, 2))).join() === '0.00,0.00,0.00,+0.02,\u22120.02', 'what is written as nothing has no sign');

// ---- statistics at the edges -----------------------------------------------------------------------------------------
const { spearman, bootstrapMean } = await load('stats');
const six = [1, 2, 3, 4, 5, 6];
check(spearman(six, six).value === 1 && spearman(six, six).interval === null, 'six trials in line: a correlation, and no interval');
check(spearman(six, [1, 2, 3, 4, 6, 5]).interval === null, 'six trials are too few for an interval');
const twenty = Array.from({ length: 20 }, (_, i) => i);
check(spearman(twenty, twenty.map((i) => 3 * i)).interval === null, 'a perfect correlation has no interval');
const some = spearman(twenty, twenty.map((i) => (7 * i) % 20));
check(some.interval.low < some.value && some.value < some.interval.high && some.interval.low > -1 && some.interval.high < 1, 'else it has one');
check(Number.isNaN(bootstrapMean([1, 2, 3, 4, 5]).low), 'five differences are too few for the interval of a mean');
check(bootstrapMean([1, 2, 3, 4, 5, 6]).low >= 1 && bootstrapMean([1, 2, 3, 4, 5, 6]).high <= 6, 'six are enough');
// The numbers that stats_test.cc asks the program for.
{
  const { wilson, mcnemar, holm, pairedRate } = await load('stats');
  const reference = JSON.parse(readFileSync(join(source, 'tests/data/stats_reference.json'), 'utf8'));
  const same = (found, wanted, what) => check(near(found, wanted, 1e-12 + 1e-10 * Math.abs(wanted)), `${what}: ${found}, wanted ${wanted}`);
  const interval = (found, wanted) => ['low', 'high'].forEach((key) => same(found[key], wanted[key], JSON.stringify(wanted)));
  for (const one of reference.wilson.filter((c) => c.confidence === 0.95)) interval(wilson(one.k, one.n), one);
  for (const { a, b, p } of reference.mcnemar) same(mcnemar(a, b), p, `McNemar's test of ${a} and ${b}`);
  for (const one of reference.paired_rates) interval(pairedRate(one.only_a, one.only_b, one.n), one);
  for (const { p, adjusted } of reference.holm) holm(p).forEach((found, i) => same(found, adjusted[i], `Holm's correction of ${p}`));
}
// As in StatsComparison.AnErrorIsNoSuccess: A leaves 26 of 60 worlds to errors, which gains nothing.
{
  const { rates, errorsText } = await load('compare');
  const ending = (world) => (world < 31 ? 'success' : 'timeout');
  const outcomes = Array.from({ length: 60 }, (_, world) => [world >= 31 && world < 57 ? 'error' : ending(world), ending(world)]).flat();
  const told = (all) => rates({ trials: { outcome: (row) => all[row] } }, all.slice(0, all.length / 2).map((_, world) => ({ a: 2 * world, b: 2 * world + 1 })));
  const found = told(outcomes);
  check(found.success.n === 60 && found.success.value === 0 && found.ahead === 0 && found.errorsA === 26 && found.errorsB === 0, `errors are failures: ${JSON.stringify(found)}`);
  check(found.sansErrors.n === 34 && found.sansErrors.both === 31, `34 worlds are without errors: ${JSON.stringify(found.sansErrors)}`);
  check(/In 26 of these worlds.*\(A 26, B 0\), which is no success; without these worlds the difference is 0\.0 points/.test(errorsText(found, 'A', 'B')), errorsText(found, 'A', 'B'));
  // Six worlds of B alone: p = 0.031, and 0.0625 by Holm's correction where collisions do not differ.
  const six = told(Array.from({ length: 6 }, () => ['timeout', 'success']).flat());
  check(six.success.p < 0.05 && six.p === 2 * six.success.p && six.ahead === 0 && six.sansErrors === null && errorsText(six, 'A', 'B') === '', `the program's rule: ${JSON.stringify(six)}`);
  check(told(Array.from({ length: 8 }, () => ['collision', 'success']).flat()).ahead === 1, 'eight are enough');
}
// The same numbers as in StatsComparison.TheIntervalIsThePagesToo: draws are Philox's, by their place.
{
  const { low, high } = bootstrapMean([0.5, -0.5, 1, -0.5, 2, 1]);
  check(low === -1 / 12 && high === 1.25, `digit for digit the interval of moma compare: ${low} ${high}`);
}

// ---- words of the store: each outcome has a colour, none is that of another --------------------------------------------
if (process.env.MOMA_STORE_DEFINITION !== undefined) {
  const outcomes = JSON.parse(readFileSync(join(process.env.MOMA_STORE_DEFINITION, 'outcomes.json'), 'utf8'));
  check(outcomes.length > 5 && outcomes[0] === 'success', `the words for outcomes: ${outcomes}`);
  for (const palette of kPalettes) {
    for (const outcome of outcomes) check(palette.outcomes[outcome] !== undefined, `${outcome} has a colour`);
    check(Object.keys(palette.outcomes).every((name) => outcomes.includes(name)), `no colour of an outcome that there is not: ${Object.keys(palette.outcomes)}`);
  }
}

// ---- objects that give way have the times of their motions in columns, in their order ------------------------------------
const { clocksOf } = await load('replay/motion');
const manners = { distance: 0.8, patience: 3 };
const clocks = clocksOf([{}, { yields: manners }, {}, { yields: manners }]);
check(clocks.join() === ',object_time0,,object_time1', `columns of own times: ${clocks}`);

// ---- the camera: all of a motion is in the picture, which is filled; by the projection of another library's copy -----------
{
  const { fit } = await load('replay/fit');
  const { PerspectiveCamera, Vector3 } = await import(pathToFileURL(join(source, 'reports/web/node_modules/three/build/three.module.js')));
  let state = 7;
  const draw = () => { state = (state * 48271) % 2147483647; return state / 2147483647; };
  for (let k = 0; k < 40; ++k) {
    const camera = new PerspectiveCamera(38, 0.5 + 2.5 * draw(), 0.05, 200);
    camera.up.set(0, 0, 1);
    const points = Array.from({ length: 8 + Math.floor(30 * draw()) }, () => new Vector3(8 * draw() - 4, 8 * draw() - 4, 1.5 * draw()));
    const towards = new Vector3(draw() - 0.5, draw() - 0.5, 0.1 + 0.4 * draw()).normalize();
    camera.lookAt(fit(camera, points, towards));
    camera.updateMatrixWorld();
    const seen = points.map((point) => point.clone().project(camera));
    const most = Math.max(...seen.flatMap(({ x, y }) => [Math.abs(x), Math.abs(y)]));
    check(most < 1 && most > 0.8, `view ${k}: the outermost point is at ${most.toFixed(3)} of the picture's half`);
    check(seen.every(({ z }) => Math.abs(z) < 1), `view ${k}: nothing is cut off`);
  }
}

// ---- axes and steps --------------------------------------------------------------------------------------------------
const { nice, stairs } = await load('chart');
for (const [low, high] of [[0, 0], [3, 3], [0, 1], [2, 7], [0, 113], [1e-9, 2e-9]]) {
  const axis = nice(low, high);
  check(axis.max > axis.min && axis.min <= low && axis.max >= high, `an axis for ${low} to ${high}: ${JSON.stringify(axis)}`);
  check(low < 0 || axis.min >= 0, `an axis for ${low} to ${high} begins at ${axis.min}`);
}
check(JSON.stringify(stairs([[0, 0], [2, 1], [5, 1], [6, 3]])) === '[[0,0],[2,0],[2,1],[5,1],[6,1],[6,3]]', 'steps are level, then upright');

// ---- names -----------------------------------------------------------------------------------------------------------
const { namedBy } = await load('data');
check(namedBy(['lambda_q=0.01 k_epsilon=1', 'lambda_q=0.1 k_epsilon=2']) === 'lambda_q, k_epsilon', 'names of several keys');
check(namedBy(['lambda_q=0.01', 'lambda_q=0.1']) === '' && namedBy(['a=1 b=2', 'a=1']) === '' && namedBy([]) === '', 'other names stay whole');
// ---- causes: noise keeps a robot in motion, so that the same failure is stuck without it and out of time with it ------------
{
  const { causeOf } = await load('causes');
  const where = { 'local minimum': '0.4 m and 0.1 rad from the goal; link4 is 0.02 m from sphere3', limit: '0.4 m and 0.1 rad from the goal; joint4 is 0.01 from its limit' };
  for (const [cause, reason] of Object.entries(where)) {
    const found = [['stuck', `nothing moved for 2 s; ${reason}`], ['timeout', reason]].map(([outcome, text]) =>
      causeOf({ trials: { outcome: () => outcome, text: () => text, number: () => NaN }, point: () => undefined }, 0));
    check(found.every((one) => one.cause === cause) && found[0].what === found[1].what, `stuck and out of time at the same place: ${JSON.stringify(found)}`);
  }
}
// ---- pairs have equal conditions, names say what differs, and a click promises what it does -------------------------------
{
  const { Model, startView, view, rivalsOf, equalConditions } = await load('data', 'view', 'conditions');
  globalThis.location = { hash: '' };
  const at = { suite: 's', robot: 'r', mode: 'm' };
  const made = (live, motions) => {
    const points = ['moma', 'holistic'].flatMap((controller) => [['none', {}], ['realistic', { base: { noise: 1 } }]].map(([name, disturbances]) => ({
      ...at, controller, point: `disturbances=${name}`, params: { disturbances: name }, disturbances, left_out: [] })));
    const trials = points.flatMap((p) => [0, 1].map((world) => ({ ...p, world_key: `w${world}`, trial: `${p.controller}${p.point}${world}`, family: 'f', outcome: world === 0 ? 'success' : 'stuck' })));
    const column = (name) => { const values = [...new Set(trials.map((t) => t[name]))]; return { values, codes: trials.map((t) => values.indexOf(t[name])) }; };
    const overall = points.map((p, i) => ({ ...at, controller: p.controller, point: p.point, family: null, n: 2, errors: 0, success_rate: [0.5, 0.6, 0.7, 0.9][i] }));
    return new Model({ metrics: [], outcomes: ['success', 'stuck'], words: {}, points, overall, summary: [], invocations: [], tuning: [], robots: [], store: { file: 'a.db', schema: 1 }, live,
      replays: trials.slice(0, motions).map(({ trial }) => ({ trial, data: '' })),
      trials: { n: trials.length, stored: trials.length, worlds: 2, columns: Object.fromEntries(['suite', 'robot', 'mode', 'controller', 'point', 'world_key', 'trial', 'family', 'outcome'].map((name) => [name, column(name)])) } });
  };
  const model = made(undefined, 3);
  startView(model);
  const { slice, all } = view();
  check(all.map((s) => s.name).join('|') === 'moma \u00b7 disturbances: none|moma \u00b7 disturbances: realistic|holistic \u00b7 disturbances: none|holistic \u00b7 disturbances: realistic', `points are named by what differs: ${all.map((s) => s.name)}`);
  check(all.every((a) => all.every((b) => equalConditions(model, slice, a.info, b.info) === (a.point === b.point))), 'conditions are equal where all values are');
  for (const base of all) {
    check(rivalsOf(base, all).map((s) => s.name).join() === all.filter((s) => s !== base && s.point === base.point).map((s) => s.name).join(), `${base.name} is compared with ${rivalsOf(base, all).map((s) => s.name)}`);
  }
  check(rivalsOf(all[0], all.slice(0, 2)).map((s) => s.name).join() === all[1].name, 'one controller alone is compared under its conditions');
  check(rivalsOf(all[0], [all[0], all[3]]).length === 0, 'two controllers under two conditions are no pair');
  check(/3 of 8\u00a0trials.*moma view a\.db plays any/.test(model.clickPlays()), `what a click plays: ${model.clickPlays()}`);
  check(made({ simulates: true }, 0).clickPlays() === 'A click plays the trial.' && made(undefined, 8).clickPlays() === 'A click plays the trial.', 'where all can be played');
}

// ---- the probability of a rare event, and the way there ----------------------------------------------------------------
{
  const { riskFigures, kPalettes: palettes } = await load('figures/risk', 'theme');
  const found = (family, p, more = {}) => ({
    controller: 'moma', point: '', family, event: 'collision', level: 'clearance_min_m', at: 0, p, low: p / 2, high: 2 * p, refused: false, replicates: 10, trials: 40000,
    crude: 0, crude_low: 0, crude_high: 1e-4, crude_trials: 1000, excess: 1.3, died: 0, ancestors: 4, tied: 0, way: [[0.05, 0.5, 0.4, 0.6, 0.49], [0.01, 1e-3, 5e-4, 2e-3, 0]], ...more,
  });
  const figures = (...runs) => riskFigures({ page: { invocations: runs.map((risk) => ({ suite: 's', risk })) } });
  const [figure, ...rest] = figures(null, [found('clutter', 1e-5), found('moving', 2e-4), found('all', 1e-4)], [found('clutter', 3e-5)]);
  check(rest.length === 0 && /collision in s/.test(figure.title), `one figure for one event: ${figure.title}`);
  const drawing = figure.draw(palettes[0], 900);
  const events = drawing.rows.filter((row) => row[4] === 0);
  check(JSON.stringify(events.map((row) => [row[2], row[5], row[6], row[7]])) === '[["clutter",0.00001,0.000005,0.00002],["moving",0.0002,0.0001,0.0004]]', `the last run counts, and each curve ends at its event: ${JSON.stringify(events)}`);
  check(drawing.rows.length === 6, 'a row for each point of the families, none for their mixture');
  check(drawing.option.yAxis.min === -6 && drawing.option.yAxis.max === 0, `the axis spans the intervals: ${drawing.option.yAxis.min}`);
  check(figures([found('clutter', 0, { way: [] })])[0].draw(palettes[0], 900) === null, 'nothing came near');
  check(figures([found('clutter', 1e-5)], [found('clutter', 1e-5, { event: 'timeout', at: null, level: 'time_end_s' })]).length === 2, 'a figure for each event');
}

// ---- versions of a controller: every setting in which they differ and nothing else; numbers are equal however they are written -------------
{
  const { changesOf } = await load('sections/provenance');
  const point = (controller, text, more = {}) => ({ controller, point: '', disturbances: {}, ...JSON.parse(text), ...more });
  const a = '{"time_limit_s": 30, "parameters": {"gain": 1, "collision": {"stop": 0.02, "list": [1, 2.0]}, "gone": "x"}, "worlds": {"seed": 1}}';
  const b = '{"time_limit_s": 30.0, "parameters": {"gain": 1.0, "collision": {"stop": 0.05, "list": [1.0, 2]}, "come": true}, "worlds": {"seed": 2}}';
  const [only, ...more] = changesOf([point('mine', a), point('mine@2', b), point('yours', b)]);
  check(more.length === 0 && only.before.controller === 'mine' && only.differs.join('; ') === 'collision.stop: 0.02 \u2192 0.05; gone: x \u2192 not set; worlds.seed: 1 \u2192 2; come: not set \u2192 true', `what changed: ${only.differs}`);
  const stores = changesOf([point('mine (before)', a, { store: 'before' }), point('mine@3 (after)', a, { store: 'after' })]);
  check(stores.length === 1 && stores[0].differs.length === 0, 'the same controller of two stores');
}

// ---- what a controller that looks ahead was about -------------------------------------------------------------------
{
  const { looksAhead, planSentence, pathAhead, detourTarget, Trace, describeSamples } = await load('replay/plan', 'replay/trace', 'data');
  describeSamples({ plan_mode: ['goes by its own policy', 'follows a path', 'slows down', 'stands'], plan_reason: ['a motion begins', '', 'it arrives soonest', '', '', '', 'the path ends', '', 'something is in the way'] });
  const columns = {
    t: [0, 1, 2, 3, 4], plan_mode: [3, 1, 1, 1, 0], plan_reason: [0, 2, 2, 8, 6], plan_going_on: [0, 0, 0, 1, 0], plan_attempts: [1, 1, 1, 2, 2],
    plan_clock: [0, 0.5, 1.5, 0.25, 0], plan_duration: [0, 6, 6, 4, 0], plan_lag: [0, 0.01, 0.02, 0, 0],
    plan_target_x: [0, 1, 2, 7, 0], plan_target_y: [0, -1, -2, -7, 0], plan_end_x: [0, 5, 5, 9, 0], plan_end_y: [0, -5, -5, -9, 0],
    plan_choice: [0, 3, 3, 2, 1], plan_detour: [-1, -1, -1, 4, -1], plan_tried: [0, 12, 12, 3, 2],
    plan_time_policy: [-1, -1, -1, 8, 5], plan_time_detour: [-1, 7.5, 7.5, 6.25, -1], plan_time_path: [-1, 6, 6, -1, -1],
    detour: [0, 1, 0, 0, 1], detour_x: [3, 3, 0, 0, 4], detour_y: [-3, -3, 0, 0, -4],
  };
  const trace = (names) => new Trace({ n: 5, columns: names }, Float32Array.from(names.flatMap((name) => columns[name])));
  const all = trace(Object.keys(columns));
  check(looksAhead(all) && !looksAhead(trace(['t'])), 'a plan is noticed');
  check(planSentence(trace(['t']), 1) === '' && pathAhead(trace(['t']), 1).length === 0 && detourTarget(trace(['t']), 1) === null, 'nothing is said without a plan');
  // A path ends with the choice that made it, and at its own end, driven or not.
  check(JSON.stringify(pathAhead(all, 1)) === '[[1,-1],[2,-2],[5,-5]]', `path ahead: ${JSON.stringify(pathAhead(all, 1))}`);
  check(JSON.stringify(pathAhead(all, 3.9)) === '[[7,-7],[9,-9]]', `the next path: ${JSON.stringify(pathAhead(all, 3.9))}`);
  check(pathAhead(all, 0).length === 0 && pathAhead(all, 4).length === 0, 'no path where none is followed');
  check(JSON.stringify([0, 1, 4].map((t) => detourTarget(all, t))) === '[null,null,[4,-4]]', 'a detour counts where no path is followed');
  const words = [
    'Looking ahead: the robot stands: a motion begins.',
    'Looking ahead: the robot follows a path: it arrives soonest; at 0.50 of 6.00 s, 0.010 m behind. Choice 1, of 12 candidates, fell on a path: 6.00 s to the goal, the least. The policy as it was: would not have arrived.',
    'Looking ahead: the robot follows a path: something is in the way; at 0.25 of 4.00 s, 0.000 m behind. Meanwhile a path is worked out. Choice 2, of 3 candidates, fell on a detour: 6.25 s to the goal, the least. The policy as it was: 8.00 s. A path: none that is quicker.',
    'Looking ahead: the robot makes a detour: the path ends. Choice 2, of 2 candidates, fell on the policy: 5.00 s to the goal, the least. A path: none that is quicker.',
  ];
  [0, 1, 3, 4].forEach((t, i) => check(planSentence(all, t).replaceAll('\u00a0', ' ') === words[i], `at ${t} s: ${planSentence(all, t)}`));
}

end('units of the page');
