// Writes a part of the store's definition to a file: moma_define_store tables.sql|views.sql|metrics.json|outcomes.json
// FILE
#include <cstdio>
#include <fstream>
#include <string>

#include "eval/store/definition.h"

int main(int argc, char** argv) {
  const std::string part = argc == 3 ? argv[1] : "";
  std::string text;
  if (part == "tables.sql") {
    text = moma::store::tables_sql();
  } else if (part == "views.sql") {
    text = moma::store::views_sql();
  } else if (part == "metrics.json") {
    text = moma::store::metrics_json();
  } else if (part == "outcomes.json") {
    text = moma::store::outcomes_json();
  } else {
    std::fprintf(stderr, "usage: moma_define_store tables.sql|views.sql|metrics.json|outcomes.json FILE\n");
    return 2;
  }
  std::ofstream file(argv[2], std::ios::binary);
  file << text << '\n';
  if (!file.flush()) {
    std::fprintf(stderr, "%s: cannot be written\n", argv[2]);
    return 2;
  }
  return 0;
}
