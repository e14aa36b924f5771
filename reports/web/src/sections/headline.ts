// By how much, and where: success of the judged controllers on one axis, a row per family of worlds, the paired difference
// of two of them beside it, and what the one that is behind mostly fails by.

import { causeOf } from '../causes';
import { chance, errorsText, pairs, points, rates, type Rates } from '../compare';
import { conditions, onlyConditions } from '../conditions';
import { grouped, type Model, type Series, type SummaryRow } from '../data';
import { h, replace } from '../dom';
import { fixed, integer, percent, percentRange, plural, probability } from '../format';
import { afterFrame } from '../draw_order';
import { holm } from '../stats';
import { palette, seriesColour } from '../theme';
import { baseline, kFew, resultOf, rivalsOf, view } from '../view';

interface Judged { series: Series; row: SummaryRow | undefined }

function rateOf(judged: Judged): number {
  return judged.row?.success_rate ?? -1;
}

/** The shown series with their rows of the summary; of many, the few with the highest success rate, best first. */
export function judged(model: Model): Judged[] {
  const { slice, series } = view();
  const all = series.map((s) => ({ series: s, row: resultOf(s) }));
  if (all.length <= kFew || onlyConditions(model, slice)) return all;
  return all.sort((a, b) => rateOf(b) - rateOf(a)).slice(0, 3);
}

function rivals(shown: readonly Judged[]): [Series, Series] | null {
  const base = baseline();
  const allowed = base === undefined ? [] : rivalsOf(base, shown.map((j) => j.series));
  const best = shown.filter((j) => allowed.includes(j.series)).sort((a, b) => rateOf(b) - rateOf(a))[0]?.series;
  return base === undefined || best === undefined ? null : [base, best];
}

type Difference = Rates & { family: string };

/** World by world, for all families together first; `p` of a family is corrected over the families. */
function differences(model: Model, a: Series, b: Series, families: readonly string[]): Difference[] {
  const within = (s: Series, family: string): Series => (family === '' ? s : { ...s, rows: s.rows.filter((row) => model.trials.text('family', row) === family) });
  const all = ['', ...families].map((family): Difference => {
    const { worlds } = pairs(model, within(a, family), within(b, family), 'time_to_goal_s');
    return { ...rates(model, worlds), family };
  });
  const corrected = holm(all.slice(1).map((d) => d.success.p));
  all.slice(1).forEach((d, i) => { d.p = corrected[i] ?? 1; });
  return all;
}

/** "+34.0 points, 26.9 to 40.5, p < 0.001" */
function differenceText(d: Difference): Node[] {
  const r = d.success;
  if (r.n === 0) return [document.createTextNode('no common world')];
  return [h('b', null, `${points(r.value)} points`), h('span', null, `${fixed(100 * r.low, 1)} to ${fixed(100 * r.high, 1)}, ${chance(r, d.p)}`)];
}

function track(rows: readonly { series: Series; row: SummaryRow }[]): HTMLElement {
  const at = (v: number): string => `${(100 * v).toFixed(3)}%`;
  return h('div', { class: 'track' }, ...rows.map(({ series, row }, i) => h('div', {
    class: `whisker mark${series.mark % 4}`, style: `--c:${seriesColour(palette(), series.mark)};top:${(100 * (i + 0.5)) / rows.length}%`,
    role: 'img', 'aria-label': `${series.name}: success ${percent(row.success_rate)}, 95 % interval ${percentRange(row.success_low, row.success_high)}, n = ${integer(row.n)}`,
    title: `${series.name}: ${percent(row.success_rate)} (${percentRange(row.success_low, row.success_high)}), n = ${integer(row.n)}`,
  }, h('i', { class: 'line', style: `left:${at(row.success_low)};width:${at(row.success_high - row.success_low)}` }), h('i', { class: 'dot', style: `left:${at(row.success_rate)}` }))));
}

function forest(shown: readonly Judged[], pair: readonly [Series, Series] | null, told: readonly Difference[]): HTMLElement {
  const { family, families } = view();
  const lines = family !== '' ? [family] : ['', ...(families.length > 1 ? families : [])];
  const ticks = h('div', { class: 'ticks', 'aria-hidden': 'true' }, ...[0, 25, 50, 75, 100].map((v) => h('span', { style: `left:${v}%` }, v === 100 ? '100\u00a0%' : `${v}`)));
  return h('div', { class: pair === null ? 'forest' : 'forest paired', style: `--rows:${shown.length}` },
    h('div', { class: 'forest-head' }, h('span', null, 'worlds'), h('span', null, 'success, 95 % Wilson interval'),
      pair === null ? null : h('span', null, `${pair[1].short} less ${pair[0].short}, same worlds`)),
    ...lines.map((name) => {
      const found = shown.flatMap(({ series }) => {
        const row = resultOf(series, name);
        return row === undefined ? [] : [{ series, row }];
      });
      const difference = told.find((d) => d.family === (family === '' ? name : ''));
      return h('div', { class: 'forest-row' }, h('span', { class: 'where' }, name === '' ? 'all' : name), track(found),
        pair === null ? null : h('span', { class: 'difference' }, ...(difference === undefined ? [document.createTextNode('\u00a0')] : differenceText(difference))));
    }),
    h('div', { class: 'forest-row axis' }, h('span'), ticks, pair === null ? null : h('span')));
}

/** "succeeded twice", "never failed". */
function often(verb: string, count: number): string {
  return count === 0 ? `never ${verb}` : `${verb} ${['', 'once', 'twice'][count] ?? `${integer(count)}\u00a0times`}`;
}

function sentence(a: Series, b: Series, d: Difference): string {
  const r = d.success;
  const on = `On the same ${plural(r.n, 'world')}, `;
  const errors = errorsText(d, a.name, b.name);
  if (r.both + r.onlyA + r.onlyB === 0) return `${on}neither ${a.name} nor ${b.name} reached a goal: nothing tells them apart.${errors}`;
  if (r.onlyA + r.onlyB === 0) return `${on}${b.name} succeeded and failed exactly where ${a.name} did.${errors}`;
  const verdict = d.ahead === 0 ? 'the difference may be chance' : `${(d.ahead > 0 ? b : a).name} is ahead`;
  return `${on}${b.name} ${often('succeeded', r.onlyB)} where ${a.name} failed, and ${often('failed', r.onlyA)} where it succeeded: ${verdict} `
    + `(${points(r.value)} points, 95 % interval ${fixed(100 * r.low, 1)} to ${fixed(100 * r.high, 1)}; exact McNemar with Holm\u2019s correction, ${probability(d.p)}).${errors}`;
}

/** "holistic fails mainly in clutter: local minimum, 69 of 86." Of the trials at hand; null where it never fails. */
function whereItFails(model: Model, loser: Series): string | null {
  const t = model.trials;
  const failed = loser.rows.filter((row) => !t.success(row)).map((row) => ({ family: t.text('family', row), cause: causeOf(model, row).cause }));
  const [most = []] = [...grouped(failed, ({ family, cause }) => `${family}\n${cause}`).values()].sort((x, y) => y.length - x.length);
  const [first] = most;
  if (first === undefined) return null;
  const several = view().families.length > 1 && view().family === '';
  return `${loser.name} fails ${2 * most.length > failed.length ? 'mainly' : 'most often'}${several ? ` in ${first.family}` : ''}: ${first.cause}, ${integer(most.length)} of ${plural(failed.length, 'failure')}.`;
}

let painted = false;

/** Fills `box`. The first time the rates are painted before worlds are paired, whose place is kept. */
export function fillHeadline(model: Model, box: HTMLElement): void {
  const shown = judged(model);
  let withRows = shown.filter((j) => j.row !== undefined);
  if (withRows.length === 0) {
    replace(box);
    return;
  }
  if (shown.length > kFew) {
    const under = conditions(model, view().slice).length > 0 ? 'Choose one condition in the bar below for its paired comparison in words; t' : 'T';
    replace(box, h('p', { class: 'aside' }, `${under}he section Pairs compares all of them with one, on the same worlds.`));
    return;
  }
  const pair = rivals(withRows);
  const now = view();
  const later = !painted && pair !== null;
  painted = true;
  if (later) {
    afterFrame(() => { if (view() === now) fillHeadline(model, box); });
  }
  const told = pair === null || later ? [] : differences(model, ...pair, now.families);
  const [all] = told;
  // The baseline stands beside the best, though it may not be one of them.
  if (pair !== null && !withRows.some((j) => j.series === pair[0])) withRows = [...withRows, { series: pair[0], row: undefined }];
  const fails = h('p', { class: 'fails' });
  replace(box, forest(withRows, pair, told),
    later ? h('div', { class: 'paired-words soon' })
      : pair === null || all === undefined || all.success.n === 0 ? null : h('div', { class: 'paired-words' }, h('p', null, sentence(...pair, all)), fails));
  if (pair === null || all === undefined) return;
  const loser = all.success.onlyB >= all.success.onlyA ? pair[0] : pair[1];
  afterFrame(() => { if (view() === now) replace(fails, whereItFails(model, loser)); });
}
