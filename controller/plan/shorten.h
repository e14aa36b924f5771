#pragma once

#include "controller/plan/search.h"

namespace moma {

/// The `index`-th try of a shortcut: two times on the edges (each third of two corners) are joined by one edge, of
/// which each second of a differential base ends as it drives; taken where that is free and quicker. `work` and `spare`
/// are scratch. One piece of work: at most three edges are checked.
void try_shortcut(FreeSpace& space, double check_step, int index, CountedDraws& draws, EdgeList& edges, EdgeList& work,
                  Edge& spare) noexcept;

}  // namespace moma
