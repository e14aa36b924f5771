#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

namespace moma::risk {

/// Items by index, in ascending order.
using Things = std::vector<std::size_t>;

/// Returns the first of some sets that still fails; nothing if all pass.
using FirstFailing = std::function<std::optional<std::size_t>(const std::vector<Things>&)>;

/// Searches for the smallest failing subset of 0 .. count - 1, with `needed` in it if set. The whole set fails.
/// Failures are not monotone: a pair may fail although the halves that contain it pass. The search therefore tries
/// `needed` alone and with one other item, then halves, quarters, ... and their complements (ddmin), then pairs of the
/// remaining items. In the end no single item can be removed. `singly`: tries that alone. No set is asked for again
/// once it has passed. Source: Zeller & Hildebrandt, IEEE Trans. Softw. Eng. 28(2), 2002.
Things shrink_set(std::size_t count, std::optional<std::size_t> needed, const FirstFailing& failing,
                  bool singly = false);

}  // namespace moma::risk
