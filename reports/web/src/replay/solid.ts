// Surfaces of the shapes that robots and objects are made of: no finer than can be seen, since without a graphics card every
// triangle costs microseconds. At a radius of 100 pixels, 24 sides are within a pixel of round.

import { BoxGeometry, BufferAttribute, BufferGeometry, CapsuleGeometry, CylinderGeometry, SphereGeometry } from 'three';

import type { ShapeJson } from './robot';

export function solid(shape: ShapeJson): BufferGeometry {
  const [a = 0.05, b = 0.1, c = 0.1] = shape.size ?? [];
  switch (shape.shape) {
    case 'box': return new BoxGeometry(a, b, c);
    case 'cylinder': return new CylinderGeometry(a, a, b, 32).rotateX(Math.PI / 2);
    case 'capsule': return new CapsuleGeometry(a, b, 6, 24).rotateX(Math.PI / 2);
    case 'convex': {
      const out = new BufferGeometry();
      out.setAttribute('position', new BufferAttribute(Float32Array.from(shape.vertices ?? []), 3));
      out.setIndex(shape.triangles ?? []);
      const flat = out.toNonIndexed();
      flat.computeVertexNormals();
      return flat;
    }
    default: return new SphereGeometry(a, 24, 16);
  }
}
