#pragma once

#include "controller/plan/search.h"

namespace moma {

/// Tries shortcut number `index`: it joins two times on the edges (every third try: two corners) by one edge and takes
/// that if it is free and quicker. Every second edge of a differential base ends in its driving direction. `work` is
/// scratch. Checks at most three edges.
void try_shortcut(FreeSpace& space, double check_step, int index, CountedDraws& draws, EdgeList& edges,
                  EdgeList& work) noexcept;

}  // namespace moma
