#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

namespace moma::risk {

/// Things by their places, in rising order.
using Things = std::vector<std::size_t>;

/// The first of some sets that still fails; none where all pass.
using FirstFailing = std::function<std::optional<std::size_t>(const std::vector<Things>&)>;

/// The smallest set of 0 .. count - 1 found that still fails, `needed` in it where there is one. The whole fails.
/// Failures are not monotone: a pair may fail where the halves that hold it pass. So first come `needed` alone and with
/// any other one, then halves, quarters, ... and what they leave (ddmin), then pairs of what is left. In the end no
/// single one can be taken away, by what `failing` said last.
/// Source: Zeller & Hildebrandt, IEEE Trans. Softw. Eng. 28(2), 2002.
Things shrink_set(std::size_t count, std::optional<std::size_t> needed, const FirstFailing& failing);

}  // namespace moma::risk
