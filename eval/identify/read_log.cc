#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstring>
#include <map>
#include <new>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "controller/config/node.h"
#include "controller/config/text_file.h"
#include "eval/identify/motion_log.h"

namespace moma::identify {
namespace {

using config::Mark;

constexpr const char* kColumns =
    "time_s, base.x_m, base.y_m, base.heading_rad, base.stamp_s, base.{vx,vy}_m_s, base.omega_rad_s, "
    "base.command_{vx,vy}_m_s, base.command_omega_rad_s, joint.stamp_s, joint.NAME.{position_rad, velocity_rad_s, "
    "command_rad_s} (or _m, _m_s), object.NAME.{x_m, y_m, z_m, stamp_s}";

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && std::strchr(" \t\r\"", text.front()) != nullptr) text.remove_prefix(1);
  while (!text.empty() && std::strchr(" \t\r\"", text.back()) != nullptr) text.remove_suffix(1);
  return text;
}

struct Field {
  std::string_view text;
  int column;  // column in the line, from 1
};

std::vector<Field> fields_of(std::string_view line) {
  std::vector<Field> out;
  std::size_t begin = 0;
  for (;;) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    out.push_back({trimmed(line.substr(begin, end - begin)), static_cast<int>(begin) + 1});
    if (end == line.size()) return out;
    begin = end + 1;
  }
}

// Finds the destination of a column's values, and creates joints and objects by their names.
class Columns {
 public:
  explicit Columns(MotionLog& log) : log_(log) {
    for (const char* name : {"vx", "vy", "omega"}) base_[name].name = std::string("base.") + name;
  }

  /// nullptr for an unknown name.
  std::vector<double>* place(std::string_view name) {
    const std::map<std::string_view, std::vector<double>*> plain = {
        {"time_s", &log_.time},
        {"base.x_m", &log_.base_x},
        {"base.y_m", &log_.base_y},
        {"base.heading_rad", &log_.base_heading},
        {"base.stamp_s", &log_.base_stamp},
        {"joint.stamp_s", &log_.joint_stamp},
        {"base.vx_m_s", &base_["vx"].velocity},
        {"base.vy_m_s", &base_["vy"].velocity},
        {"base.omega_rad_s", &base_["omega"].velocity},
        {"base.command_vx_m_s", &base_["vx"].command},
        {"base.command_vy_m_s", &base_["vy"].command},
        {"base.command_omega_rad_s", &base_["omega"].command}};
    if (const auto found = plain.find(name); found != plain.end()) return found->second;
    // A name may contain dots.
    const std::size_t dot = name.rfind('.');
    if (name.starts_with("joint.") && dot > 6 && dot != std::string_view::npos)
      return joint(std::string(name.substr(6, dot - 6)), name.substr(dot + 1));
    if (name.starts_with("object.") && dot > 7 && dot != std::string_view::npos)
      return object(std::string(name.substr(7, dot - 7)), name.substr(dot + 1));
    return nullptr;
  }

  /// Moves the values into the log, and returns a message about missing columns; "" if complete.
  std::string finish() {
    const std::size_t rows = log_.time.size();
    if (rows == 0) return "there are no rows, or no column time_s";
    const std::size_t poses =
        (log_.base_x.empty() ? 0 : 1) + (log_.base_y.empty() ? 0 : 1) + (log_.base_heading.empty() ? 0 : 1);
    if (poses != 0 && poses != 3) return "base.x_m, base.y_m and base.heading_rad go together";
    for (const char* name : {"vx", "vy", "omega"}) {
      Axis& axis = base_[name];
      if (axis.velocity.empty() != axis.command.empty())
        return fmt::format("base.command_{0}_.. and base.{0}_.. go together", name);
      if (!axis.velocity.empty()) log_.base.push_back(std::move(axis));
    }
    if (log_.base.size() == 1 || (log_.base.size() == 2 && log_.base[1].name != "base.omega"))
      return "a base has vx and omega, or vx, vy and omega";
    for (Axis& axis : joints_) {
      if (axis.velocity.empty() || axis.command.empty())
        return fmt::format("joint {} needs its command and its velocity", axis.name);
      log_.joints.push_back(std::move(axis));
    }
    for (LoggedObject& object : objects_) {
      if (object.x.empty() || object.y.empty() || object.z.empty())
        return fmt::format("object {} needs x_m, y_m and z_m", object.name);
      log_.objects.push_back(std::move(object));
    }
    return log_.base.empty() && log_.joints.empty() ? "neither base nor joints have commands and velocities" : "";
  }

 private:
  /// Finds the entry of that name, or creates it as a copy of `first`; null if there are too many. Names come in any
  /// order, and destinations must not move while rows are read.
  template <class T>
  static T* named(std::vector<T>& all, const std::string& name, T first) {
    for (T& known : all)
      if (known.name == name) return &known;
    all.reserve(kMost);
    if (all.size() == kMost) return nullptr;
    all.push_back(std::move(first));
    all.back().name = name;
    return &all.back();
  }
  std::vector<double>* joint(const std::string& name, std::string_view part) {
    std::vector<double> Axis::*member = part == "position_rad" || part == "position_m"       ? &Axis::position
                                        : part == "velocity_rad_s" || part == "velocity_m_s" ? &Axis::velocity
                                        : part == "command_rad_s" || part == "command_m_s"   ? &Axis::command
                                                                                             : nullptr;
    if (member == nullptr) return nullptr;
    Axis first;  // its first column tells revolute from prismatic
    first.prismatic = part == "position_m" || part == "velocity_m_s" || part == "command_m_s";
    Axis* axis = named(joints_, name, std::move(first));
    return axis == nullptr ? nullptr : &(axis->*member);
  }
  std::vector<double>* object(const std::string& name, std::string_view part) {
    std::vector<double> LoggedObject::*member = part == "x_m"       ? &LoggedObject::x
                                                : part == "y_m"     ? &LoggedObject::y
                                                : part == "z_m"     ? &LoggedObject::z
                                                : part == "stamp_s" ? &LoggedObject::stamp
                                                                    : nullptr;
    if (member == nullptr) return nullptr;
    LoggedObject* seen = named(objects_, name, LoggedObject{});
    return seen == nullptr ? nullptr : &(seen->*member);
  }

  static constexpr std::size_t kMost = 1000;  // reserved, so that destinations do not move
  MotionLog& log_;
  std::map<std::string, Axis> base_;
  std::vector<Axis> joints_;
  std::vector<LoggedObject> objects_;
};

double number(const Field& field, const Mark& line, const std::string& column) {
  const Mark mark{line.file, line.line, field.column};
  double value = 0.0;
  const char* const end = field.text.data() + field.text.size();
  const auto result = std::from_chars(field.text.data(), end, value);
  if (result.ec != std::errc{} || result.ptr != end)
    config::fail(mark, column, fmt::format("found '{}', expected a number", field.text));
  if (!std::isfinite(value))
    config::fail(mark, column, fmt::format("found '{}', expected a finite number", field.text));
  return value;
}

}  // namespace

MotionLog parse_log(const std::string& text, const std::string& name) {
  if (text.find('\0') != std::string::npos)
    config::fail({name, 0, 0}, "", "is no text; expected CSV, as `moma replay --log` writes it");
  MotionLog log;
  log.source = name;
  Columns columns(log);
  std::vector<std::string> names;
  std::vector<std::vector<double>*> places;
  std::istringstream in(text);
  std::string line;
  Mark mark{name, 0, 0};
  while (std::getline(in, line)) {
    ++mark.line;
    if (trimmed(line).empty() || line.front() == '#') {
      if (!log.time.empty()) config::fail(mark, "", "found an empty line or a comment between rows");
      continue;
    }
    const std::vector<Field> fields = fields_of(line);
    if (places.empty()) {
      for (const Field& field : fields) {
        const Mark at{name, mark.line, field.column};
        std::vector<double>* const place = columns.place(field.text);
        if (place == nullptr)
          config::fail(at, std::string(field.text), fmt::format("unknown column; there are {}", kColumns));
        for (const auto* known : places)
          if (known == place) config::fail(at, std::string(field.text), "the column was there before");
        places.push_back(place);
        names.emplace_back(field.text);
      }
      log.first_line = mark.line + 1;
      continue;
    }
    if (fields.size() != places.size())
      config::fail(mark, "", fmt::format("found {} values, expected {} as in the head", fields.size(), places.size()));
    for (std::size_t i = 0; i < fields.size(); ++i) places[i]->push_back(number(fields[i], mark, names[i]));
  }
  if (in.bad()) throw std::bad_alloc();  // getline() takes a failed allocation for the end
  if (const std::string wrong = columns.finish(); !wrong.empty()) config::fail({name, 0, 0}, "", wrong);
  check_times(log);
  return log;
}

MotionLog read_log(const std::filesystem::path& file) {
  std::string text;
  try {
    text = config::read_text_file(file);
  } catch (const std::runtime_error& error) {
    config::fail({file.string(), 0, 0}, "", error.what());
  }
  return parse_log(text, file.string());
}

}  // namespace moma::identify
