#pragma once

#include "controller/plan/search.h"

namespace moma {

/// Tries change number `index` of the edges, and takes it if it is free and quicker; returns true then. A shortcut
/// joins two times (every third try: two corners) by one edge; every second such edge of a differential base ends in
/// its driving direction. With `pulls` every second try instead brings the corners between two others nearer to the
/// straight way of the arm between those, in one joint (after Geraerts & Overmars, "Creating high-quality paths for
/// motion planning", IJRR 2007) or in all, by a random part. `work` is scratch. Checks at most three edges.
bool try_shortcut(FreeSpace& space, double check_step, int index, bool pulls, CountedDraws& draws, EdgeList& edges,
                  EdgeList& work) noexcept;

}  // namespace moma
