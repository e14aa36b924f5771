#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace moma::test {

/// The part of a page of docs/ between the lines "<!-- NAME -->" and "<!-- end of NAME -->" is made by the program (of
/// a header: "/* NAME */"). This expects it to be `text`. With MOMA_UPDATE_DOCS=1 the file is written instead.
inline void expect_generated(const std::filesystem::path& page, const std::string& name, const std::string& text) {
  std::ifstream in(page, std::ios::binary);
  ASSERT_TRUE(in) << page;
  std::string all{std::istreambuf_iterator<char>(in), {}};
  const bool code = page.extension() == ".h";
  const auto mark = [&](const std::string& words) { return code ? "/* " + words + " */" : "<!-- " + words + " -->"; };
  const std::string open = mark(name) + "\n";
  const std::string close = mark("end of " + name);
  const std::size_t begin = all.find(open);
  const std::size_t end = all.find(close);
  ASSERT_TRUE(begin != std::string::npos && end != std::string::npos && begin < end)
      << page << " has no part '" << name << "'";
  const std::string found = all.substr(begin + open.size(), end - begin - open.size());
  if (std::getenv("MOMA_UPDATE_DOCS") != nullptr) {
    all.replace(begin + open.size(), found.size(), text);
    std::ofstream(page, std::ios::binary) << all;
    return;
  }
  EXPECT_EQ(found, text) << page << ": MOMA_UPDATE_DOCS=1 and this test write the part '" << name << "' anew";
}

}  // namespace moma::test
