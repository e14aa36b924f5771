#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "controller/config/robot_file.h"
#include "controller/draft/draft_robot.h"

// URDFs made of parts, and the robot files drafted of them.
namespace moma::draft {

namespace fs = std::filesystem;

inline std::string link(const std::string& name, const std::string& geometry = "", double mass = 1.0,
                        const std::string& at = "0 0 0") {
  return "<link name='" + name + "'>" +
         (mass > 0.0 ? "<inertial><mass value='" + std::to_string(mass) +
                           "'/><inertia ixx='0.01' iyy='0.01' izz='0.01' ixy='0' ixz='0' iyz='0'/></inertial>"
                     : "") +
         (geometry.empty() ? ""
                           : "<collision><origin xyz='" + at + "'/><geometry>" + geometry + "</geometry></collision>") +
         "</link>\n";
}

inline std::string joint(const std::string& name, const std::string& type, const std::string& parent,
                         const std::string& child, const std::string& xyz, const std::string& axis,
                         const std::string& limit = "") {
  return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent + "'/><child link='" + child +
         "'/><origin xyz='" + xyz + "'/><axis xyz='" + axis + "'/>" + limit + "</joint>\n";
}

inline const std::string kLimit = "<limit lower='-2' upper='2' velocity='1.5' effort='60'/>";

// Links PREFIXa1 to PREFIXa6 on `parent`, a flange, two fingers that slide, a tool.
inline std::string arm(const std::string& parent, const std::string& prefix, const std::string& xyz) {
  std::string text;
  std::string before = parent;
  for (int i = 1; i <= 6; ++i) {
    const std::string name = prefix + "a" + std::to_string(i);
    text += link(name, "<sphere radius='0.04'/>", 1.0, "0 0 0.08");
    text += joint(prefix + "j" + std::to_string(i), "revolute", before, name, i == 1 ? xyz : "0 0 0.16",
                  i % 2 == 1 ? "0 0 1" : "0 1 0", kLimit);
    before = name;
  }
  text +=
      link(prefix + "hand_base") + joint(prefix + "mount", "fixed", before, prefix + "hand_base", "0 0 0.16", "1 0 0");
  for (const std::string side : {"l", "r"}) {
    const std::string name = prefix + side + "_pad";
    text += link(name, "<box size='0.01 0.02 0.05'/>", 0.05) +
            joint(prefix + side + "_finger", "prismatic", prefix + "hand_base", name, "0 0 0.05", "0 1 0",
                  "<limit lower='0' upper='0.04' velocity='0.1' effort='20'/>");
  }
  return text + link(prefix + "tool0", "", 0.0) +
         joint(prefix + "tool", "fixed", prefix + "hand_base", prefix + "tool0", "0 0 0.1", "1 0 0");
}

inline std::string wheel(const std::string& name, const std::string& xyz, const std::string& axis = "0 1 0",
                         const std::string& parent = "base_link") {
  return link(name, "<sphere radius='0.1'/>", 2.0) +
         joint(name + "_joint", "continuous", parent, name, xyz, axis, "<limit velocity='12' effort='20'/>");
}

inline std::string body() { return link("base_link", "<box size='0.6 0.4 0.2'/>", 40.0); }

/// Whether the drafted file has these words.
inline ::testing::AssertionResult says(const Draft& draft, const std::string& words) {
  const bool found = draft.text.find(words) != std::string::npos;
  return (found ? ::testing::AssertionSuccess() : ::testing::AssertionFailure())
         << "'" << words << "' is " << (found ? "" : "not ") << "in:\n"
         << draft.text;
}

class Drafts : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("moma_draft_" + std::to_string(::getpid()) + "_" +
                                           ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path urdf(const std::string& parts, const std::string& file = "robot.urdf") const {
    std::ofstream(folder_ / file) << "<?xml version='1.0'?>\n<robot name='made'>\n" << parts << "</robot>\n";
    return folder_ / file;
  }

  // The drafted robot as its file is read.
  config::LoadedRobot load(const Draft& draft) const {
    std::ofstream(folder_ / "robot.yaml") << draft.text;
    return config::load_robot(folder_ / "robot.yaml");
  }

  Draft draft(const std::string& parts) const { return draft_robot({urdf(parts), folder_, false}); }

  fs::path folder_;
};

}  // namespace moma::draft
