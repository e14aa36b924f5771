// The run and its result: one sentence per controller.

import { disturbances } from '../conditions';
import { inSlice, type Model, type SummaryRow } from '../data';
import { h, replace, terms } from '../dom';
import { fixed, integer, list, percent, percentNumber, percentRange, plural } from '../format';
import { verdictOf } from '../search_words';
import { keepFilled } from '../panel';
import { palette, seriesColour } from '../theme';
import { kFew, view } from '../view';
import { fillHeadline, judged } from './headline';
import { notices } from './notices';

function unique(values: readonly string[]): string[] {
  return [...new Set(values)];
}

/** More names than this are not all written at the top of the page. */
const kNames = 6;

const kMonths = ['January', 'February', 'March', 'April', 'May', 'June', 'July', 'August', 'September', 'October', 'November', 'December'];

/** "22 November 2026", without the browser's calendar, which takes its time to be read before the first paint. */
function when(iso: string): string {
  const date = new Date(iso);
  return Number.isNaN(date.getTime()) ? iso : `${date.getUTCDate()} ${kMonths[date.getUTCMonth()]} ${date.getUTCFullYear()}`;
}

function names(all: readonly string[]): string {
  return all.length <= kNames ? all.join(', ') : `${all.slice(0, kNames - 3).join(', ')} and ${integer(all.length - kNames + 3)} others`;
}

function facts(model: Model): [string, string][] {
  const { page } = model;
  const { slice, families } = view();
  const points = model.pointsOf(slice);
  const all = page.invocations.filter((i) => i.suite === slice.suite);
  const working = all.filter((i) => i.trials_done > 0);
  const runs = working.length > 0 ? working : all;   // one that found every trial in the store has made none of them
  const latest = runs[0];
  const trials = page.overall.filter((o) => inSlice(o, slice)).reduce((sum, o) => sum + o.n, 0);
  const versions = unique(runs.map((r) => `${r.moma_version}${r.git_commit ? ` (${r.git_commit.slice(0, 7)}${r.git_dirty ? ', changed' : ''})` : ''}`));
  const seeds = list(unique(points.map((p) => String(p.worlds?.seed ?? '')).filter((s) => s !== '')));
  const between = disturbances(model, slice);
  return [
    ['Robot', slice.robot],
    ['Controllers', names(unique(points.map((p) => p.controller))) + (points.some((p) => p.point !== '') ? `, ${plural(points.length, 'point')}` : '')],
    ['Worlds', `${families.join(', ') || 'none'}${seeds === '' ? '' : `; seed ${seeds}`}`],
    ['Simulation', `${slice.mode}, ${unique(points.map((p) => `${1e3 * p.control_period_s} ms`)).join(', ')} control period`],
    ...(between === '' ? [] : [['Disturbances', between] as [string, string]]),
    ['Trials', integer(trials)],
    ...(latest === undefined ? [] : [['Run', `${when(latest.started)} on ${unique(runs.map((r) => r.host)).join(', ')}`], ['moma', versions.join(', ')]] as [string, string][]),
  ];
}

function sentence(name: string, row: SummaryRow): string {
  const reached = Math.round(row.success_rate * row.n);
  const hits = Math.round(row.collision_rate * row.n);
  const collided = hits === 0 ? 'None collided' : `${integer(hits)}\u00a0collided`;
  const median = row.time_to_goal_median_s;
  const time = median === null ? '' : ` Median time to goal ${fixed(median, median < 10 ? 2 : 1)}\u00a0s.`;
  return `${name} reached the goal in ${integer(reached)} of ${plural(row.n, 'trial')} (95 % interval ${percentRange(row.success_low, row.success_high)}). `
    + `${collided} (${percent(row.collision_rate)}, ${percentRange(row.collision_low, row.collision_high)}).${time}`
    + (row.errors === 0 ? '' : ` ${plural(row.errors, 'trial')} ended by an error, which is no success${row.success_without_errors === null ? '' : `; of the others ${percent(row.success_without_errors)} succeeded`}.`);
}

function verdicts(model: Model): HTMLElement[] {
  const { all } = view();
  const shown = judged(model);
  const what = all.some((s) => s.point !== '') ? 'point' : 'controller';
  return shown.map(({ series: s, row }) => {
    const words = row === undefined ? [h('p', null, 'has no trials among these worlds.')]
      : [h('p', { class: 'rate' }, percentNumber(row.success_rate), h('small', null, '\u00a0%')), h('p', { class: 'words' }, sentence(s.point === '' ? s.name : 'It', row))];
    return h('article', { class: 'verdict', style: `--c:${seriesColour(palette(), s.mark)}` }, h('h2', null, s.name), ...words);
  }).concat(all.length > shown.length
    ? [h('p', { class: 'aside' }, shown.length === view().series.length ? `${integer(shown.length)} of ${plural(all.length, what)}, as chosen; all are in the table below.`
      : `The best ${integer(shown.length)} of ${plural(all.length, what)}; all are in the table below. The best of many look better on the worlds that chose them than they are: confirm them on other worlds.`)]
    : []);
}

export function masthead(model: Model, live: HTMLElement | null): HTMLElement {
  const title = h('h1');
  const strip = h('dl', { class: 'facts' });
  const told = h('div', { class: 'notices' });
  const verdictBox = h('div', { class: 'verdicts' });
  const noteBox = h('div');
  const found = h('div', { class: 'paired-words found' });
  const pairBox = h('div');
  const fill = (): void => {
    const { slice, family } = view();
    const suites = unique(model.page.points.map((p) => p.suite));
    replace(title, slice.suite || model.page.store.file, family !== '' ? h('span', null, ` ${family} only`) : null);
    replace(strip, ...terms(facts(model)));
    const noted = [model.page.notes ?? '', model.page.invocations.find((i) => i.suite === slice.suite && (i.notes ?? '') !== '')?.notes ?? ''].join('\n\n').trim();
    replace(noteBox);
    // The parser of notes is run only where there are some.
    if (noted !== '') void import('../markdown').then(({ markdown }) => { if (view().slice === slice) replace(noteBox, markdown(noted)); });
    replace(told, ...notices(model, suites).map((text) => h('p', null, text)));
    const all = verdicts(model);
    verdictBox.classList.toggle('many', all.length > kFew);
    replace(verdictBox, ...all);
    fillHeadline(model, pairBox);
    replace(found, ...model.page.tuning.map((search) => { const [first, ...rest] = verdictOf(search); return h('div', null, h('p', null, first ?? ''), ...rest.map((text) => h('p', { class: 'aside' }, text))); }));
  };
  keepFilled(fill);
  return h('header', { class: 'masthead', id: 'top' },
    h('p', { class: 'overline' }, 'moma \u00b7 Monte Carlo evaluation of mobile-manipulator controllers'),
    title, noteBox, strip, live, told, found, verdictBox, pairBox);
}
