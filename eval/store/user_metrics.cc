#include "eval/store/user_metrics.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <mutex>
#include <new>
#include <string_view>

#include "controller/config/node.h"
#include "eval/store/samples.h"
#include "eval/store/statement.h"

namespace moma::store {
namespace {

struct Closer {
  void operator()(sqlite3* connection) const { sqlite3_close(connection); }
};

constexpr int kCheckEvery = 10000;  // steps of SQLite's machine
constexpr int kMostChecks = 1000;

/// Functions whose value is decided by their arguments. Values of metrics are hashed and compared between machines: no
/// clock, no chance, nothing of the connection or of how text is stored.
constexpr std::array<std::string_view, 53> kFunctions = {
    "abs",          "acos",        "acosh",    "asin",   "asinh",   "atan",  "atan2",      "atanh",      "avg",
    "ceil",         "ceiling",     "coalesce", "cos",    "cosh",    "count", "cume_dist",  "degrees",    "dense_rank",
    "exp",          "first_value", "floor",    "ifnull", "iif",     "lag",   "last_value", "lead",       "ln",
    "log",          "log10",       "log2",     "max",    "min",     "mod",   "nth_value",  "ntile",      "nullif",
    "percent_rank", "pi",          "pow",      "power",  "radians", "rank",  "round",      "row_number", "sign",
    "sin",          "sinh",        "sqrt",     "sum",    "tan",     "tanh",  "total",      "trunc"};

bool accepted(std::string_view function) {
  std::string lower(function);
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
  return std::ranges::find(kFunctions, lower) != kFunctions.end();
}

/// Expressions read samples and compute; nothing else. `refused` is the std::string that gets a function's name.
int authorize(void* refused, int action, const char* /*first*/, const char* second, const char* /*database*/,
              const char* /*trigger*/) {
  switch (action) {
    case SQLITE_SELECT:
    case SQLITE_READ:
    case SQLITE_RECURSIVE:
      return SQLITE_OK;
    case SQLITE_FUNCTION:
      if (second != nullptr && accepted(second)) return SQLITE_OK;
      if (second != nullptr) *static_cast<std::string*>(refused) = second;
      return SQLITE_DENY;
    default:
      return SQLITE_DENY;
  }
}

/// A connection in memory to a table of its own fails for want of memory alone, except by the SQL that it is given.
void expect(bool done) {
  if (!done) throw std::bad_alloc();
}

/// Names in a row whose numbers follow each other as the first and the last of them.
std::string ranges(const std::vector<std::string>& names) {
  const auto number = [](const std::string& name) { return name.find_last_not_of("0123456789") + 1; };
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::size_t digits = number(names[i]);
    const std::string stem = names[i].substr(0, digits);
    std::size_t last = i;
    while (digits < names[i].size() && last + 1 < names.size() && number(names[last + 1]) == digits &&
           names[last + 1].starts_with(stem))
      ++last;
    text += (i > 0 ? ", " : "") + names[i] + (last > i ? " to " + names[last] : "");
    i = last;
  }
  return text;
}

/// SQLite's word, and the columns where one is named that is not there.
std::string complaint(const std::string& of_sqlite, const std::vector<std::string>& columns) {
  constexpr std::string_view kUnknown = "no such column: ";
  if (!of_sqlite.starts_with(kUnknown)) return of_sqlite;
  return fmt::format("{}{}; columns are step, {}", of_sqlite,
                     config::suggestion(of_sqlite.substr(kUnknown.size()), columns), ranges(columns));
}

/// True if a ';' that is in no text and no comment ends a statement within `expression`. SQLite says nothing of what
/// comes behind it, and misses the columns of `FROM samples`, which is behind it too.
bool ends_within(const std::string& expression) {
  for (std::size_t at = expression.find(';'); at != std::string::npos; at = expression.find(';', at + 1))
    if (sqlite3_complete(expression.substr(0, at + 1).c_str()) == 1) return true;
  return false;
}

}  // namespace

/// One connection in memory with the table of one trial at a time.
struct UserMetrics::Evaluator {
  std::unique_ptr<sqlite3, Closer> connection;
  StatementPtr insert;
  StatementPtr clear;
  std::vector<StatementPtr> queries;
  std::size_t columns = 0;
  int checks = 0;
  std::string refused;  // the function that was asked for and is not accepted

  Evaluator(const std::vector<std::pair<std::string, std::string>>& metrics, Eigen::Index q, Eigen::Index v) {
    sqlite3* raw = nullptr;
    const int opened = sqlite3_open(":memory:", &raw);
    connection.reset(raw);
    expect(opened == SQLITE_OK);
    const std::vector<std::string> names = sample_columns(q, v);
    columns = names.size();
    std::string table = "CREATE TABLE samples (step INTEGER PRIMARY KEY";
    std::string marks = "?";
    for (const std::string& name : names) {
      table += fmt::format(", {} REAL", name);
      marks += ", ?";
    }
    execute((table + ")").c_str());
    insert = prepare(fmt::format("INSERT INTO samples VALUES ({})", marks));
    clear = prepare("DELETE FROM samples");
    expect(insert != nullptr && clear != nullptr);
    sqlite3_limit(raw, SQLITE_LIMIT_ATTACHED, 0);
    sqlite3_limit(raw, SQLITE_LIMIT_LENGTH, 10'000'000);
    sqlite3_set_authorizer(raw, &authorize, &refused);
    sqlite3_progress_handler(
        raw, kCheckEvery, [](void* self) { return ++static_cast<Evaluator*>(self)->checks > kMostChecks ? 1 : 0; },
        this);
    for (std::size_t i = 0; i < metrics.size(); ++i) {
      const std::string& expression = metrics[i].second;
      if (expression.find_first_not_of(" \t\r\n") == std::string::npos)
        throw MetricError(i, "found nothing, expected an SQL expression over a trial's samples, for instance max(t)");
      if (ends_within(expression)) throw MetricError(i, "is more than one expression: ';' ends it");
      // Without brackets around it too, so that its own cannot close those.
      const bool alone = prepare(fmt::format("SELECT {}\n FROM samples", expression)) != nullptr;
      const std::string why_not = alone ? "" : complaint(sqlite3_errmsg(raw), names);
      StatementPtr query = prepare(fmt::format("SELECT ({}\n) FROM samples", expression));
      if (!refused.empty()) {
        throw MetricError(
            i, fmt::format("the function {}() is not accepted; accepted are {}", refused, fmt::join(kFunctions, ", ")));
      }
      expect(sqlite3_errcode(raw) != SQLITE_NOMEM);
      if (alone && query == nullptr) throw MetricError(i, complaint(sqlite3_errmsg(raw), names));
      if (!alone) throw MetricError(i, query == nullptr ? why_not : "its brackets do not match: it is one expression");
      if (sqlite3_bind_parameter_count(query.get()) > 0) throw MetricError(i, "has an unbound parameter (? or :name)");
      // An aggregate gives one row even of no samples; anything else would be the value of some sample.
      checks = 0;
      const int code = sqlite3_step(query.get());
      expect(code != SQLITE_NOMEM);
      if (code != SQLITE_ROW && code != SQLITE_DONE) throw MetricError(i, sqlite3_errmsg(raw));
      if (code == SQLITE_DONE) {
        throw MetricError(i, fmt::format("'{}' is one value per sample; make it one per trial by an aggregate, "
                                         "for instance max({})",
                                         expression, expression));
      }
      sqlite3_reset(query.get());
      queries.push_back(std::move(query));
    }
  }
  Evaluator(const Evaluator&) = delete;
  Evaluator& operator=(const Evaluator&) = delete;

  StatementPtr prepare(const std::string& sql) const {
    sqlite3_stmt* statement = nullptr;
    const char* tail = nullptr;
    if (sqlite3_prepare_v3(connection.get(), sql.c_str(), -1, SQLITE_PREPARE_PERSISTENT, &statement, &tail) !=
        SQLITE_OK)
      return nullptr;
    StatementPtr owned(statement);
    return tail != nullptr && *tail != '\0' ? nullptr : std::move(owned);
  }

  void execute(const char* sql) const {
    expect(sqlite3_exec(connection.get(), sql, nullptr, nullptr, nullptr) == SQLITE_OK);
  }

  void fill(const Trace& trace) {
    sqlite3_set_authorizer(connection.get(), nullptr, nullptr);
    expect(sqlite3_step(clear.get()) == SQLITE_DONE);
    sqlite3_reset(clear.get());
    execute("BEGIN");
    for (std::size_t k = 0; k < trace.size(); ++k) {
      const std::vector<double> row = sample_row(trace[k]);
      sqlite3_bind_int64(insert.get(), 1, static_cast<sqlite3_int64>(k));
      for (std::size_t c = 0; c < columns; ++c) {
        const int index = static_cast<int>(c) + 2;
        if (c < row.size() && std::isfinite(row[c])) {
          sqlite3_bind_double(insert.get(), index, row[c]);
        } else {
          sqlite3_bind_null(insert.get(), index);
        }
      }
      expect(sqlite3_step(insert.get()) == SQLITE_DONE);
      sqlite3_reset(insert.get());
    }
    execute("COMMIT");
    sqlite3_set_authorizer(connection.get(), &authorize, &refused);
  }

  double value(sqlite3_stmt* query) {
    checks = 0;
    double result = kAbsent;
    const int code = sqlite3_step(query);
    expect(code != SQLITE_NOMEM);
    if (code == SQLITE_ROW) {
      const int type = sqlite3_column_type(query, 0);
      if (type == SQLITE_INTEGER || type == SQLITE_FLOAT) result = sqlite3_column_double(query, 0);
    }
    sqlite3_reset(query);
    return std::isfinite(result) ? result : kAbsent;
  }
};

struct UserMetrics::Pool {
  std::mutex mutex;
  std::vector<std::unique_ptr<Evaluator>> idle;
};

UserMetrics::UserMetrics(std::vector<std::pair<std::string, std::string>> metrics, Eigen::Index q, Eigen::Index v)
    : metrics_(std::move(metrics)), q_(q), v_(v), pool_(std::make_unique<Pool>()) {
  pool_->idle.push_back(std::make_unique<Evaluator>(metrics_, q_, v_));
}

UserMetrics::~UserMetrics() = default;

std::vector<double> UserMetrics::evaluate(const Trace& trace) const {
  std::unique_ptr<Evaluator> evaluator;
  {
    const std::scoped_lock lock(pool_->mutex);
    if (!pool_->idle.empty()) {
      evaluator = std::move(pool_->idle.back());
      pool_->idle.pop_back();
    }
  }
  if (evaluator == nullptr) evaluator = std::make_unique<Evaluator>(metrics_, q_, v_);
  std::vector<double> values(metrics_.size(), kAbsent);
  if (!trace.empty()) {
    evaluator->fill(trace);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = evaluator->value(evaluator->queries[i].get());
  }
  const std::scoped_lock lock(pool_->mutex);
  pool_->idle.push_back(std::move(evaluator));
  return values;
}

}  // namespace moma::store
