// Writes a part of the store's definition to a file: moma_define_store PART FILE
#include <cstdio>
#include <fstream>
#include <string>
#include <string_view>

#include "eval/store/definition.h"

namespace {

struct Part {
  std::string_view name;
  std::string (*text)();
};
constexpr Part kParts[] = {
    {"tables.sql", &moma::store::tables_sql},          {"views.sql", &moma::store::views_sql},
    {"overall.sql", &moma::store::query_of_overall},   {"metrics.json", &moma::store::json_of_metrics},
    {"outcomes.json", &moma::store::json_of_outcomes}, {"samples.json", &moma::store::json_of_samples},
};

}  // namespace

int main(int argc, char** argv) {
  for (const Part& part : kParts) {
    if (argc != 3 || part.name != argv[1]) continue;
    std::ofstream file(argv[2], std::ios::binary);
    file << part.text() << '\n';
    if (file.flush()) return 0;
    std::fprintf(stderr, "%s: cannot be written\n", argv[2]);
    return 2;
  }
  std::fprintf(stderr, "usage: moma_define_store PART FILE; parts:");
  for (const Part& part : kParts) std::fprintf(stderr, " %s", part.name.data());
  std::fprintf(stderr, "\n");
  return 2;
}
