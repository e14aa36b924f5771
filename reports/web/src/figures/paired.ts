// Two controllers on the same worlds: one dot per world, A along x, B along y.

import { axis, kFont, legendHeight, nice, plain, tip, type FigureSpec } from '../chart';
import { pairs, pairsText } from '../compare';
import { outcomeName } from '../data';
import { choice } from '../dom';
import { integer, upper } from '../format';
import { axisName, kMetrics, metric, withUnit } from '../metrics';
import { select } from '../select';
import * as state from '../state';
import { extent } from '../stats';
import { outcomeColour, seriesColour, type Palette } from '../theme';
import { baseline, bestRival, view } from '../view';

/** The two series that are compared: as chosen, else the baseline with the best of the others that are shown. */
function chosen(): [number, number] {
  const { all } = view();
  const valid = (text: string): number | undefined => all.find((s) => text !== '' && s.index === Number(text))?.index;
  const a = valid(state.get('f.a')) ?? baseline()?.index ?? 0;
  const b = valid(state.get('f.b')) ?? bestRival(all.find((s) => s.index === a))?.index ?? a;
  return [a, b];
}

export function paired(): FigureSpec {
  state.setDefault('f.paired', 'time_to_goal_s');
  return {
    id: 'paired',
    title: () => `${upper(metric(state.get('f.paired')).name)} on the same worlds`,
    caption: () => `Each dot is one world that both controllers met. Where only one has a value, its dot lies in the strip named none. ${view().model.clickPlays()}`,
    empty: 'Two controllers that met the same worlds are needed.',
    controls: (redraw) => {
      const { all, model, series } = view();
      const [a, b] = chosen();
      const names = all.map((s) => [String(s.index), s.short] as const);
      const metrics = kMetrics.filter((m) => series.some((s) => model.trials.any(m.key, s.rows))
        && m.of !== 'world');
      const pick = (key: string) => (value: string) => { state.set({ [key]: value }); redraw(); };
      return [
        choice('Metric', metrics.map((m) => [m.key, axisName(m)] as const), state.get('f.paired'), pick('f.paired')),
        ...(all.length > 2 ? [choice('Along x', names, String(a), pick('f.a')), choice('Along y', names, String(b), pick('f.b'))] : []),
      ];
    },
    draw: (p: Palette, width: number) => {
      const { model, all } = view();
      const [ia, ib] = chosen();
      const a = all.find((s) => s.index === ia);
      const b = all.find((s) => s.index === ib);
      if (a === undefined || b === undefined || ia === ib) return null;
      const of = metric(state.get('f.paired'));
      const result = pairs(model, a, b, of.key);
      if (result.worlds.length === 0) return null;
      const t = model.trials;
      const ends = extent(result.worlds.flatMap((w) => [w.x, w.y]));
      if (ends === null) return null;
      const range = nice(...ends);
      // Strips beside the axes, outside their numbers, are for worlds in which one has no value; dots are spread in them.
      const strip = range.interval;
      const least = range.min - strip;
      const spread = (world: number): number => least + strip * (0.2 + 0.6 * ((world * 0.618033988749895) % 1));
      const limits = { min: least, max: range.max, interval: range.interval };
      const dots = result.worlds.filter((w) => Number.isFinite(w.x) || Number.isFinite(w.y)).map((w) => ({
        value: [Number.isFinite(w.x) ? w.x : spread(w.world), Number.isFinite(w.y) ? w.y : spread(w.world)],
        w,
      }));
      const colour = (w: (typeof result.worlds)[number]): string => {
        const sa = t.success(w.a);
        const sb = t.success(w.b);
        return sa && sb ? outcomeColour(p, 'success') : sa ? seriesColour(p, a.mark) : sb ? seriesColour(p, b.mark) : p.faint;
      };
      const groups: [string, (w: (typeof result.worlds)[number]) => boolean, string][] = [
        ['both succeed', (w) => t.success(w.a) && t.success(w.b), 'circle'],
        [`only ${a.short}`, (w) => t.success(w.a) && !t.success(w.b), 'triangle'],
        [`only ${b.short}`, (w) => !t.success(w.a) && t.success(w.b), 'diamond'],
        ['neither', (w) => !t.success(w.a) && !t.success(w.b), 'rect'],
      ];
      const used = groups.map(([name, belongs, symbol]) => ({ name, symbol, data: dots.filter((d) => belongs(d.w)) })).filter((g) => g.data.length > 0);
      const label = { color: p.muted, fontSize: 11, hideOverlap: true, formatter: (v: number) => (v < range.min - 1e-6 * range.interval ? '' : plain(v)) };
      const top = legendHeight(used.map((g) => g.name), width);
      const left = 74;
      const side = Math.max(180, Math.min(width - left - 24, 460));
      return {
        height: top + side + 62,
        note: pairsText(result, a.short, b.short, of),
        columns: ['family', 'world', `${of.key}_a`, `${of.key}_b`, 'outcome_a', 'outcome_b', 'trial_a', 'trial_b'],
        rows: result.worlds.map((w) => [t.text('family', w.a), w.world, w.x, w.y, t.outcome(w.a), t.outcome(w.b), t.text('trial', w.a), t.text('trial', w.b)]),
        option: {
          legend: { data: used.map((g) => g.name), top: 0, left: 0, itemWidth: 10, itemHeight: 10, itemGap: 16, selectedMode: false, textStyle: { color: p.muted, fontSize: 12 } },
          grid: { left, top, width: side, height: side, outerBoundsMode: 'none' },
          xAxis: axis(p, `${a.short}: ${axisName(of)}`, { ...limits, nameGap: 30, axisLabel: label }),
          yAxis: axis(p, `${b.short}: ${axisName(of)}`, { ...limits, nameGap: 50, axisLabel: label }),
          tooltip: {
            trigger: 'item',
            formatter: ({ data }: { data: (typeof dots)[number] }) => tip(`${t.text('family', data.w.a)} world ${integer(data.w.world)}`, [
              [a.short, `${outcomeName(t.outcome(data.w.a))}, ${withUnit(of, data.w.x)}`],
              [b.short, `${outcomeName(t.outcome(data.w.b))}, ${withUnit(of, data.w.y)}`],
            ]),
          },
          series: [
            {
              type: 'custom', silent: true, z: 0, tooltip: { show: false }, data: [[least, least]],
              renderItem: (_: unknown, api: { coord: (at: number[]) => number[] }) => {
                const [x0 = 0, y0 = 0] = api.coord([least, least]);
                const [x1 = 0, y1 = 0] = api.coord([range.min, range.min]);
                const [x2 = 0, y2 = 0] = api.coord([range.max, range.max]);
                const text = (x: number, y: number, turn: number) => ({ type: 'text', x, y, rotation: turn, style: { text: 'none', fill: p.muted, font: `11px ${kFont}`, align: 'center', verticalAlign: 'middle' } });
                return {
                  type: 'group',
                  children: [
                    { type: 'rect', shape: { x: x0, y: y2, width: x1 - x0, height: y0 - y2 }, style: { fill: p.rule, opacity: 0.35 } },
                    { type: 'rect', shape: { x: x0, y: y1, width: x2 - x0, height: y0 - y1 }, style: { fill: p.rule, opacity: 0.35 } },
                    text((x0 + x1) / 2, y0 + 11, 0), text(x0 - 10, (y0 + y1) / 2, Math.PI / 2),
                  ],
                };
              },
            },
            {
              type: 'line', data: [[range.min, range.min], [range.max, range.max]], showSymbol: false, silent: true, tooltip: { show: false },
              lineStyle: { color: p.faint, width: 1, type: [4, 4] }, z: 1,
            },
            ...used.map((g) => ({
              name: g.name, type: 'scatter', symbol: g.symbol, symbolSize: g.symbol === 'circle' ? 7 : 8.5, data: g.data,
              itemStyle: { color: g.data[0] === undefined ? p.ink : colour(g.data[0].w), opacity: 0.72, borderColor: p.surface, borderWidth: 0.5 },
              cursor: 'pointer',
            })),
          ],
        },
      };
    },
    click: (data) => {
      const w = (data as { w?: { a: number; b: number } } | undefined)?.w;
      if (w === undefined) return;
      const { model } = view();
      // The failed one of the two is the one to look at.
      const row = model.trials.success(w.a) && !model.trials.success(w.b) ? w.b : w.a;
      state.set({ beside: model.trials.text('trial', row === w.a ? w.b : w.a) });
      select(model.trials.text('trial', row), true);
    },
  };
}
