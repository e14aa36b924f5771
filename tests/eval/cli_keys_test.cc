// `moma keys`: what it lists, and what it says of a prefix that nothing begins with.

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
  EXPECT_GT(keys, 5) << out;
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

TEST_F(CliKeys, APrefixOfNoneSaysWhatIsMeant) {
  bad({"keys", "lambda_q"}, {"no key begins with 'lambda_q'", "did you mean controller.lambda_q"});
  bad({"keys", "simulation.mod3"}, {"no key begins with", "simulation.mode"});
}

}  // namespace
}  // namespace moma
