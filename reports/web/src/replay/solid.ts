// Surfaces of the shapes that robots and objects are made of.

import { BoxGeometry, BufferAttribute, BufferGeometry, CapsuleGeometry, CylinderGeometry, SphereGeometry } from 'three';

import type { ShapeJson } from './robot';

export function solid(shape: ShapeJson): BufferGeometry {
  const [a = 0.05, b = 0.1, c = 0.1] = shape.size ?? [];
  switch (shape.shape) {
    case 'box': return new BoxGeometry(a, b, c);
    case 'cylinder': return new CylinderGeometry(a, a, b, 36).rotateX(Math.PI / 2);
    case 'capsule': return new CapsuleGeometry(a, b, 10, 28).rotateX(Math.PI / 2);
    case 'convex': {
      const out = new BufferGeometry();
      out.setAttribute('position', new BufferAttribute(Float32Array.from(shape.vertices ?? []), 3));
      out.setIndex(shape.triangles ?? []);
      const flat = out.toNonIndexed();
      flat.computeVertexNormals();
      return flat;
    }
    default: return new SphereGeometry(a, 32, 20);
  }
}
