// Bytes as reports/render packs them: base64, deflated, in planes of equal significance.

import { unzlibSync } from 'fflate';

/** `count` values of `size` bytes each, put back in order. Throws an Error where it is another number. */
export function unpacked(data: string, count: number, size: number, what: string): ArrayBuffer {
  const planes = unzlibSync(Uint8Array.from(atob(data), (c) => c.charCodeAt(0)));
  if (planes.length !== size * count) throw new Error(`${what} do not fit their columns`);
  const bytes = new Uint8Array(size * count);
  for (let k = 0; k < size; ++k) {
    for (let i = 0; i < count; ++i) bytes[size * i + k] = planes[k * count + i] ?? 0;
  }
  return bytes.buffer;
}

/** 16-bit values, as many as there are. */
export function unpacked16(data: string): Uint16Array {
  const planes = unzlibSync(Uint8Array.from(atob(data), (c) => c.charCodeAt(0)));
  const count = planes.length >> 1;
  return Uint16Array.from({ length: count }, (_, i) => (planes[i] ?? 0) | ((planes[count + i] ?? 0) << 8));
}
