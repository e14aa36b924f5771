#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "eval/batch/batch.h"

namespace moma {

// A trial's result as bytes, for another process of the same program on a machine of the same kind. Numbers keep their
// memory representation, so that every bit arrives.

using Bytes = std::vector<unsigned char>;

Bytes encode_result(std::uint64_t place, const BatchResult& result);

struct DecodedResult {
  std::uint64_t place = 0;
  BatchResult result;
};
/// Throws std::runtime_error if the bytes are no output of encode_result().
DecodedResult decode_result(std::span<const unsigned char> bytes);

}  // namespace moma
