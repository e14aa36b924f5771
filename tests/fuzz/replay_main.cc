// Runs a target over the files of a corpus and over changed copies of them, the same ones every time: what a fuzzer
// found stays found, by any compiler.
//   fuzz_NAME_replay CORPUS [CHANGES]   CHANGES: changed copies of each file (0)
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "tests/fuzz/draws.h"
#include "tests/fuzz/target.h"

#pragma weak LLVMFuzzerCustomMutator

namespace {

namespace fs = std::filesystem;

using Draws = moma::fuzz::Draws;

constexpr std::size_t kMost = 16384;  // bytes of an input, as in scripts/fuzz.sh

std::string changed(std::string text, const std::string& other, Draws& draws) {
  static const std::vector<std::string> kWords = {"0",
                                                  "-1",
                                                  "1e308",
                                                  "1e-320",
                                                  "nan",
                                                  ".inf",
                                                  "[",
                                                  "]",
                                                  "{",
                                                  "}",
                                                  "\"",
                                                  "'",
                                                  "<",
                                                  ">",
                                                  "/>",
                                                  "&a ",
                                                  "*a",
                                                  "- ",
                                                  ": ",
                                                  "\n",
                                                  "\n---\n",
                                                  "include: ",
                                                  "''",
                                                  ",",
                                                  "99999999999999999999",
                                                  std::string(1, '\0'),
                                                  "\xff\xfe"};
  for (std::size_t n = 1 + draws.below(4); n > 0; --n) {
    const std::size_t at = draws.below(text.size() + 1);
    const std::size_t length = std::min(draws.below(20), text.size() - at);
    switch (draws.below(6)) {
      case 0:
        if (at < text.size()) text[at] = static_cast<char>(draws.next() & 0xffU);
        break;
      case 1:
        text.erase(at, length);
        break;
      case 2:
        text.insert(at, kWords[draws.below(kWords.size())]);
        break;
      case 3:
        text.insert(draws.below(text.size() + 1), text.substr(at, length));
        break;
      case 4:
        text.replace(at, length, kWords[draws.below(kWords.size())]);
        break;
      default:
        text.insert(at, other.substr(draws.below(other.size() + 1), 40));
    }
  }
  return text;
}

/// By the target's own mutator where it has one.
std::string changed_as_the_fuzzer_would(const std::string& text, const std::string& other, Draws& draws) {
  if (LLVMFuzzerCustomMutator == nullptr || draws.below(2) == 0) return changed(text, other, draws);
  std::string room = text.substr(0, kMost);
  const std::size_t size = room.size();
  room.resize(kMost);
  // Even: what keeps the structure.
  const auto seed = static_cast<unsigned>(draws.next()) & ~1U;
  room.resize(LLVMFuzzerCustomMutator(reinterpret_cast<std::uint8_t*>(room.data()), size, kMost, seed));
  return room;
}

void run(const std::string& text) {
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
}

}  // namespace

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer's name
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most) {
  const std::string text = moma::fuzz::text_of(data, size);
  Draws draws{size};
  const std::string other = changed(text, text, draws).substr(0, most);
  std::copy(other.begin(), other.end(), data);
  return other.size();
}

int main(int argc, char** argv) {
  if (argc < 2) return std::fputs("usage: fuzz_NAME_replay CORPUS [CHANGES]\n", stderr), 2;
  const long changes = argc > 2 ? std::strtol(argv[2], nullptr, 10) : 0;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(argv[1]))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  if (files.empty()) return std::fprintf(stderr, "%s: no files\n", argv[1]), 1;
  std::vector<std::string> texts;
  for (const fs::path& file : files) {
    std::ifstream in(file, std::ios::binary);
    texts.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
  const auto start = std::chrono::steady_clock::now();
  long inputs = 0;
  for (std::size_t i = 0; i < texts.size(); ++i) {
    // Said before it is run, so that the last line names what ended the process.
    std::printf("%s\n", files[i].filename().c_str());
    std::fflush(stdout);
    run(texts[i]);
    Draws draws{i};
    for (long k = 0; k < changes; ++k)
      run(changed_as_the_fuzzer_would(texts[i], texts[draws.below(texts.size())], draws));
    inputs += 1 + changes;
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::printf("%ld inputs of %zu files, %.0f a second\n", inputs, files.size(),
              static_cast<double>(inputs) / std::max(seconds, 1e-9));
  return 0;
}
