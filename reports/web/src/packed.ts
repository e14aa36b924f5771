// Bytes as reports/render packs them: base64, deflated, in planes of equal significance.

import { unzlibSync } from 'fflate';

/** As many values as there are, put back in order. */
export function unpacked<T>(data: string, type: { new (bytes: ArrayBuffer): T; readonly BYTES_PER_ELEMENT: number }): T {
  const planes = unzlibSync(Uint8Array.from(atob(data), (c) => c.charCodeAt(0)));
  const size = type.BYTES_PER_ELEMENT;
  const count = Math.floor(planes.length / size);
  const bytes = new Uint8Array(size * count);
  for (let k = 0; k < size; ++k) {
    for (let i = 0; i < count; ++i) bytes[size * i + k] = planes[k * count + i] ?? 0;
  }
  return new type(bytes.buffer);
}

/** Values of so many columns. Throws an Error where it is another number. */
export function columnsOf(data: string, n: number, columns: number, what: string): Float32Array {
  const values = unpacked(data, Float32Array);
  if (values.length !== n * columns) throw new Error(`${what} do not fit their columns`);
  return values;
}
