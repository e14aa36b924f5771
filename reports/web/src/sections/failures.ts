// The failure atlas: failures that look alike together, the worst of each ready to play.

import { causeOf, kCauses, kCauseTexts, type Cause } from '../causes';
import { grouped, outcomeName, type Model, type Outcome, type Series } from '../data';
import { button, h, replace, roving, table } from '../dom';
import { integer, percent, plural } from '../format';
import { goToSection } from '../go_to';
import { metric, withUnit } from '../metrics';
import { fillLater, footer, saveCsv } from '../panel';
import { select } from '../select';
import * as state from '../state';
import { outcomeColour, palette, seriesColour } from '../theme';
import { naming, view } from '../view';

interface Cluster { outcome: Outcome; series: Series; cause: Cause; what: string; rows: number[] }

function clusters(model: Model): Cluster[] {
  const t = model.trials;
  const failed = view().series.flatMap((series) => series.rows.filter((row) => !t.success(row)).map((row) => ({ series, row, outcome: t.outcome(row), ...causeOf(model, row) })));
  return [...grouped(failed, ({ outcome, series, cause, what }) => [outcome, series.index, cause, what].join('\n')).values()]
    .map((alike) => ({ ...alike[0]!, rows: alike.map(({ row }) => row) })).sort((a, b) => b.rows.length - a.rows.length);
}

function byCause(all: readonly Cluster[]): HTMLElement {
  const { series } = view();
  const p = palette();
  const causes = kCauses.filter((cause) => all.some((c) => c.cause === cause));
  const count = (s: Series, cause?: Cause): number => all.filter((c) => c.series === s && (cause === undefined || c.cause === cause)).reduce((sum, c) => sum + c.rows.length, 0);
  const most = Math.max(1, ...causes.flatMap((cause) => series.map((s) => count(s, cause))));
  return h('div', { class: 'panel', id: 'causes' },
    table('Failures by cause', ['Cause', ...series.map((s) => [h('span', { class: 'dotted', title: s.name, style: `--c:${seriesColour(p, s.mark)}` }, s.short), h('small', null, `${integer(count(s))} failures, n\u00a0=\u00a0${integer(s.rows.length)}`)])],
      causes.map((cause) => [[cause, h('small', null, kCauseTexts[cause])], ...series.map((s) => {
        const n = count(s, cause);
        return n === 0 ? '\u2013' : h('span', { class: 'share', style: `--w:${(100 * n) / most}%;--c:${seriesColour(p, s.mark)}` }, integer(n), h('small', null, percent(n / s.rows.length)));
      })]), 'causes'),
    footer(h('p', { class: 'note' }, 'Causes follow from what the store says of a trial, in the order of this table; they are no proof. \u201cBase misaligned\u201d and \u201clate detection\u201d need stored samples.', naming()),
      saveCsv('causes', () => ({ columns: ['cause', 'controller', 'point', 'failures', 'n'], rows: causes.flatMap((cause) => series.map((s) => [cause, s.controller, s.point, count(s, cause), s.rows.length])) }))));
}

export function failures(model: Model): HTMLElement {
  const box = roving(h('div', { class: 'atlas' }), 'button');
  const note = h('p', { class: 'note' });
  const causes = h('div');
  let open = false;
  const fill = (): void => {
    const all = clusters(model);
    replace(causes, all.length === 0 ? null : byCause(all));
    const p = palette();
    const few = innerWidth < 640 ? 5 : 12;
    const shown = open ? all : all.slice(0, few);
    const failed = all.reduce((sum, c) => sum + c.rows.length, 0);
    const met = view().series.reduce((sum, s) => sum + s.rows.length, 0);
    replace(box, ...shown.map((c) => {
      const of = metric(c.outcome === 'collision' ? 'collision_depth_m' : 'position_error_m');   // how bad
      const value = (row: number): number => model.trials.number(of.key, row);
      const ranked = [...c.rows].sort((a, b) => (value(b) || 0) - (value(a) || 0));
      const playable = ranked.find((row) => model.playable(model.trials.text('trial', row)));
      const row = playable ?? ranked[0] ?? 0;
      const trial = model.trials.text('trial', row);
      const of_ = c.series.rows.length;
      return h('article', { style: `--c:${outcomeColour(p, c.outcome)}` },
        h('h4', null, h('span', { class: 'chip' }, outcomeName(c.outcome)), h('span', { class: 'who', title: c.series.name }, c.series.short)),
        h('p', { class: 'why', title: kCauseTexts[c.cause] }, c.cause),
        h('p', { class: 'what' }, c.what || (c.outcome === 'timeout' ? 'the time ran out' : 'no reason given')),
        h('p', { class: 'count' }, h('b', null, integer(c.rows.length)), ` of ${plural(of_, 'trial')}, ${percent(c.rows.length / of_)}`),
        h('p', { class: 'worst' }, `${playable === undefined ? 'Worst' : 'Worst to play'}: world ${integer(model.trials.number('world', row))}`, Number.isFinite(value(row)) ? `, ${of.name} ${withUnit(of, value(row))}` : ''),
        h('div', { class: 'actions' },
          playable === undefined ? button('Command', () => select(trial, true)) : button('Play', () => select(trial, true), 'play'),
          button('List', () => {
            state.set({ outcome: c.outcome, q: c.outcome === 'collision' ? model.trials.text('link', row) : '', who: c.series.controller, in: 'trials' }, true);
            goToSection('trials');
          })));
    }));
    if (all.length === 0) replace(box, h('p', { class: 'empty' }, met === 0 ? 'No trial here has a result.' : 'No trial failed.'));
    replace(note, all.length === 0 ? '' : `${integer(failed)} of n = ${integer(met)} trials failed, in ${plural(all.length, 'kind')} (outcome, controller, cause, and what took part). `,
      all.length > few ? button(open ? 'Show fewer' : `Show all ${integer(all.length)}`, () => { open = !open; fill(); }) : null);
  };
  const element = h('div', null, causes, box, h('footer', null, note));
  fillLater(element, fill);
  return element;
}
