// What a robot looks like: the visual elements of its URDF, as reports/render/mesh_data.h writes them.

import { BufferAttribute, BufferGeometry, Color, Matrix4 } from 'three';
import { toCreasedNormals } from 'three/examples/jsm/utils/BufferGeometryUtils.js';

import { unpacked16 } from '../packed';
import { poseMatrix } from './robot';
import { solid } from './solid';

interface PartJson {
  link: string; position: number[]; rotation: number[]; colour?: number[];
  shape?: string; size?: number[];
  n?: number; low?: number[]; step?: number; vertices?: string; triangles?: string;
}

export interface Part { link: string; local: Matrix4; colour: string | null; surface: BufferGeometry }

/** Edges sharper than this stay edges [rad]. */
const kCrease = 0.6;

function surface({ shape, size, n = 0, low = [], step = 0, vertices = '', triangles = '' }: PartJson): BufferGeometry {
  if (shape !== undefined) return solid(size === undefined ? { shape } : { shape, size });
  const places = unpacked16(vertices);
  if (places.length !== 3 * n) throw new Error('a mesh does not fit its number of vertices');
  const points = new Float32Array(3 * n);
  for (let i = 0; i < points.length; ++i) points[i] = (low[i % 3] ?? 0) + step * (places[i] ?? 0);
  const changes = unpacked16(triangles);
  const indices = new Uint16Array(changes.length);
  let last = 0;
  for (let i = 0; i < changes.length; ++i) indices[i] = last = (last + (changes[i] ?? 0)) & 0xffff;
  const mesh = new BufferGeometry();
  mesh.setAttribute('position', new BufferAttribute(points, 3));
  mesh.setIndex(new BufferAttribute(indices, 1));
  return toCreasedNormals(mesh, kCrease);
}

/** Throws an Error where a mesh cannot be read. */
export function readLook(look: unknown): Part[] {
  return ((look ?? []) as PartJson[]).map((part) => {
    const [r = 0, g = 0, b = 0] = part.colour ?? [];
    return {
      link: part.link, local: poseMatrix(part), surface: surface(part),
      colour: part.colour === undefined ? null : `#${new Color().setRGB(r, g, b, 'srgb').getHexString()}`,
    };
  });
}
