// The same suite over time: success of each controller in every store, in the order of their runs.

import { axis, curveNames, endLabels, tip, whisker, type FigureSpec } from '../chart';
import { inSlice, type Model, type SummaryRow } from '../data';
import { integer, percent, percentRange, sizes } from '../format';
import { seriesColour, seriesInk, type Palette } from '../theme';
import { view } from '../view';

interface Dot { at: number; row: SummaryRow }

export function isHistory(model: Model): boolean {
  return model.page.history === true && (model.page.stores?.length ?? 0) > 1;
}

/** Stores by the time of their latest run. */
function stores(model: Model): { label: string; when: string }[] {
  return (model.page.stores ?? []).map(({ label }) => ({ label, when: model.page.invocations.filter((i) => i.store === label).map((i) => i.started).sort().pop() ?? '' }))
    .sort((a, b) => (a.when < b.when ? -1 : a.when > b.when ? 1 : 0));
}

export function history(model: Model): FigureSpec {
  return {
    id: 'history',
    title: 'Success rate over time',
    caption: 'A dot per store with its 95 % Wilson interval, in the order of their runs; a line joins the versions of one controller. What changed between them is under Provenance.',
    empty: 'Two stores or more are needed.',
    draw: (p: Palette, width: number) => {
      const { slice, family } = view();
      const order = stores(model);
      const rows = (family === '' ? model.page.overall : model.page.summary.filter((s) => s.family === family)).filter((r) => inSlice(r, slice));
      const lines = new Map<string, Dot[]>();
      for (const row of rows) {
        const at = order.findIndex((s) => s.label === row.store);
        const lineage = model.page.points.find((p) => p.controller === row.controller && p.point === row.point && p.store === row.store)?.lineage ?? row.controller;
        const name = [lineage, row.point].filter((text) => text !== '').join(' \u00b7 ');
        if (at >= 0) lines.set(name, [...(lines.get(name) ?? []), { at, row }]);
      }
      const all = [...lines].map(([name, dots]) => ({ name, dots: dots.sort((a, b) => a.at - b.at) }));
      if (order.length < 2 || all.length === 0) return null;
      const named = curveNames(p, all.map((l) => l.name), width);
      const beside = (i: number): number => (i - (all.length - 1) / 2) * 0.04;
      return {
        height: 360 + named.above,
        note: `n = ${sizes(rows.map((r) => r.n))} trials a dot; 95 % Wilson, each by itself: for a difference on the same worlds see Pairs.`,
        columns: ['store', 'started', 'controller', 'point', 'n', 'success_rate', 'success_low', 'success_high'],
        rows: all.flatMap((l) => l.dots.map(({ at, row }) => [order[at]?.label ?? '', order[at]?.when ?? '', l.name, row.point, row.n, row.success_rate, row.success_low, row.success_high])),
        option: {
          grid: named.grid, ...named.option,
          xAxis: axis(p, '', { min: -0.4, max: order.length - 0.6, interval: 1, axisLabel: { color: p.muted, fontSize: 11, hideOverlap: true, customValues: order.map((_, i) => i), formatter: (v: number) => { const s = order[v]; return s === undefined ? '' : `${s.label}\n${s.when.slice(0, 10)}`; } }, splitLine: { show: false } }),
          yAxis: axis(p, '', { min: 0, max: 1, axisLabel: { color: p.muted, formatter: (v: number) => `${Math.round(100 * v)} %` } }),
          tooltip: {
            trigger: 'item',
            formatter: ({ data }: { data: { row?: SummaryRow } }) => (data.row === undefined ? '' : tip(data.row.controller, [['store', data.row.store ?? ''], ['success', `${percent(data.row.success_rate)} (${percentRange(data.row.success_low, data.row.success_high)})`], ['n', integer(data.row.n)]])),
          },
          series: [
            ...all.flatMap((l, i) => {
              const colour = seriesColour(p, i);
              return [
                { type: 'custom', silent: true, tooltip: { show: false }, data: l.dots.map((d) => [d.at + beside(i), d.row.success_low, d.row.success_high]), encode: { x: 0, y: [1, 2] }, renderItem: whisker(colour, false, 1.6) },
                { name: l.name, type: 'line', data: l.dots.map((d) => ({ value: [d.at + beside(i), d.row.success_rate], row: d.row })), symbol: 'circle', symbolSize: 9, lineStyle: { color: colour, width: 1.6 }, itemStyle: { color: colour }, emphasis: { disabled: true }, z: 4 },
              ];
            }),
            ...endLabels(all.flatMap((l, i) => { const d = l.dots[l.dots.length - 1]; return d === undefined ? [] : [{ name: l.name, x: d.at + beside(i), y: d.row.success_rate, colour: seriesInk(p, i) }]; }), named.room),
          ],
        },
      };
    },
  };
}
