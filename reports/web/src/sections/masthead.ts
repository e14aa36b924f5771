// What was run, and what came of it: one sentence per controller.

import { pairs } from '../compare';
import { conditions, disturbances, onlyConditions } from '../conditions';
import { inSlice, type Model, type PointInfo, type Series, type SummaryRow } from '../data';
import { h, replace } from '../dom';
import { integer, list, percent, percentNumber, percentRange, plural, probability, seconds, times } from '../format';
import { holm } from '../stats';
import { palette, seriesColour, onTheme } from '../theme';
import { onView, view } from '../view';
import { notices } from './notices';

function unique(values: readonly string[]): string[] {
  return [...new Set(values)];
}

function when(iso: string): string {
  const date = new Date(iso);
  return Number.isNaN(date.getTime()) ? iso
    : date.toLocaleDateString('en-GB', { day: 'numeric', month: 'long', year: 'numeric', timeZone: 'UTC' });
}

function seeds(points: readonly PointInfo[]): string {
  return list(unique(points.map((p) => String(p.worlds?.seed ?? '')).filter((s) => s !== '')));
}

function facts(model: Model): [string, string][] {
  const { page } = model;
  const { slice, families } = view();
  const points = page.points.filter((p) => inSlice(p, slice));
  const runs = page.invocations.filter((i) => i.suite === slice.suite);
  const latest = runs[0];
  const trials = page.overall.filter((o) => inSlice(o, slice)).reduce((sum, o) => sum + o.n, 0);
  const versions = unique(runs.map((r) => `${r.moma_version}${r.git_commit ? ` (${r.git_commit.slice(0, 7)}${r.git_dirty ? ', changed' : ''})` : ''}`));
  const out: [string, string][] = [
    ['Robot', slice.robot],
    ['Controllers', unique(points.map((p) => p.controller)).join(', ') + (points.some((p) => p.point !== '') ? `, ${plural(points.length, 'point')}` : '')],
    ['Worlds', `${families.join(', ') || 'none'}${seeds(points) ? `; seed ${seeds(points)}` : ''}`],
    ['Simulation', `${slice.mode}, ${unique(points.map((p) => `${1e3 * p.control_period_s} ms`)).join(', ')} control period`],
    ['Trials', integer(trials)],
  ];
  const between = disturbances(model, slice);
  if (between !== '') out.splice(4, 0, ['Disturbances', between]);
  if (latest !== undefined) {
    out.push(['Run', `${when(latest.started)} on ${unique(runs.map((r) => r.host)).join(', ')}`], ['moma', versions.join(', ')]);
  }
  return out;
}

/** A bar from 0 to 100 % with the interval as a band and the rate as a tick. */
function gauge(row: SummaryRow, colour: string): HTMLElement {
  const at = (v: number): string => `${(100 * v).toFixed(3)}%`;
  return h('div', { class: 'gauge', style: `--c:${colour}`, role: 'img', 'aria-label': `success ${percent(row.success_rate)}, 95 % interval ${percentRange(row.success_low, row.success_high)}` },
    h('i', { class: 'band', style: `left:${at(row.success_low)};width:${at(row.success_high - row.success_low)}` }),
    h('i', { class: 'tick', style: `left:${at(row.success_rate)}` }),
    ...[0, 25, 50, 75, 100].map((v) => h('span', { style: `left:${v}%` }, v === 0 || v === 50 || v === 100 ? `${v}` : '')));
}

function sentence(name: string, row: SummaryRow): string {
  const reached = Math.round(row.success_rate * row.n);
  const hits = Math.round(row.collision_rate * row.n);
  const collided = hits === 0 ? 'None collided' : `${integer(hits)}\u00a0collided`;
  const time = row.time_to_goal_median_s === null ? '' : ` Median time to goal ${seconds(row.time_to_goal_median_s)}.`;
  return `${name} reached the goal in ${integer(reached)} of ${plural(row.n, 'trial')} (95 % interval ${percentRange(row.success_low, row.success_high)}). `
    + `${collided} (${percent(row.collision_rate)}, ${percentRange(row.collision_low, row.collision_high)}).${time}`;
}

/** More verdicts than this do not help: the best are shown, the others are in the table. */
const kVerdicts = 4;

interface Judged {
  series: Series;
  row: SummaryRow | undefined;
}

/** The shown series with their rows; of many, the few with the highest success rate, best first. */
function judged(model: Model): Judged[] {
  const { slice, family, series } = view();
  const rows = (family === '' ? model.page.overall : model.page.summary.filter((s) => s.family === family)).filter((r) => inSlice(r, slice));
  const all = series.map((s) => ({ series: s, row: rows.find((r) => r.controller === s.controller && r.point === s.point) }));
  if (all.length <= kVerdicts || onlyConditions(model, slice)) return all;
  return all.sort((a, b) => (b.row?.success_rate ?? -1) - (a.row?.success_rate ?? -1)).slice(0, 3);
}

function verdicts(model: Model): HTMLElement[] {
  const { all } = view();
  const shown = judged(model);
  return shown.map(({ series: s, row }) => {
    const colour = seriesColour(palette(), s.mark);
    if (row === undefined) {
      return h('article', { class: 'verdict', style: `--c:${colour}` }, h('h2', null, s.name), h('p', null, 'has no trials here yet.'));
    }
    return h('article', { class: 'verdict', style: `--c:${colour}` },
      h('h2', null, s.name),
      h('p', { class: 'rate' }, percentNumber(row.success_rate), h('small', null, '\u00a0%')),
      gauge(row, colour),
      h('p', { class: 'words' }, sentence(s.point === '' ? s.name : 'It', row)));
  }).concat(all.length > shown.length
    ? [h('p', { class: 'aside' }, shown.length === view().series.length ? `${integer(shown.length)} of ${plural(all.length, 'point')}, as chosen; all are in the table below.`
      : `The best ${integer(shown.length)} of ${plural(all.length, 'point')}; all are in the table below. The best of many look better on the worlds that chose them than they are: confirm them on other worlds.`)]
    : []);
}

/** "failed twice", "never failed". */
function often(verb: string, count: number): string {
  return count === 0 ? `never ${verb}` : `${verb} ${times(count)}`;
}

/** Pairs on the same worlds; with several of them, Holm's correction. */
function comparison(model: Model): HTMLElement | null {
  const shown = judged(model).map((j) => j.series);
  const first = shown[0];
  if (first === undefined) return null;
  if (shown.length > kVerdicts) {
    const under = conditions(model, view().slice).length > 0 ? 'Choose one condition in the bar below for its paired comparison in words; t' : 'T';
    return h('p', { class: 'aside' }, `${under}he section World by world compares all of them with one, on the same worlds.`);
  }
  // Of many points only the best two: each further comparison would cost the others power.
  const others = view().series.length > kVerdicts ? shown.slice(1, 2) : shown.slice(1);
  const all = others.map((s) => ({ s, r: pairs(model, first, s, 'time_to_goal_s') })).filter(({ r }) => r.worlds.length > 0);
  if (all.length === 0) return null;
  const corrected = holm(all.map(({ r }) => r.p));
  return h('div', { class: 'paired-words' }, ...all.map(({ s, r }, i) => {
    const p = corrected[i] ?? 1;
    const verdict = p < 0.05 ? `${(r.onlyB > r.onlyA ? s : first).name} is ahead` : 'the difference may be chance';
    return h('p', null, `On the same ${plural(r.worlds.length, 'world')}, ${s.name} ${often('succeeded', r.onlyB)} where ${first.name} failed, and ${often('failed', r.onlyA)} where it succeeded: ${verdict} (exact McNemar ${probability(p)}${all.length > 1 ? ', Holm' : ''}).`);
  }));
}

export function masthead(model: Model, live: HTMLElement | null): HTMLElement {
  const title = h('h1');
  const strip = h('dl', { class: 'facts' });
  const told = h('div', { class: 'notices' });
  const verdictBox = h('div', { class: 'verdicts' });
  const pairBox = h('div');
  const fill = (): void => {
    const { slice, family } = view();
    const suites = unique(model.page.points.map((p) => p.suite));
    replace(title, slice.suite || model.page.store.file, family !== '' ? h('span', null, ` ${family} only`) : null);
    replace(strip, ...facts(model).map(([name, value]) => h('div', null, h('dt', null, name), h('dd', null, value))));
    replace(told, ...notices(model, suites).map((text) => h('p', null, text)));
    const all = verdicts(model);
    verdictBox.classList.toggle('many', all.length > kVerdicts);
    replace(verdictBox, ...all);
    replace(pairBox, comparison(model));
  };
  fill();
  onView(fill);
  onTheme(fill);
  return h('header', { class: 'masthead', id: 'top' },
    h('p', { class: 'overline' }, 'moma \u00b7 Monte Carlo evaluation of mobile-manipulator controllers'),
    title, strip, live, told, verdictBox, pairBox);
}
