#include "controller/plan/tree.h"

namespace moma {

int Tree::nearest(const WholeConfiguration& c) const noexcept {
  int best = -1;
  double least = 0.0;
  for (int i = 0; i < size_; ++i) {
    const double d = distance_squared(nodes_.col(i), c);
    if (best >= 0 && d >= least) continue;
    least = d;
    best = i;
  }
  return best;
}

}  // namespace moma
