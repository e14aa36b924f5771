// Shares of gains as bars with their errors, the greatest first.

import { axis, kFont, nice, plain, tip, whisker, type Drawing } from '../chart';
import { percent } from '../format';
import { seriesColour, type Palette } from '../theme';

/** `error`: one standard error; null where there is none. */
export interface Share { name: string; key: string; share: number; error: number | null }

export function shareBars(p: Palette, width: number, shares: readonly Share[], note: string): Drawing {
  const bars = [...shares].sort((a, b) => b.share - a.share);
  const most = Math.min(1, Math.max(...bars.map((bar) => bar.share + (bar.error ?? 0))));
  const colour = seriesColour(p, 0);
  const errors = bars.flatMap((bar, i) => (bar.error === null ? [] : [[Math.max(0, bar.share - bar.error), Math.min(1, bar.share + bar.error), i]]));
  return {
    height: 60 + 26 * bars.length,
    note,
    columns: ['gain', 'share', 'error'],
    rows: bars.map((bar) => [bar.key, bar.share, bar.error]),
    option: {
      grid: { left: 4, right: 24, top: 8, bottom: 8, outerBoundsMode: 'same', outerBoundsContain: 'all' },
      xAxis: axis(p, '', { ...nice(0, Math.max(most, 0.05)), axisLabel: { color: p.muted, formatter: (v: number) => `${plain(100 * v)} %` } }),
      yAxis: {
        type: 'category', inverse: true, data: bars.map((_, i) => String(i)), axisLine: { show: false }, axisTick: { show: false }, splitLine: { show: false },
        axisLabel: { color: p.ink, fontSize: 12.5, fontFamily: kFont, interval: 0, width: Math.min(320, 0.4 * width), overflow: 'truncate', formatter: (i: string) => bars[Number(i)]?.name ?? '' },
      },
      tooltip: {
        trigger: 'item',
        formatter: ({ dataIndex }: { dataIndex: number }) => {
          const bar = bars[dataIndex];
          return bar === undefined ? '' : tip(bar.name, [['share', percent(bar.share)], ...(bar.error === null ? [] : [['error', percent(bar.error)] as const])], colour);
        },
      },
      series: [
        { type: 'bar', barWidth: 12, data: bars.map((bar, i) => ({ value: [bar.share, String(i)], itemStyle: { color: colour, opacity: 0.75 } })) },
        { type: 'custom', silent: true, tooltip: { show: false }, z: 3, data: errors, encode: { x: [0, 1], y: 2 }, renderItem: whisker(p.ink, true, 1.5) },
      ],
    },
  };
}
