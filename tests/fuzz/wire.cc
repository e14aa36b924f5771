// Results from other processes: the bytes of a good one, changed as the input says, or the input itself. What is
// accepted is written to what is accepted again.
#include <cstdlib>
#include <memory>
#include <stdexcept>

#include "controller/config/json_node.h"
#include "controller/config/text_file.h"
#include "eval/batch/wire.h"
#include "tests/fuzz/bytes.h"
#include "tests/fuzz/target.h"
#include "tests/support/filled.h"
#include "world/world_json.h"

namespace moma {
namespace {

Bytes good_result() {
  BatchResult result;
  result.world = std::make_shared<const World>(
      world_from_json(config::parse_json(config::read_text_file("tests/data/fuzz/world/moving.json"), "a"), "a"));
  test::Filler filler(1.0);
  filler.fill(result.output.row);
  result.output.trace.resize(3);
  for (Sample& sample : result.output.trace) filler.fill(sample);
  result.metrics = {0.1, -0.0};
  return encode_result(77, result);
}

Bytes changed(Bytes message, fuzz::Bytes& choices) {
  while (!choices.empty() && !message.empty()) {
    const auto at = static_cast<std::ptrdiff_t>((choices.byte() + std::size_t{256} * choices.byte()) % message.size());
    switch (choices.below(5)) {
      case 0:
        message[static_cast<std::size_t>(at)] = choices.byte();
        break;
      case 1:
        message.resize(static_cast<std::size_t>(at));
        break;
      case 2:
        message.insert(message.begin() + at, choices.byte());
        break;
      case 3:
        message.erase(message.begin() + at);
        break;
      default:  // a length of eight bytes
        for (std::size_t i = 0; i < 8 && static_cast<std::size_t>(at) + i < message.size(); ++i)
          message[static_cast<std::size_t>(at) + i] = choices.below(2) == 0 ? 0xff : 0x00;
    }
  }
  return message;
}

}  // namespace
}  // namespace moma

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace moma;
  static const Bytes kGood = good_result();
  fuzz::Bytes choices(data, size);
  const bool raw = choices.byte() % 8 == 7;
  const Bytes message = raw ? Bytes(data + 1, data + size) : changed(kGood, choices);
  try {
    const DecodedResult found = decode_result(message);
    const Bytes again = encode_result(found.place, found.result);
    const DecodedResult twice = decode_result(again);
    if (encode_result(twice.place, twice.result) != again) std::abort();
  } catch (const std::runtime_error&) {
  }
  return 0;
}
