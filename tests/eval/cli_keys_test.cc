// `moma keys`: what it lists, and what it says of a prefix that nothing begins with.

#include <algorithm>
#include <set>
#include <sstream>
#include <string>

#include "cli_fixture.h"

namespace moma {
namespace {

using CliKeys = test::CliTest;

TEST_F(CliKeys, OnesThatBeginSoWithUnitAndDefault) {
  const std::string out = good({"keys", "controller.servo."}).out;
  std::istringstream lines(out);
  std::string line, position;
  int keys = 0;
  while (std::getline(lines, line)) {
    if (line.starts_with("controller.")) {
      ++keys;
      EXPECT_TRUE(line.starts_with("controller.servo.")) << line;
    }
    if (line.starts_with("controller.servo.position")) position = line;
  }
  EXPECT_EQ(keys, 7) << out;
  for (const char* word : {"1/s", "1.5", "k_p"})
    EXPECT_NE(position.find(word), std::string::npos) << word << "\n" << out;
}

TEST_F(CliKeys, AllAreListedOnce) {
  std::istringstream lines(good({"keys"}).out);
  std::set<std::string> names;
  std::string line;
  while (std::getline(lines, line)) {
    const std::string name = line.substr(0, line.find(' '));
    EXPECT_TRUE(names.insert(name).second) << name << " is listed twice";
  }
  for (const char* name : {"trials", "simulation.mode", "controller.servo.position", "worlds.seed",
                           "worlds.families.moving.weight", "tune.budget.trials", "tune.racing.first"})
    EXPECT_TRUE(names.contains(name)) << name;
}

TEST_F(CliKeys, BoundsAreShort) {
  constexpr std::size_t kMostDigits = 19;  // of a seed of 63 bits; the largest double has 309
  const std::string out = good({"keys"}).out;
  for (std::size_t at = 0; (at = out.find_first_of("0123456789", at)) != std::string::npos;) {
    const std::size_t end = std::min(out.find_first_not_of("0123456789", at), out.size());
    EXPECT_LE(end - at, kMostDigits) << out.substr(at, end - at);
    at = end;
  }
  bad({"run", "suite.yaml", "-o", "a.db", "--set", "simulation.time_limit=-1"}, {"a number from 0 to 3600, above 0\n"});
  EXPECT_EQ(out.find("e+308"), std::string::npos) << "the largest double is no bound";
  bad({"run", "suite.yaml", "-o", "a.db", "--set", "stuck.time=-1"}, {"a number above 0, or .inf\n"});
  bad({"run", "suite.yaml", "-o", "a.db", "--set", "trials=0"}, {"a whole number from 1 to 100000000\n"});
}

TEST_F(CliKeys, APrefixOfNoneSaysWhatIsMeant) {
  bad({"keys", "lambda_q"}, {"no key begins with 'lambda_q'", "did you mean controller.lambda_q"});
  bad({"keys", "simulation.mod3"}, {"no key begins with", "simulation.mode"});
}

}  // namespace
}  // namespace moma
