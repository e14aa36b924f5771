// All shown controllers against one of them, on the worlds that both met.

import { chance, kMeanInterval, pairs, points, rates, type Pairs, type Rates } from '../compare';
import type { Model, Series } from '../data';
import { choice, dotted, h, replace, table } from '../dom';
import { fixed, integer, plural, signed } from '../format';
import { kMetrics, withUnit, type Metric } from '../metrics';
import { fillLater, footer, saveCsv } from '../panel';
import * as state from '../state';
import { holm, type PairedRate } from '../stats';
import { palette, seriesColour } from '../theme';
import { baseline, rivalsOf, view } from '../view';

/** Metrics of the table of results. */
function compared(): Metric[] {
  return kMetrics.filter((m) => m.summary !== undefined || m.own);
}

/** More comparisons than this cost each other too much power. */
const kMost = 12;

interface Row { series: Series; rates: Rates; metrics: { of: Metric; r: Pairs }[] }

function rowsAgainst(model: Model, base: Series): Row[] {
  return rivalsOf(base, view().series).slice(0, kMost).map((series) => {
    const metrics = compared().map((of) => ({ of, r: pairs(model, base, series, of.key) }));
    return { series, metrics, rates: rates(model, metrics[0]?.r.worlds ?? []) };
  }).filter((row) => row.rates.success.n > 0);
}

export function comparison(model: Model): HTMLElement {
  const box = h('div');
  const controls = h('div', { class: 'controls' });
  const note = h('p', { class: 'note' });
  let data: (string | number | null)[][] = [];
  const saveButton = saveCsv('comparison', () => ({ columns: ['controller', 'baseline', 'measure', 'n', 'difference', 'low', 'high', 'only_baseline', 'only_controller', 'p', 'p_holm'], rows: data }));
  const fill = (): void => {
    const { series } = view();
    const base = baseline();
    const rows = base === undefined ? [] : rowsAgainst(model, base);
    replace(controls, base === undefined || series.length < 2 ? null
      : choice('Compared with', (series.includes(base) ? series : [base, ...series]).map((s) => [String(s.index), s.short] as const), String(base.index), (value) => { state.set({ base: value }); fill(); }));
    saveButton.hidden = rows.length === 0;
    data = [];
    if (base === undefined || rows.length === 0) {
      replace(box, h('p', { class: 'empty' }, 'Two controllers that met the same worlds are needed.'));
      replace(note);
      return;
    }
    const tested = rows.flatMap(({ rates: { success, collision } }) => [success, collision]);
    const corrected = new Map(holm(tested.map(({ p }) => p)).map((p, i) => [tested[i], p]));
    const save = (of: Series, name: string, d: PairedRate, p: number | null): void => {
      data.push([of.name, base.name, name, d.n, d.value, d.low, d.high, d.onlyA, d.onlyB, d.p, p]);
    };
    const sansErrors = ({ series: of, rates: { sansErrors: d } }: Row): HTMLElement | null => {
      if (d === null) return null;
      save(of, 'success without errors', d, null);
      return h('small', { class: 'errors' }, d.n === 0 ? 'errors in every world' : `${points(d.value)} without errors, n\u00a0=\u00a0${integer(d.n)}`);
    };
    replace(box, table('Paired comparison',
      ['Controller', 'Worlds', ...['Success', 'Collision'].map((name) => [name, h('small', null, 'percentage points, exact McNemar')]), ...compared().map((of) => [of.name, h('small', null, 'mean difference')])],
      rows.map((row) => [
        dotted(seriesColour(palette(), row.series.mark), row.series.name), integer(row.rates.success.n),
        ...(['success', 'collision'] as const).map((name) => {
          const d = row.rates[name];
          const p = corrected.get(d) ?? 1;
          save(row.series, name, d, p);
          return [h('b', null, points(d.value)), h('small', null, `${fixed(100 * d.low, 1)} to ${fixed(100 * d.high, 1)}, ${chance(d, p)}`), name === 'success' ? sansErrors(row) : null];
        }),
        ...row.metrics.map(({ of, r }) => {
          data.push([row.series.name, base.name, of.key, r.differences, r.mean, r.interval.low, r.interval.high, null, null, null, null]);
          return r.differences === 0 ? '\u2013'
            : [h('b', null, signed(r.mean, (v) => withUnit(of, v))), h('small', null, `${Number.isFinite(r.interval.low) ? `${of.write(r.interval.low)} to ${of.write(r.interval.high)}` : 'too few for an interval'}, n\u00a0=\u00a0${integer(r.differences)}`)];
        }),
      ])));
    replace(note, `Each controller less ${base.name}, world by world. Rates: 95 % interval of paired proportions (Bonett and Price), exact McNemar test with Holm\u2019s correction over ${plural(tested.length, 'test')}. Metrics: where both trials have them, mean difference with its 95 % interval (${kMeanInterval}).`);
  };
  const element = h('div', { class: 'panel', id: 'comparison' }, h('div', { class: 'panel-head' }, h('h3', null, 'Paired comparison'), controls), box, footer(note, saveButton));
  fillLater(element, fill);
  return element;
}
