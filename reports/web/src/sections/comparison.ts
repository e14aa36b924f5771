// All shown controllers against one of them, on the worlds that both met.

import { drawLater, drawOrWait } from '../draw_order';
import { kMeanInterval, pairs, type Pairs } from '../compare';
import type { Model, Series } from '../data';
import { choice, download, h, replace } from '../dom';
import { csv, fixed, integer, plural, probability, signed } from '../format';
import { kMetrics as kAll, metric, withUnit, type Metric } from '../metrics';
import * as state from '../state';
import { holm, pairedRate } from '../stats';
import { onTheme, palette, seriesColour } from '../theme';
import { baseline, onView, rivalsOf, view } from '../view';

/** Those that are compared: a few of moma's, and the suites' own. */
function compared(): string[] {
  return ['time_to_goal_s', 'manip_mean', 'clearance_min_m', 'command_change_mean', 'path_ee_m', ...kAll.filter((m) => m.own).map((m) => m.key)];
}
/** More comparisons than this cost each other too much power. */
const kMost = 12;

interface Row { series: Series; rates: { name: string; only: [number, number]; n: number; p: number }[]; metrics: { of: Metric; r: Pairs }[] }

function rowsAgainst(model: Model, base: Series): Row[] {
  return rivalsOf(base, view().series).slice(0, kMost).map((s) => {
    const metrics = compared().map((key) => ({ of: metric(key), r: pairs(model, base, s, key) }));
    const worlds = metrics[0]?.r.worlds ?? [];
    const rate = (name: string, hit: (row: number) => boolean): Row['rates'][number] => {
      const only: [number, number] = [worlds.filter((w) => hit(w.a) && !hit(w.b)).length, worlds.filter((w) => hit(w.b) && !hit(w.a)).length];
      return { name, only, n: worlds.length, p: pairedRate(...only, worlds.length).p };
    };
    const t = model.trials;
    return { series: s, metrics, rates: [rate('Success', (row) => t.success(row)), rate('Collision', (row) => t.outcome(row) === 'collision')] };
  }).filter((row) => (row.rates[0]?.n ?? 0) > 0);
}

export function comparison(model: Model): HTMLElement {
  const box = h('div', { class: 'scroll', tabindex: 0, role: 'region', 'aria-label': 'Paired comparison' });
  const controls = h('div', { class: 'controls' });
  const note = h('p', { class: 'note' });
  const saveButton = h('button', { type: 'button', class: 'quiet' }, 'Data CSV');
  let table: (string | number | null)[][] = [];
  const fill = (): void => {
    const { series } = view();
    const base = baseline();
    const rows = base === undefined ? [] : rowsAgainst(model, base);
    replace(controls, base === undefined || series.length < 2 ? null
      : choice('Compared with', (series.includes(base) ? series : [base, ...series]).map((s) => [String(s.index), s.short] as const), String(base.index), (value) => { state.set({ base: value }); fill(); }));
    saveButton.hidden = rows.length === 0;
    table = [];
    if (base === undefined || rows.length === 0) {
      replace(box, h('p', { class: 'empty' }, 'Two controllers that met the same worlds are needed.'));
      replace(note);
      return;
    }
    const corrected = holm(rows.flatMap((row) => row.rates.map((r) => r.p)));
    let place = 0;
    replace(box, h('table', { class: 'plain' },
      h('thead', null, h('tr', null, h('th', { scope: 'col' }, 'Controller'), h('th', { scope: 'col' }, 'Worlds'),
        ...['Success', 'Collision'].map((name) => h('th', { scope: 'col' }, name, h('small', null, 'percentage points, exact McNemar'))),
        ...compared().map((key) => h('th', { scope: 'col' }, metric(key).name, h('small', null, 'mean difference'))))),
      h('tbody', null, ...rows.map((row) => h('tr', null,
        h('th', { scope: 'row' }, h('span', { class: 'dotted', style: `--c:${seriesColour(palette(), row.series.mark)}` }, row.series.name)),
        h('td', null, integer(row.rates[0]?.n ?? 0)),
        ...row.rates.map((r) => {
          const p = corrected[place++] ?? 1;
          const d = pairedRate(...r.only, r.n);
          table.push([row.series.name, base.name, r.name.toLowerCase(), r.n, d.value, d.low, d.high, r.only[0], r.only[1], r.p, p]);
          return h('td', null, h('b', null, signed(100 * d.value, (v) => fixed(v, 1))), h('small', null, `${fixed(100 * d.low, 1)} to ${fixed(100 * d.high, 1)}, ${r.only[0] + r.only[1] === 0 ? 'no world differs' : probability(p)}`));
        }),
        ...row.metrics.map(({ of, r }) => {
          table.push([row.series.name, base.name, of.key, r.differences, r.mean, r.interval.low, r.interval.high, null, null, null, null]);
          return r.differences === 0 ? h('td', null, '\u2013')
            : h('td', null, h('b', null, signed(r.mean, (v) => withUnit(of, v))), h('small', null, `${Number.isFinite(r.interval.low) ? `${of.write(r.interval.low)} to ${of.write(r.interval.high)}` : 'too few for an interval'}, n\u00a0=\u00a0${integer(r.differences)}`));
        }))))));
    replace(note, `Each controller less ${base.name}, world by world. Rates: 95 % interval of paired proportions (Bonett and Price), exact McNemar test with Holm\u2019s correction over ${plural(corrected.length, 'test')}. Metrics: where both trials have them, mean difference with its 95 % interval (${kMeanInterval}).`);
  };
  saveButton.addEventListener('click', () => download('comparison.csv', 'text/csv',
    csv(['controller', 'baseline', 'measure', 'n', 'difference', 'low', 'high', 'only_baseline', 'only_controller', 'p', 'p_holm'], table)));
  const element = h('div', { class: 'panel', id: 'comparison' }, h('div', { class: 'panel-head' }, h('h3', null, 'Paired comparison'), controls), box, h('footer', null, note, h('div', { class: 'actions' }, saveButton)));
  drawLater(element, fill);   // it takes its time
  const refill = (): void => drawOrWait(element, fill);
  onView(refill);
  onTheme(refill);
  return element;
}
