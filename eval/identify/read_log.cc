#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstring>
#include <new>
#include <optional>
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
  Columns(MotionLog& log, std::size_t columns) : log_(log) {
    for (const char* name : {"base.vx", "base.vy", "base.omega"}) log_.base.emplace_back().name = name;
    // Destinations must not move while the others are created.
    log_.joints.reserve(columns);
    log_.objects.reserve(columns);
  }

  /// nullptr for an unknown name.
  std::vector<double>* place(const std::string& name) {
    if (std::vector<double>* known = find(name)) return known;
    // A name may contain dots.
    const std::size_t first = name.find('.'), last = name.rfind('.');
    if (last == std::string::npos || last <= first + 1) return nullptr;
    const std::string kind = name.substr(0, first), own = name.substr(first + 1, last - first - 1);
    const std::string part = name.substr(last + 1);
    if (log_.joints.size() + log_.objects.size() >= kMost) return nullptr;
    if (kind == "joint") {
      Axis& joint = log_.joints.emplace_back();
      joint.name = own;
      joint.prismatic = part.ends_with("_m") || part.ends_with("_m_s");
      if (std::vector<double>* made = find(name)) return made;
      log_.joints.pop_back();
    } else if (kind == "object") {
      log_.objects.emplace_back().name = own;
      if (std::vector<double>* made = find(name)) return made;
      log_.objects.pop_back();
    }
    return nullptr;
  }

  /// Removes the base's axes that the log lacks, and returns a message about missing columns; "" if complete.
  std::string finish() {
    if (log_.rows() == 0) return "there are no rows, or no column time_s";
    const std::size_t poses =
        (log_.base_x.empty() ? 0 : 1) + (log_.base_y.empty() ? 0 : 1) + (log_.base_heading.empty() ? 0 : 1);
    if (poses != 0 && poses != 3) return "base.x_m, base.y_m and base.heading_rad go together";
    for (const Axis& axis : log_.base)
      if (axis.velocity.empty() != axis.command.empty())
        return fmt::format("base.command_{0}_.. and base.{0}_.. go together", axis.name.substr(5));
    std::erase_if(log_.base, [](const Axis& axis) { return axis.velocity.empty(); });
    if (log_.base.size() == 1 || (log_.base.size() == 2 && log_.base[1].name != "base.omega"))
      return "a base has vx and omega, or vx, vy and omega";
    for (const Axis& axis : log_.joints)
      if (axis.velocity.empty() || axis.command.empty())
        return fmt::format("joint {} needs its command and its velocity", axis.name);
    for (const LoggedObject& object : log_.objects)
      if (object.x.empty() || object.y.empty() || object.z.empty())
        return fmt::format("object {} needs x_m, y_m and z_m", object.name);
    return log_.base.empty() && log_.joints.empty() ? "neither base nor joints have commands and velocities" : "";
  }

 private:
  std::vector<double>* find(const std::string& name) {
    for (const LogColumn& column : columns_of(log_))
      if (column.name == name) return column.values;
    return nullptr;
  }

  static constexpr std::size_t kMost = 1000;  // joints and objects
  MotionLog& log_;
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
  std::optional<Columns> columns;
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
      columns.emplace(log, fields.size());
      for (const Field& field : fields) {
        const Mark at{name, mark.line, field.column};
        std::vector<double>* const place = columns->place(std::string(field.text));
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
  if (!columns) columns.emplace(log, 0);
  if (const std::string wrong = columns->finish(); !wrong.empty()) config::fail({name, 0, 0}, "", wrong);
  check_times(log);
  return log;
}

MotionLog read_log(const fs::path& file) {
  std::string text;
  try {
    text = config::read_text_file(file);
  } catch (const std::runtime_error& error) {
    config::fail({file.string(), 0, 0}, "", error.what());
  }
  return parse_log(text, file.string());
}

}  // namespace moma::identify
