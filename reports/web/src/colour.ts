// Colours as numbers: contrast by WCAG 2.2, text that can be read on a colour or in it, steps of a ramp.

type Rgb = [number, number, number];

function rgb(hex: string): Rgb {
  return [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16)) as Rgb;
}

function hex(of: Rgb): string {
  return `#${of.map((v) => Math.round(v).toString(16).padStart(2, '0')).join('')}`;
}

/** Relative luminance, 0 to 1. */
export function luminance(colour: string): number {
  const [r, g, b] = rgb(colour).map((v) => (v / 255 <= 0.04045 ? v / 255 / 12.92 : ((v / 255 + 0.055) / 1.055) ** 2.4)) as Rgb;
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

/** 1 (equal) to 21. */
export function contrast(a: string, b: string): number {
  const [high, low] = [luminance(a), luminance(b)].sort((x, y) => y - x) as [number, number];
  return (high + 0.05) / (low + 0.05);
}

function mix(a: string, b: string, share: number): string {
  const [from, to] = [rgb(a), rgb(b)];
  return hex(from.map((v, i) => v + share * ((to[i] ?? v) - v)) as Rgb);
}

/** Black or white, whichever reads better on `colour`: at least 4.5. */
export function inkOn(colour: string): string {
  return contrast(colour, '#ffffff') >= contrast(colour, '#000000') ? '#ffffff' : '#000000';
}

/** `colour`, towards `ink` as far as it takes to be read as text on `background`. */
export function readable(colour: string, ink: string, background: string): string {
  for (let share = 0; share < 1; share += 0.1) {
    const now = mix(colour, ink, share);
    if (contrast(now, background) >= 4.5) return now;
  }
  return ink;
}

export function along(ramp: readonly string[], t: number): string {
  const place = Math.min(1, Math.max(0, t)) * (ramp.length - 1);
  const below = Math.min(ramp.length - 2, Math.floor(place));
  return mix(ramp[below] ?? '#808080', ramp[below + 1] ?? '#808080', place - below);
}
