// URDFs, read strictly and leniently: what is accepted strictly is the same leniently, with nothing left out.
#include <cstdlib>
#include <optional>

#include "controller/model/text_check.h"
#include "controller/model/urdf.h"
#include "tests/fuzz/target.h"

namespace {

std::optional<moma::UrdfTree> read(const std::string& text, moma::UrdfReading reading) {
  try {
    return moma::read_urdf(text, reading);
  } catch (const moma::UrdfError&) {
    return {};
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text = moma::fuzz::text_of(data, size);
  const auto strict = read(text, moma::UrdfReading::kStrict);
  const auto lenient = read(text, moma::UrdfReading::kLenient);
  if (lenient) {  // names become JSON
    std::string names = lenient->name;
    for (const moma::UrdfLink& link : lenient->links) names += link.name + link.joint.name;
    for (const std::string& what : lenient->left_out) names += what;
    if (moma::not_text(names) != std::string::npos) std::abort();
  }
  if (strict && (!lenient || !lenient->left_out.empty() || lenient->links.size() != strict->links.size())) std::abort();
  return 0;
}
